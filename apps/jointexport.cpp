// jointexport: writes the content of files of the chain in the formats of other tools.
//
//   jointexport result.h5 -o result.xdmf2                     the zones at all states, for ParaView
//   jointexport result.h5 -o result.vtu                       the zones at the last state
//   jointexport result.h5 -o histories.csv                    the histories of the monitoring points
//   jointexport result.failed.h5 --what failure -o why.csv    the blocks that move, and the reason
//   jointexport result.h5 --format csv -o - | head            to standard output
//   jointexport network.h5 -o joints.csv                      the joint traces inside the section
//   jointexport network.h5 -o blocks.geo                      the blocks, for Gmsh
//   jointexport networks/*.h5 -o all.gpkg                     many realizations in one GeoPackage
//   jointexport networks/*.h5 -o 'joints-{realization}.dxf'   or a file of each
//
// Reads   network.h5, joints.h5 or result.h5   (from jointgen, strength-averaging, demsolve)
// Writes  a file of one of exchange::formats() (docs/exchange.md lists what is in it)

#include "program.hpp"

#include "exchange/csv.hpp"
#include "exchange/format.hpp"
#include "exchange/grids.hpp"
#include "exchange/xdmf.hpp"
#include "model/error.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <numeric>

using namespace jointcreep;

namespace
{

using exchange::Format;

bool is_of_result(std::string_view what)
{
    return what == "zones" || what == "contacts" || what == "histories" || what == "failure";
}

// What of the format's content the file can give.
std::vector<std::string> offered_by(const Format& format, store::FileKind kind)
{
    std::vector<std::string> offered;
    for (const std::string_view what : format.holds)
        if (kind >= store::FileKind::result || !is_of_result(what))
            offered.emplace_back(what);
    return offered;
}

std::vector<std::string> parts_of(const std::string& list)
{
    std::vector<std::string> parts(1);
    for (const char c : list) {
        if (c == ',')
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

// What to write: --what, or what is usual.
std::vector<std::string> chosen(const Arguments& arguments, const Format& format, store::FileKind kind)
{
    const std::vector<std::string> offered = offered_by(format, kind);
    if (offered.empty())
        throw input_error(arguments.input() + ": the format " + std::string(format.name) +
                          " shows states, and only a result file has them");
    const std::optional<std::string> given = arguments.text("what");
    if (!given && kind >= store::FileKind::result && !format.usual_of_result.empty())
        return {std::string(format.usual_of_result)};
    if (!given)
        return {format.usual.begin(), format.usual.end()};
    std::string list;
    for (const std::string& one : offered)
        list.append(list.empty() ? "" : ", ").append(one);
    std::vector<std::string> wanted = parts_of(*given);
    for (auto one = wanted.begin(); one != wanted.end(); ++one) {
        if (std::ranges::find(offered, *one) == offered.end())
            throw input_error("--what is '" + *one + "'; from " + arguments.input() + " the format " +
                              std::string(format.name) + " can have: " + list);
        if (std::find(wanted.begin(), one, *one) != one)
            throw input_error("--what has " + *one + " twice");
    }
    if (wanted.size() > 1 && !format.holds_several)
        throw input_error("--what is '" + *given + "'; a file of the format " + std::string(format.name) +
                          " holds one of them");
    return wanted;
}

// The row of the states that --state names: a number, a stage (its state after removal), or the last.
std::size_t chosen_state(const Arguments& arguments, const States& states)
{
    const std::string wanted = arguments.text("state").value_or("last");
    const std::size_t count = states.time.size();
    if (count == 0)
        throw input_error(arguments.input() + ": there is no state in this file");
    if (wanted == "last")
        return count - 1;
    std::size_t row = 0;
    const auto read = std::from_chars(wanted.data(), wanted.data() + wanted.size(), row);
    if (read.ec == std::errc() && read.ptr == wanted.data() + wanted.size() && row < count)
        return row;
    const auto stage = std::find(states.event.begin(), states.event.end(), wanted);
    if (!wanted.empty() && stage != states.event.end())
        return static_cast<std::size_t>(stage - states.event.begin());
    std::string message = "--state is '" + wanted + "'; the states are:";
    for (row = 0; row < count; ++row) {
        message += '\n' + std::to_string(row) + ", day " + shown_time(states.time[row]);
        if (!states.event[row].empty())
            message += ", after " + states.event[row];
    }
    throw input_error(message);
}

// Where the output finds the input: the path from the output's folder.
std::string path_between(const std::string& output, const std::string& input)
{
    return std::filesystem::relative(input, std::filesystem::absolute(output).parent_path()).string();
}

// What a result file alone has.
std::string text_of_result(const Arguments& arguments, const Format& format, const std::string& what)
{
    const std::string& input = arguments.input();
    const store::ResultFile file = store::read_result(input);
    if (what == "histories")
        return exchange::histories_csv(file.result.history);
    if (what == "failure") {
        if (file.result.failure.reason.empty())
            throw input_error(input + ": this run did not end early; only NAME.failed.h5 has a failure");
        return exchange::failure_csv(file.result.failure, file.network.blocks);
    }
    if (format.name == "xdmf") {
        const std::string result_file = path_between(arguments.output(), input);
        return what == "zones" ? exchange::zones_xdmf(file.result, result_file)
                               : exchange::contacts_xdmf(file.result, result_file);
    }
    const std::size_t state = chosen_state(arguments, file.result.states);
    const exchange::Grid grid = what == "zones" ? exchange::zones_grid(file.network, file.result, state)
                                                : exchange::contacts_grid(file.result, state);
    return format.name == "vtkhdf" ? vtkhdf_of(grid) : vtu_of(grid);
}

exchange::Section section_of(const std::string& path, bool with_properties)
{
    exchange::Section section{.file = path};
    const auto take = [&](store::NetworkFile& file) {
        const Scene scene = scene::parse_scene_of_file(file.provenance.scene, path, file.network);
        section.realization = file.provenance.realization;
        section.azimuth = scene.azimuth;
        section.outline = scene.outline;
        section.holes = scene.holes;
        section.network = std::move(file.network);
    };
    if (with_properties && store::kind_of(path) >= store::FileKind::joints) {
        store::JointsFile file = store::read_joints(path);
        section.equivalent = std::move(file.equivalent);
        take(file);
    } else {
        store::NetworkFile file = store::read_network(path);
        take(file);
    }
    return section;
}

std::string metres(double length)
{
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.6g m", length);
    return text.data();
}

// What was written, and what it adds up to beside the section and the fates of its joints.
void account(Summary& summary, const exchange::Job& job)
{
    const auto length_of = [&](std::string_view name) {
        double sum = 0;
        std::size_t rows = 0;
        for (const exchange::Layer& layer : job.all(name)) {
            sum += layer.length();
            rows += layer.rows();
        }
        return std::pair(rows, sum);
    };
    const auto by_fates = [&](auto lengths) {
        double sum = 0;
        for (const exchange::Section& section : job.sections)
            for (const std::vector<double>* of : lengths(section.network.blocks.fates))
                sum += std::accumulate(of->begin(), of->end(), 0.0);
        return sum;
    };
    using Lengths = std::vector<const std::vector<double>*>;
    const auto has = [&](const char* name) {
        return std::ranges::find(job.layers, name) != job.layers.end();
    };
    if (has("joints") || has("bridges")) {
        const auto [traces, in_traces] = length_of("joints");
        const auto [bridges, in_bridges] = length_of("bridges");
        if (has("joints"))
            summary.add("joint traces", std::to_string(traces) + ", " + metres(in_traces));
        if (has("bridges"))
            summary.add("rock bridges", std::to_string(bridges) + ", " + metres(in_bridges));
        summary.add("traces and bridges", metres(in_traces + in_bridges));
        summary.add("  by the fates of joints", metres(by_fates([](const JointFates& f) {
                        return Lengths{&f.kept, &f.shared, &f.on_outline, &f.dangling_end, &f.merged};
                    })));
    }
    if (has("edges")) {
        double on_joints = 0;
        std::size_t rows = 0;
        for (const exchange::Section& section : job.sections) {
            const Blocks& blocks = section.network.blocks;
            rows += blocks.edge_vertex.size();
            for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e)
                if (blocks.edge_joint[e] >= 0)
                    on_joints +=
                        (blocks.vertex[blocks.edge_vertex[e][0]] - blocks.vertex[blocks.edge_vertex[e][1]])
                            .norm();
        }
        summary.add("edges", rows);
        summary.add("  on joints", metres(on_joints));
        summary.add("  by the fates of joints", metres(by_fates([](const JointFates& f) {
                        return Lengths{&f.kept, &f.extended};
                    })));
    }
    if (has("blocks")) {
        double area = 0, of_sections = 0;
        std::size_t rows = 0;
        for (const exchange::Layer& layer : job.all("blocks")) {
            area += layer.area();
            rows += layer.rows();
        }
        for (const exchange::Layer& layer : job.all("section"))
            of_sections += layer.area();
        summary.add("blocks", rows);
        summary.add("area", area, "m2");
        summary.add("  of the section", of_sections, "m2");
        if (std::abs(area - of_sections) > 1e-9 * of_sections)
            throw input_error(job.sections[0].file + ": the areas of blocks add up to " + shown(area) +
                              " m2, and the section has " + shown(of_sections) +
                              " m2; make the file again from its scene");
    }
    if (has("planes")) {
        double area = 0;
        std::size_t rows = 0;
        for (const exchange::Layer& layer : job.all("planes")) {
            area += layer.area();
            rows += layer.rows();
        }
        summary.add("joints in space", rows);
        summary.add("  their area", area, "m2");
    }
}

std::string name_of(const exchange::File& file, const std::string& output)
{
    const std::string beside = file.word.empty() ? output : name_beside(output, file.word);
    return file.extension.empty() ? beside
                                  : std::filesystem::path(beside).replace_extension(file.extension).string();
}

constexpr std::string_view realization_mark = "{realization}";

void export_layers(const Arguments& arguments, const Format& format, std::vector<std::string> layers,
                   Summary& summary)
{
    const bool with_properties = std::ranges::find(layers, "edges") != layers.end();
    const std::string& output = arguments.output();
    const auto mark = output.find(realization_mark);
    if (mark == std::string::npos && arguments.inputs().size() > 1 && !format.holds_realizations)
        throw input_error("a file of the format " + std::string(format.name) +
                          " holds one realization; for a file of each put {realization} into the name: -o '" +
                          name_beside(output, std::string(realization_mark)) + "'");
    std::vector<exchange::Section> sections;
    for (const std::string& input : arguments.inputs())
        sections.push_back(section_of(input, with_properties));

    std::optional<double> width = arguments.number("width", above(0).to(1e6), "m");
    std::vector<exchange::Job> jobs;
    std::vector<std::string> outputs;
    if (mark == std::string::npos) {
        jobs.push_back({sections, layers, width});
        outputs.push_back(output);
    } else {
        for (std::size_t i = 0; i < sections.size(); ++i) {
            jobs.push_back({std::span(sections).subspan(i, 1), layers, width});
            outputs.push_back(std::string(output).replace(mark, realization_mark.size(),
                                                          std::to_string(sections[i].realization)));
        }
    }
    std::vector<TextFile> files; // an output after those beside it
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        summary.add("file", outputs[i]);
        account(summary, jobs[i]);
        for (exchange::File& file :
             of_file(jobs[i].sections[0].file, [&] { return format.write(jobs[i]); })) {
            const std::string name = name_of(file, outputs[i]);
            if (name != outputs[i])
                summary.add("  beside it", name);
            if (name != outputs[i] && arguments.to_standard_output())
                throw input_error("-o -: the format " + std::string(format.name) +
                                  " is several files, not for standard output; give the name of a file");
            files.push_back({name, std::move(file.bytes)});
        }
    }
    std::vector<NamedFile> written;
    for (const TextFile& file : files)
        if (file.path != standard_output)
            written.push_back({file.path, "the output " + file.path});
    refuse_overwriting(arguments.files({"input"}), written);
    write_texts(files);
}

void export_file(const Arguments& arguments)
{
    if (arguments.has("file-format") || arguments.has("formats")) {
        std::cout << (arguments.has("formats") ? exchange::formats_text() : store::schema_markdown());
        return;
    }
    const std::string& input = arguments.input();
    const std::string& output = arguments.output();
    const Format& format = exchange::format_of(output, arguments.text("format"));
    if (!arguments.to_standard_output())
        store::check_writable(output);
    const store::FileKind kind = store::kind_of(input);

    const std::vector<std::string> what = chosen(arguments, format, kind);
    const bool of_result = is_of_result(what[0]);
    if (arguments.has("state") && format.name == "xdmf")
        throw input_error("--state does not go with .xdmf, which has all states");
    if (arguments.has("state") && what[0] != "zones" && what[0] != "contacts")
        throw input_error("--state goes with --what zones or contacts, not with " + what[0]);
    if (of_result && arguments.inputs().size() > 1)
        throw input_error("--what " + what[0] + " is of one file, and several are given");
    if (of_result && (what.size() > 1 || arguments.has("width")))
        throw input_error(what.size() > 1 ? "--what " + what[0] + " goes with nothing else"
                                          : "--width does not go with --what " + what[0]);
    Summary summary;
    for (const std::string& one : arguments.inputs())
        if (const std::string reason = store::reason_of_failure(one); !reason.empty())
            summary.warn("the run of " + one + " ended early: " + reason);
    if (of_result) {
        summary.add(what[0], output);
        write_texts({{output, text_of_result(arguments, format, what[0])}});
    } else {
        export_layers(arguments, format, what, summary);
    }
    summary.print(arguments);
}

} // namespace

int main(int argc, char** argv)
{
    return run(
        {.name = "jointexport",
         .summary = "Writes the content of files of the chain in the formats of other programs.",
         .input = "FILE.h5...",
         .output = "NAME.EXT",
         .options =
             {{"format", "NAME", "format, where several have the extension"},
              {"formats", "", "show the table of formats, tab separated, and nothing else"},
              {"what", "NAME",
               "joints (traces), bridges, edges, blocks, section, planes (joints in space); from a result file "
               "also zones, contacts, histories, failure. Several, separated by commas, where the format holds them. "
               "Default: by format (docs/exchange.md)"},
              {"width", "M",
               "width across the section of joints that are not discs, and of blocks of 3dec and yade "
               "(default of blocks: 1 m)"},
              {"state", "STATE",
               "of zones and contacts in a .vtu or .vtkhdf file: its number, counted from 0, the stage that it "
               "follows, or last (default)"},
              {"file-format", "", "show the format of the HDF5 files of the chain, and nothing else"}},
         .example = "jointexport result.h5 -o zones.vtu --state \"block 2 removed\"",
         .takes_several = true,
         .writes_text = true},
        argc, argv, export_file);
}
