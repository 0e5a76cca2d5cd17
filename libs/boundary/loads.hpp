// Boundary conditions over time: tractions and prescribed displacements of the outline.

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

    // Sets the displacements [m, from the start] of gridpoints with prescribed displacements at `time` [s, from the
    // start]. `is_present` has an entry for each stress point of the zones. Sides of excavated zones are left out.
    void displace(std::vector<Vector2d>& displacement, const std::vector<char>& is_present,
                  double time) const;

    // Adds the tractions at `time` to the forces on gridpoints [N/m].
    void add_forces(std::vector<Vector2d>& force, const std::vector<char>& is_present, double time) const;

    // Directions {x, y} that sides with rock fix, of so many gridpoints: 1 fixed, 0 not.
    std::vector<Vector2d> fixed(std::size_t gridpoints, const std::vector<char>& is_present) const;

    // Whether tractions or prescribed displacements change between two times [s].
    bool changes(double from, double to) const;

    // The times at which a load history has a corner [s].
    std::set<double> corners() const;

private:
    struct Side {
        std::vector<Index> gridpoint;
        std::vector<double> share; // of the side's length, for each gridpoint
        Index stress_point;        // of its zone
        double length;
        Index boundary;
    };
    std::vector<Boundary> boundary_;
    std::vector<Side> side_;
};

} // namespace jointcreep::boundary
