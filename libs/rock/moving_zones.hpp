// Zones of rock that slides, turns and falls: rock at large displacements.
//
// They are elastic in the frame that turns with the zone, Biot's stress over Biot's strain (rock/finite_strain.hpp), from a
// shape without stress that has the in-situ stress in the shape they start from. So turning costs nothing, and the forces have
// a potential. Rock that yields has its plastic strain taken off Biot's strain there.

#pragma once

#include "rock/zones.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace jointcreep::rock
{

inline constexpr double most_strain = 0.5; // of a zone that yields [-]

struct MovingZone {
    std::array<Index, 3> gridpoint;
    Eigen::Matrix2d inverse; // of the edges {1 - 0, 2 - 0} in the shape without stress [1/m]
    double area = 0;         // of that shape [m2]
    Vector3d stiffness;      // {C11, C12, C33} [Pa]
    Vector3d strain;         // Biot's {xx, yy, 2 xy} in the last step
    Vector3d held{0, 0, 0};  // stress of dashpots now [Pa]
};

// Of rock that yields, in the frame that turns with its zone.
struct MovingYieldingZone {
    YieldingZone zone; // strains since the shape without stress; its dissipation is of one step
    Vector3d stress;   // Biot's {xx, yy, xy} now [Pa]
};

struct MovingZones {
    std::vector<MovingZone> zone;
    std::vector<MovingYieldingZone> yielding; // by Zones::yielding_number
    std::vector<Vector2d> corner_force;       // on the three corners of each zone [N/m]
};

// Sums over zones [J/m].
struct ZoneSums {
    double stored = 0;               // now
    double friction = 0, damped = 0; // in the last step; friction is what yielding takes
    Index torn = -1;                 // a zone strained by more than `most_strain`

    void operator+=(const ZoneSums& other)
    {
        stored += other.stored;
        friction += other.friction;
        damped += other.damped;
        torn = torn < 0 ? other.torn : torn;
    }
};

// With the stress that zones have, in the shape that they have where gridpoints are at `place` [m].
MovingZones moving_zones_of(const Zones& zones, const std::vector<Vector2d>& place);

// Stress and corner forces of one zone where gridpoints are at `place` [m]; adds its energies. `viscosity`: of dashpots over
// springs, by strains in this step [-].
void find_force(const Zones& zones, MovingZones& moving, Index z, const std::vector<Vector2d>& place,
                double viscosity, ZoneSums& sums);

// Cauchy's stress, and plastic strain, of one zone into `zones`.
void put_back(const MovingZones& moving, Index z, const std::vector<Vector2d>& place, Zones& zones);

// What moving_zones_of() and find_force() cannot find anew.
void transfer(const Transfer& to, MovingZones& moving, DynamicsState& kept);

} // namespace jointcreep::rock
