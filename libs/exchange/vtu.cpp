#include "exchange/vtu.hpp"

#include "exchange/forces.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string_view>

namespace jointcreep::exchange
{

namespace
{

using fields::Column;
using fields::ForceColumns;

enum CellType { vertex = 1, line = 3, triangle = 5, polygon = 7, quadratic_triangle = 22 }; // VTK's numbers

// The text of a grid, in the order in which VTK wants its parts.
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

    void add(const Column& column, const std::vector<Index>& rows)
    {
        if (column.is_integer)
            add(column.name, values_of<Index>(column, rows));
        else
            add(column.name, values_of<double>(column, rows));
    }

    // Field data: the names behind a code, as bytes, each ended by a 0; and the time of a state.
    void add_names(const std::string& name, const std::vector<std::string>& names)
    {
        std::vector<Index> bytes;
        for (const std::string& text : names) {
            for (const char c : text)
                bytes.push_back(static_cast<unsigned char>(c));
            bytes.push_back(0);
        }
        array("String", name, names.size(), bytes);
    }
    void add_time(double time) { array("Float64", "TimeValue", 1, std::vector<double>{time}); }

    void cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& offsets,
               CellType type)
    {
        open("Cells");
        add("connectivity", connectivity);
        add("offsets", offsets);
        array("UInt8", "types", 1, std::vector<Index>(offsets.size(), type));
    }

    std::string finish()
    {
        close();
        return text_ + "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
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

    static std::string text_of(double value) { return shown(value); }
    template <std::integral Value>
    static std::string text_of(Value value)
    {
        return std::to_string(value);
    }

    template <class Value>
    void array(std::string_view type, std::string_view name, std::size_t number,
               const std::vector<Value>& values)
    {
        // In field data the number counts tuples, elsewhere the components of each.
        text_.append("<DataArray type=\"").append(type).append("\" Name=\"").append(name);
        text_.append(section_ == "FieldData" ? "\" NumberOfTuples=\"" : "\" NumberOfComponents=\"");
        text_.append(std::to_string(number)).append("\" format=\"ascii\">\n");
        for (std::size_t i = 0; i < values.size(); ++i)
            text_.append(text_of(values[i])).append(i % 12 == 11 || i + 1 == values.size() ? "\n" : " ");
        text_ += "</DataArray>\n";
    }

    void close()
    {
        if (!section_.empty())
            text_.append("</").append(section_).append(">\n");
        section_ = "";
    }

    std::string text_, piece_;
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

// The vertices around a block, its holes joined in by bridges between nearest vertices.
std::vector<Index> outline(const Blocks& blocks, std::size_t block)
{
    const auto ring = [&](Index r) {
        return std::vector<Index>(blocks.ring_vertex.begin() + blocks.ring_start[r],
                                  blocks.ring_vertex.begin() + blocks.ring_start[r + 1]);
    };
    std::vector<Index> around = ring(blocks.block_ring[block]);
    for (Index r = blocks.block_ring[block] + 1; r < blocks.block_ring[block + 1]; ++r) {
        std::vector<Index> hole = ring(r);
        std::size_t from = 0, to = 0;
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < around.size(); ++i)
            for (std::size_t j = 0; j < hole.size(); ++j) {
                const double distance = (blocks.vertex[around[i]] - blocks.vertex[hole[j]]).squaredNorm();
                if (distance < nearest) {
                    nearest = distance;
                    from = i;
                    to = j;
                }
            }
        // ... from, then the hole from `to` round to `to`, then from again ...
        std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(to), hole.end());
        hole.push_back(hole.front());
        hole.push_back(around[from]);
        around.insert(around.begin() + static_cast<std::ptrdiff_t>(from) + 1, hole.begin(), hole.end());
    }
    return around;
}

} // namespace

std::string blocks_vtu(const Network& network)
{
    const Blocks& blocks = network.blocks;
    const std::size_t count = blocks.block_area.size();

    std::vector<std::int64_t> connectivity, offsets;
    std::vector<Index> ids;
    for (std::size_t block = 0; block < count; ++block) {
        const std::vector<Index> around = outline(blocks, block);
        connectivity.insert(connectivity.end(), around.begin(), around.end());
        offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
        ids.push_back(static_cast<Index>(block));
    }

    GridText grid(blocks.vertex.size(), count);
    grid.open("FieldData");
    grid.add_names("rock_names", network.names.rock);
    grid.add_names("stage_names", network.names.stage);
    grid.open("CellData");
    grid.add("block", ids);
    grid.add("rock", blocks.block_rock);
    grid.add("stage", blocks.block_stage);
    grid.add("area", blocks.block_area);
    grid.open("Points");
    grid.add("position", blocks.vertex);
    grid.cells(connectivity, offsets, polygon);
    return grid.finish();
}

std::string joints_vtu(const Network& network, const EquivalentJoints* equivalent)
{
    const Blocks& blocks = network.blocks;
    std::vector<Index> edges;
    std::vector<std::int64_t> connectivity;
    for (std::size_t edge = 0; edge < blocks.edge_vertex.size(); ++edge) {
        const bool rests_on_joint = equivalent && equivalent->normal_stiffness[edge] > 0;
        if (blocks.edge_kind[edge] != static_cast<Index>(EdgeKind::joint) && !rests_on_joint)
            continue;
        edges.push_back(static_cast<Index>(edge));
        connectivity.insert(connectivity.end(), blocks.edge_vertex[edge].begin(),
                            blocks.edge_vertex[edge].end());
    }
    const std::vector<Index> joint = picked(blocks.edge_joint, edges);

    GridText grid(blocks.vertex.size(), edges.size());
    grid.open("FieldData");
    grid.add_names("joint_set_names", network.names.joint_set);
    grid.open("CellData");
    grid.add("edge", edges);
    grid.add("kind", picked(blocks.edge_kind, edges));
    grid.add("joint", joint);
    grid.add("set", looked_up(network.joints.set, joint));
    grid.add("joint_fraction", picked(blocks.edge_joint_fraction, edges));
    if (equivalent)
        for (const Column& column : columns_of(&ForceColumns::of_edges, *equivalent))
            grid.add(column, edges);
    grid.open("Points");
    grid.add("position", blocks.vertex);
    grid.cells(connectivity, offsets_of(edges.size(), 2), line);
    return grid.finish();
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
