// A section small enough to check by eye, with one of everything that an export has to get right.
//
//   y = 10  5-----------------4
//           |     block 0     |   stage "dig", rock "upper"
//   y = 5   3------joint------2
//           |     block 1     |   stays, rock "lower"; block 2 is an island of "upper" in it
//           |      9---8      |
//           |      | 2 |      |
//           |      6---7      |
//   y = 0   0-----------------1
//         x = 0      4   6    10

#pragma once

#include "exchange/layers.hpp"
#include "model/network.hpp"
#include "model/result.hpp"

namespace jointcreep::exchange
{

inline Network small_network()
{
    Network network;
    network.names = {{"upper", "lower"}, {"clay"}, {"bedding, main", "the \"other\" set"}, {"dig"}};

    network.joints.set = {1};
    network.joints.number = {7};
    network.joints.material = {0};
    network.joints.from = {{0, 5}};
    network.joints.to = {{10, 5}};
    network.joints.pole = {{0, 1, 0}};
    network.joints.diameter = {0};
    network.joints.centre = {{5, 5, 0}};
    network.joints.trace_joint = {0, 0};
    network.joints.trace_from = {{0, 5}, {6, 5}};
    network.joints.trace_to = {{4, 5}, {1.0 / 3.0 + 9, 5}};

    Blocks& blocks = network.blocks;
    blocks.vertex = {{0, 0}, {10, 0}, {10, 5}, {0, 5}, {10, 10}, {0, 10}, {4, 1}, {6, 1}, {6, 3}, {4, 3}};
    blocks.edge_vertex = {{0, 1}, {1, 2}, {3, 2}, {3, 0}, {2, 4}, {4, 5},
                          {5, 3}, {6, 7}, {7, 8}, {8, 9}, {9, 6}};
    blocks.edge_block = {{1, -1}, {1, -1}, {0, 1}, {1, -1}, {0, -1}, {0, -1},
                         {0, -1}, {2, 1},  {2, 1}, {2, 1},  {2, 1}};
    blocks.edge_kind = {0, 0, 1, 0, 0, 0, 0, 2, 2, 2, 2};
    blocks.edge_joint = {-1, -1, 0, -1, -1, -1, -1, -1, -1, -1, -1};
    blocks.edge_joint_fraction = {0, 0, 0.7, 0, 0, 0, 0, 0, 0, 0, 0};
    blocks.edge_share = {0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    blocks.share_joint = {0};
    blocks.share_fraction = {0.7};
    blocks.edge_boundary = {0, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
    blocks.block_rock = {0, 1, 0};
    blocks.block_stage = {0, -1, -1};
    blocks.block_area = {50, 46, 4};
    blocks.block_ring = {0, 1, 3, 4};
    blocks.ring_start = {0, 4, 8, 12, 16};
    blocks.ring_vertex = {3, 2, 4, 5, 0, 1, 2, 3, 6, 9, 8, 7, 6, 7, 8, 9};
    blocks.fates = {{0}, {10}, {0}, {0}, {0}, {0}, {0}, {0}};
    return network;
}

// The joint at y = 5, and the base on a joint.
inline EquivalentJoints small_equivalent()
{
    const auto on_joints = [](double base, double joint) {
        std::vector<double> values(11, 0.0);
        values[0] = base;
        values[2] = joint;
        return values;
    };
    EquivalentJoints joints{on_joints(6.9e8, 1e9 / 3), on_joints(0, 2.8e8),
                            on_joints(0, 1e5),         on_joints(0.5, 0.6),
                            on_joints(0, 1e4),         on_joints(0, 0.1),
                            on_joints(0, 0.03),        on_joints(6.9e8, 7e8),
                            on_joints(1e8, 2e8),       on_joints(5e13, 6e13),
                            on_joints(7e13, 8e13),     on_joints(0, 9e15),
                            on_joints(0, 3e15),        {0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0}};
    joints.own["residual_cohesion"] = on_joints(0, 2e4);
    joints.own["residual_friction_angle"] = on_joints(0, 0.4);
    joints.own["roughness"] = on_joints(0, 8);
    joints.own["wall_strength"] = on_joints(0, 5e7);
    joints.own["largest_closure"] = on_joints(0, 2e-4);
    return joints;
}

inline Section small_section(bool with_properties = false)
{
    Section section{.file = "small.h5",
                    .realization = 4,
                    .outline = {{0, 0}, {10, 0}, {10, 10}, {0, 10}},
                    .network = small_network()};
    if (with_properties)
        section.equivalent = small_equivalent();
    return section;
}

// Zones 0, 1 in block 0 (dug in state 1) and 2, 3 in block 1; contact 0 between the blocks, contact 1 under
// block 1 on fixed ground.
inline Result small_result()
{
    Result result;
    result.mesh.gridpoint = {{0, 5}, {10, 5}, {10, 10}, {0, 10}, {0, 0}, {10, 0}, {10, 5}, {0, 5}, {0, 0}};
    result.mesh.gridpoint_fixed = {0, 0, 0, 0, 0, 0, 0, 0, 3};
    result.mesh.zone_gridpoint = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    result.mesh.zone_block = {0, 0, 1, 1};
    result.mesh.contact_gridpoint = {{6, 1}, {8, 4}};
    result.mesh.contact_edge = {2, 0};
    result.mesh.contact_normal = {{0, 1}, {0, 1}};
    result.mesh.contact_length = {5, 5};
    result.mesh.contact_centre = {{7.5, 5}, {2.5, 0}};

    result.history.time = {0, 1, 1};
    result.history.event = {"", "", "dig"};
    result.history.point = {"A", "B, deep"};
    result.history.point_position = {{5, 7}, {5, 2}};
    result.history.first_reading_row = {0, 0};
    result.history.displacement = {{0, 0}, {0, 0}, {0, 0}, {1e-4, 0}, {0, 0}, {0.1 + 0.2, -1.0 / 3.0}};
    result.history.present = {1, 1, 1, 1, 0, 1};

    result.states.time = {0, 1};
    result.states.event = {"", "dig"};
    for (int i = 0; i < 18; ++i)
        result.states.displacement.emplace_back(i / 3.0, -i / 7.0);
    for (int i = 0; i < 8; ++i)
        result.states.stress.emplace_back(i * 1e6 / 3, -i * 1e5, i * 10.0);
    result.states.zone_present = {1, 1, 1, 1, 0, 0, 1, 1};
    result.states.traction = {{-1e6, 2e5}, {-2e6, 0}, {0, 0}, {-1e6, 3e5}};
    result.states.relative_displacement = {{-1e-3, 2e-4}, {-3e-3, 0}, {0, 0}, {-1e-3, 5e-4}};
    result.states.contact_status = {1, 1, 0, 2};
    result.history.reset_row = {0, 0, 0};
    result.states.reset_state = {0, 0};
    return result;
}

} // namespace jointcreep::exchange
