// Cuts the section into blocks along its joints, stage outlines and borders between rocks.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::blocks
{

// What finds the crossings of lines and divides them there: this project's own subdivision, or CGAL's Arrangement_2.
// Both give the same blocks, bit by bit; lengths in Blocks::fates may differ by rounding, as CGAL also divides lines
// outside the section. CGAL takes longer, and only programs built with the tests have it.
enum class Subdivision { own, cgal };

// The blocks of the section. `joints` may cross, touch, overlap, reach beyond the outline or run along it.
//
//  - Every crossing is found by exact predicates and rounded once (blocks/graph.hpp). Then vertices closer
//    than scene.cutting.shortest_edge to each other, or than half of it to an edge, are merged. Wedges
//    narrower than scene.cutting.smallest_angle are closed where that moves little. Vertices on the outline
//    stay on it, so the blocks' areas add up to the section's.
//  - A joint that ends inside a block is cut back to the last block border it met, or extended to the next
//    line as rock bridge, by scene.cutting.dangling_ends.
//  - Inside the section's holes there are no blocks.
//  - Blocks are checked (blocks/check.hpp), and each joint's length is accounted for.
//  - An edge on several joints belongs to the one with the largest joint fraction, then to the single
//    joint that is last in the scene, then to the first.
//  - Joint edges have the direction of their joint; boundary edges have the rock on their left.
//
// Throws input_error where there are more crossings than can be found, where a boundary condition does not lie on
// the outline, where merging does not settle, or where the check fails.
Blocks cut(const Scene& scene, const Joints& joints, Subdivision subdivision = Subdivision::own);

// What cut() will cost, from pairs of joints and from how many of them lie closer than the shortest edge: crossings of
// joints, and seconds on one processor, to a factor of three; less where many joints meet in a point. Zeros where it is
// less than a second, and where cut() will refuse.
struct CuttingCost {
    double crossings = 0, seconds = 0;
};
CuttingCost expected_cost(const Scene& scene, const Joints& joints);

} // namespace jointcreep::blocks
