// strength-averaging: turn joints and the rock bridges between them into equivalent continuous joints.
//
//   strength-averaging network.h5 -o joints.h5
//
// Reads   network.h5   joints and blocks                           (from jointgen)
// Writes  joints.h5    the same, every edge's equivalent joint, joint by joint its
//                      traces and rock bridges, and what they average to (docs/file-format.md)

#include "program.hpp"

#include "joint/equivalent.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "model/version.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"

#include <optional>

using namespace jointcreep;

namespace
{

const Program program{
    .name = "strength-averaging",
    .summary = "Turns joints and rock bridges into equivalent continuous joints.",
    .input = "network.h5",
    .output = "joints.h5",
    .options = {},
    .example = "strength-averaging network.h5 -o joints.h5",
};

// "0.1 joint, 2 bridges, 1.2 equivalent"; without bridges "0.1". `called` is "bridges" or what they are.
std::string beside(double joint, std::optional<double> bridges, double equivalent, double unit,
                   const std::string& called = "")
{
    if (joint == equivalent)
        return rounded(joint / unit);
    return rounded(joint / unit) + " joint, " +
           (bridges ? rounded(*bridges / unit) + " " + called + ", " : "") + rounded(equivalent / unit) +
           " equivalent";
}

// For each set: persistence, target and achieved; and the properties of joints, bridges and their averages.
void report(const Arguments& arguments, const Network& network, const EquivalentJoints& joints,
            const Warnings& earlier)
{
    const SetAverages& sets = joints.sets;
    Summary summary;
    summary.add("joint traces in the section", joints.pieces.joint.size() - joints.pieces.bridge.size());
    summary.add("rock bridges on joint lines", joints.pieces.bridge.size());
    for (std::size_t set = 0; set < network.names.joint_set.size(); ++set) {
        const std::string& name = network.names.joint_set[set];
        summary.add(name + ": length on edges", sets.edge_length[set], "m");
        if (sets.edge_persistence[set] == 1 && sets.cohesion[set] == sets.joint_cohesion[set])
            summary.add(name + ": persistence", "1, all joint");
        if (sets.edge_length[set] == 0 || sets.edge_persistence[set] == 1)
            continue;
        // Of segments nothing is bridged on their lines, but extensions to the border of a block are rock.
        const bool are_extensions = sets.target_persistence[set] == 1;
        const std::string bridges = are_extensions ? "extensions" : "bridges";
        if (are_extensions) {
            const std::string share = rounded(sets.edge_persistence[set]);
            summary.add(name + ": joint on edges",
                        share == "1" ? "nearly all of the length"
                                     : share + " of the length; the rest: extensions through rock");
        } else
            summary.add(name + ": persistence", rounded(sets.target_persistence[set]) + " in the scene, " +
                                                    rounded(sets.line_persistence[set]) +
                                                    " on lines (error " +
                                                    rounded(sets.persistence_error[set]) + "), " +
                                                    rounded(sets.edge_persistence[set]) + " on edges");
        summary.add(name + ": cohesion",
                    beside(sets.joint_cohesion[set], sets.bridge_cohesion[set], sets.cohesion[set], unit::MPa,
                           bridges),
                    "MPa");
        summary.add(name + ": friction angle",
                    beside(sets.joint_friction_angle[set], sets.bridge_friction_angle[set],
                           sets.friction_angle[set], unit::deg, bridges),
                    "deg");
        summary.add(name + ": tensile strength",
                    beside(sets.joint_tensile_strength[set], sets.bridge_tensile_strength[set],
                           sets.tensile_strength[set], unit::MPa, bridges),
                    "MPa");
        if (sets.dilation_angle[set] > 0)
            summary.add(name + ": dilation angle",
                        beside(sets.joint_dilation_angle[set], sets.bridge_dilation_angle[set],
                               sets.dilation_angle[set], unit::deg, bridges),
                        "deg");
        summary.add(name + ": normal stiffness",
                    beside(sets.joint_normal_stiffness[set], {}, sets.normal_stiffness[set], unit::MPa),
                    "MPa/m");
        summary.add(name + ": shear stiffness",
                    beside(sets.joint_shear_stiffness[set], {}, sets.shear_stiffness[set], unit::MPa),
                    "MPa/m");
        if (sets.limited_length[set] > 0)
            summary.add(name + ": stiffness limited on", sets.limited_length[set], "m");
    }
    summary.count_warnings(0, earlier.text.size());
    summary.print(arguments);
}

void average_and_write(const Arguments& arguments)
{
    const std::string& input = arguments.input();
    store::check_writable(arguments.output());

    // 1. Joints, blocks, and the scene they were made from.
    store::NetworkFile file = store::read_network(input);
    const Scene scene = scene::parse_scene_of_file(file.provenance.scene, input, file.network);

    // 2. The equivalent joint of every edge.
    const EquivalentJoints joints =
        of_file(input, [&] { return joint::average_strength(scene, file.network); });

    Provenance provenance = file.provenance;
    provenance.program.push_back(program.name);
    provenance.version.emplace_back(version());
    provenance.input_sha256.push_back(store::sha256_of(input));
    provenance.options.emplace_back();
    store::write_joints(arguments.output(), provenance, file.network, joints);
    report(arguments, file.network, joints, file.provenance.warnings);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, average_and_write);
}
