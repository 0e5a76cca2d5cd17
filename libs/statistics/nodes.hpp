// The topology of the joint traces inside the section, as Sanderson and Nixon 2015 count it: where two traces
// cross is an X node, where one ends at another a Y node, and where one ends alone an I node. Between nodes
// there are (4 X + 3 Y + I) / 2 branches, and (4 X + 3 Y) / branches of their ends are at other joints:
// connections per branch, from 0 to 2. Ends outside the section are not nodes.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <cstdint>

namespace jointcreep::statistics
{

struct Nodes {
    std::int64_t x = 0, y = 0, i = 0;
    double branches() const { return static_cast<double>(4 * x + 3 * y + i) / 2; }
    double connections_per_branch() const
    {
        return branches() > 0 ? static_cast<double>(4 * x + 3 * y) / branches() : 0;
    }
};

// An end within `tolerance` [m] of another trace is at it. Traces of one joint do not meet. Three traces
// through one point are three X nodes. In time that is linear for evenly scattered traces.
Nodes count_nodes(const Joints& joints, const Polygon& outline, double tolerance);

} // namespace jointcreep::statistics
