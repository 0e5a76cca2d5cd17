#include "rock/fields.hpp"

namespace jointcreep::rock
{

namespace
{

using fields::Field;

std::vector<Field> fields_of(Mesh& mesh)
{
    using namespace fields;
    // clang-format off
    return {
        {"/mesh/zone_gridpoint", &mesh.zone_gridpoint, {"zone"}, "1", index_of("gridpoint"),
         "Corners of the zone, counter-clockwise."},
        {"/mesh/zone_middle", &mesh.zone_middle, {"quadratic_zone"}, "1", index_of("gridpoint"),
         "Gridpoints in the middles of its sides from corner 0 to 1, 1 to 2 and 2 to 0."},
        {"/mesh/stress_point_position", &mesh.stress_point, {"quadratic_point"}, "m", any(),
         "Stress points of quadratic zones {x, y}, three a zone, each nearest to a corner."},
        {"/mesh/zone_block", &mesh.zone_block, {"zone"}, "1", index_of("block"),
         "Block the zone is part of."},
    };
    // clang-format on
}

std::vector<Field> fields_of(States& states)
{
    using namespace fields;
    // clang-format off
    return {
        {"/states/stress", &states.stress, {"state", "zone"}, "Pa", any(),
         "Stress {xx, yy, xy}, tension positive. Of a quadratic zone the mean over its stress points, as in all datasets below with the dimension zone."},
        {"/states/point_stress", &states.point_stress, {"state", "quadratic_point"}, "Pa", any(),
         "Stress at the stress points of quadratic zones, three per zone: point i has the share 2/3 of "
         "corner i, 1/6 of the others."},
        {"/states/zone_present", &states.zone_present, {"state", "zone"}, "1", between(0, 1),
         "1 while the zone is there, 0 once it is removed."},
        {"/states/yielding_zone", &states.yielding_zone, {"yielding_zone"}, "1", index_of("zone"),
         "Zones of rock that yields; none where all is elastic."},
        {"/states/plastic_strain", &states.plastic_strain, {"state", "yielding_zone"}, "1", any(),
         "Plastic strain {xx, yy, xy} since the in-situ equilibrium, extension positive."},
        {"/states/stress_zz", &states.stress_zz, {"state", "yielding_zone"}, "Pa", any(),
         "Stress across the section. The strength of these zones depends on it, too."},
        {"/states/creeping_zone", &states.creeping_zone, {"creeping_zone"}, "1", index_of("zone"),
         "Zones of rock that creeps."},
        {"/states/crept_strain", &states.crept_strain, {"state", "creeping_zone"}, "1", any(),
         "Deviatoric creep strain {xx, yy, xy} since the in-situ equilibrium; its zz is -(xx + yy)."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Checkpoint& checkpoint)
{
    using namespace fields;
    const std::vector<std::string> zone = {"stress_point"}, yields = {"yielding_point"};
    // clang-format off
    return {
        {"/checkpoint/zone_present", &checkpoint.zone_present, zone, "1", between(0, 1),
         "1 while the zone is there, 0 once it is removed."},
        {"/checkpoint/stress", &checkpoint.stress, zone, "Pa", any(), "Stress {xx, yy, xy}, tension positive."},
        {"/checkpoint/initial_stress", &checkpoint.initial_stress, zone, "Pa", any(),
         "Stress {xx, yy, xy} at zero displacement, less 2 G times the creep strain."},
        {"/checkpoint/stiffness", &checkpoint.stiffness, zone, "Pa", at_least(0),
         "C11, C12 and C33 of the rock. Creep steps change and restore them, with rounding errors; so they are kept."},
        {"/checkpoint/plastic_strain", &checkpoint.plastic_strain, yields, "1", any(),
         "Plastic strain {xx, yy, zz, 2 xy} since the in-situ equilibrium, extension positive."},
        {"/checkpoint/stress_zz", &checkpoint.stress_zz, yields, "Pa", any(), "Stress across the section."},
        {"/checkpoint/initial_zz", &checkpoint.initial_zz, yields, "Pa", any(), "Stress across the section at zero displacement."},
        {"/checkpoint/rock_reference", &checkpoint.rock_reference, {"creeping_point"}, "Pa", any(),
         "Stress {xx, yy, xy} from which creep counts."},
        {"/checkpoint/rock_crept", &checkpoint.rock_crept, {"zone_unit"}, "1", any(),
         "Deviatoric creep strain {xx, yy, xy} of the unit."},
    };
    // clang-format on
}

std::vector<Field> fields_of(DynamicsState& state)
{
    using namespace fields;
    const std::vector<std::string> zone = {"zone"}, yields = {"yielding_zone"};
    // clang-format off
    return {
        {"/dynamics_state/inverse", &state.inverse, zone, "1/m", any(),
         "Inverse of the matrix of the zone's edges without stress, by columns."},
        {"/dynamics_state/area", &state.area, zone, "m2", positive(), "Area of the zone without stress."},
        {"/dynamics_state/strain", &state.strain, zone, "1", any(), "Biot's strain {xx, yy, 2 xy} of the zone."},
        {"/dynamics_state/plastic_strain", &state.plastic_strain, yields, "1", any(),
         "Of it, plastic strain {xx, yy, zz, 2 xy}, extension positive."},
        {"/dynamics_state/initial_zz", &state.initial_zz, yields, "Pa", any(), "Stress across the section at zero strain in the section."},
        {"/dynamics_state/stress_zz", &state.stress_zz, yields, "Pa", any(), "Present stress across the section."},
        {"/dynamics_state/stress", &state.stress, yields, "Pa", any(), "Biot's stress {xx, yy, xy}, tension positive."},
    };
    // clang-format on
}

std::vector<fields::Invariant> invariants_of(const Mesh& mesh)
{
    return {
        {"/mesh/zone_gridpoint", "the corners of a zone run counter-clockwise around an area", "zone",
         [&mesh](std::size_t zone) {
             const auto [first, second, third] = mesh.zone_gridpoint[zone];
             const Eigen::Vector2d to_second = mesh.gridpoint[second] - mesh.gridpoint[first];
             const Eigen::Vector2d to_third = mesh.gridpoint[third] - mesh.gridpoint[first];
             return to_second.x() * to_third.y() - to_second.y() * to_third.x() > 0;
         }},
        {"/mesh/zone_middle", "all zones have gridpoints in the middles of their sides, or none has", "zone",
         [&mesh](std::size_t) {
             return mesh.zone_middle.empty() || mesh.zone_middle.size() == mesh.zone_gridpoint.size();
         }},
    };
}

} // namespace

fields::ForceFields fields_in_files()
{
    // clang-format off
    return {
        .dimensions = {
            {"zone", "a triangle, of constant strain or quadratic"},
            {"quadratic_zone", "a zone, if zones are quadratic; otherwise there is none"},
            {"yielding_zone", "a zone of rock that yields"},
            {"stress_point", "a point of a zone at which its stress is computed: one of a zone of constant strain, three of a quadratic one"},
            {"yielding_point", "a stress point of rock that yields"},
            {"creeping_zone", "a zone of rock that creeps"},
            {"creeping_point", "a stress point of rock that creeps"},
            {"zone_unit", "a Kelvin unit or dashpot of a creeping point"},
            {"quadratic_point", "a stress point, if zones are quadratic; otherwise there is none"},
        },
        .mesh = fields_of,
        .invariants_of_mesh = invariants_of,
        .states = fields_of,
        .checkpoint = fields_of,
        .dynamics_state = fields_of,
    };
    // clang-format on
}

} // namespace jointcreep::rock
