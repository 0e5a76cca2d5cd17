#include "store/schema.hpp"

#include "joint/law.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace jointcreep::store::schema
{

namespace
{

Limits any()
{
    return {};
}

Limits positive()
{
    return {.positive = true};
}

Limits at_least(double least)
{
    return {.least = least};
}

Limits between(double least, double most)
{
    return {.least = least, .most = most};
}

Limits index_of(std::string dimension)
{
    return {.index_of = std::move(dimension)};
}

Limits index_or_none(std::string dimension)
{
    return {.index_of = std::move(dimension), .or_none = true};
}

Limits ascending()
{
    return {.least = 0, .ascending = true};
}

// For "first" arrays: rows first[i] .. first[i + 1] belong to i.
Limits rows_in(std::string dimension)
{
    return {.least = 0, .ascending = true, .rows_of = std::move(dimension)};
}

void append(std::vector<Field>& fields, std::vector<Field> more)
{
    std::ranges::move(more, std::back_inserter(fields));
}

std::vector<Field> fields_of(Names& names)
{
    // clang-format off
    return {
        {"/names/rock", &names.rock, {"rock"}, "1", any(), "Rocks, as named in the scene."},
        {"/names/joint_material", &names.joint_material, {"joint_material"}, "1", any(),
         "Joint materials, as named in the scene."},
        {"/names/joint_set", &names.joint_set, {"joint_set"}, "1", any(),
         "Joint sets, then the single joints, each as a set of its own, then the mapped sets."},
        {"/names/stage", &names.stage, {"stage"}, "1", any(), "Excavation stages, as named in the scene."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Joints& joints)
{
    // clang-format off
    return {
        {"/joints/set", &joints.set, {"joint"}, "1", index_of("joint_set"), "Set the joint belongs to."},
        {"/joints/number", &joints.number, {"joint"}, "1", any(),
         "Number within the set; with the set's name it identifies the joint."},
        {"/joints/material", &joints.material, {"joint"}, "1", index_of("joint_material"), "Joint material."},
        {"/joints/from", &joints.from, {"joint"}, "m", any(), "One end of the joint's line {x, y}."},
        {"/joints/to", &joints.to, {"joint"}, "m", any(), "The other end {x, y}."},
        {"/joints/pole", &joints.pole, {"joint"}, "1", between(-1, 1),
         "Upward unit normal of the joint's plane {x, y, z}, z being across the section, at its azimuth plus 90 "
         "degrees; 0 where only a trace angle was drawn."},
        {"/joints/point", &joints.point, {"joint"}, "m", any(),
         "Where the joint was placed, about which it turns {x, y}; need not be inside the section."},

        {"/traces/joint", &joints.trace_joint, {"trace"}, "1", index_of("joint"), "Joint the trace lies on."},
        {"/traces/from", &joints.trace_from, {"trace"}, "m", any(), "One end of the joint trace {x, y}."},
        {"/traces/to", &joints.trace_to, {"trace"}, "m", any(),
         "The other end {x, y}; between its traces a joint's line is rock bridge."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Blocks& blocks)
{
    CuttingReport& report = blocks.report;
    JointFates& fates = blocks.fates;
    // clang-format off
    return {
        {"/vertices/position", &blocks.vertex, {"vertex"}, "m", any(), "Position of the vertex {x, y}."},

        {"/edges/vertex", &blocks.edge_vertex, {"edge"}, "1", index_of("vertex"), "First and second vertex."},
        {"/edges/block", &blocks.edge_block, {"edge"}, "1", index_or_none("block"),
         "Block on the left (side b) and on the right (side a); -1 is outside the section."},
        {"/edges/kind", &blocks.edge_kind, {"edge"}, "1", between(0, 2),
         "0 boundary (outline of the section), 1 joint, 2 bonded (no joint: the blocks hold together)."},
        {"/edges/joint", &blocks.edge_joint, {"edge"}, "1", index_or_none("joint"), "Joint of a joint edge."},
        {"/edges/joint_fraction", &blocks.edge_joint_fraction, {"edge"}, "1", between(0, 1),
         "Joint length over edge length, on joint edges; the rest is rock bridge."},
        {"/edges/boundary", &blocks.edge_boundary, {"edge"}, "1", at_least(-1),
         "Which of the scene's boundary entries holds a boundary edge, counted from 0; -1 none."},

        {"/edges/first_share", &blocks.edge_share, {"edge+1"}, "1", rows_in("share"),
         "Edge e lies on the joints of the shares first_share[e] up to, not including, first_share[e + 1]; the "
         "first is /edges/joint."},
        {"/shares/joint", &blocks.share_joint, {"share"}, "1", index_of("joint"), "Joint that the edge lies on."},
        {"/shares/joint_fraction", &blocks.share_fraction, {"share"}, "1", between(0, 1),
         "Length of this joint's traces on the edge over edge length."},

        {"/blocks/rock", &blocks.block_rock, {"block"}, "1", index_of("rock"), "Rock of the block."},
        {"/blocks/stage", &blocks.block_stage, {"block"}, "1", index_or_none("stage"),
         "Stage that removes the block; -1 if it stays."},
        {"/blocks/area", &blocks.block_area, {"block"}, "m2", positive(), "Area of the block."},
        {"/blocks/first_ring", &blocks.block_ring, {"block+1"}, "1", rows_in("ring"),
         "Block i has the rings first_ring[i] up to, not including, first_ring[i + 1]: its outline, "
         "counter-clockwise, then its holes, clockwise."},
        {"/rings/first_corner", &blocks.ring_start, {"ring+1"}, "1", rows_in("corner"),
         "Ring r has the corners first_corner[r] up to, not including, first_corner[r + 1]."},
        {"/rings/vertex", &blocks.ring_vertex, {"corner"}, "1", index_of("vertex"), "Vertex at the corner."},

        {"/fates/fate", &fates.fate, {"joint"}, "1", between(0, 4),
         "What became of the joint, up to the shortest edge: 0 kept (all on block edges), 1 clipped (what lies in "
         "the section is), 2 trimmed (some ended inside a block), 3 merged (some was on edges that vanished), 4 "
         "dropped (none is on block edges). The lengths below, without the extension, sum to the joint's."},
        {"/fates/kept_length", &fates.kept, {"joint"}, "m", at_least(0), "On block edges with its properties."},
        {"/fates/shared_length", &fates.shared, {"joint"}, "m", at_least(0),
         "On block edges with the properties of another joint on them."},
        {"/fates/outline_length", &fates.on_outline, {"joint"}, "m", at_least(0),
         "Along the outline of the section."},
        {"/fates/outside_length", &fates.outside, {"joint"}, "m", at_least(0), "Outside the section."},
        {"/fates/dangling_end_length", &fates.dangling_end, {"joint"}, "m", at_least(0),
         "Inside a block, and cut back."},
        {"/fates/merged_length", &fates.merged, {"joint"}, "m", at_least(0), "On edges that vanished."},
        {"/fates/extended_length", &fates.extended, {"joint"}, "m", at_least(0),
         "Carried on beyond its ends to the next block edge, as rock bridge."},

        {"/cutting/merged_vertices", &report.merged_vertices, {}, "1", at_least(0),
         "Vertices that cutting merged into others."},
        {"/cutting/merged_edge_length", &report.merged_edge_length, {}, "m", at_least(0),
         "Total length of the edges that vanished."},
        {"/cutting/merged_block_area", &report.merged_block_area, {}, "m2", at_least(0),
         "Total area of the blocks that vanished into their neighbours."},
        {"/cutting/largest_move", &report.largest_move, {}, "m", at_least(0),
         "Largest distance by which a vertex was moved."},
        {"/cutting/pruned_length", &report.pruned_length, {}, "m", at_least(0),
         "Total length of joints that ended inside a block and were cut back."},
        {"/cutting/shortest_edge", &report.shortest_edge, {}, "m", at_least(0),
         "Shortest edge that is left."},
        {"/cutting/smallest_angle", &report.smallest_angle, {}, "rad", at_least(0),
         "Smallest angle between neighbouring edges that is left."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Statistics& rows)
{
    const std::vector<std::string> statistic = {"statistic"};
    const std::string unit = "1"; // the row's own, /statistics/unit
    // clang-format off
    return {
        {"/statistics/subject", &rows.subject, statistic, "1", any(),
         "What the row is about: a joint set, `blocks` or `nodes`. Rows are there only if a report was asked for."},
        {"/statistics/quantity", &rows.quantity, statistic, "1", any(), "What is looked at."},
        {"/statistics/unit", &rows.unit, statistic, "1", any(),
         "Unit of target, achieved value and interval: SI, angles in rad."},
        {"/statistics/has_target", &rows.has_target, statistic, "1", between(0, 1), "1 if there is a target."},
        {"/statistics/target", &rows.target, statistic, unit, any(),
         "By the laws of the scene; 0 where there is none."},
        {"/statistics/achieved", &rows.achieved, statistic, unit, any(),
         "What the network has; of a law, the largest distance between the two distribution functions."},
        {"/statistics/has_interval", &rows.has_interval, statistic, "1", between(0, 1),
         "1 if there is a confidence interval."},
        {"/statistics/low", &rows.low, statistic, unit, any(),
         "Lower end of the confidence interval; the achieved value where there is none."},
        {"/statistics/high", &rows.high, statistic, unit, any(), "Its upper end."},
        {"/statistics/sample_size", &rows.sample_size, statistic, "1", at_least(0),
         "How many joints, traces, intervals, blocks or nodes were looked at."},
        {"/statistics/is_tested", &rows.is_tested, statistic, "1", between(0, 1),
         "1 if the verdict follows from the p-value."},
        {"/statistics/p_value", &rows.p_value, statistic, "1", between(0, 1),
         "Probability that chance takes a network by the scene's laws so far from the target; 1 where not tested."},
        {"/statistics/verdict", &rows.verdict, statistic, "1", between(0, 3),
         "0 not judged, 1 sample too small for a verdict, 2 pass, 3 fail."},
        {"/statistics/confidence", &rows.confidence, {}, "1", between(0, 1), "Of the confidence intervals."},
        {"/statistics/false_alarm_rate", &rows.false_alarm_rate, {}, "1", between(0, 1),
         "Largest probability that a network by the scene's laws fails in any row."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Mesh& mesh)
{
    // clang-format off
    return {
        {"/mesh/gridpoint_position", &mesh.gridpoint, {"gridpoint"}, "m", any(),
         "Position of the gridpoint at the start {x, y}."},
        {"/mesh/gridpoint_fixed", &mesh.gridpoint_fixed, {"gridpoint"}, "1", between(0, 3),
         "0 free, 1 held in x, 2 held in y, 3 held in both."},
        {"/mesh/zone_gridpoint", &mesh.zone_gridpoint, {"zone"}, "1", index_of("gridpoint"),
         "Corners of the zone, counter-clockwise."},
        {"/mesh/zone_block", &mesh.zone_block, {"zone"}, "1", index_of("block"),
         "Block the zone is part of."},
        {"/mesh/tie_gridpoint", &mesh.tie_gridpoint, {"tie"}, "1", index_of("gridpoint"),
         "Two gridpoints that move as one until a stage."},
        {"/mesh/tie_stage", &mesh.tie_stage, {"tie"}, "1", index_of("stage"), "The stage that parts them."},
        {"/mesh/side_gridpoint", &mesh.side_gridpoint, {"side"}, "1", index_of("gridpoint"),
         "Gridpoints of a zone side that lies on a boundary condition."},
        {"/mesh/side_zone", &mesh.side_zone, {"side"}, "1", index_of("zone"), "Its zone."},
        {"/mesh/side_boundary", &mesh.side_boundary, {"side"}, "1", at_least(0),
         "Position of the boundary condition among the scene's [[boundary]] tables."},
        {"/mesh/contact_gridpoint", &mesh.contact_gridpoint, {"contact"}, "1", index_of("gridpoint"),
         "Gridpoint on side a and on side b."},
        {"/mesh/contact_edge", &mesh.contact_edge, {"contact"}, "1", index_of("edge"),
         "Edge the contact lies on."},
        {"/mesh/contact_normal", &mesh.contact_normal, {"contact"}, "1", any(),
         "Unit normal {x, y}, from side a to side b."},
        {"/mesh/contact_length", &mesh.contact_length, {"contact"}, "m", positive(),
         "Length of edge that the contact stands for."},
        {"/mesh/contact_centre", &mesh.contact_centre, {"contact"}, "m", any(),
         "Where a traction that is linear along the edge has its mean over the contact {x, y}."},
    };
    // clang-format on
}

std::vector<Field> fields_of(History& history)
{
    // clang-format off
    return {
        {"/history/time", &history.time, {"time"}, "day", ascending(),
         "Time since the start; two rows at a stage's time, before and after it."},
        {"/history/event", &history.event, {"time"}, "1", any(),
         "Stage that this row is the first after, or an empty text."},
        {"/history/point", &history.point, {"point"}, "1", any(), "Names of the monitoring points."},
        {"/history/point_position", &history.point_position, {"point"}, "m", any(),
         "Position of the monitoring point {x, y}."},
        {"/history/first_reading_row", &history.first_reading_row, {"point"}, "1", index_of("time"),
         "Row of time from which the point's own readings count."},
        {"/history/displacement", &history.displacement, {"time", "point"}, "m", any(),
         "Displacement {x, y} since the in-situ equilibrium; the last one is held once the point is "
         "removed."},
        {"/history/present", &history.present, {"time", "point"}, "1", between(0, 1),
         "1 while the point is there, 0 once it is removed."},
        {"/history/reset_row", &history.reset_row, {"time"}, "1", index_of("time"),
         "Row from which displacements are to count since the last stage that resets them; 0 before one."},
    };
    // clang-format on
}

std::vector<Field> fields_of(States& states)
{
    // clang-format off
    return {
        {"/states/time", &states.time, {"state"}, "day", ascending(), "Time since the start."},
        {"/states/event", &states.event, {"state"}, "1", any(),
         "Stage that this state is the first after, or an empty text."},
        {"/states/displacement", &states.displacement, {"state", "gridpoint"}, "m", any(),
         "Displacement {x, y} since the in-situ equilibrium."},
        {"/states/stress", &states.stress, {"state", "zone"}, "Pa", any(),
         "Stress {xx, yy, xy}, tension positive."},
        {"/states/zone_present", &states.zone_present, {"state", "zone"}, "1", between(0, 1),
         "1 while the zone is there, 0 once it is removed."},
        {"/states/traction", &states.traction, {"state", "contact"}, "Pa", any(),
         "Traction {normal, shear} that side b exerts on side a, tension positive."},
        {"/states/relative_displacement", &states.relative_displacement, {"state", "contact"}, "m", any(),
         "Displacement of side b minus that of side a {normal, shear}, opening positive."},
        {"/states/contact_status", &states.contact_status, {"state", "contact"}, "1", between(0, 3),
         "0 removed (a side has been excavated), 1 stuck, 2 slipping, 3 open."},
        {"/states/yielding_zone", &states.yielding_zone, {"yielding_zone"}, "1", index_of("zone"),
         "Zones of rock that yields; none where all is elastic."},
        {"/states/plastic_strain", &states.plastic_strain, {"state", "yielding_zone"}, "1", any(),
         "Plastic strain {xx, yy, xy} since the in-situ equilibrium, extension positive."},
        {"/states/reset_state", &states.reset_state, {"state"}, "1", index_of("state"),
         "State from which displacements are to count since the last stage that resets them; 0 before one."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Equilibria& equilibria)
{
    // clang-format off
    return {
        {"/equilibria/time", &equilibria.time, {"equilibrium"}, "day", ascending(), "Time since the start."},
        {"/equilibria/is_implicit", &equilibria.is_implicit, {"equilibrium"}, "1", between(0, 1),
         "1 if the implicit engine found it, 0 if dynamic relaxation did."},
        {"/equilibria/searches", &equilibria.searches, {"equilibrium"}, "1", at_least(1),
         "Equilibria sought for this one: by either engine, and with creep steps that were too long."},
        {"/equilibria/steps", &equilibria.steps, {"equilibrium"}, "1", at_least(0),
         "Steps of dynamic relaxation, and corrections by the implicit engine, in all of these."},
        {"/equilibria/factorisations", &equilibria.factorisations, {"equilibrium"}, "1", at_least(0),
         "Factorisations of the stiffness in all of these."},
        {"/equilibria/solves", &equilibria.solves, {"equilibrium"}, "1", at_least(0),
         "Back-substitutions in all of these."},
        {"/equilibria/unbalanced_force_ratio", &equilibria.unbalanced_force_ratio, {"equilibrium"},
         "1", at_least(0),
         "Unbalanced force ratio at the end."},
        {"/equilibria/contact_force_change", &equilibria.contact_force_change, {"equilibrium"},
         "1", at_least(0),
         "Largest change of a contact force over the last 100 steps, or by one more correction, over the mean force "
         "on a gridpoint."},
        {"/equilibria/remaining_displacement", &equilibria.remaining_displacement, {"equilibrium"}, "m", at_least(-1),
         "Largest displacement that remains until rest, by estimate: from the softest mode that dynamic relaxation shows, or "
         "from one more correction; -1 after a dynamic analysis with large displacements, which has none."},
        {"/equilibria/work_of_loads", &equilibria.work_of_loads, {"equilibrium"}, "J/m", any(),
         "Work of weight, held rock and tractions on the way, not that of displaced boundaries; the sum of the next "
         "three."},
        {"/equilibria/stored_energy", &equilibria.stored_energy, {"equilibrium"}, "J/m", any(),
         "Energy that zones and contacts took up on the way."},
        {"/equilibria/dissipated_energy", &equilibria.dissipated_energy, {"equilibrium"}, "J/m", any(),
         "Energy lost in contacts by slip and opening."},
        {"/equilibria/damped_energy", &equilibria.damped_energy, {"equilibrium"}, "J/m", any(),
         "Energy taken by damping; by the implicit engine, what a sudden change of loads would set free."},
    };
    // clang-format on
}

} // namespace

std::vector<Field> fields_of(Provenance& provenance)
{
    // clang-format off
    return {
        {"/scene", &provenance.scene, {}, "1", any(), "The scene's text, as it was read."},
        {"/provenance/program", &provenance.program, {"program"}, "1", any(),
         "Programs that led to this file, in the order they ran; the last one wrote it."},
        {"/provenance/version", &provenance.version, {"program"}, "1", any(), "Version of the program."},
        {"/provenance/input_sha256", &provenance.input_sha256, {"program"}, "1", any(),
         "SHA-256 of the file that the program read."},
        {"/provenance/options", &provenance.options, {"program"}, "1", any(),
         "Options given to the program that can change its result, or an empty text."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Network& network)
{
    std::vector<Field> fields = fields_of(network.names);
    append(fields, fields_of(network.joints));
    append(fields, fields_of(network.blocks));
    append(fields, fields_of(network.statistics));
    return fields;
}

namespace
{

std::vector<Field> fields_of(Pieces& pieces)
{
    // clang-format off
    return {
        {"/pieces/joint", &pieces.joint, {"piece"}, "1", index_of("joint"),
         "Joint that the piece lies on; pieces are in the order of joints, and along each from its one end."},
        {"/pieces/is_bridge", &pieces.is_bridge, {"piece"}, "1", between(0, 1),
         "1 rock bridge, 0 joint trace."},
        {"/pieces/from", &pieces.from, {"piece"}, "m", any(),
         "One end of the piece, inside the section {x, y}."},
        {"/pieces/to", &pieces.to, {"piece"}, "m", any(), "The other end {x, y}."},
        {"/pieces/length", &pieces.length, {"piece"}, "m", positive(), "Its length."},
        {"/bridges/piece", &pieces.bridge, {"bridge"}, "1", index_of("piece"),
         "The rock bridges among the pieces."},
        {"/lines/length", &pieces.line_length, {"joint"}, "m", at_least(0),
         "Length of the joint's line inside the section."},
        {"/lines/persistence", &pieces.line_persistence, {"joint"}, "1", between(0, 1),
         "Fraction of it that is joint."},
    };
    // clang-format on
}

std::vector<Field> fields_of(SetAverages& sets)
{
    const std::vector<std::string> set = {"joint_set"};
    const Limits fraction = between(0, 1), angle = between(0, std::numbers::pi / 2), natural = at_least(0);
    // clang-format off
    return {
        {"/sets/target_persistence", &sets.target_persistence, set, "1", fraction,
         "Persistence that the scene asks for; 1 for all but sets of lines."},
        {"/sets/line_persistence", &sets.line_persistence, set, "1", fraction,
         "Fraction of the set's lines inside the section that is joint."},
        {"/sets/persistence_error", &sets.persistence_error, set, "1", natural,
         "Standard error that it is expected to have, by the laws of traces and bridges."},
        {"/sets/edge_persistence", &sets.edge_persistence, set, "1", fraction,
         "Fraction of the set's edges that is joint."},
        {"/sets/line_length", &sets.line_length, set, "m", natural,
         "Length of the set's lines inside the section."},
        {"/sets/edge_length", &sets.edge_length, set, "m", natural,
         "Length of the set's edges. Strengths and stiffnesses are means over it."},
        {"/sets/joint_cohesion", &sets.joint_cohesion, set, "Pa", natural, "Cohesion of the joint."},
        {"/sets/joint_friction_angle", &sets.joint_friction_angle, set, "rad", angle, "Its friction angle."},
        {"/sets/joint_tensile_strength", &sets.joint_tensile_strength, set, "Pa", natural,
         "Its tensile strength."},
        {"/sets/bridge_cohesion", &sets.bridge_cohesion, set, "Pa", natural,
         "Cohesion of the rock bridges; 0, as the next two, where there are none."},
        {"/sets/bridge_friction_angle", &sets.bridge_friction_angle, set, "rad", angle,
         "Their friction angle."},
        {"/sets/bridge_tensile_strength", &sets.bridge_tensile_strength, set, "Pa", natural,
         "Their tensile strength."},
        {"/sets/cohesion", &sets.cohesion, set, "Pa", natural, "Cohesion of the equivalent joints."},
        {"/sets/friction_angle", &sets.friction_angle, set, "rad", angle, "Their friction angle."},
        {"/sets/tensile_strength", &sets.tensile_strength, set, "Pa", natural, "Their tensile strength."},
        {"/sets/joint_dilation_angle", &sets.joint_dilation_angle, set, "rad", angle,
         "Dilation angle of the joint."},
        {"/sets/bridge_dilation_angle", &sets.bridge_dilation_angle, set, "rad", angle,
         "Dilation angle of the rock bridges; 0 where there are none."},
        {"/sets/dilation_angle", &sets.dilation_angle, set, "rad", angle,
         "Dilation angle of the equivalent joints."},
        {"/sets/joint_normal_stiffness", &sets.joint_normal_stiffness, set, "Pa/m", natural,
         "Normal stiffness of the joint."},
        {"/sets/joint_shear_stiffness", &sets.joint_shear_stiffness, set, "Pa/m", natural,
         "Its shear stiffness."},
        {"/sets/normal_stiffness", &sets.normal_stiffness, set, "Pa/m", natural,
         "Normal stiffness of the equivalent joints."},
        {"/sets/shear_stiffness", &sets.shear_stiffness, set, "Pa/m", natural, "Their shear stiffness."},
        {"/sets/limited_length", &sets.limited_length, set, "m", natural,
         "Length of edges whose stiffness was limited to ten times that of a zone."},
    };
    // clang-format on
}

} // namespace

std::vector<Field> fields_of(EquivalentJoints& joints)
{
    const std::vector<std::string> edge = {"edge"}, units = {"edge", "kelvin_unit"};
    // clang-format off
    std::vector<Field> fields;
    for (const joint::Parameter& parameter : joint::all_parameters())
        fields.push_back({"/equivalent/" + std::string(parameter.name), &parameter.in(joints), edge,
                          parameter.si_unit(),
                          parameter.is_angle() ? between(0, std::numbers::pi / 2) : at_least(0),
                          std::string(parameter.meaning)});
    std::string numbers;
    for (std::size_t law = 0; law < joint::laws().size(); ++law)
        numbers += (law > 0 ? "; " : "") + std::to_string(law) + " " + std::string(joint::laws()[law].about);
    fields.push_back({"/equivalent/law", &joints.law, edge, "1",
                      between(0, static_cast<double>(joint::laws().size() - 1)),
                      "Joint law: " + numbers + ". Parameters that the law does not have are 0."});
    append(fields, {
        {"/equivalent/persistence", &joints.persistence, edge, "1", between(0, 1),
         "Persistence that joint and rock bridges were averaged with: of the edge, of its line or of its set."},
        {"/equivalent/normal_kelvin_stiffness", &joints.normal_kelvin_stiffness, units, "Pa/m", at_least(0),
         "Normal stiffness of the Kelvin unit; 0 if the joint has no such unit."},
        {"/equivalent/shear_kelvin_stiffness", &joints.shear_kelvin_stiffness, units, "Pa/m", at_least(0),
         "Shear stiffness of the Kelvin unit; 0 if the joint has no such unit."},
        {"/equivalent/normal_kelvin_viscosity", &joints.normal_kelvin_viscosity, units, "Pa s/m", at_least(0),
         "Normal viscosity of the Kelvin unit."},
        {"/equivalent/shear_kelvin_viscosity", &joints.shear_kelvin_viscosity, units, "Pa s/m", at_least(0),
         "Shear viscosity of the Kelvin unit."},
        {"/equivalent/normal_maxwell_viscosity", &joints.normal_maxwell_viscosity, edge, "Pa s/m", at_least(0),
         "Normal viscosity of the Maxwell dashpot; 0 if there is none."},
        {"/equivalent/shear_maxwell_viscosity", &joints.shear_maxwell_viscosity, edge, "Pa s/m", at_least(0),
         "Shear viscosity of the Maxwell dashpot; 0 if there is none."},
    });
    // clang-format on
    append(fields, fields_of(joints.pieces));
    append(fields, fields_of(joints.sets));
    return fields;
}

std::vector<Field> fields_of(Result& result)
{
    std::vector<Field> fields = fields_of(result.mesh);
    append(fields, fields_of(result.history));
    append(fields, fields_of(result.states));
    append(fields, fields_of(result.equilibria));
    return fields;
}

std::vector<Field> fields_of(StepHistory& step_history)
{
    // clang-format off
    return {
        {"/step_history/time", &step_history.time, {"row"}, "day", ascending(), "Time since the start."},
        {"/step_history/solver_time", &step_history.solver_time, {"row"}, "s", ascending(),
         "Time of the solver, accumulated over all equilibria."},
        {"/step_history/displacement", &step_history.displacement, {"row", "point"}, "m", any(),
         "Displacement {x, y} of the monitoring point, as in the history."},
        {"/step_history/gauge", &step_history.gauge, {"gauge"}, "1", any(), "Names of the gauges."},
        {"/step_history/gauge_contact", &step_history.gauge_contact, {"gauge"}, "1", index_of("contact"),
         "Contact the gauge reads."},
        {"/step_history/traction", &step_history.traction, {"row", "gauge"}, "Pa", any(),
         "Traction {normal, shear} at the gauge, as in the states."},
    };
    // clang-format on
}

std::vector<Field> fields_of(DynamicsHistory& dynamics)
{
    // clang-format off
    return {
        {"/dynamics/time", &dynamics.time, {"moment"}, "day", ascending(), "Time of the stage since the start."},
        {"/dynamics/dynamic_time", &dynamics.dynamic_time, {"moment"}, "s", at_least(0), "Time since the dynamic analysis began."},
        {"/dynamics/state", &dynamics.state, {"moment"}, "1", index_of("state"), "The section's state then."},
        {"/dynamics/work_of_loads", &dynamics.work_of_loads, {"moment"}, "J/m", any(),
         "Work of weight, held rock and tractions since then; but for the error of time steps the sum of the next "
         "four."},
        {"/dynamics/kinetic_energy", &dynamics.kinetic_energy, {"moment"}, "J/m", any(),
         "Kinetic energy; a little below 0 where all turns round at once."},
        {"/dynamics/stored_energy", &dynamics.stored_energy, {"moment"}, "J/m", any(),
         "Energy that zones and contacts took up."},
        {"/dynamics/friction_energy", &dynamics.friction_energy, {"moment"}, "J/m", any(),
         "Energy lost to slip and yield; a little below 0 where slip dilates by the friction angle, which loses none."},
        {"/dynamics/damped_energy", &dynamics.damped_energy, {"moment"}, "J/m", any(),
         "Energy taken by dashpots, and where slow motion was stopped."},
        {"/dynamics/fastest", &dynamics.fastest, {"moment"}, "m/s", at_least(0), "Speed of the fastest gridpoint."},
        {"/dynamics/unbalanced_force_ratio", &dynamics.unbalanced_force_ratio, {"moment"}, "1", at_least(0),
         "Unbalanced force ratio."},
        {"/dynamics/first_contact", &dynamics.first_contact, {"moment+1"}, "1", rows_in("moving_contact"),
         "At moment i the moving contacts first_contact[i] up to, not including, first_contact[i + 1] touch."},
        {"/dynamics/contact_block", &dynamics.contact_block, {"moving_contact"}, "1", index_or_none("block"),
         "Its two blocks, on side a and on side b; -1 is the ground that a boundary rests on."},
        {"/dynamics/contact_from", &dynamics.contact_from, {"moving_contact"}, "m", any(),
         "One end of the part that touches {x, y}, where it is then."},
        {"/dynamics/contact_to", &dynamics.contact_to, {"moving_contact"}, "m", any(), "The other end {x, y}."},
        {"/dynamics/contact_normal", &dynamics.contact_normal, {"moving_contact"}, "1", any(),
         "Unit normal {x, y} from side a to side b."},
        {"/dynamics/contact_traction", &dynamics.contact_traction, {"moving_contact"}, "Pa", any(),
         "Mean traction {normal, shear} that side b exerts on side a by the joint's springs, tension positive."},
        {"/dynamics/contact_closing", &dynamics.contact_closing, {"moving_contact"}, "m", any(),
         "By how much its springs are pressed together, the mean; below 0 where a bond is pulled."},
        {"/dynamics/contact_slips", &dynamics.contact_slips, {"moving_contact"}, "1", between(0, 1), "1 while it slips."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Failure& failure)
{
    // clang-format off
    return {
        {"/failure/reason", &failure.reason, {}, "1", any(), "Why there is no equilibrium."},
        {"/failure/stage", &failure.stage, {}, "1", any(),
         "Stage whose rock had just been taken away, or an empty text."},
        {"/failure/time", &failure.time, {}, "day", at_least(0), "Time since the start."},
        {"/failure/moves_on", &failure.moves_on, {}, "1", between(0, 1),
         "1 blocks were seen to slide or fall, 0 the search for equilibrium ended without an answer."},
        {"/failure/steps", &failure.steps, {}, "1", at_least(0), "Steps of the engine, the last ones."},
        {"/failure/seconds", &failure.seconds, {}, "s", at_least(0),
         "Time that these steps stand for with real masses; otherwise 0."},
        {"/failure/block", &failure.block, {"moving_block"}, "1", index_of("block"),
         "Blocks that moved by more than a tenth of what the fastest one did, the fastest first; or that nothing "
         "holds."},
        {"/failure/place", &failure.place, {"moving_block"}, "m", any(), "Centroid of the block {x, y}."},
        {"/failure/motion", &failure.motion, {"moving_block"}, "m", any(),
         "Displacement {x, y} of the block in these steps, a mean over its zones."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Safety& safety)
{
    // clang-format off
    return {
        {"/safety/factor", &safety.factor, {"trial"}, "1", positive(),
         "Factor that all strengths of joints were divided by."},
        {"/safety/stands", &safety.stands, {"trial"}, "1", between(-1, 1),
         "1 every equilibrium was found, 0 rock was seen to slide or fall, -1 the search ended without an answer."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Checkpoint& checkpoint)
{
    const std::vector<std::string> gridpoint = {"gridpoint"}, zone = {"zone"}, yields = {"yielding_zone"},
                                   contact = {"contact"}, remark = {"remark"};
    // clang-format off
    return {
        {"/checkpoint/stage", &checkpoint.stage, {}, "1", index_of("stage"), "Stage that is about to be excavated."},
        {"/checkpoint/time", &checkpoint.time, {}, "s", at_least(0), "Its time since the start."},
        {"/checkpoint/displacement", &checkpoint.displacement, gridpoint, "m", any(),
         "Displacement {x, y} since the in-situ equilibrium."},
        {"/checkpoint/is_free", &checkpoint.is_free, gridpoint, "1", between(0, 1),
         "1 or 0 in {x, y}: free, or held itself or without rock."},
        {"/checkpoint/load", &checkpoint.load, gridpoint, "N/m", any(), "Weight {x, y} that the gridpoint has."},
        {"/checkpoint/zone_present", &checkpoint.zone_present, zone, "1", between(0, 1),
         "1 while the zone is there, 0 once it is removed."},
        {"/checkpoint/stress", &checkpoint.stress, zone, "Pa", any(), "Stress {xx, yy, xy}, tension positive."},
        {"/checkpoint/initial_stress", &checkpoint.initial_stress, zone, "Pa", any(),
         "The same at zero displacement, less what has crept since."},
        {"/checkpoint/stiffness", &checkpoint.stiffness, zone, "Pa", at_least(0),
         "C11, C12 and C33 of the rock, rounded as creep leaves them."},
        {"/checkpoint/plastic_strain", &checkpoint.plastic_strain, yields, "1", any(),
         "Plastic strain {xx, yy, zz, 2 xy} since the in-situ equilibrium, extension positive."},
        {"/checkpoint/stress_zz", &checkpoint.stress_zz, yields, "Pa", any(), "Stress across the section."},
        {"/checkpoint/initial_zz", &checkpoint.initial_zz, yields, "Pa", any(), "The same at zero displacement."},
        {"/checkpoint/contact_status", &checkpoint.contact_status, contact, "1", between(0, 3),
         "0 removed, 1 stuck, 2 slipping, 3 open."},
        {"/checkpoint/traction", &checkpoint.traction, contact, "Pa", any(), "Traction {normal, shear}, tension positive."},
        {"/checkpoint/initial_traction", &checkpoint.initial_traction, contact, "Pa", any(),
         "The same at zero displacement; where open, what its springs would carry."},
        {"/checkpoint/relative_displacement", &checkpoint.relative_displacement, contact, "m", any(),
         "Displacement of side b minus that of side a {normal, shear}."},
        {"/checkpoint/offset", &checkpoint.offset, contact, "m", any(), "What of it has crept {normal, shear}."},
        {"/checkpoint/slip", &checkpoint.slip, contact, "m", any(), "Slip since the in-situ equilibrium."},
        {"/checkpoint/dilation", &checkpoint.dilation, contact, "m", any(), "Opening by slip since then."},
        {"/checkpoint/is_broken", &checkpoint.is_broken, contact, "1", between(0, 1),
         "1 once the bonds of the contact are broken."},
        {"/checkpoint/first_memory", &checkpoint.first_memory, contact, "1", any(),
         "What the contact's law remembers beside slip, dilation and broken bonds, in SI units; 0 if nothing."},
        {"/checkpoint/second_memory", &checkpoint.second_memory, contact, "1", any(), "The same, a second number."},
        {"/checkpoint/third_memory", &checkpoint.third_memory, contact, "1", any(), "The same, a third number."},
        {"/checkpoint/reference", &checkpoint.reference, {"direction"}, "Pa", any(), "Traction from which creep counts."},
        {"/checkpoint/crept", &checkpoint.crept, {"direction_unit"}, "m", any(), "Displacement that has crept."},
        {"/checkpoint/rock_reference", &checkpoint.rock_reference, {"creeping_zone"}, "Pa", any(),
         "Stress {xx, yy, xy} from which creep counts."},
        {"/checkpoint/rock_crept", &checkpoint.rock_crept, {"zone_unit"}, "1", any(),
         "Deviatoric strain {xx, yy, xy} that has crept."},
        {"/checkpoint/creep_step", &checkpoint.creep_step, {}, "s", at_least(0),
         "Creep step to be tried next; 0 where nothing creeps."},
        {"/checkpoint/solver_time", &checkpoint.solver_time, {}, "s", at_least(0),
         "Time of the solver, accumulated over all equilibria."},
        {"/checkpoint/steps_since_record", &checkpoint.steps_since_record, {}, "1", at_least(0),
         "Solver steps since a row of the step history."},
        {"/checkpoint/steps_since_state", &checkpoint.steps_since_state, {}, "1", at_least(0),
         "Creep steps since a state by their number."},
        {"/checkpoint/remark", &checkpoint.remark, remark, "1", any(), "A joint, a rock, a reason or a stage, by name."},
        {"/checkpoint/remark_kind", &checkpoint.remark_kind, remark, "1", between(0, 3),
         "0 contacts of the joint at yield in the initial stress state, 1 zones of the rock, 2 why the implicit engine gave up, 3 the stage's "
         "account of energy is off."},
        {"/checkpoint/remark_count", &checkpoint.remark_count, remark, "1", at_least(0), "How often, or by how many percent."},
    };
    // clang-format on
}

std::vector<Field> fields_of(DynamicsState& state)
{
    const std::vector<std::string> gridpoint = {"gridpoint"}, zone = {"zone"}, yields = {"yielding_zone"},
                                   pair = {"pair"};
    // clang-format off
    return {
        {"/dynamics_state/origin", &state.origin, gridpoint, "m", any(), "Place {x, y} that displacements count from, counted from the section's middle."},
        {"/dynamics_state/place", &state.place, gridpoint, "m", any(), "Place {x, y} now, counted from there."},
        {"/dynamics_state/inverse", &state.inverse, zone, "1/m", any(),
         "Inverse of the matrix of the zone's edges without stress, by columns."},
        {"/dynamics_state/area", &state.area, zone, "m2", positive(), "Area of the zone without stress."},
        {"/dynamics_state/strain", &state.strain, zone, "1", any(), "Biot's strain {xx, yy, 2 xy} of the zone."},
        {"/dynamics_state/plastic_strain", &state.plastic_strain, yields, "1", any(),
         "Of it, plastic strain {xx, yy, zz, 2 xy}, extension positive."},
        {"/dynamics_state/initial_zz", &state.initial_zz, yields, "Pa", any(), "Stress across the section of the shape without stress."},
        {"/dynamics_state/stress_zz", &state.stress_zz, yields, "Pa", any(), "The same now."},
        {"/dynamics_state/stress", &state.stress, yields, "Pa", any(), "Biot's stress {xx, yy, xy}, tension positive."},
        {"/dynamics_state/face", &state.face, {"face"}, "1", index_of("gridpoint"), "First and second gridpoint of the face."},
        {"/dynamics_state/pair", &state.pair, pair, "1", index_of("face"), "The two faces."},
        {"/dynamics_state/law", &state.law, pair, "1", at_least(0), "Number of the joint law between them."},
        {"/dynamics_state/first_lead", &state.first_lead, pair, "m", any(),
         "Closing without a gap at the first end of the first face."},
        {"/dynamics_state/second_lead", &state.second_lead, pair, "m", any(), "The same at its second end."},
        {"/dynamics_state/dilation", &state.dilation, pair, "m", at_least(0), "What dilation has added to both."},
        {"/dynamics_state/tau", &state.tau, pair, "Pa", any(), "Shear traction."},
        {"/dynamics_state/is_known", &state.is_known, pair, "1", between(0, 1), "1 if they have touched since they came near."},
        {"/dynamics_state/is_new", &state.is_new, pair, "1", between(0, 1), "1 if they have not carried a force yet."},
        {"/dynamics_state/is_closed", &state.is_closed, pair, "1", between(0, 1), "1 if they touch."},
        {"/dynamics_state/is_broken", &state.is_broken, pair, "1", between(0, 1), "1 if there are no bonds between them."},
        {"/dynamics_state/first_memory", &state.first_memory, pair, "1", any(),
         "What the law of the pair remembers beside, in SI units; 0 if nothing."},
        {"/dynamics_state/second_memory", &state.second_memory, pair, "1", any(), "The same, a second number."},
        {"/dynamics_state/third_memory", &state.third_memory, pair, "1", any(), "The same, a third number."},
        {"/dynamics_state/normal", &state.normal, pair, "1", any(), "Unit normal {x, y} from the first to the second, or 0."},
        {"/dynamics_state/length", &state.length, pair, "m", at_least(0), "Length on which they touch."},
        {"/dynamics_state/pressed_in", &state.pressed_in, pair, "J/m", at_least(0), "Energy of the normal springs between them."},
        {"/dynamics_state/sheared_in", &state.sheared_in, pair, "J/m", at_least(0), "Energy of the shear springs between them."},
        {"/dynamics_state/fastest", &state.fastest, {}, "m/s", at_least(0), "Speed of the fastest gridpoint at the end of the last dynamic analysis."},
        {"/dynamics_state/unbalanced_force_ratio", &state.unbalanced_force_ratio, {}, "1", at_least(0), "Unbalanced force ratio then."},
        {"/dynamics_state/largest_mean_force", &state.largest_mean_force, {}, "N/m", at_least(0), "Largest mean force on gridpoints so far."},
    };
    // clang-format on
}

std::vector<Invariant> invariants_of(const Network& network)
{
    const Blocks& blocks = network.blocks;
    const auto is = [&blocks](std::size_t edge, EdgeKind kind) {
        return blocks.edge_kind[edge] == static_cast<Index>(kind);
    };
    return {
        {"/edges/vertex", "the two vertices of an edge differ", "edge",
         [&blocks](std::size_t edge) { return blocks.edge_vertex[edge][0] != blocks.edge_vertex[edge][1]; }},
        {"/edges/block", "a boundary edge has a block on one side, any other edge on both", "edge",
         [&blocks, is](std::size_t edge) {
             const auto [left, right] = blocks.edge_block[edge];
             return is(edge, EdgeKind::boundary) ? (left < 0) != (right < 0) : left >= 0 && right >= 0;
         }},
        {"/edges/joint", "a joint edge has a joint, any other edge none", "edge",
         [&blocks, is](std::size_t edge) {
             return (blocks.edge_joint[edge] >= 0) == is(edge, EdgeKind::joint);
         }},
    };
}

std::vector<Invariant> invariants_of(const EquivalentJoints& joints)
{
    const auto flows = [&joints](const std::vector<double>& stiffness, const std::vector<double>& viscosity) {
        return [&joints, &stiffness, &viscosity](std::size_t edge) {
            const std::size_t units = joints.kelvin_units();
            for (std::size_t unit = edge * units; unit < (edge + 1) * units; ++unit)
                if (stiffness[unit] > 0 && viscosity[unit] <= 0)
                    return false;
            return true;
        };
    };
    const std::string sentence = "a Kelvin unit with a stiffness has a viscosity";
    return {{"/equivalent/normal_kelvin_viscosity", sentence, "edge",
             flows(joints.normal_kelvin_stiffness, joints.normal_kelvin_viscosity)},
            {"/equivalent/shear_kelvin_viscosity", sentence, "edge",
             flows(joints.shear_kelvin_stiffness, joints.shear_kelvin_viscosity)}};
}

std::vector<Invariant> invariants_of(const Mesh& mesh)
{
    return {
        {"/mesh/zone_gridpoint", "the corners of a zone run counter-clockwise around an area", "zone",
         [&mesh](std::size_t zone) {
             const auto [first, second, third] = mesh.zone_gridpoint[zone];
             const Eigen::Vector2d to_second = mesh.gridpoint[second] - mesh.gridpoint[first];
             const Eigen::Vector2d to_third = mesh.gridpoint[third] - mesh.gridpoint[first];
             return to_second.x() * to_third.y() - to_second.y() * to_third.x() > 0;
         }},
        {"/mesh/contact_gridpoint", "the two gridpoints of a contact differ", "contact",
         [&mesh](std::size_t contact) {
             return mesh.contact_gridpoint[contact][0] != mesh.contact_gridpoint[contact][1];
         }},
        {"/mesh/contact_normal", "the normal of a contact has length 1", "contact",
         [&mesh](std::size_t contact) { return std::abs(mesh.contact_normal[contact].norm() - 1) < 1e-9; }},
    };
}

const std::vector<Described>& dimensions()
{
    static const std::vector<Described> all = {
        {"program", "a program of the chain that has run"},
        {"rock", "a rock of the scene"},
        {"joint_material", "a joint material of the scene"},
        {"joint_set", "a joint set or single joint of the scene"},
        {"stage", "an excavation stage of the scene"},
        {"joint", "a joint: a straight line of traces and rock bridges"},
        {"trace", "a joint trace: an open piece of a joint"},
        {"vertex", "a point where edges meet"},
        {"edge", "a straight piece of the cut between blocks"},
        {"piece", "a joint trace or a rock bridge inside the section"},
        {"bridge", "a rock bridge: rock between the traces of a joint"},
        {"share", "a joint on an edge; where joints share an edge it has several"},
        {"kelvin_unit", "a Kelvin unit of a joint's chain, as many as the longest chain has"},
        {"block", "a face of the cut section"},
        {"ring", "a closed outline of a block, outer or hole"},
        {"corner", "a corner of a ring"},
        {"statistic", "a row of the report on the network"},
        {"gridpoint", "a corner of zones, split along joints"},
        {"zone", "a constant-strain triangle"},
        {"yielding_zone", "a zone of rock that yields"},
        {"tie", "a pair of gridpoints that are one until a stage"},
        {"side", "a side of a zone that lies on a boundary condition"},
        {"contact", "a pair of gridpoints that face each other across a joint"},
        {"time", "a recorded time of the history"},
        {"point", "a monitoring point of the scene"},
        {"state", "a recorded state of the whole section"},
        {"equilibrium", "an equilibrium that was found"},
        {"row", "a recorded step of the solver"},
        {"moment", "a recorded moment of a dynamic analysis"},
        {"moving_contact", "two faces of blocks that touch at a recorded moment of a dynamic analysis"},
        {"gauge", "a gauge of the scene"},
        {"moving_block", "a block that had no equilibrium"},
        {"trial", "a run by which a factor of safety was found"},
        {"direction", "the normal or the shear of a contact that creeps"},
        {"direction_unit", "a Kelvin unit or dashpot of one of these"},
        {"creeping_zone", "a zone of rock that creeps"},
        {"zone_unit", "a Kelvin unit or dashpot of one of these"},
        {"remark", "a line of the summary so far"},
        {"face", "a side of a zone with no rock before it, or of the ground"},
        {"pair", "two faces that may touch"},
    };
    return all;
}

const std::vector<Described>& root_attributes()
{
    static const std::vector<Described> all = {
        {"filetype",
         "text: `jointcreep network`, `jointcreep joints`, `jointcreep result` or `jointcreep checkpoint`"},
        {"format_version",
         "two int32 {major, minor}; readers refuse another major and accept a higher minor"},
        {"program", "text: the program that wrote the file"},
        {"program_version", "text: its version"},
        {"seed", "uint64: seed of the joint sets"},
        {"realization", "int32: number of the realization drawn with that seed"},
        {"complete", "int32: 1, written last"},
    };
    return all;
}

std::string file_type(FileKind kind)
{
    switch (kind) {
    case FileKind::network:
        return "jointcreep network";
    case FileKind::joints:
        return "jointcreep joints";
    case FileKind::result:
        return "jointcreep result";
    case FileKind::checkpoint:
        return "jointcreep checkpoint";
    }
    return {};
}

std::string maker(FileKind kind)
{
    switch (kind) {
    case FileKind::network:
        return "jointgen";
    case FileKind::joints:
        return "strength-averaging";
    case FileKind::result:
    case FileKind::checkpoint:
        return "demsolve";
    }
    return {};
}

std::string wanted(const Limits& limits)
{
    if (!limits.index_of.empty())
        return "index of " + limits.index_of + (limits.or_none ? " or -1" : "");
    if (!limits.rows_of.empty())
        return "0, not decreasing, up to the number of " + limits.rows_of + "s";
    std::string text = "finite";
    if (limits.positive)
        text = "> 0";
    else if (std::isfinite(limits.least) && std::isfinite(limits.most))
        text = shown(limits.least) + " to " + shown(limits.most);
    else if (std::isfinite(limits.least))
        text = ">= " + shown(limits.least);
    return limits.ascending ? text + ", not decreasing" : text;
}

namespace
{

template <class Number, int rows>
std::span<double> spread(std::vector<Eigen::Matrix<Number, rows, 1>>& values)
{
    static_assert(sizeof values[0] == rows * sizeof(Number));
    return {reinterpret_cast<double*>(values.data()), rows * values.size()};
}

template <std::size_t size>
std::span<Index> spread(std::vector<std::array<Index, size>>& values)
{
    static_assert(sizeof values[0] == size * sizeof(Index));
    return {reinterpret_cast<Index*>(values.data()), size * values.size()};
}

template <class Value>
std::span<Value> spread(std::vector<Value>& values)
{
    return values;
}

template <class Value>
std::span<Value> spread(Value& value)
{
    return {&value, 1};
}

template <class Value>
void resize_array(std::vector<Value>& values, std::size_t count)
{
    values.resize(count);
}

template <class Value>
void resize_array(Value&, std::size_t)
{
    // a single value
}

template <class Value>
inline constexpr std::size_t components_in = 1;
template <int rows>
inline constexpr std::size_t components_in<std::vector<Eigen::Matrix<double, rows, 1>>> = rows;
template <std::size_t size>
inline constexpr std::size_t components_in<std::vector<std::array<Index, size>>> = size;

} // namespace

Flat flat(const Values& values)
{
    return std::visit([](auto* place) -> Flat { return spread(*place); }, values);
}

std::size_t components(const Values& values)
{
    return std::visit([](auto* place) { return components_in<std::remove_reference_t<decltype(*place)>>; },
                      values);
}

std::size_t rows(const Values& values)
{
    return std::visit([](auto span) { return span.size(); }, flat(values)) / components(values);
}

void resize(const Values& values, std::size_t count)
{
    std::visit([count](auto* place) { resize_array(*place, count); }, values);
}

} // namespace jointcreep::store::schema
