// GeoJSON (RFC 7946), but for its coordinates: these are metres of the section. Foreign members say so, and "crs" is
// null, by which GDAL and what is built on it take them for plain coordinates.

#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"

namespace jointcreep::exchange
{

namespace
{

void append_place(std::string& text, const Layer& layer, Index corner)
{
    const Eigen::Vector3d& place = layer.point[corner];
    text.append("[").append(place_text(Eigen::Vector2d(place.head<2>()), ","));
    if (layer.is_in_space)
        text.append(",").append(shown(place.z()));
    text += ']';
}

void append_geometry(std::string& text, const Layer& layer, std::size_t row)
{
    const bool is_line = layer.shape == Shape::lines;
    text.append("{\"type\":\"").append(is_line ? "LineString" : "Polygon").append("\",\"coordinates\":[");
    for (Index r = layer.first_ring[row]; r < layer.first_ring[row + 1]; ++r) {
        const auto ring = layer.ring(r);
        if (!is_line)
            text += r == layer.first_ring[row] ? "[" : ",[";
        for (std::size_t i = 0; i < ring.size(); ++i) {
            if (i > 0)
                text += ',';
            append_place(text, layer, ring[i]);
        }
        if (!is_line) { // closed
            text += ',';
            append_place(text, layer, ring[0]);
            text += ']';
        }
    }
    text += "]}";
}

std::string collection(std::span<const Layer> layers)
{
    std::string text = "{\"type\":\"FeatureCollection\",\n\"crs\":null,\n\"coordinates_are\":\"";
    text += layers[0].is_in_space ? "east, north and up from the section's origin"
                                  : "x to the right and y up, in the section";
    text += "; no longitude and latitude\",\n\"unit\":\"m\",\n\"features\":[";
    bool is_first = true;
    for (const Layer& layer : layers) {
        std::vector<std::string> headings;
        for (const Attribute& attribute : layer.attributes)
            headings.push_back(json_text(attribute.heading()));
        for (std::size_t row = 0; row < layer.rows(); ++row) {
            text += is_first ? "\n" : ",\n";
            is_first = false;
            text += "{\"type\":\"Feature\",\"geometry\":";
            append_geometry(text, layer, row);
            text.append(",\"properties\":{\"layer\":").append(json_text(layer.name));
            for (std::size_t i = 0; i < layer.attributes.size(); ++i) {
                const Attribute& attribute = layer.attributes[i];
                const std::string value = text_of(attribute, row);
                const bool is_none = !attribute.value(row);
                text.append(",").append(headings[i]).append(":");
                text += is_none ? "null" : attribute.names ? json_text(value) : value;
            }
            text += "}}";
        }
    }
    return text + "\n]}\n";
}

} // namespace

std::vector<File> write_geojson(const Job& job)
{
    std::vector<Layer> layers;
    for (const std::string& name : job.layers)
        for (Layer& layer : job.all(name))
            layers.push_back(std::move(layer));
    return {{"", "", collection(layers)}};
}

// Traces as LineStrings and the target area as Polygons, each a file: fractopo reads one layer a file, and no
// MultiLineStrings.
std::vector<File> write_fractopo(const Job& job)
{
    return {{"area", "", collection(job.all("section"))}, {"", "", collection(job.all("joints"))}};
}

} // namespace jointcreep::exchange
