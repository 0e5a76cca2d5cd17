#include "store/schema.hpp"

#include "store/forces.hpp"

namespace jointcreep::store::schema
{

namespace
{

using namespace fields;

// The rows that forces have of a record, or their invariants.
template <class Row, class Record>
std::vector<Row> of_forces(std::vector<Row> (*ForceFields::*part)(Record&), Record& record)
{
    std::vector<Row> all;
    for (const ForceFields& force : forces())
        if (force.*part)
            append(all, (force.*part)(record));
    return all;
}

std::vector<Field> fields_of(Names& names)
{
    // clang-format off
    return {
        {"/names/rock", &names.rock, {"rock"}, "1", any(), "Rocks, as named in the scene."},
        {"/names/joint_material", &names.joint_material, {"joint_material"}, "1", any(),
         "Joint materials, as named in the scene."},
        {"/names/joint_set", &names.joint_set, {"joint_set"}, "1", any(),
         "Joint sets, then single joints (each is a set of its own), then sets of mapped traces."},
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
         "Point {x, y} at which the joint was placed; its angle is applied about this point. It may be "
         "outside the section."},
        {"/joints/diameter", &joints.diameter, {"joint"}, "m", at_least(0),
         "Diameter of the disc in space whose trace is this joint; 0 for joints that are not discs."},
        {"/joints/centre", &joints.centre, {"joint"}, "m", any(),
         "Centre of that disc {x, y, z}, z being across the section; elsewhere {x, y} of /joints/point, and 0."},

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
         "0 boundary (outline of the section), 1 joint, 2 bonded (no joint: the rock is continuous)."},
        {"/edges/joint", &blocks.edge_joint, {"edge"}, "1", index_or_none("joint"), "Joint of a joint edge."},
        {"/edges/joint_fraction", &blocks.edge_joint_fraction, {"edge"}, "1", between(0, 1),
         "Joint length over edge length, on joint edges; the rest is rock bridge."},

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
         "What became of the joint: 0 kept (all of it is on block edges), 1 clipped (the part inside the "
         "section is on block edges), 2 trimmed (a part ended inside a block), 3 merged (a part was on "
         "edges that vanished), 4 dropped (nothing is on block edges). For the values 1, 2 and 3 only parts longer than the "
         "shortest edge count. The lengths below, without the extension, add up to the joint's length."},
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
         "Extension beyond its ends to the next block edge, as rock bridge."},

        {"/cutting/merged_vertices", &report.merged_vertices, {}, "1", at_least(0),
         "Vertices that cutting merged into others."},
        {"/cutting/merged_edge_length", &report.merged_edge_length, {}, "m", at_least(0),
         "Total length of the edges that vanished."},
        {"/cutting/merged_block_area", &report.merged_block_area, {}, "m2", at_least(0),
         "Total area of the blocks that were merged into their neighbours."},
        {"/cutting/largest_move", &report.largest_move, {}, "m", at_least(0),
         "Largest distance by which a vertex was moved."},
        {"/cutting/pruned_length", &report.pruned_length, {}, "m", at_least(0),
         "Total length of joints that ended inside a block and were cut back."},
        {"/cutting/shortest_edge", &report.shortest_edge, {}, "m", at_least(0),
         "Shortest edge that is left."},
        {"/cutting/smallest_angle", &report.smallest_angle, {}, "rad", at_least(0),
         "Smallest angle between neighbouring edges after cutting."},
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
         "Subject of the row: a joint set, `blocks` or `nodes`. There are rows only if a report was asked "
         "for."},
        {"/statistics/quantity", &rows.quantity, statistic, "1", any(), "Quantity that is examined."},
        {"/statistics/unit", &rows.unit, statistic, "1", any(),
         "Unit of target, achieved value and interval: SI, angles in rad."},
        {"/statistics/has_target", &rows.has_target, statistic, "1", between(0, 1), "1 if there is a target."},
        {"/statistics/target", &rows.target, statistic, unit, any(),
         "By the laws of the scene; 0 where there is none."},
        {"/statistics/achieved", &rows.achieved, statistic, unit, any(),
         "Value of the network. For a law: the largest distance between the two distribution functions."},
        {"/statistics/has_interval", &rows.has_interval, statistic, "1", between(0, 1),
         "1 if there is a confidence interval."},
        {"/statistics/low", &rows.low, statistic, unit, any(),
         "Lower end of the confidence interval; the achieved value where there is none."},
        {"/statistics/high", &rows.high, statistic, unit, any(), "Its upper end."},
        {"/statistics/sample_size", &rows.sample_size, statistic, "1", at_least(0),
         "Number of joints, traces, intervals, blocks or nodes examined."},
        {"/statistics/is_tested", &rows.is_tested, statistic, "1", between(0, 1),
         "1 if the verdict follows from the p-value."},
        {"/statistics/p_value", &rows.p_value, statistic, "1", between(0, 1),
         "Probability that a network by the scene's laws is at least as far from the target; 1 where not tested."},
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
    std::vector<Field> all = {
        {"/mesh/gridpoint_position", &mesh.gridpoint, {"gridpoint"}, "m", any(),
         "Position of the gridpoint at the start {x, y}."},
        {"/mesh/tie_gridpoint", &mesh.tie_gridpoint, {"tie"}, "1", index_of("gridpoint"),
         "Two gridpoints that move as one until a stage."},
        {"/mesh/tie_stage", &mesh.tie_stage, {"tie"}, "1", index_of("stage"), "The stage that separates them."},
    };
    // clang-format on
    append(all, of_forces(&ForceFields::mesh, mesh));
    return all;
}

std::vector<Field> fields_of(History& history)
{
    // clang-format off
    return {
        {"/history/time", &history.time, {"time"}, "day", ascending(),
         "Time since the start; two rows at a stage's time, before and after it."},
        {"/history/event", &history.event, {"time"}, "1", any(),
         "Name of the stage in the first row after it; otherwise empty."},
        {"/history/point", &history.point, {"point"}, "1", any(), "Names of the monitoring points."},
        {"/history/point_position", &history.point_position, {"point"}, "m", any(),
         "Position of the monitoring point {x, y}."},
        {"/history/first_reading_row", &history.first_reading_row, {"point"}, "1", index_or_none("time"),
         "Row of time from which the point's own readings count; -1 in checkpoints of the in-situ equilibrium."},
        {"/history/displacement", &history.displacement, {"time", "point"}, "m", any(),
         "Displacement {x, y} since the in-situ equilibrium; the last one is kept once the point is "
         "removed."},
        {"/history/present", &history.present, {"time", "point"}, "1", between(0, 1),
         "1 while the point is there, 0 once it is removed."},
        {"/history/reset_row", &history.reset_row, {"time"}, "1", index_of("time"),
         "Row of the last stage that resets displacements. Subtract the displacement of this row to count from there. 0 before "
         "the first such stage."},
    };
    // clang-format on
}

std::vector<Field> fields_of(States& states)
{
    // clang-format off
    std::vector<Field> all = {
        {"/states/time", &states.time, {"state"}, "day", ascending(), "Time since the start."},
        {"/states/event", &states.event, {"state"}, "1", any(),
         "Name of the stage in the first state after it; otherwise empty."},
        {"/states/displacement", &states.displacement, {"state", "gridpoint"}, "m", any(),
         "Displacement {x, y} since the in-situ equilibrium."},
        {"/states/reaction", &states.reaction, {"state", "gridpoint"}, "N/m", any(),
         "Force {x, y} of supports on a fixed gridpoint, 0 elsewhere; of gridpoints that a tie connects, at "
         "the one with the lowest number. In a dynamic analysis with large displacements the reaction of a "
         "rigid block is divided equally among its fixed gridpoints."},
    };
    // clang-format on
    append(all, of_forces(&ForceFields::states, states));
    // clang-format off
    append(all, {
        {"/states/reset_state", &states.reset_state, {"state"}, "1", index_of("state"),
         "State after the last stage that resets displacements. Subtract its displacement to count from there. 0 before the first "
         "such stage."},
    });
    // clang-format on
    return all;
}

std::vector<Field> fields_of(Equilibria& equilibria)
{
    // clang-format off
    return {
        {"/equilibria/time", &equilibria.time, {"equilibrium"}, "day", ascending(), "Time since the start."},
        {"/equilibria/is_implicit", &equilibria.is_implicit, {"equilibrium"}, "1", between(0, 1),
         "1 if the implicit engine found it, 0 if dynamic relaxation did."},
        {"/equilibria/searches", &equilibria.searches, {"equilibrium"}, "1", at_least(1),
         "Searches for this equilibrium: by either engine, and with creep steps that were too long."},
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
         "Work of weight, of forces of excavated rock and of tractions. Boundaries with a prescribed displacement "
         "move before the search; their work is not included. So it is the sum of the next three."},
        {"/equilibria/stored_energy", &equilibria.stored_energy, {"equilibrium"}, "J/m", any(),
         "Increase of the energy stored in zones and contacts."},
        {"/equilibria/dissipated_energy", &equilibria.dissipated_energy, {"equilibrium"}, "J/m", any(),
         "Energy lost by slip and opening of contacts, and by yield of rock."},
        {"/equilibria/damped_energy", &equilibria.damped_energy, {"equilibrium"}, "J/m", any(),
         "Energy taken by damping; by the implicit engine, the energy that a sudden change of loads would "
         "release."},
    };
    // clang-format on
}

} // namespace

std::vector<Field> fields_of(Provenance& provenance)
{
    // clang-format off
    return {
        {"/scene", &provenance.scene, {}, "1", any(), "Text of the scene. Formulas are replaced by their numbers, and files that it names are added as [[file]] tables."},
        {"/provenance/program", &provenance.program, {"program"}, "1", any(),
         "Programs that made this file and the files before it, in the order they ran; the last one wrote "
         "this file."},
        {"/provenance/version", &provenance.version, {"program"}, "1", any(), "Version of the program."},
        {"/provenance/input_sha256", &provenance.input_sha256, {"program"}, "1", any(),
         "SHA-256 of the file that the program read."},
        {"/provenance/options", &provenance.options, {"program"}, "1", any(),
         "Options given to the program that can change its result, or an empty text."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Warnings& warnings)
{
    // clang-format off
    return {
        {"/warnings/program", &warnings.program, {"warning"}, "1", any(), "Program that warned."},
        {"/warnings/text", &warnings.text, {"warning"}, "1", any(), "Text of the warning."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Network& network)
{
    std::vector<Field> fields = fields_of(network.names);
    append(fields, fields_of(network.joints));
    append(fields, fields_of(network.blocks));
    append(fields, fields_of(network.statistics));
    append(fields, of_forces(&ForceFields::network, network));
    return fields;
}

std::vector<Field> fields_of(EquivalentJoints& joints)
{
    return of_forces(&ForceFields::equivalent_joints, joints);
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
    std::vector<Field> all = {
        {"/step_history/time", &step_history.time, {"row"}, "day", at_least(0),
         "Time since the start; it goes back where a step of creep is rejected or cut."},
        {"/step_history/solver_time", &step_history.solver_time, {"row"}, "s", ascending(),
         "Time of the solver, accumulated over all equilibria."},
        {"/step_history/displacement", &step_history.displacement, {"row", "point"}, "m", any(),
         "Displacement {x, y} of the monitoring point, as in the history."},
    };
    // clang-format on
    append(all, of_forces(&ForceFields::step_history, step_history));
    return all;
}

std::vector<Field> fields_of(DynamicsHistory& dynamics)
{
    // clang-format off
    std::vector<Field> all = {
        {"/dynamics/time", &dynamics.time, {"moment"}, "day", ascending(), "Time of the stage since the start."},
        {"/dynamics/dynamic_time", &dynamics.dynamic_time, {"moment"}, "s", at_least(0), "Time since the dynamic analysis began."},
        {"/dynamics/state", &dynamics.state, {"moment"}, "1", index_of("state"), "State of the section at this moment."},
        {"/dynamics/work_of_loads", &dynamics.work_of_loads, {"moment"}, "J/m", any(),
         "Work of weight, of forces of excavated rock and of tractions since the dynamic analysis began. It is the sum of the next "
         "four, except for the error of time steps."},
        {"/dynamics/kinetic_energy", &dynamics.kinetic_energy, {"moment"}, "J/m", any(),
         "Kinetic energy, from the product of the velocities before and after the moment; so it is a little below 0 where all velocities "
         "change sign at once."},
        {"/dynamics/stored_energy", &dynamics.stored_energy, {"moment"}, "J/m", any(),
         "Increase of the energy stored in zones and contacts."},
        {"/dynamics/friction_energy", &dynamics.friction_energy, {"moment"}, "J/m", any(),
         "Energy lost to slip and yield. Slip that dilates by the friction angle loses no energy: there the value may be a little below 0."},
        {"/dynamics/damped_energy", &dynamics.damped_energy, {"moment"}, "J/m", any(),
         "Energy taken by dashpots, and by stopping slow movement."},
        {"/dynamics/fastest", &dynamics.fastest, {"moment"}, "m/s", at_least(0), "Speed of the fastest gridpoint."},
        {"/dynamics/unbalanced_force_ratio", &dynamics.unbalanced_force_ratio, {"moment"}, "1", at_least(0),
         "Unbalanced force ratio."},
    };
    // clang-format on
    append(all, of_forces(&ForceFields::dynamics, dynamics));
    return all;
}

std::vector<Field> fields_of(GuardHistory& guards)
{
    // clang-format off
    return {
        {"/guards/area_error", &guards.area_error, {"state"}, "1", at_least(0),
         "Area of the zones of a block minus the area of the block, over the area of the block. The largest "
         "value."},
        {"/guards/weight_error", &guards.weight_error, {"state"}, "1", at_least(0),
         "Loads minus the weight of the present rock, over the weight of all rock."},
        {"/guards/penetration", &guards.penetration, {"state"}, "m", at_least(0),
         "Largest excess of a contact's closure over the closure that follows from its normal stress and normal "
         "stiffness. Of an open contact: the overlap of its faces. 0 at large displacements."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Failure& failure)
{
    // clang-format off
    return {
        {"/failure/reason", &failure.reason, {}, "1", any(), "Why there is no equilibrium."},
        {"/failure/stage", &failure.stage, {}, "1", any(),
         "Stage whose rock had just been excavated, or an empty text."},
        {"/failure/time", &failure.time, {}, "day", at_least(0), "Time since the start."},
        {"/failure/moves_on", &failure.moves_on, {}, "1", between(0, 1),
         "1 blocks slide or fall, 0 undecided: the search for equilibrium ended without an answer."},
        {"/failure/steps", &failure.steps, {}, "1", at_least(0), "Number of steps of the engine to which "
                                                                 "/failure/motion belongs."},
        {"/failure/seconds", &failure.seconds, {}, "s", at_least(0),
         "Duration of these steps with real masses; otherwise 0."},
        {"/failure/block", &failure.block, {"moving_block"}, "1", index_of("block"),
         "Blocks that moved by more than a tenth of the displacement of the fastest block, the fastest "
         "first; or blocks without support."},
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
         "Factor that all strengths of joints and of rock that yields were divided by."},
        {"/safety/stands", &safety.stands, {"trial"}, "1", between(-1, 1),
         "1 every equilibrium was found, 0 blocks are moving, or displacement grows without bound, -1 "
         "undecided."},
        {"/safety/largest_displacement", &safety.largest_displacement, {"trial"}, "m", at_least(0),
         "Largest displacement since the in-situ equilibrium, at the end of the run."},
        {"/safety/largest_plastic_strain", &safety.largest_plastic_strain, {"trial"}, "1", at_least(0),
         "Largest plastic shear strain of a zone, at the end of the run."},
        {"/safety/coarse_factor", &safety.coarse_factor, {"coarse_trial"}, "1", positive(),
         "Factor of runs with zones twice as large, for the estimate of the influence of the mesh."},
        {"/safety/coarse_stands", &safety.coarse_stands, {"coarse_trial"}, "1", between(-1, 1),
         "How they ended, as stands."},
        {"/safety/coarse_largest_displacement", &safety.coarse_largest_displacement, {"coarse_trial"}, "m", at_least(0),
         "Their largest displacement."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Checkpoint& checkpoint)
{
    const std::vector<std::string> gridpoint = {"gridpoint"}, remark = {"remark"};
    // clang-format off
    std::vector<Field> all = {
        {"/checkpoint/is_in_situ", &checkpoint.is_in_situ, {}, "1", between(0, 1),
         "1 before the in-situ equilibrium; a run then starts from the scene, and uses only "
         "/checkpoint/search."},
        {"/checkpoint/stage", &checkpoint.stage, {}, "1", at_least(0),
         "Number of stages that are complete."},
        {"/checkpoint/time", &checkpoint.time, {}, "s", at_least(0),
         "Time since the start. If it is the time of the next stage, this stage comes next or is being "
         "excavated; otherwise a creep step comes next."},
        {"/checkpoint/displacement", &checkpoint.displacement, gridpoint, "m", any(),
         "Displacement {x, y} since the in-situ equilibrium."},
        {"/checkpoint/is_free", &checkpoint.is_free, gridpoint, "1", between(0, 1),
         "In {x, y}: 1 free, 0 fixed by a boundary or without rock. A gridpoint that is only tied to a fixed one counts as free."},
        {"/checkpoint/load", &checkpoint.load, gridpoint, "N/m", any(), "Weight {x, y} on the gridpoint."},
        {"/checkpoint/force", &checkpoint.force, gridpoint, "N/m", any(), "Unbalanced force {x, y}, also of a fixed "
                                                                          "gridpoint."},
        {"/checkpoint/released", &checkpoint.released, {"released_gridpoint"}, "N/m", any(),
         "Within a stage: force {x, y} of the excavated rock on the gridpoint, before its excavation."},
        {"/checkpoint/unloaded", &checkpoint.unloaded, {}, "1", at_least(0),
         "Number of finest increments unloaded so far; 0 outside of a stage. A finest increment is 1/32 of "
         "an increment of the scene; with dynamic relaxation alone it is the whole increment."},
        {"/checkpoint/increment", &checkpoint.increment, {}, "1", at_least(0),
         "Number of finest increments to be unloaded next."},
    };
    // clang-format on
    append(all, of_forces(&ForceFields::checkpoint, checkpoint));
    // clang-format off
    append(all, {
        {"/checkpoint/creep_step", &checkpoint.creep_step, {}, "s", at_least(0),
         "Next trial creep step; 0 where nothing creeps."},
        {"/checkpoint/solver_time", &checkpoint.solver_time, {}, "s", at_least(0),
         "Time of the solver, accumulated over all equilibria."},
        {"/checkpoint/steps_since_record", &checkpoint.steps_since_record, {}, "1", at_least(0),
         "Solver steps since a row of the step history."},
        {"/checkpoint/steps_since_state", &checkpoint.steps_since_state, {}, "1", at_least(0),
         "Creep steps since the last state that --states recorded."},
        {"/checkpoint/remark", &checkpoint.remark, remark, "1", any(), "A joint, a rock, a reason or a stage, by name."},
        {"/checkpoint/remark_kind", &checkpoint.remark_kind, remark, "1", between(0, 4),
         "0 contacts of the joint at yield in the initial stress state, 1 zones of the rock, 2 why the implicit engine found no equilibrium, 3 the stage's "
         "energy balance is off, 4 rock slid in a creep step."},
        {"/checkpoint/remark_count", &checkpoint.remark_count, remark, "1", at_least(0), "How often, or by how many percent."},
        {"/checkpoint/search_number", &checkpoint.search_number, {}, "1", at_least(0),
         "Number of dynamic relaxations and dynamic analyses that a run makes again if it continues from this checkpoint, "
         "before it continues the unfinished search for equilibrium."},
        {"/checkpoint/search", &checkpoint.search, {"search_value"}, "1", any(),
         "State of the unfinished search, in the order of the program of the same version; empty if there "
         "is none."},
    });
    // clang-format on
    return all;
}

std::vector<Field> fields_of(DynamicsState& state)
{
    const std::vector<std::string> gridpoint = {"gridpoint"};
    // clang-format off
    std::vector<Field> all = {
        {"/dynamics_state/origin", &state.origin, gridpoint, "m", any(),
         "Position {x, y} at zero displacement, from the middle of the section."},
        {"/dynamics_state/place", &state.place, gridpoint, "m", any(),
         "Present position {x, y}, from the middle of the section."},
    };
    // clang-format on
    append(all, of_forces(&ForceFields::dynamics_state, state));
    // clang-format off
    append(all, {
        {"/dynamics_state/fastest", &state.fastest, {}, "m/s", at_least(0), "Speed of the fastest gridpoint at the end of the last dynamic analysis."},
        {"/dynamics_state/unbalanced_force_ratio", &state.unbalanced_force_ratio, {}, "1", at_least(0), "Unbalanced force ratio then."},
        {"/dynamics_state/largest_mean_force", &state.largest_mean_force, {}, "N/m", at_least(0), "Largest mean force on gridpoints so far."},
    });
    // clang-format on
    return all;
}

std::vector<Invariant> invariants_of(const Network& network)
{
    const Blocks& blocks = network.blocks;
    const auto is = [&blocks](std::size_t edge, EdgeKind kind) {
        return blocks.edge_kind[edge] == static_cast<Index>(kind);
    };
    const auto differ = [](const std::string& dimension, const std::vector<std::string>& names) {
        return Invariant{"/names/" + dimension, "all names differ", dimension, [&names](std::size_t row) {
                             const auto here = names.begin() + static_cast<std::ptrdiff_t>(row);
                             return std::find(names.begin(), here, *here) == here;
                         }};
    };
    return {
        differ("rock", network.names.rock),
        differ("joint_material", network.names.joint_material),
        differ("joint_set", network.names.joint_set),
        differ("stage", network.names.stage),
        {"/edges/vertex", "the two vertices of an edge differ", "edge",
         [&blocks](std::size_t edge) { return blocks.edge_vertex[edge][0] != blocks.edge_vertex[edge][1]; }},
        {"/vertices/position", "each vertex is an end of an edge", "vertex",
         [&blocks, is_end = std::vector<char>()](std::size_t vertex) mutable {
             if (is_end.empty()) {
                 is_end.resize(blocks.vertex.size());
                 for (const auto& [a, b] : blocks.edge_vertex)
                     is_end[a] = is_end[b] = 1;
             }
             return is_end[vertex] != 0;
         }},
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
    return of_forces(&ForceFields::invariants_of_equivalent_joints, joints);
}

std::vector<Invariant> invariants_of(const Mesh& mesh)
{
    return of_forces(&ForceFields::invariants_of_mesh, mesh);
}

Field component_of_history(std::vector<std::string>& names)
{
    names = {"x", "y"};
    return {"/history/component",
            &names,
            {"component"},
            "1",
            any(),
            "Names of the components {x, y} of the datasets beside it."};
}

const std::vector<Described>& dimensions()
{
    static const std::vector<Described> own = {
        {"program", "a program of the chain that has run"},
        {"rock", "a rock of the scene"},
        {"joint_material", "a joint material of the scene"},
        {"joint_set", "a joint set, a single joint or a set of mapped traces of the scene"},
        {"stage", "an excavation stage of the scene"},
        {"joint", "a joint: a straight line of traces and rock bridges"},
        {"trace", "a joint trace: a piece of a joint without rock bridge"},
        {"vertex", "a point where edges meet"},
        {"edge", "a straight piece of the cut between blocks"},
        {"share", "a joint on an edge; where joints share an edge it has several"},
        {"block", "a face of the cut section"},
        {"ring", "a closed outline of a block, outer or hole"},
        {"corner", "a corner of a ring"},
        {"statistic", "a row of the report on the network"},
        {"gridpoint",
         "a corner of zones, or the middle of a side of a quadratic zone; each side of a joint has its own gridpoints"},
        {"released_gridpoint",
         "a gridpoint, if the checkpoint is from within a stage; otherwise this dimension is 0"},
        {"tie", "a pair of gridpoints that move as one until a stage"},
        {"time", "a recorded time of the history"},
        {"point", "a monitoring point of the scene"},
        {"state", "a recorded state of the whole section"},
        {"equilibrium", "an equilibrium that was found"},
        {"row", "a recorded step of the solver"},
        {"moment", "a recorded moment of a dynamic analysis"},
        {"moving_block", "a block that had no equilibrium"},
        {"trial", "a run by which a factor of safety was found"},
        {"coarse_trial",
         "a run with zones twice as large, for the estimate of the influence of the mesh on the factor of safety"},
        {"remark", "a line that the summary will have, from the part of the run before the checkpoint"},
        {"search_value", "a number of the state of a search for equilibrium"},
        {"warning", "a warning of a program"},
    };
    static const std::vector<Described> all = [] {
        std::vector<Described> list = own;
        for (const ForceFields& force : forces())
            append(list, force.dimensions);
        return list;
    }();
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

} // namespace jointcreep::store::schema
