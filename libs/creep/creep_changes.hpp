// What creep changes by, to first order, when a parameter does: the derivatives of creep/creep.hpp, by the formulas that let
// it follow tractions and stresses. Changes are per unit of the logarithm of the parameter, which is a factor.

#pragma once

#include "creep/creep.hpp"
#include "joint/contact_changes.hpp"
#include "rock/zone_changes.hpp"

namespace jointcreep::creep
{

// The weights of a step for each chain of a Creep, and what they change by.
struct StepChanges {
    std::vector<Step> step;
    std::vector<Chain> chain_change; // where it is a joint's; those of rock stay
    std::vector<Step> joint_change;
    std::vector<Step> rock_change; // by the duration only
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

    // What Creep::begin() and Creep::end() change by. Both come after Creep::begin() and the equilibrium at the step's end,
    // and before Creep::end(); between them, `contacts` and `zones` take the response.
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

    // Of springs and of their units: what Creep::Spring has of these names [Pa], and creep displacements [m].
    std::vector<double> reference_, before_, crept_;
    // Of shears and of their units: what Creep::Shear has of these names [Pa], and creep strains [-].
    std::vector<Vector3d> reference_stress_, before_stress_, crept_strain_;
};

} // namespace jointcreep::creep
