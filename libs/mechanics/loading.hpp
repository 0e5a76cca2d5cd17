// Tractions and displacements that the outline is given, over time.

#pragma once

#include "mechanics/assembly.hpp"

#include <set>

namespace jointcreep::mechanics
{

class Loading
{
public:
    Loading(const Scene& scene, const Mesh& mesh);

    // Puts on the tractions and displacements of `time` since start [s], in place of those before.
    // Displacements count from the start.
    void apply(Assembly& assembly, double time);

    // Takes tractions off sides whose rock has been removed.
    void leave_removed(Assembly& assembly) const;

    // Whether anything changes between two times [s].
    bool changes(double from, double to) const;

    // The times at which a load history has a corner [s].
    std::set<double> corners() const;

private:
    struct Side {
        std::array<Index, 2> gridpoint;
        Index zone;
        double length;
        Index boundary;
    };
    std::vector<Boundary> boundary_;
    std::vector<Side> side_;
    double time_ = 0;
};

} // namespace jointcreep::mechanics
