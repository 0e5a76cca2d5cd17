#include "exchange/vtu.hpp"

#include "exchange/convex.hpp"
#include "exchange/forces.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <string_view>

namespace jointcreep::exchange
{

namespace
{

using fields::Column;
using fields::ForceColumns;

enum CellType { vertex = 1, line = 3, triangle = 5, polygon = 7, quadratic_triangle = 22 }; // VTK's numbers

// Bytes in base64 (RFC 4648).
std::string base64(std::span<const unsigned char> bytes)
{
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t at) { return at < bytes.size() ? unsigned{bytes[at]} : 0U; };
        const unsigned three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        text += letters[three >> 18];
        text += letters[three >> 12 & 63];
        text += i + 1 < bytes.size() ? letters[three >> 6 & 63] : '=';
        text += i + 2 < bytes.size() ? letters[three & 63] : '=';
    }
    return text;
}

// The text of a grid, in the order in which VTK wants its parts. Numbers are binary, all in base64 behind the grid,
// each array with its size in bytes before it. Readers of raw bytes are fewer, and meshio's can take one array for
// another.
class GridText
{
public:
    GridText(std::size_t points, std::size_t cells)
    {
        text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
                "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
        piece_ = "<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" +
                 std::to_string(cells) + "\">\n";
    }

    // Field data come first; then the other sections, each opened by its name.
    void open(std::string_view section)
    {
        close();
        if (section != "FieldData" && !piece_.empty()) {
            text_ += piece_;
            piece_.clear();
        }
        section_ = section;
        text_.append("<").append(section).append(">\n");
    }

    void add(std::string_view name, const std::vector<double>& values) { array("Float64", name, 1, values); }
    void add(std::string_view name, const std::vector<Index>& values) { array("Int32", name, 1, values); }
    void add(std::string_view name, const std::vector<std::int64_t>& values)
    {
        array("Int64", name, 1, values);
    }
    void add(std::string_view name, const std::vector<Eigen::Vector2d>& vectors)
    {
        std::vector<double> flat; // VTK's vectors have three components
        flat.reserve(3 * vectors.size());
        for (const Eigen::Vector2d& vector : vectors)
            flat.insert(flat.end(), {vector.x(), vector.y(), 0.0});
        array("Float64", name, 3, flat);
    }
    void add(std::string_view name, const std::vector<Eigen::Vector3d>& vectors)
    {
        std::vector<double> flat;
        flat.reserve(3 * vectors.size());
        for (const Eigen::Vector3d& vector : vectors)
            flat.insert(flat.end(), {vector.x(), vector.y(), vector.z()});
        array("Float64", name, 3, flat);
    }

    void add(const Column& column, const std::vector<Index>& rows)
    {
        if (column.is_integer)
            add(column.name, values_of<Index>(column, rows));
        else
            add(column.name, values_of<double>(column, rows));
    }

    // Field data: the names behind a code, as bytes of UTF-8, each name ended by a 0; and the time of a state. (meshio ends at
    // VTK's arrays of the type String.)
    void add_names(const std::string& name, const std::vector<std::string>& names)
    {
        std::vector<unsigned char> bytes;
        for (const std::string& text : names) {
            bytes.insert(bytes.end(), text.begin(), text.end());
            bytes.push_back(0);
        }
        array("UInt8", name, 1, bytes);
    }
    void add_time(double time) { array("Float64", "TimeValue", 1, std::vector<double>{time}); }

    void cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& offsets,
               CellType type)
    {
        open("Cells");
        add("connectivity", connectivity);
        add("offsets", offsets);
        array("UInt8", "types", 1,
              std::vector<unsigned char>(offsets.size(), static_cast<unsigned char>(type)));
    }

    std::string finish()
    {
        close();
        return text_ + "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"base64\">\n_" + appended_ +
               "\n</AppendedData>\n</VTKFile>\n";
    }

private:
    template <class Value>
    static std::vector<Value> values_of(const Column& column, const std::vector<Index>& rows)
    {
        std::vector<Value> values;
        values.reserve(rows.size());
        for (const Index row : rows)
            values.push_back(static_cast<Value>(column.value(static_cast<std::size_t>(row))));
        return values;
    }

    template <class Value>
    void array(std::string_view type, std::string_view name, std::size_t components,
               const std::vector<Value>& values)
    {
        text_.append("<DataArray type=\"").append(type).append("\" Name=\"").append(name);
        // In field data the number of tuples is to be said.
        text_.append(section_ == "FieldData" ? "\" NumberOfTuples=\"" : "\" NumberOfComponents=\"");
        text_.append(std::to_string(section_ == "FieldData" ? values.size() : components));
        text_.append("\" format=\"appended\" offset=\"").append(std::to_string(appended_.size()));
        text_ += "\"/>\n";
        static_assert(std::endian::native == std::endian::little);
        const std::uint64_t size = values.size() * sizeof(Value);
        std::vector<unsigned char> bytes(sizeof size + size);
        std::memcpy(bytes.data(), &size, sizeof size);
        if (size > 0)
            std::memcpy(bytes.data() + sizeof size, values.data(), size);
        appended_ += base64(bytes);
    }

    void close()
    {
        if (!section_.empty())
            text_.append("</").append(section_).append(">\n");
        section_ = "";
    }

    std::string text_, piece_, appended_;
    std::string_view section_;
};

// 0, 1, ...
std::vector<std::int64_t> consecutive(std::size_t size)
{
    std::vector<std::int64_t> indices(size);
    std::iota(indices.begin(), indices.end(), 0);
    return indices;
}

// Where each cell's points end in the connectivity, when every cell has `size` of them.
std::vector<std::int64_t> offsets_of(std::size_t cells, std::int64_t size)
{
    std::vector<std::int64_t> offsets(cells);
    for (std::size_t i = 0; i < cells; ++i)
        offsets[i] = static_cast<std::int64_t>(i + 1) * size;
    return offsets;
}

// The rows of an array that are wanted; `first` is where a state's part of the array begins.
template <class Value>
std::vector<Value> picked(const std::vector<Value>& values, const std::vector<Index>& rows,
                          std::size_t first = 0)
{
    std::vector<Value> result;
    result.reserve(rows.size());
    for (const Index row : rows)
        result.push_back(values[first + row]);
    return result;
}

// A code for each row, through an index: that of its target, or -1 where the index is none.
std::vector<Index> looked_up(const std::vector<Index>& target, const std::vector<Index>& indices)
{
    std::vector<Index> result;
    result.reserve(indices.size());
    for (const Index index : indices)
        result.push_back(index < 0 ? -1 : target[index]);
    return result;
}

// The values of an attribute: codes of names and whole numbers with -1 for none, other numbers with 0.
void add(GridText& grid, const Attribute& attribute, std::size_t rows)
{
    std::vector<Index> codes;
    std::vector<double> numbers;
    for (std::size_t row = 0; row < rows; ++row)
        if (attribute.is_integer)
            codes.push_back(static_cast<Index>(attribute.value(row).value_or(-1)));
        else
            numbers.push_back(attribute.value(row).value_or(0));
    if (attribute.is_integer)
        grid.add(attribute.name, codes);
    else
        grid.add(attribute.name, numbers);
}

} // namespace

std::string layer_vtu(const Layer& layer)
{
    std::vector<std::int64_t> connectivity, offsets;
    for (std::size_t row = 0; row < layer.rows(); ++row) {
        const std::vector<Index> around = with_bridges(layer, row);
        connectivity.insert(connectivity.end(), around.begin(), around.end());
        offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    }
    GridText grid(layer.point.size(), layer.rows());
    grid.open("FieldData");
    for (const Attribute& attribute : layer.attributes)
        if (attribute.names)
            grid.add_names(attribute.name + "_names", *attribute.names);
    grid.open("CellData");
    for (const Attribute& attribute : layer.attributes)
        add(grid, attribute, layer.rows());
    grid.open("Points");
    grid.add("position", layer.point);
    grid.cells(connectivity, offsets, layer.shape == Shape::lines ? line : polygon);
    return grid.finish();
}

std::vector<File> write_vtu(const Job& job)
{
    return {{"", "", layer_vtu(job.all(job.layers[0])[0])}};
}

std::string zones_vtu(const Network& network, const Result& result, std::size_t state)
{
    const Mesh& mesh = result.mesh;
    const States& states = result.states;
    if (state >= states.time.size())
        throw input_error("state " + std::to_string(state) + " is not among the result's " +
                          std::to_string(states.time.size()) + " states");
    const std::size_t zones = mesh.zone_block.size();

    std::vector<Index> present;
    std::vector<Index> gridpoints;                                 // of these zones
    std::vector<std::int64_t> point_of(mesh.gridpoint.size(), -1); // gridpoint -> point of the grid
    std::vector<std::int64_t> connectivity;
    for (std::size_t zone = 0; zone < zones; ++zone) {
        if (!states.zone_present[state * zones + zone])
            continue;
        present.push_back(static_cast<Index>(zone));
        std::vector<Index> of_zone(mesh.zone_gridpoint[zone].begin(), mesh.zone_gridpoint[zone].end());
        if (mesh.is_quadratic())
            of_zone.insert(of_zone.end(), mesh.zone_middle[zone].begin(), mesh.zone_middle[zone].end());
        for (const Index gridpoint : of_zone) {
            if (point_of[gridpoint] < 0) {
                point_of[gridpoint] = static_cast<std::int64_t>(gridpoints.size());
                gridpoints.push_back(gridpoint);
            }
            connectivity.push_back(point_of[gridpoint]);
        }
    }
    const std::vector<Index> block = picked(mesh.zone_block, present);

    GridText grid(gridpoints.size(), present.size());
    grid.open("FieldData");
    grid.add_time(states.time[state]);
    grid.add_names("rock_names", network.names.rock);
    grid.add_names("stage_names", network.names.stage);
    grid.open("PointData");
    grid.add("gridpoint", gridpoints);
    const auto displacement_in = [&](std::size_t of) {
        return picked(states.displacement, gridpoints, of * mesh.gridpoint.size());
    };
    std::vector<Eigen::Vector2d> displacement = displacement_in(state);
    grid.add("displacement", displacement);
    if (const Index reset = states.reset_state[state]; reset > 0) {
        const std::vector<Eigen::Vector2d> then = displacement_in(static_cast<std::size_t>(reset));
        for (std::size_t g = 0; g < displacement.size(); ++g)
            displacement[g] -= then[g];
        grid.add("displacement_since_reset", displacement);
    }
    grid.open("CellData");
    grid.add("zone", present);
    grid.add("block", block);
    grid.add("rock", looked_up(network.blocks.block_rock, block));
    grid.add("stage", looked_up(network.blocks.block_stage, block));
    for (const Column& column : columns_of(&ForceColumns::of_zones, result, state))
        grid.add(column, present);
    grid.open("Points");
    grid.add("position", picked(mesh.gridpoint, gridpoints));
    grid.cells(connectivity, offsets_of(present.size(), mesh.is_quadratic() ? 6 : 3),
               mesh.is_quadratic() ? quadratic_triangle : triangle);
    return grid.finish();
}

std::string contacts_vtu(const Result& result, std::size_t state)
{
    const Mesh& mesh = result.mesh;
    const States& states = result.states;
    if (state >= states.time.size())
        throw input_error("state " + std::to_string(state) + " is not among the result's " +
                          std::to_string(states.time.size()) + " states");
    const std::size_t contacts = mesh.contact_edge.size();
    const std::size_t first_gridpoint = state * mesh.gridpoint.size();

    std::vector<Index> present;
    std::vector<Eigen::Vector2d> displacement;
    for (std::size_t contact = 0; contact < contacts; ++contact) {
        if (states.contact_status[state * contacts + contact] == static_cast<Index>(ContactStatus::removed))
            continue;
        present.push_back(static_cast<Index>(contact));
        const auto [a, b] = mesh.contact_gridpoint[contact];
        displacement.push_back(
            (states.displacement[first_gridpoint + a] + states.displacement[first_gridpoint + b]) / 2);
    }

    GridText grid(present.size(), present.size());
    grid.open("FieldData");
    grid.add_time(states.time[state]);
    grid.open("PointData");
    grid.add("contact", present);
    grid.add("edge", picked(mesh.contact_edge, present));
    grid.add("normal", picked(mesh.contact_normal, present));
    grid.add("length", picked(mesh.contact_length, present));
    grid.add("displacement", displacement);
    for (const Column& column : columns_of(&ForceColumns::of_contacts, result, state))
        grid.add(column, present);
    grid.open("Points");
    grid.add("position", picked(mesh.contact_centre, present));
    grid.cells(consecutive(present.size()), offsets_of(present.size(), 1), vertex);
    return grid.finish();
}

} // namespace jointcreep::exchange
