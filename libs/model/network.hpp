// The blocks of a section and the joints that made them: flat arrays, the same in memory and in a file
// (libs/store/schema.hpp and the forces give each one's dataset, unit and range). An index of -1 means none.

#pragma once

#include "model/statistics.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace jointcreep
{

enum class EdgeKind : Index {
    boundary = 0, // on the section's outline: rock on one side only
    joint = 1,
    bonded = 2 // a stage outline or a border between rocks: no joint, the blocks hold together
};

// Where the rows of other arrays that name something by index find its name.
struct Names {
    std::vector<std::string> rock;           // as in the scene's [[rock]]
    std::vector<std::string> joint_material; // [[joint_material]]
    std::vector<std::string> joint_set;      // [[joint_set]], then each [[joint]], then [[mapped]]
    std::vector<std::string> stage;          // [[stage]]
};

// The names of a scene, in the scene's order.
struct Scene;
Names names_of(const Scene& scene);

// Joints: straight lines through the section, each made of joint traces and the rock bridges between them.
struct Joints {
    std::vector<Index> set;      // into Names::joint_set
    std::vector<Index> number;   // within the set; with the set's name it identifies the joint for good
    std::vector<Index> material; // into Names::joint_material
    std::vector<Eigen::Vector2d> from, to; // ends of the line [m]

    // The joint traces. What a line has between its traces is rock bridge.
    std::vector<Index> trace_joint;                    // the joint it lies on
    std::vector<Eigen::Vector2d> trace_from, trace_to; // [m]

    // Upward unit normal of the joint's plane: {x, y} in the section, z across it, at the azimuth plus 90
    // degrees. Zero where only the trace angle was drawn [-].
    std::vector<Eigen::Vector3d> pole{};
    std::vector<Eigen::Vector2d> point{}; // where the joint was placed, about which it turns [m]

    // Of the disc that a trace is a chord of: its diameter, 0 of joints that are no discs [m]; its centre, z being
    // across the section; of others the point above [m].
    std::vector<double> diameter{};
    std::vector<Eigen::Vector3d> centre{};
};

// What cutting had to change to keep edges and angles above the scene's limits.
struct CuttingReport {
    Index merged_vertices = 0;
    double merged_edge_length = 0; // of the edges that vanished [m]
    double merged_block_area = 0;  // of the blocks that vanished into their neighbours [m2]
    double largest_move = 0;       // of a vertex [m]
    double pruned_length = 0;      // of joints that ended inside a block, and were cut back [m]
    double shortest_edge = 0;      // that is left [m]
    double smallest_angle = 0;     // between neighbouring edges that is left [rad]
};

// The fate of a joint: what became of it when the section was cut, to the length of the shortest edge.
enum class JointFate : Index {
    kept = 0,    // all of it is on block edges
    clipped = 1, // the part inside the section is, except along the outline
    trimmed = 2, // some of it ended inside a block, and was cut back
    merged = 3,  // some of it was on edges too short, or too close to others, to stay
    dropped = 4  // none of it is on block edges
};

// Fates by lengths [m]; rows are joints. All lengths but the last add up to the joint's line, traces and bridges.
struct JointFates {
    std::vector<Index> fate;          // JointFate
    std::vector<double> kept;         // on block edges that have its properties
    std::vector<double> shared;       // on block edges that have another joint's
    std::vector<double> on_outline;   // along the section's outline
    std::vector<double> outside;      // of the section: clipped
    std::vector<double> dangling_end; // inside a block: cut back
    std::vector<double> merged;       // on edges that vanished
    std::vector<double> extended;     // beyond its ends, to the next block edge
};

// The cut section: a planar map whose faces are the blocks.
struct Blocks {
    std::vector<Eigen::Vector2d> vertex; // [m]

    // Edges run from their first vertex to their second; the left block is side b (model/signs.hpp).
    std::vector<std::array<Index, 2>> edge_vertex;
    std::vector<std::array<Index, 2>> edge_block; // {left, right}; -1 outside the section
    std::vector<Index> edge_kind;                 // EdgeKind
    std::vector<Index> edge_joint;                // into Joints, on joint edges
    std::vector<double> edge_joint_fraction;      // joint length / edge length, on joint edges [-]
    std::vector<Index> edge_boundary;             // into the scene's [[boundary]]; on boundary edges

    // All joints that a joint edge lies on, its own first.
    std::vector<Index> edge_share; // [edges + 1] those of edge e are rows edge_share[e] .. edge_share[e + 1]
    std::vector<Index> share_joint;
    std::vector<double> share_fraction; // of the edge that is joint trace of this one [-]

    // Blocks. Several blocks on bonded edges hold together as one.
    std::vector<Index> block_rock;  // into Names::rock
    std::vector<Index> block_stage; // that removes it, into Names::stage; -1 stays
    std::vector<double> block_area; // [m2]
    // [blocks + 1] The rings of block i are rows block_ring[i] .. block_ring[i + 1] of ring_start. The first is the
    // outer one, counter-clockwise, the others are holes, clockwise.
    std::vector<Index> block_ring;
    std::vector<Index> ring_start;  // [rings + 1] its vertices are rows ring_start[r] .. of ring_vertex
    std::vector<Index> ring_vertex; // into vertex

    JointFates fates;
    CuttingReport report;
};

// Corners of a ring, a Polygon.
inline std::vector<Eigen::Vector2d> ring_of(const Blocks& blocks, Index ring)
{
    std::vector<Eigen::Vector2d> corners;
    for (Index i = blocks.ring_start[ring]; i < blocks.ring_start[ring + 1]; ++i)
        corners.push_back(blocks.vertex[blocks.ring_vertex[i]]);
    return corners;
}

// What jointgen makes.
struct Network {
    Names names;
    Joints joints;
    Blocks blocks;
    Statistics statistics; // on request
};

// What lies along the joints inside the section: traces and rock bridges. Made by strength-averaging.
struct Pieces {
    std::vector<Index> joint;              // into Joints, in their order, and from `from` to `to` along each
    std::vector<Index> is_bridge;          // 1 rock bridge, 0 joint trace
    std::vector<Eigen::Vector2d> from, to; // [m]
    std::vector<double> length;            // [m]

    std::vector<Index> bridge; // the rock bridges among the pieces

    // Of each joint's line, inside the section; 0 where it does not meet it.
    std::vector<double> line_length;      // [m]
    std::vector<double> line_persistence; // [-]
};

// The averages of each joint set; rows are Names::joint_set. Strengths and stiffnesses are means over the
// length of the set's edges, 0 where it has none. Made by strength-averaging.
struct SetAverages {
    std::vector<double> target_persistence;       // as the scene has it; 1 for single joints [-]
    std::vector<double> line_persistence;         // on all lines inside the section [-]
    std::vector<double> persistence_error;        // standard error that it is expected to have [-]
    std::vector<double> edge_persistence;         // on the edges of blocks [-]
    std::vector<double> line_length, edge_length; // [m]

    // Cohesion [Pa], friction angle [rad] and tensile strength [Pa]: of joints, of rock bridges (0 without), averaged.
    std::vector<double> joint_cohesion, joint_friction_angle, joint_tensile_strength;
    std::vector<double> bridge_cohesion, bridge_friction_angle, bridge_tensile_strength;
    std::vector<double> cohesion, friction_angle, tensile_strength;
    std::vector<double> joint_dilation_angle, bridge_dilation_angle, dilation_angle; // [rad]
    std::vector<double> joint_normal_stiffness, joint_shear_stiffness;               // [Pa/m]
    std::vector<double> normal_stiffness, shear_stiffness;                           // of the averages [Pa/m]
    std::vector<double> limited_length; // of edges that are stiffer than zones can tell [m]
};

// The equivalent continuous joint of every joint edge, and of every boundary edge that rests on a joint;
// rows are edges, and on all other edges every value is 0. Made by strength-averaging.
struct EquivalentJoints {
    std::vector<double> normal_stiffness, shear_stiffness; // [Pa/m]
    std::vector<double> cohesion;                          // [Pa]
    std::vector<double> friction_angle;                    // [rad]
    std::vector<double> tensile_strength;                  // [Pa]
    std::vector<double> dilation_angle;                    // [rad]
    std::vector<double> dilation_until;                    // slip at which dilation ends; 0: it does not [m]
    // Kelvin units in series, [edge, unit], the unit running fastest; a stiffness of 0 is no unit.
    std::vector<double> normal_kelvin_stiffness, shear_kelvin_stiffness; // [Pa/m]
    std::vector<double> normal_kelvin_viscosity, shear_kelvin_viscosity; // [Pa s/m]
    // Maxwell dashpot in series; 0 is none.
    std::vector<double> normal_maxwell_viscosity, shear_maxwell_viscosity; // [Pa s/m]

    std::vector<Index> law{}; // into joint::laws() (libs/joint/law.hpp)
    // Parameters of single laws, by their names; 0 on edges of other laws [SI].
    std::map<std::string, std::vector<double>, std::less<>> own{};
    // Into Scene::joint_materials, where factors on one material are wanted; else empty. In no file.
    std::vector<Index> material{};
    double strength_divisor = 1; // of all strengths, for a run with strengths divided; in no file [-]

    // What was averaged, and with which persistence; 0 without joint [-].
    std::vector<double> persistence{};
    Pieces pieces{};
    SetAverages sets{};

    // The number of Kelvin units of the longest chain.
    std::size_t kelvin_units() const
    {
        return normal_stiffness.empty() ? 0 : normal_kelvin_stiffness.size() / normal_stiffness.size();
    }
};

} // namespace jointcreep
