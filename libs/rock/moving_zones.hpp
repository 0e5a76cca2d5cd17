// Zones of rock at large displacements and rotations.
//
// Zones are elastic in the frame that rotates with them: Biot's stress from Biot's strain (rock/finite_strain.hpp).
// Strain counts from a shape without stress; the start shape has the in-situ stress. So rotation alone changes no
// stress, and the forces have a potential. In rock that yields, the plastic strain is subtracted from Biot's strain.

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
    YieldingZone zone; // strains since the shape without stress; dissipation of one step
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
    double friction = 0, damped = 0; // in the last step; friction is the energy lost by yielding
    Index torn = -1;                 // a zone strained by more than `most_strain`

    void operator+=(const ZoneSums& other)
    {
        stored += other.stored;
        friction += other.friction;
        damped += other.damped;
        torn = torn < 0 ? other.torn : torn;
    }
};

// Zones with their present stress, in their present shape: gridpoints are at `place` [m].
MovingZones moving_zones_of(const Zones& zones, const std::vector<Vector2d>& place);

// Stress and corner forces of one zone with gridpoints at `place` [m]; adds its energies. `viscosity`: stiffness of
// dashpots over that of springs, for the strain of this step [-].
void find_force(const Zones& zones, MovingZones& moving, Index z, const std::vector<Vector2d>& place,
                double viscosity, ZoneSums& sums);

// Sets the part of one zone's corner forces that its dashpots have, in the order of MovingZones::corner_force [N/m]; after
// find_force() with these places.
void take_corner_forces_of_dashpots(const Zones& zones, const MovingZones& moving, Index z,
                                    const std::vector<Vector2d>& place, std::vector<Vector2d>& corner_force);

// Writes Cauchy's stress and the plastic strain of one zone to `zones`.
void put_back(const MovingZones& moving, Index z, const std::vector<Vector2d>& place, Zones& zones);

// State for checkpoints: all that moving_zones_of() and find_force() cannot compute again.
void transfer(const Transfer& to, MovingZones& moving, DynamicsState& kept);

// What steps change.
void pass(Tape& tape, MovingZones& moving);

} // namespace jointcreep::rock
