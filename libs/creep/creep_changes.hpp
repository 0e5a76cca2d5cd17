// Derivatives of creep (creep/creep.hpp) by a parameter, by the formulas with which creep follows tractions and
// stresses. A parameter is a factor. Changes are of the first order, per unit of its logarithm.

#pragma once

#include "creep/creep.hpp"
#include "joint/contact_changes.hpp"
#include "rock/zone_changes.hpp"

namespace jointcreep::creep
{

// The weights of a step for each chain of a Creep, and their changes.
struct StepChanges {
    std::vector<StepWeights> step;
    std::vector<Chain> chain_change; // for chains of joints; those of rock do not change
    std::vector<StepWeights> joint_change;
    std::vector<StepWeights> rock_change; // by the duration only
};
// For joints whose chains change by `chain_change`, and a duration [s] that changes by `duration_change` [s].
StepChanges step_changes(const Creep& creep, std::vector<Chain> chain_change, double duration,
                         double duration_change);

class CreepChanges
{
public:
    CreepChanges() = default; // before anything creeps
    // After the constructor of Creep.
    CreepChanges(const Creep& creep, const joint::ContactChanges& contacts, const rock::ZoneChanges& zones);

    // Changes of Creep::begin() and Creep::end(). Call both after Creep::begin() and the equilibrium at the step's end,
    // and before Creep::end(). Between the two calls `contacts` and `zones` take the response.
    void begin(const Creep& creep, const StepChanges& steps, const mechanics::Assembly& assembly,
               joint::ContactChanges& contacts, rock::ZoneChanges& zones);
    void end(const Creep& creep, const StepChanges& steps, const mechanics::Assembly& assembly,
             joint::ContactChanges& contacts, rock::ZoneChanges& zones);

private:
    using Vector3d = Eigen::Vector3d;

    void begin_springs(const Creep& creep, const StepChanges& steps, const joint::Contacts& contacts,
                       joint::ContactChanges& changes);
    void begin_shears(const Creep& creep, const StepChanges& steps, const rock::Zones& zones,
                      rock::ZoneChanges& changes);
    void end_springs(const Creep& creep, const StepChanges& steps, const joint::Contacts& contacts,
                     joint::ContactChanges& changes);
    void end_shears(const Creep& creep, const StepChanges& steps, const rock::Zones& zones,
                    rock::ZoneChanges& changes);

    // Springs and their units: stiffnesses as in Creep::Spring [Pa], and creep displacements [m].
    std::vector<double> reference_, before_, crept_;
    // Shears and their units: moduli as in Creep::Shear [Pa], and creep strains [-].
    std::vector<Vector3d> reference_stress_, before_stress_, crept_strain_;
};

} // namespace jointcreep::creep
