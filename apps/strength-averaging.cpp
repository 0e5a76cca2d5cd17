// strength-averaging: turn joints and the rock bridges between them into equivalent continuous joints.
//
//   strength-averaging network.h5 -o joints.h5
//
// Reads   network.h5   joints and blocks                           (from jointgen)
// Writes  joints.h5    the same, and every edge's equivalent joint (docs/file-format.md)

#include "program.hpp"

#include "joint/equivalent.hpp"
#include "model/units.hpp"
#include "model/version.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"

#include <cmath>

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

// Means over the length of each set's edges.
void report(const Network& network, const EquivalentJoints& joints)
{
    const Blocks& blocks = network.blocks;
    Summary summary;
    for (std::size_t set = 0; set < network.names.joint_set.size(); ++set) {
        double length = 0, joint = 0, cohesion = 0, tan_phi = 0;
        for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
            if (blocks.edge_joint[e] < 0 ||
                network.joints.set[blocks.edge_joint[e]] != static_cast<Index>(set))
                continue;
            const auto [a, b] = blocks.edge_vertex[e];
            const double l = (blocks.vertex[a] - blocks.vertex[b]).norm();
            length += l;
            joint += l * blocks.edge_joint_fraction[e];
            cohesion += l * joints.cohesion[e];
            tan_phi += l * std::tan(joints.friction_angle[e]);
        }
        const std::string& name = network.names.joint_set[set];
        summary.add(name + ": length", length, "m");
        if (length == 0)
            continue;
        summary.add(name + ": persistence", joint / length);
        summary.add(name + ": mean cohesion", cohesion / length / unit::MPa, "MPa");
        summary.add(name + ": mean friction angle", std::atan(tan_phi / length) / unit::deg, "deg");
    }
    summary.print();
}

void average_and_write(const Arguments& arguments)
{
    const std::string& input = arguments.input();
    check_writable(arguments.output());

    // 1. Joints, blocks, and the scene they were made from.
    NetworkFile file = read_network(input);
    const Scene scene = parse_scene(file.provenance.scene, input + ": /scene");

    // 2. The equivalent joint of every edge.
    const EquivalentJoints joints = average_strength(scene, file.network);

    Provenance provenance = file.provenance;
    provenance.program.push_back(program.name);
    provenance.version.emplace_back(version());
    provenance.input_sha256.push_back(sha256_of(input));
    provenance.options.emplace_back();
    write_joints(arguments.output(), provenance, file.network, joints);
    if (!arguments.quiet())
        report(file.network, joints);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, average_and_write);
}
