#include "rock/creep_changes.hpp"

#include "rock/elasticity.hpp"

#include <algorithm>

namespace jointcreep::rock
{

using creep::AtStart;
using creep::StepWeights;

std::vector<Chain> chain_changes(const CreepingZones& creeping, Scaled /*scaled*/)
{
    std::vector<Chain> changes = creeping.chains();
    for (Chain& change : changes) {
        change.spring = 0;
        std::fill(change.units.begin(), change.units.end(), KelvinUnit{0, 0});
    }
    return changes;
}

CreepingZoneChanges::CreepingZoneChanges(const CreepingZones& creeping, const ZoneChanges& zones)
    : before_(creeping.shears().size(), Vector3d::Zero()), crept_(creeping.crept().size(), Vector3d::Zero())
{
    for (const CreepingZones::Shear& shear : creeping.shears())
        reference_.push_back(zones.initial_stress[shear.zone]);
}

// The shear moduli and offsets that zones act with during the step.
void CreepingZoneChanges::begin(const CreepingZones& creeping, const creep::StepChanges& steps,
                                const Zones& zones, ZoneChanges& changes)
{
    for (std::size_t s = 0; s < creeping.shears().size(); ++s) {
        const CreepingZones::Shear& shear = creeping.shears()[s];
        if (!zones.is_present[shear.zone])
            continue;
        const StepWeights &step = steps.step[shear.chain], &by = steps.step_change[shear.chain];
        Vector3d crept(0, 0, 0), offset(0, 0, 0);
        for (std::size_t u = 0; u < step.units.size(); ++u)
            crept += crept_[shear.first_unit + u];
        before_[s] = deviatoric(shear.bulk_modulus, creeping.chains()[shear.chain].spring / 2, crept,
                                changes.stress[shear.zone] - reference_[s]);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = shear.first_unit + u;
            const AtStart<Vector3d> start{creeping.crept()[unit], shear.before},
                start_change{crept_[unit], before_[s]};
            offset += change_by_start(step.units[u], start_change, by.units[u], start);
        }
        changes.shear_modulus[shear.zone] = by.acting_stiffness / 2;
        changes.initial_stress[shear.zone] =
            reference_[s] - step.acting_stiffness * offset - by.acting_stiffness * shear.offset;
    }
}

// Creep is updated. Zones have their own shear moduli again, with the creep strain so far as offset.
void CreepingZoneChanges::end(const CreepingZones& creeping, const creep::StepChanges& steps,
                              const Zones& zones, ZoneChanges& changes)
{
    for (std::size_t s = 0; s < creeping.shears().size(); ++s) {
        const CreepingZones::Shear& shear = creeping.shears()[s];
        const Index z = shear.zone;
        if (!zones.is_present[z])
            continue;
        const StepWeights &step = steps.step[shear.chain], &by = steps.step_change[shear.chain];
        const double modulus = step.acting_stiffness / 2, modulus_change = by.acting_stiffness / 2;
        const Vector3d now = zones.stress[z] - shear.reference,
                       now_change = changes.stress[z] - reference_[s];
        // initial stress = reference - 2 G_t offset
        const Vector3d offset_change =
            (reference_[s] - changes.initial_stress[z] - 2 * modulus_change * shear.offset) / (2 * modulus);
        const Vector3d after = deviatoric(shear.bulk_modulus, modulus, shear.offset, now),
                       after_change = change_of_deviatoric(shear.bulk_modulus, modulus, modulus_change,
                                                           shear.offset, offset_change, now, now_change);
        Vector3d crept(0, 0, 0);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = shear.first_unit + u;
            const AtStart<Vector3d> start{creeping.crept()[unit], shear.before},
                start_change{crept_[unit], before_[s]};
            crept_[unit] = change_by_start(step.units[u], start_change, by.units[u], start) +
                           step.units[u].last * after_change + by.units[u].last * after;
            crept += crept_[unit];
        }
        changes.shear_modulus[z] = 0;
        changes.initial_stress[z] = reference_[s] - creeping.chains()[shear.chain].spring * crept;
    }
}

} // namespace jointcreep::rock
