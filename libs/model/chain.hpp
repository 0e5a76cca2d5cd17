// A spring in series with Kelvin units: what creeps. Of a direction of a joint stiffnesses are in Pa/m and viscosities
// in Pa s/m, of rock in Pa and Pa s.

#pragma once

#include <vector>

namespace jointcreep
{

struct KelvinUnit {
    double stiffness; // E; 0 for a Maxwell dashpot
    double viscosity; // eta

    bool operator==(const KelvinUnit&) const = default;
};

struct Chain {
    double spring; // K, above 0 where anything creeps
    std::vector<KelvinUnit> units;
    // Whose constants these are: of joints 2 material + direction. What changes them changes all chains of the same.
    int constants = 0;

    bool operator==(const Chain&) const = default;
};

} // namespace jointcreep
