// DXF of AutoCAD R12 (AC1009): what CAD programs, GIS and 3DEC's `geometry import` all read. It has no attributes,
// so a table of ids is beside it: the id of a row is the handle of its entity.

#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"
#include "model/version.hpp"

#include <array>
#include <cstdio>

namespace jointcreep::exchange
{

namespace
{

constexpr std::size_t longest_layer_name = 31; // of R12

class Dxf
{
public:
    // A group code and its value.
    void add(int code, const std::string& value)
    {
        text.append(std::to_string(code)).append("\n").append(value).append("\n");
    }
    void add_place(int first_code, const Eigen::Vector3d& place)
    {
        add(first_code, shown(place.x()));
        add(first_code + 10, shown(place.y()));
        add(first_code + 20, shown(place.z()));
    }
    std::string text;
};

std::string handle_text(std::size_t number)
{
    std::array<char, 20> text{};
    std::snprintf(text.data(), text.size(), "%zX", number);
    return text.data();
}

// The layer of a row: its joint set, the rock of a block, or what the row is.
std::string layer_of_row(const Layer& layer, std::size_t row)
{
    const Attribute* const set = find_attribute(layer, "set");
    const std::string name = set ? text_of(*set, row) : "";
    if (layer.name == "blocks")
        return text_of(*find_attribute(layer, "rock"), row) + "-BLOCKS";
    if (layer.name == "bridges")
        return name + "-BRIDGES";
    if (layer.name == "section" || name.empty())
        return layer.name == "section" ? "SECTION" : "NO-JOINT";
    return name;
}

void add_entity(Dxf& dxf, const Layer& layer, std::size_t row, const std::string& name,
                const std::string& handle)
{
    const auto begin = [&](const char* type) {
        dxf.add(0, type);
        dxf.add(5, handle);
        dxf.add(8, name);
    };
    if (layer.shape == Shape::lines) {
        begin("LINE");
        dxf.add_place(10, layer.from(row));
        dxf.add_place(11, layer.to(row));
        return;
    }
    const auto first = layer.ring(layer.first_ring[row]);
    if (layer.is_in_space && first.size() == 4) {
        begin("3DFACE");
        for (int i = 0; i < 4; ++i)
            dxf.add_place(10 + i, layer.point[first[static_cast<std::size_t>(i)]]);
        return;
    }
    for (Index r = layer.first_ring[row]; r < layer.first_ring[row + 1]; ++r) { // holes, too
        dxf.add(0, "POLYLINE");
        if (r == layer.first_ring[row])
            dxf.add(5, handle);
        dxf.add(8, name);
        dxf.add(66, "1");
        dxf.add_place(10, {0, 0, 0});
        dxf.add(70, layer.is_in_space ? "9" : "1"); // closed; in space
        for (const Index corner : layer.ring(r)) {
            dxf.add(0, "VERTEX");
            dxf.add(8, name);
            dxf.add_place(10, layer.point[corner]);
            if (layer.is_in_space)
                dxf.add(70, "32");
        }
        dxf.add(0, "SEQEND");
        dxf.add(8, name);
    }
}

} // namespace

std::vector<File> write_dxf(const Job& job)
{
    std::vector<Layer> layers;
    for (const std::string& name : job.layers)
        for (Layer& layer : job.all(name))
            layers.push_back(std::move(layer));

    PlainNames names(longest_layer_name);
    for (const Layer& layer : layers)
        for (std::size_t row = 0; row < layer.rows(); ++row)
            names.of(layer_of_row(layer, row));

    Dxf dxf;
    dxf.add(999, "jointcreep " + std::string(version()) + ", metres");
    for (const auto& [name, plain] : names.all())
        if (name != plain)
            dxf.add(999, "layer " + plain + " is " + json_text(name));
    dxf.add(0, "SECTION");
    dxf.add(2, "HEADER");
    dxf.add(9, "$ACADVER");
    dxf.add(1, "AC1009");
    dxf.add(9, "$HANDLING");
    dxf.add(70, "1");
    dxf.add(0, "ENDSEC");
    dxf.add(0, "SECTION");
    dxf.add(2, "TABLES");
    dxf.add(0, "TABLE");
    dxf.add(2, "LTYPE");
    dxf.add(70, "1");
    dxf.add(0, "LTYPE");
    dxf.add(2, "CONTINUOUS");
    dxf.add(70, "0");
    dxf.add(3, "Solid line");
    dxf.add(72, "65");
    dxf.add(73, "0");
    dxf.add(40, "0");
    dxf.add(0, "ENDTAB");
    dxf.add(0, "TABLE");
    dxf.add(2, "LAYER");
    dxf.add(70, std::to_string(names.all().size()));
    int color = 0; // AutoCAD's colours by index, 1 to 6
    for (const auto& [name, plain] : names.all()) {
        dxf.add(0, "LAYER");
        dxf.add(2, plain);
        dxf.add(70, "0");
        dxf.add(62, std::to_string(1 + color++ % 6));
        dxf.add(6, "CONTINUOUS");
    }
    dxf.add(0, "ENDTAB");
    dxf.add(0, "ENDSEC");
    dxf.add(0, "SECTION");
    dxf.add(2, "ENTITIES");
    std::size_t handle = 0;
    for (const Layer& layer : layers)
        for (std::size_t row = 0; row < layer.rows(); ++row)
            add_entity(dxf, layer, row, names.of(layer_of_row(layer, row)), handle_text(++handle));
    dxf.add(0, "ENDSEC");
    dxf.add(0, "EOF");

    handle = 0;
    return {
        {"ids", ".csv", ids_csv(layers, [&](const Layer&, std::size_t) { return handle_text(++handle); })},
        {"", "", dxf.text}};
}

} // namespace jointcreep::exchange
