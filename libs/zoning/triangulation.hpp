// One constrained triangulation of the whole section. Inside libs/zoning only.

#pragma once

#include "model/network.hpp"

#include <array>
#include <functional>
#include <vector>

namespace jointcreep::zoning
{

// A piece of a block edge between two neighbouring vertices of the triangulation.
struct Side {
    Index edge;                    // into Blocks
    std::array<Index, 2> vertex;   // in the direction of the edge
    std::array<Index, 2> triangle; // on its {left, right}; -1 outside the section
};

struct Triangulation {
    std::vector<Eigen::Vector2d> vertex;        // [m]
    std::vector<std::array<Index, 3>> triangle; // counter-clockwise
    std::vector<Index> block;                   // of each triangle
    std::vector<Side> side;                     // all pieces of all block edges
    // Across the side opposite each corner; -1 across block edges.
    std::vector<std::array<Index, 3>> neighbour;
};

// Delaunay refinement of all blocks at once, with the block edges kept: no side longer than the size at the
// triangle's middle [m], no angle below about 20 degrees except where the blocks' own corners are sharper.
// `least` is the smallest size [m].
Triangulation triangulate(const Blocks& blocks, double least,
                          const std::function<double(const Eigen::Vector2d&)>& size);

} // namespace jointcreep::zoning
