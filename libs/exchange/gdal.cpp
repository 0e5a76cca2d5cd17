// GeoPackage and Shapefile by GDAL, written in GDAL's memory and handed over as bytes. Without a reference system,
// or a plain one: these are metres of a section. No dates, so that the same records give the same bytes.

#include "exchange/writers.hpp"

#ifdef JOINTCREEP_GDAL
#include "exchange/text.hpp"
#include "model/error.hpp"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <memory>
#endif

namespace jointcreep::exchange
{

#ifdef JOINTCREEP_GDAL

namespace
{

struct Close {
    void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Close>;

[[noreturn]] void fail(const std::string& what)
{
    throw file_error("GDAL could not " + what + ": " + CPLGetLastErrorMsg());
}

Dataset created(const char* driver_name, const std::string& path)
{
    static const bool is_ready = [] {
        GDALAllRegister();
        CPLSetErrorHandler(CPLQuietErrorHandler);
        CPLSetConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z");
        return true;
    }();
    GDALDriver* const driver = is_ready ? GetGDALDriverManager()->GetDriverByName(driver_name) : nullptr;
    if (!driver)
        throw file_error(std::string("this GDAL has no driver ") + driver_name);
    Dataset dataset(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (!dataset)
        fail(std::string("make a file of ") + driver_name);
    return dataset;
}

std::unique_ptr<OGRGeometry> geometry_of(const Layer& layer, std::size_t row)
{
    const auto add = [&](OGRSimpleCurve& curve, std::span<const Index> ring) {
        for (const Index corner : ring) {
            const Eigen::Vector3d& p = layer.point[corner];
            if (layer.is_in_space)
                curve.addPoint(p.x(), p.y(), p.z());
            else
                curve.addPoint(p.x(), p.y());
        }
    };
    if (layer.shape == Shape::lines) {
        auto line = std::make_unique<OGRLineString>();
        add(*line, layer.ring(layer.first_ring[row]));
        return line;
    }
    auto polygon = std::make_unique<OGRPolygon>();
    for (Index r = layer.first_ring[row]; r < layer.first_ring[row + 1]; ++r) {
        OGRLinearRing ring;
        add(ring, layer.ring(r));
        ring.closeRings();
        polygon->addRing(&ring);
    }
    return polygon;
}

void add_layer(GDALDataset& dataset, std::span<const Layer> layers, char** options, bool is_geopackage)
{
    const Layer& first = layers[0];
    OGRwkbGeometryType type = first.shape == Shape::lines ? wkbLineString : wkbPolygon;
    if (first.is_in_space)
        type = wkbSetZ(type);
    // Without a reference system GDAL calls the coordinates of a GeoPackage longitude and latitude.
    OGRSpatialReference plain;
    plain.SetLocalCS("Undefined Cartesian SRS");
    plain.SetLinearUnits("metre", 1);
    OGRLayer* const made =
        dataset.CreateLayer(first.name.c_str(), is_geopackage ? &plain : nullptr, type, options);
    if (!made)
        fail("make the layer " + first.name);
    for (const Attribute& attribute : first.attributes) {
        OGRFieldDefn field(attribute.heading().c_str(), attribute.names        ? OFTString
                                                        : attribute.is_integer ? OFTInteger
                                                                               : OFTReal);
        if (made->CreateField(&field) != OGRERR_NONE)
            fail("make the field " + attribute.heading());
    }
    dataset.StartTransaction();
    for (const Layer& layer : layers)
        for (std::size_t row = 0; row < layer.rows(); ++row) {
            OGRFeature feature(made->GetLayerDefn());
            for (int i = 0; i < static_cast<int>(layer.attributes.size()); ++i) {
                const Attribute& attribute = layer.attributes[static_cast<std::size_t>(i)];
                const std::optional<double> value = attribute.value(row);
                if (!value)
                    feature.SetFieldNull(i);
                else if (attribute.names)
                    feature.SetField(i, text_of(attribute, row).c_str());
                else if (attribute.is_integer)
                    feature.SetField(i, static_cast<int>(*value));
                else
                    feature.SetField(i, *value);
            }
            feature.SetGeometryDirectly(geometry_of(layer, row).release());
            if (made->CreateFeature(&feature) != OGRERR_NONE)
                fail("write a row of " + first.name);
        }
    if (dataset.TestCapability(ODsCTransactions) && dataset.CommitTransaction() != OGRERR_NONE)
        fail("write " + first.name);
}

std::string taken(const std::string& path)
{
    vsi_l_offset size = 0;
    GByte* const bytes = VSIGetMemFileBuffer(path.c_str(), &size, TRUE);
    if (!bytes)
        fail("write " + path);
    std::string text(reinterpret_cast<const char*>(bytes), size);
    CPLFree(bytes);
    return text;
}

} // namespace

std::vector<File> write_geopackage(const Job& job)
{
    const std::string path = "/vsimem/jointexport.gpkg";
    {
        const Dataset dataset = created("GPKG", path);
        for (const std::string& name : job.layers)
            add_layer(*dataset, job.all(name), nullptr, true);
    }
    return {{"", "", taken(path)}};
}

std::vector<File> write_shapefile(const Job& job)
{
    const std::string path = "/vsimem/jointexport.shp";
    {
        std::vector<Layer> layers = job.all(job.layers[0]);
        layers[0].name = "jointexport";
        char** options = CSLSetNameValue(nullptr, "DBF_DATE_LAST_UPDATE", "2000-01-01");
        options = CSLSetNameValue(options, "ENCODING", "UTF-8");
        const Dataset dataset = created("ESRI Shapefile", path);
        add_layer(*dataset, layers, options, false);
        CSLDestroy(options);
    }
    std::vector<File> files;
    for (const char* extension : {".shx", ".dbf", ".cpg", ".shp"})
        files.push_back({"", extension, taken("/vsimem/jointexport" + std::string(extension))});
    return files;
}

bool has_gdal()
{
    return true;
}

#else

std::vector<File> write_geopackage(const Job&)
{
    return {};
}

std::vector<File> write_shapefile(const Job&)
{
    return {};
}

bool has_gdal()
{
    return false;
}

#endif

} // namespace jointcreep::exchange
