// How many crossings of joints a section will have, before they are found. Inside libs/blocks only.

#pragma once

#include "blocks/graph.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::blocks
{

// The bounding box of an outline.
Box box_of(const Polygon& outline);

// More are refused: they take five minutes and 22 GB (page docs/cutting.md), ten times as many do not fit the
// numbers of edges.
inline constexpr double most_crossings = 5e7;

// Crossings of two joints in a box, estimated from pairs of joints, always the same ones; exact to a tenth or so
// where there are `most_crossings`, and elsewhere to a tenth where a thousandth of all pairs cross.
struct ExpectedCrossings {
    double number = 0;
    Index set = -1; // whose joints have most of them
};
ExpectedCrossings expected_crossings(const Joints& joints, const Box& box);

// Throws input_error where more than `most_crossings` are expected, or where joints lie so close beside each other that
// merging would take hours.
void check_crossings(const Scene& scene, const Joints& joints, const Box& box);

} // namespace jointcreep::blocks
