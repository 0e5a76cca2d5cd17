// The module that scene/trace_file.hpp loads: reads GeoPackage, Shapefile and DXF by GDAL.

#include "model/error.hpp"

#include <nlohmann/json.hpp>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

namespace jointcreep::scene
{

namespace
{

using nlohmann::json;

struct Close {
    void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Close>;

Dataset opened(const std::string& path)
{
    static const bool is_ready = [] {
        RegisterOGRGeoPackage();
        RegisterOGRShape();
        RegisterOGRDXF();
        CPLSetErrorHandler(CPLQuietErrorHandler);
        return true;
    }();
    CPLErrorReset();
    Dataset dataset(is_ready ? GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY) : nullptr);
    if (!dataset) {
        const std::string why = CPLGetLastErrorMsg();
        throw input_error("cannot be read by GDAL" + (why.empty() ? "" : ": " + why));
    }
    return dataset;
}

// The lines that a geometry consists of; false if it is something else.
bool add_lines(const OGRGeometry& geometry, json& lines)
{
    switch (wkbFlatten(geometry.getGeometryType())) {
    case wkbLineString: {
        json line = json::array();
        for (const OGRPoint& place : *geometry.toLineString())
            line.push_back({place.getX(), place.getY()});
        lines.push_back(std::move(line));
        return true;
    }
    case wkbMultiLineString:
    case wkbGeometryCollection: { // blocks of a DXF file
        const OGRGeometryCollection& all = *geometry.toGeometryCollection();
        for (const OGRGeometry* const part : all)
            if (!add_lines(*part, lines))
                return false;
        return !all.IsEmpty();
    }
    case wkbCircularString:
    case wkbCompoundCurve:
    case wkbMultiCurve: {
        const std::unique_ptr<OGRGeometry> straight(geometry.getLinearGeometry());
        return straight && add_lines(*straight, lines);
    }
    default:
        return false;
    }
}

// {"type": ..., "coordinates": ...}; without coordinates if it is no line; null if there is none.
json geometry_of(const OGRFeature& feature)
{
    const OGRGeometry* const geometry = feature.GetGeometryRef();
    if (!geometry)
        return nullptr;
    json lines = json::array();
    if (!add_lines(*geometry, lines))
        return {{"type", geometry->getGeometryName()}};
    return {{"type", "MultiLineString"}, {"coordinates", std::move(lines)}};
}

json properties_of(const OGRFeature& feature)
{
    json properties = json::object();
    for (int i = 0; i < feature.GetFieldCount(); ++i) {
        json& value = properties[feature.GetFieldDefnRef(i)->GetNameRef()];
        if (!feature.IsFieldSetAndNotNull(i))
            continue;
        switch (feature.GetFieldDefnRef(i)->GetType()) {
        case OFTInteger:
        case OFTInteger64:
            value = static_cast<std::int64_t>(feature.GetFieldAsInteger64(i));
            break;
        case OFTReal:
            value = feature.GetFieldAsDouble(i);
            break;
        default:
            value = feature.GetFieldAsString(i);
        }
    }
    return properties;
}

// Refuses coordinates that are not metres. GDAL calls a GeoPackage without a reference system geographic, too.
void check_units(const OGRSpatialReference* reference, const std::string& layer)
{
    if (!reference)
        return;
    const char* const name = reference->GetName();
    const std::string in = "layer \"" + layer + "\" has coordinates in ",
                      wanted = "; expected metres of the section, x to the right and y up";
    if (name && std::string_view(name).starts_with("Undefined"))
        return;
    if (reference->IsGeographic())
        throw input_error(in + "degrees (" + (name ? name : "") + ")" + wanted);
    const char* unit = nullptr;
    const double metres = reference->GetLinearUnits(&unit);
    if (std::abs(metres - 1) > 1e-12 && metres != 0)
        throw input_error(in + (unit ? unit : "another unit") + wanted);
}

// Refuses a DXF file whose header names another unit than metres, or none. Its numbers: DXF reference, $INSUNITS.
void check_units_of_dxf(const std::string& path)
{
    std::ifstream file(path);
    std::string line, value;
    for (int i = 0; i < 10000 && std::getline(file, line); ++i) {
        if (line.starts_with("ENTITIES"))
            return;
        if (!line.starts_with("$INSUNITS"))
            continue;
        std::getline(file, line);
        std::getline(file, value);
        const int unit = std::atoi(value.c_str());
        if (unit != 0 && unit != 6)
            throw input_error("has $INSUNITS " + std::to_string(unit) + (unit == 4 ? ", millimetres" : "") +
                              "; expected metres of the section, 6, or 0, no unit");
        return;
    }
}

struct FoundLayer {
    json features = json::array();
    bool has_lines = false;
    const OGRSpatialReference* reference = nullptr;
};

std::string lines_of(const std::string& path)
{
    const Dataset dataset = opened(path);
    const bool is_dxf = std::string_view(dataset->GetDriver()->GetDescription()) == "DXF";
    if (is_dxf)
        check_units_of_dxf(path);
    std::map<std::string, FoundLayer> layers;
    for (OGRLayer* const layer : dataset->GetLayers()) {
        const int layer_field = is_dxf ? layer->GetLayerDefn()->GetFieldIndex("Layer") : -1;
        const bool has_id = layer->GetLayerDefn()->GetFieldIndex("id") >= 0;
        for (const auto& feature : layer) {
            FoundLayer& found =
                layers[layer_field >= 0 ? feature->GetFieldAsString(layer_field) : layer->GetName()];
            json one{{"type", "Feature"},
                     {"geometry", geometry_of(*feature)},
                     {"properties", properties_of(*feature)}};
            found.has_lines = found.has_lines || one["geometry"].contains("coordinates");
            found.reference = layer->GetSpatialRef();
            if (!has_id && !is_dxf)
                one["id"] = static_cast<std::int64_t>(feature->GetFID());
            found.features.push_back(std::move(one));
        }
        if (CPLGetLastErrorType() >= CE_Failure)
            throw input_error(std::string("cannot be read by GDAL: ") + CPLGetLastErrorMsg());
    }
    json all = json::object();
    for (auto& [name, found] : layers)
        if (found.has_lines) {
            check_units(found.reference, name);
            all[name] = {{"type", "FeatureCollection"}, {"features", std::move(found.features)}};
        }
    if (all.empty())
        throw input_error("has no lines; expected joint traces");
    return json{{"layers", std::move(all)}}.dump(-1, ' ', false, json::error_handler_t::replace);
}

} // namespace

} // namespace jointcreep::scene

extern "C" [[gnu::visibility("default")]] void jointcreep_lines_of_trace_file(const std::string& path,
                                                                              std::string& text)
{
    using namespace jointcreep;
    try {
        text = scene::lines_of(path);
    } catch (const input_error& error) { // GDAL's words may have bytes of the file
        std::string message = error.what();
        std::replace_if(
            message.begin(), message.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
        throw input_error(message);
    }
}
