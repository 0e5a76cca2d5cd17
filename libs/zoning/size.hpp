// How large zones are to be at a place. Inside libs/zoning only.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <unsupported/Eigen/BVH>

namespace jointcreep::zoning
{

class ZoneSize
{
public:
    ZoneSize(const Scene& scene, const Blocks& blocks);

    // Longest zone side aimed at, at the middle of a zone [m].
    double at(const Eigen::Vector2d& place) const;

    double steepest() const; // change of the size with the distance, at most [-]

private:
    // A straight piece of a face, or a place of measurement, where both ends are one [m].
    struct Stretch {
        Eigen::Vector2d from, to;
    };
    friend Eigen::AlignedBox2d bounding_box(const Stretch& stretch); // for the tree
    struct DistanceFrom;

    const Scene& scene_;
    Eigen::KdBVH<double, 2, Stretch> fine_; // what zones are to be small at
};

} // namespace jointcreep::zoning
