#include "exchange/grids.hpp"

#include "exchange/convex.hpp"
#include "exchange/forces.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <numeric>

namespace jointcreep::exchange
{

namespace
{

using exchange::array_of;
using fields::Column;
using fields::ForceColumns;

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
GridArray array_of(const Attribute& attribute, std::size_t rows)
{
    std::vector<Index> codes;
    std::vector<double> numbers;
    for (std::size_t row = 0; row < rows; ++row)
        if (attribute.is_integer)
            codes.push_back(static_cast<Index>(attribute.value(row).value_or(-1)));
        else
            numbers.push_back(attribute.value(row).value_or(0));
    return attribute.is_integer ? array_of(attribute.name, std::move(codes))
                                : array_of(attribute.name, std::move(numbers));
}

// The wanted rows of a column.
template <class Value>
std::vector<Value> values_of(const Column& column, const std::vector<Index>& rows)
{
    std::vector<Value> values;
    values.reserve(rows.size());
    for (const Index row : rows)
        values.push_back(static_cast<Value>(column.value(static_cast<std::size_t>(row))));
    return values;
}

GridArray array_of(const Column& column, const std::vector<Index>& rows)
{
    return column.is_integer ? array_of(column.name, values_of<Index>(column, rows))
                             : array_of(column.name, values_of<double>(column, rows));
}

void check_state(const States& states, std::size_t state)
{
    if (state >= states.time.size())
        throw input_error("state " + std::to_string(state) + " is not among the result's " +
                          std::to_string(states.time.size()) + " states");
}

GridArray time_of(double time)
{
    return array_of("TimeValue", std::vector<double>{time});
}

} // namespace

Grid layer_grid(const Layer& layer)
{
    Grid grid{.points = array_of("position", layer.point),
              .type = layer.shape == Shape::lines ? CellType::line : CellType::polygon};
    for (std::size_t row = 0; row < layer.rows(); ++row) {
        const std::vector<Index> around = with_bridges(layer, row);
        grid.connectivity.insert(grid.connectivity.end(), around.begin(), around.end());
        grid.offsets.push_back(static_cast<std::int64_t>(grid.connectivity.size()));
    }
    for (const Attribute& attribute : layer.attributes) {
        if (attribute.names)
            grid.field_data.push_back(array_of(attribute.name + "_names", *attribute.names));
        grid.cell_data.push_back(array_of(attribute, layer.rows()));
    }
    return grid;
}

std::vector<File> write_vtu(const Job& job)
{
    return {{"", "", vtu_of(layer_grid(job.all(job.layers[0])[0]))}};
}

std::vector<File> write_vtkhdf(const Job& job)
{
    return {{"", "", vtkhdf_of(layer_grid(job.all(job.layers[0])[0]))}};
}

Grid zones_grid(const Network& network, const Result& result, std::size_t state)
{
    const Mesh& mesh = result.mesh;
    const States& states = result.states;
    check_state(states, state);
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

    Grid grid{.field_data = {time_of(states.time[state]), array_of("rock_names", network.names.rock),
                             array_of("stage_names", network.names.stage)},
              .points = array_of("position", picked(mesh.gridpoint, gridpoints)),
              .connectivity = std::move(connectivity),
              .offsets = offsets_of(present.size(), mesh.is_quadratic() ? 6 : 3),
              .type = mesh.is_quadratic() ? CellType::quadratic_triangle : CellType::triangle};
    const auto displacement_in = [&](std::size_t of) {
        return picked(states.displacement, gridpoints, of * mesh.gridpoint.size());
    };
    std::vector<Eigen::Vector2d> displacement = displacement_in(state);
    grid.point_data = {array_of("gridpoint", gridpoints), array_of("displacement", displacement)};
    if (const Index reset = states.reset_state[state]; reset > 0) {
        const std::vector<Eigen::Vector2d> then = displacement_in(static_cast<std::size_t>(reset));
        for (std::size_t g = 0; g < displacement.size(); ++g)
            displacement[g] -= then[g];
        grid.point_data.push_back(array_of("displacement_since_reset", displacement));
    }
    grid.cell_data = {array_of("zone", present), array_of("block", block),
                      array_of("rock", looked_up(network.blocks.block_rock, block)),
                      array_of("stage", looked_up(network.blocks.block_stage, block))};
    if (!result.failure.block.empty()) {
        std::vector<Index> is_moving(network.blocks.block_area.size(), 0);
        for (const Index moving : result.failure.block)
            is_moving[moving] = 1;
        grid.cell_data.push_back(array_of("moving_block", looked_up(is_moving, block)));
    }
    for (const Column& column : columns_of(&ForceColumns::of_zones, result, state))
        grid.cell_data.push_back(array_of(column, present));
    return grid;
}

Grid contacts_grid(const Result& result, std::size_t state)
{
    const Mesh& mesh = result.mesh;
    const States& states = result.states;
    check_state(states, state);
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

    Grid grid{.field_data = {time_of(states.time[state])},
              .point_data = {array_of("contact", present),
                             array_of("edge", picked(mesh.contact_edge, present)),
                             array_of("normal", picked(mesh.contact_normal, present)),
                             array_of("length", picked(mesh.contact_length, present)),
                             array_of("displacement", displacement)},
              .points = array_of("position", picked(mesh.contact_centre, present)),
              .connectivity = consecutive(present.size()),
              .offsets = offsets_of(present.size(), 1),
              .type = CellType::vertex};
    for (const Column& column : columns_of(&ForceColumns::of_contacts, result, state))
        grid.point_data.push_back(array_of(column, present));
    return grid;
}

} // namespace jointcreep::exchange
