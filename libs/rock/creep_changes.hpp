// Derivatives of creep of rock (rock/creep.hpp) by a factor, by the formulas with which creep follows stresses. Changes
// are of the first order, per unit of the factor's logarithm.

#pragma once

#include "rock/creep.hpp"
#include "rock/zone_changes.hpp"

namespace jointcreep::rock
{

// What the chains change by: nothing, but they have as many units.
std::vector<Chain> chain_changes(const CreepingZones& creeping, Scaled scaled);

class CreepingZoneChanges
{
public:
    CreepingZoneChanges() = default; // before anything creeps
    // After the constructor of CreepingZones.
    CreepingZoneChanges(const CreepingZones& creeping, const ZoneChanges& zones);

    // Changes of the creep's begin() and end(). Call both after its begin() and the equilibrium at the step's end, and
    // before its end(). Between the two calls `changes` take the response.
    void begin(const CreepingZones& creeping, const creep::StepChanges& steps, const Zones& zones,
               ZoneChanges& changes);
    void end(const CreepingZones& creeping, const creep::StepChanges& steps, const Zones& zones,
             ZoneChanges& changes);

private:
    // Shears and their units: stresses as in CreepingZones::Shear [Pa], and creep strains [-].
    std::vector<Vector3d> reference_, before_, crept_;
};

} // namespace jointcreep::rock
