// Tractions and displacements that the outline is given, over time.

#pragma once

#include "model/result.hpp"
#include "model/scene.hpp"

#include <Eigen/Core>

#include <set>
#include <vector>

namespace jointcreep::boundary
{

using Eigen::Vector2d;

class Loads
{
public:
    Loads(const Scene& scene, const Mesh& mesh);

    // Puts the gridpoints where the sides that are still there have them at `time` since the start [s]. Of all stress
    // points of zones: whether their rock is there.
    // Displacements count from the start [m].
    void displace(std::vector<Vector2d>& displacement, const std::vector<char>& is_present,
                  double time) const;

    // Adds the tractions of that time to the forces on gridpoints [N/m].
    void add_forces(std::vector<Vector2d>& force, const std::vector<char>& is_present, double time) const;

    // Whether anything changes between two times [s].
    bool changes(double from, double to) const;

    // The times at which a load history has a corner [s].
    std::set<double> corners() const;

private:
    struct Side {
        std::vector<Index> gridpoint;
        std::vector<double> share; // of the side's length, for each of these
        Index stress_point;        // of its zone
        double length;
        Index boundary;
    };
    std::vector<Boundary> boundary_;
    std::vector<Side> side_;
};

} // namespace jointcreep::boundary
