#include "boundary/fields.hpp"

namespace jointcreep::boundary
{

namespace
{

using fields::Field;

std::vector<Field> fields_of(Network& network)
{
    using namespace fields;
    // clang-format off
    return {
        {"/edges/boundary", &network.blocks.edge_boundary, {"edge"}, "1", at_least(-1),
         "The scene's boundary entry on a boundary edge, counted from 0; -1 none."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Mesh& mesh)
{
    using namespace fields;
    // clang-format off
    return {
        {"/mesh/gridpoint_fixed", &mesh.gridpoint_fixed, {"gridpoint"}, "1", between(0, 3),
         "0 free, 1 fixed in x, 2 fixed in y, 3 fixed in both. Rollers (fix = \"normal\") do not count."},
        {"/mesh/side_gridpoint", &mesh.side_gridpoint, {"side"}, "1", index_of("gridpoint"),
         "Gridpoints of a zone side that lies on a boundary condition."},
        {"/mesh/side_middle", &mesh.side_middle, {"quadratic_side"}, "1", index_of("gridpoint"), "Gridpoint in its middle."},
        {"/mesh/side_zone", &mesh.side_zone, {"side"}, "1", index_of("zone"), "Its zone."},
        {"/mesh/side_boundary", &mesh.side_boundary, {"side"}, "1", at_least(0),
         "Position of the boundary condition among the scene's [[boundary]] tables."},
    };
    // clang-format on
}

} // namespace

fields::ForceFields fields_in_files()
{
    // clang-format off
    return {
        .dimensions = {
            {"side", "a side of a zone that lies on a boundary condition"},
            {"quadratic_side", "such a side, if zones are quadratic; otherwise there is none"},
        },
        .network = fields_of,
        .mesh = fields_of,
    };
    // clang-format on
}

} // namespace jointcreep::boundary
