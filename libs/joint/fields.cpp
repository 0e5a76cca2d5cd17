#include "joint/fields.hpp"

#include "joint/law.hpp"

#include <cmath>
#include <numbers>

namespace jointcreep::joint
{

namespace
{

using fields::Field;

std::vector<Field> fields_of(Pieces& pieces)
{
    using namespace fields;
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
    using namespace fields;
    const std::vector<std::string> set = {"joint_set"};
    const Limits fraction = between(0, 1), angle = between(0, std::numbers::pi / 2), natural = at_least(0);
    // clang-format off
    return {
        {"/sets/target_persistence", &sets.target_persistence, set, "1", fraction,
         "Persistence in the scene; 1 for all but sets of lines."},
        {"/sets/line_persistence", &sets.line_persistence, set, "1", fraction,
         "Fraction of the set's lines inside the section that is joint."},
        {"/sets/persistence_error", &sets.persistence_error, set, "1", natural,
         "Expected standard error of line_persistence, by the laws of traces and bridges."},
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
         "Length of edges whose stiffness is at its upper limit. The limit is the larger one of the joint's own stiffness and ten times "
         "the stiffness of the smallest zone."},
    };
    // clang-format on
}

std::vector<Field> fields_of(EquivalentJoints& joints)
{
    using namespace fields;
    const std::vector<std::string> edge = {"edge"}, units = {"edge", "kelvin_unit"};
    // clang-format off
    std::vector<Field> all;
    for (const Parameter& parameter : all_parameters())
        all.push_back({"/equivalent/" + std::string(parameter.name), &parameter.in(joints), edge,
                       parameter.si_unit(),
                       parameter.is_angle() ? between(0, std::numbers::pi / 2) : at_least(0),
                       std::string(parameter.meaning)});
    std::string numbers;
    for (std::size_t law = 0; law < laws().size(); ++law)
        numbers += (law > 0 ? "; " : "") + std::to_string(law) + " " + std::string(laws()[law].about);
    all.push_back({"/equivalent/law", &joints.law, edge, "1",
                   between(0, static_cast<double>(laws().size() - 1)),
                   "Joint law: " + numbers + ". Parameters that the law does not have are 0."});
    append(all, {
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
    append(all, fields_of(joints.pieces));
    append(all, fields_of(joints.sets));
    return all;
}

std::vector<Field> fields_of(Mesh& mesh)
{
    using namespace fields;
    // clang-format off
    return {
        {"/mesh/contact_gridpoint", &mesh.contact_gridpoint, {"contact"}, "1", index_of("gridpoint"),
         "Gridpoint on side a and on side b."},
        {"/mesh/contact_edge", &mesh.contact_edge, {"contact"}, "1", index_of("edge"),
         "Edge the contact lies on."},
        {"/mesh/contact_normal", &mesh.contact_normal, {"contact"}, "1", any(),
         "Unit normal {x, y}, from side a to side b."},
        {"/mesh/contact_length", &mesh.contact_length, {"contact"}, "m", positive(),
         "Length of edge that belongs to the contact."},
        {"/mesh/contact_centre", &mesh.contact_centre, {"contact"}, "m", any(),
         "Point {x, y} where a traction that is linear along the edge equals its mean over the contact."},
    };
    // clang-format on
}

std::vector<Field> fields_of(States& states)
{
    using namespace fields;
    // clang-format off
    return {
        {"/states/traction", &states.traction, {"state", "contact"}, "Pa", any(),
         "Traction {normal, shear} that side b exerts on side a, tension positive."},
        {"/states/relative_displacement", &states.relative_displacement, {"state", "contact"}, "m", any(),
         "Displacement of side b minus that of side a {normal, shear}, opening positive."},
        {"/states/contact_status", &states.contact_status, {"state", "contact"}, "1", between(0, 3),
         "0 removed (a side has been excavated), 1 sticking, 2 slipping, 3 open."},
        {"/states/slip", &states.slip, {"state", "contact"}, "m", any(),
         "Slip since the in-situ equilibrium: shear_stiffness times (relative_displacement - crept - slip) "
         "is the change of shear traction since then. In a dynamic analysis with large displacements slip is "
         "computed by this equation."},
        {"/states/dilation", &states.dilation, {"state", "contact"}, "m", any(),
         "Opening by slip since the in-situ equilibrium. In a dynamic analysis: the mean of the faces that "
         "meet at the contact."},
        {"/states/bond_broken", &states.bond_broken, {"state", "contact"}, "1", between(0, 1),
         "1 once the bonds of the contact are broken, by opening, or by slip if it has a residual strength. From then on it has no "
         "tensile strength, and the residual cohesion (0 if there is none). In a dynamic analysis: on more than half of the "
         "faces that meet there."},
        {"/states/crept", &states.crept, {"state", "contact"}, "m", any(),
         "Creep part of the relative displacement {normal, shear}."},
        {"/states/initial_gap", &states.initial_gap, {"contact"}, "m", at_least(0),
         "Gap at the in-situ equilibrium, 0 where the contact is closed. The gap of an open contact is initial_gap + "
         "relative_displacement - crept - dilation. If the contact was closed in situ, use -(closure of its "
         "spring in situ) in place of initial_gap."},
    };
    // clang-format on
}

std::vector<Field> fields_of(StepHistory& step_history)
{
    using namespace fields;
    // clang-format off
    return {
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
    using namespace fields;
    // clang-format off
    return {
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
         "Mean closure of its springs; below 0 where a bond is in tension."},
        {"/dynamics/contact_slips", &dynamics.contact_slips, {"moving_contact"}, "1", between(0, 1), "1 while it slips."},
    };
    // clang-format on
}

std::vector<Field> fields_of(Checkpoint& checkpoint)
{
    using namespace fields;
    const std::vector<std::string> contact = {"contact"};
    // clang-format off
    return {
        {"/checkpoint/contact_status", &checkpoint.contact_status, contact, "1", between(0, 3),
         "0 removed, 1 sticking, 2 slipping, 3 open."},
        {"/checkpoint/traction", &checkpoint.traction, contact, "Pa", any(), "Traction {normal, shear}, tension positive."},
        {"/checkpoint/initial_traction", &checkpoint.initial_traction, contact, "Pa", any(),
         "Traction {normal, shear} at zero displacement. Of an open contact: the traction that its springs "
         "would carry."},
        {"/checkpoint/relative_displacement", &checkpoint.relative_displacement, contact, "m", any(),
         "Displacement of side b minus that of side a {normal, shear}."},
        {"/checkpoint/offset", &checkpoint.offset, contact, "m", any(), "Creep part of this displacement {normal, shear}."},
        {"/checkpoint/slip", &checkpoint.slip, contact, "m", any(), "Slip since the in-situ equilibrium."},
        {"/checkpoint/dilation", &checkpoint.dilation, contact, "m", any(), "Opening by slip since the in-situ equilibrium."},
        {"/checkpoint/opening_rate", &checkpoint.opening_rate, {"open_contact"}, "m/s", any(),
         "Rate of {opening, shear} of contacts that were open in the last creep step; 0 of others."},
        {"/checkpoint/is_broken", &checkpoint.is_broken, contact, "1", between(0, 1),
         "1 once the bonds of the contact are broken."},
        {"/checkpoint/first_memory", &checkpoint.first_memory, contact, "1", any(),
         "State of the contact's law in addition to slip, dilation and broken bonds, in SI units; 0 if "
         "there is none."},
        {"/checkpoint/second_memory", &checkpoint.second_memory, contact, "1", any(), "The same, a second number."},
        {"/checkpoint/third_memory", &checkpoint.third_memory, contact, "1", any(), "The same, a third number."},
        {"/checkpoint/reference", &checkpoint.reference, {"direction"}, "Pa", any(), "Traction from which creep counts."},
        {"/checkpoint/crept", &checkpoint.crept, {"direction_unit"}, "m", any(),
         "Creep displacement of the unit."},
    };
    // clang-format on
}

std::vector<Field> fields_of(DynamicsState& state)
{
    using namespace fields;
    const std::vector<std::string> pair = {"pair"};
    // clang-format off
    return {
        {"/dynamics_state/face", &state.face, {"face"}, "1", index_of("gridpoint"), "First and second gridpoint of the face."},
        {"/dynamics_state/pair", &state.pair, pair, "1", index_of("face"), "The two faces."},
        {"/dynamics_state/law", &state.law, pair, "1", at_least(0), "Number of the joint law between them."},
        {"/dynamics_state/first_lead", &state.first_lead, pair, "m", any(),
         "Closure of the springs at a gap of 0, at the first end of the first face."},
        {"/dynamics_state/second_lead", &state.second_lead, pair, "m", any(), "The same at its second end."},
        {"/dynamics_state/dilation", &state.dilation, pair, "m", at_least(0),
         "Part of both that is due to dilation."},
        {"/dynamics_state/tau", &state.tau, pair, "Pa", any(), "Shear traction."},
        {"/dynamics_state/is_known", &state.is_known, pair, "1", between(0, 1), "1 if they have touched since they came near."},
        {"/dynamics_state/is_new", &state.is_new, pair, "1", between(0, 1), "1 if they have not carried a force yet."},
        {"/dynamics_state/is_closed", &state.is_closed, pair, "1", between(0, 1), "1 if they touch."},
        {"/dynamics_state/is_broken", &state.is_broken, pair, "1", between(0, 1), "1 if there are no bonds between them."},
        {"/dynamics_state/first_memory", &state.first_memory, pair, "1", any(),
         "State of the pair's law in addition to dilation and broken bonds, in SI units; 0 if there is "
         "none."},
        {"/dynamics_state/second_memory", &state.second_memory, pair, "1", any(), "The same, a second number."},
        {"/dynamics_state/third_memory", &state.third_memory, pair, "1", any(), "The same, a third number."},
        {"/dynamics_state/normal", &state.normal, pair, "1", any(), "Unit normal {x, y} from the first to the second, or 0."},
        {"/dynamics_state/length", &state.length, pair, "m", at_least(0), "Length on which they touch."},
        {"/dynamics_state/first_reference", &state.first_reference, pair, "Pa", any(),
         "Pressure from which creep counts, at the first end of the first face."},
        {"/dynamics_state/second_reference", &state.second_reference, pair, "Pa", any(), "The same at its second end."},
        {"/dynamics_state/shear_reference", &state.shear_reference, pair, "Pa", any(), "Shear traction from which creep counts."},
        {"/dynamics_state/pair_crept", &state.pair_crept, {"pair_unit"}, "m", any(),
         "Creep displacement of the unit: closure, or shear."},
        {"/dynamics_state/pressed_in", &state.pressed_in, pair, "J/m", at_least(0), "Energy of the normal springs between them."},
        {"/dynamics_state/sheared_in", &state.sheared_in, pair, "J/m", at_least(0), "Energy of the shear springs between them."},
    };
    // clang-format on
}

std::vector<fields::Invariant> invariants_of(const EquivalentJoints& joints)
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

std::vector<fields::Invariant> invariants_of(const Mesh& mesh)
{
    return {
        {"/mesh/contact_gridpoint", "the two gridpoints of a contact differ", "contact",
         [&mesh](std::size_t contact) {
             return mesh.contact_gridpoint[contact][0] != mesh.contact_gridpoint[contact][1];
         }},
        {"/mesh/contact_normal", "the normal of a contact has length 1", "contact",
         [&mesh](std::size_t contact) { return std::abs(mesh.contact_normal[contact].norm() - 1) < 1e-9; }},
    };
}

} // namespace

fields::ForceFields fields_in_files()
{
    // clang-format off
    return {
        .dimensions = {
            {"piece", "a joint trace or a rock bridge inside the section"},
            {"bridge", "a rock bridge: rock between the traces of a joint"},
            {"kelvin_unit", "a Kelvin unit of a joint's chain, as many as the longest chain has"},
            {"contact", "a pair of gridpoints that face each other across a joint"},
            {"open_contact", "a contact, if creep steps are cut where contacts close; otherwise there is none"},
            {"gauge", "a gauge of the scene"},
            {"moving_contact", "two faces of blocks that touch at a recorded moment of a dynamic analysis"},
            {"direction", "the normal or the shear of a contact that creeps"},
            {"direction_unit", "a Kelvin unit or dashpot of a direction"},
            {"face", "a side of a zone with no rock of the same block before it; a fixed border (ground) has faces, too"},
            {"pair", "two faces that may touch"},
            {"pair_unit", "a Kelvin unit or dashpot of such a pair. Normal direction: one at each end of the face; shear: one"},
        },
        .equivalent_joints = fields_of,
        .invariants_of_equivalent_joints = invariants_of,
        .mesh = fields_of,
        .invariants_of_mesh = invariants_of,
        .states = fields_of,
        .step_history = fields_of,
        .dynamics = fields_of,
        .checkpoint = fields_of,
        .dynamics_state = fields_of,
    };
    // clang-format on
}

} // namespace jointcreep::joint
