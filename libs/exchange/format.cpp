#include "exchange/format.hpp"

#include "exchange/writers.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <filesystem>

namespace jointcreep::exchange
{

namespace
{

const std::vector<std::string_view> all_layers{"joints", "bridges", "edges", "blocks", "section", "planes"};
const std::vector<std::string_view> section_layers{"joints", "bridges", "edges", "blocks", "section"};

std::string listed(const std::vector<std::string_view>& words, const char* between = " ")
{
    std::string text;
    for (const std::string_view word : words)
        text.append(text.empty() ? "" : between).append(word);
    return text;
}

std::string by_default(const Format& format)
{
    std::string text = listed(format.usual);
    if (!text.empty() && !format.usual_of_result.empty())
        text += "; of a result ";
    return text.append(format.usual_of_result);
}

std::string in_one_file(const Format& format)
{
    if (format.holds_several)
        return format.holds_realizations ? "layers, realizations" : "layers";
    return format.holds_realizations ? "realizations" : "-";
}

std::string written_by(const Format& format)
{
    return std::string(format.written) +
           (format.needs_gdal && !has_gdal() ? " (not in this build: GDAL was not found)" : "");
}

} // namespace

const std::vector<Format>& formats()
{
    // name, extensions, holds, usual, usual of a result, several layers, several realizations, how
    static const std::vector<Format> all{
        {"csv",
         {".csv"},
         {"joints", "bridges", "edges", "blocks", "section", "planes", "histories", "failure"},
         {"joints"},
         "histories",
         false,
         true,
         "table, RFC 4180",
         write_csv},
        {"vtu",
         {".vtu"},
         {"joints", "bridges", "edges", "blocks", "section", "planes", "zones", "contacts"},
         {"blocks"},
         "zones",
         false,
         false,
         "VTK XML, binary, appended",
         write_vtu,
         false,
         true},
        {"vtkhdf",
         {".vtkhdf"},
         {"joints", "bridges", "edges", "blocks", "section", "planes", "zones", "contacts"},
         {"blocks"},
         "zones",
         false,
         false,
         "VTKHDF 1.0, unstructured grid",
         write_vtkhdf,
         false,
         true},
        {"xdmf",
         {".xdmf2", ".xdmf"},
         {"zones", "contacts"},
         {},
         "zones",
         false,
         false,
         "XDMF 2, beside the HDF5 file"},
        {"geojson",
         {".geojson"},
         all_layers,
         {"joints"},
         "",
         false,
         true,
         "GeoJSON in metres of the section",
         write_geojson},
        {"gpkg",
         {".gpkg"},
         all_layers,
         section_layers,
         "",
         true,
         true,
         "GeoPackage, by GDAL",
         write_geopackage,
         true,
         true},
        {"shp",
         {".shp"},
         all_layers,
         {"joints"},
         "",
         false,
         true,
         "Shapefile, by GDAL",
         write_shapefile,
         true,
         true},
        {"dxf",
         {".dxf"},
         all_layers,
         {"joints", "section"},
         "",
         true,
         false,
         "AutoCAD R12 and a table of ids",
         write_dxf},
        {"svg", {".svg"}, section_layers, {"blocks", "joints"}, "", true, false, "SVG 1.1", write_svg},
        {"gmsh",
         {".geo"},
         {"blocks"},
         {"blocks"},
         "",
         false,
         false,
         "Gmsh's geometry with physical groups, and a table of ids",
         write_gmsh},
        {"udec",
         {".dat"},
         {"blocks"},
         {"blocks"},
         "",
         false,
         false,
         "UDEC 7, block create polygon, and a table of ids",
         write_udec},
        {"3dec",
         {".dat"},
         {"blocks", "planes"},
         {"blocks"},
         "",
         false,
         false,
         "3DEC 7, block create prism or fracture create, and a table of ids",
         write_3dec},
        {"yade",
         {".py"},
         {"blocks"},
         {"blocks"},
         "",
         false,
         false,
         "script of YADE, convex polyhedra",
         write_yade},
        {"fracman",
         {".fab"},
         {"planes"},
         {"planes"},
         "",
         false,
         false,
         "FracMan's .fab and a table of ids",
         write_fracman},
        {"dfnworks",
         {".dat"},
         {"planes"},
         {"planes"},
         "",
         false,
         false,
         "dfnWorks' polygons by corners and a table of ids",
         write_dfnworks},
        {"porepy",
         {".csv"},
         {"joints"},
         {"joints"},
         "",
         false,
         false,
         "PorePy's table of fractures in 2-D and a table of ids",
         write_porepy},
        {"fractopo",
         {".geojson"},
         {"joints"},
         {"joints"},
         "",
         false,
         false,
         "traces and target area for fractopo, two files",
         write_fractopo},
    };
    return all;
}

std::vector<Layer> Job::all(std::string_view name) const
{
    std::vector<Layer> made;
    for (const Section& section : sections) {
        made.push_back(layer_of(section, name, width));
        const auto headings = [](const Layer& layer) {
            std::vector<std::string> text;
            for (const Attribute& attribute : layer.attributes)
                text.push_back(attribute.heading());
            return text;
        };
        if (headings(made.back()) != headings(made[0]))
            throw input_error(section.file + ": " + std::string(name) +
                              " have other attributes than those of " + sections[0].file +
                              "; files in one output must be of one kind");
    }
    return made;
}

std::string formats_text()
{
    std::string text = "format\textension\tholds\tby default\tin one file\tas\n";
    for (const Format& format : formats())
        text.append(format.name)
            .append("\t")
            .append(listed(format.extensions))
            .append("\t")
            .append(listed(format.holds))
            .append("\t")
            .append(by_default(format))
            .append("\t")
            .append(in_one_file(format))
            .append("\t")
            .append(written_by(format))
            .append("\n");
    return text;
}

const Format& format_of(const std::string& output, const std::optional<std::string>& name)
{
    const std::string extension = std::filesystem::path(output).extension().string();
    const bool to_standard_output = output == "-";
    std::vector<std::string_view> names, extensions, shared, of_text;
    const Format* found = nullptr;
    for (const Format& format : formats()) {
        names.push_back(format.name);
        if (!format.is_binary)
            of_text.push_back(format.name);
        for (const std::string_view known : format.extensions)
            if (std::ranges::find(extensions, known) == extensions.end())
                extensions.push_back(known);
        const bool fits = std::ranges::find(format.extensions, extension) != format.extensions.end();
        if (fits)
            shared.push_back(format.name);
        if (name ? format.name == *name : fits && (!found || '.' + std::string(format.name) == extension))
            found = &format;
    }
    if (name && !found)
        throw input_error("--format is '" + *name + "'; the formats are: " + listed(names, ", "));
    if (to_standard_output && (!found || found->is_binary))
        throw input_error(
            (found ? "-o -: a file of the format " + *name +
                         " is binary, not for standard output; give the name of a file"
                   : std::string("-o -: standard output has no extension; give the format by --format")) +
            ". Formats that are text: " + listed(of_text, ", "));
    if (!found)
        throw input_error(output + ": the name must end in " + listed(extensions, ", ") +
                          ", which decides the format");
    if (name && !to_standard_output &&
        std::ranges::find(found->extensions, extension) == found->extensions.end())
        throw input_error(output + ": the name of a file of the format " + *name + " must end in " +
                          listed(found->extensions, " or "));
    if (!name && shared.size() > 1 && '.' + std::string(found->name) != extension)
        throw input_error(
            output + ": " + extension +
            " is the extension of several formats; give one by --format: " + listed(shared, ", "));
    if (found->needs_gdal && !has_gdal())
        throw input_error(
            output + ": the format " + std::string(found->name) +
            " needs GDAL, which was not found when the programs were built. Install libgdal-dev "
            "(sh pipelines/setup.sh exchange) and build again, or take .geojson");
    return *found;
}

} // namespace jointcreep::exchange
