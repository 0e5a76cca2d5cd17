#include "creep/creep_changes.hpp"

#include "rock/elasticity.hpp"

#include <algorithm>

namespace jointcreep::creep
{

namespace
{

// A unit at the start of a step (creep/scheme.hpp): its displacement d_0 or strain, and the force F_0 on it.
template <class Value>
struct AtStart {
    Value d, F;
};

// Change of a d_0 + c_0 F_0 by the product rule: weights times changed values, plus changed weights times values.
template <class Value>
Value change_by_start(const StepWeights::OfUnit& one, const AtStart<Value>& of_one,
                      const StepWeights::OfUnit& other, const AtStart<Value>& of_other)
{
    return one.decay * of_one.d + other.decay * of_other.d + one.first * of_one.F + other.first * of_other.F;
}

// The chain with zero changes, of the same units.
Chain no_change(Chain chain)
{
    std::fill(chain.units.begin(), chain.units.end(), KelvinUnit{0, 0});
    return {0, chain.units};
}

bool is_removed(const joint::Contacts& contacts, const Creep::Spring& spring)
{
    return contacts.status[spring.contact] == ContactStatus::removed;
}

} // namespace

StepChanges step_changes(const Creep& creep, std::vector<Chain> chain_change, double duration,
                         double duration_change)
{
    StepChanges changes;
    const CreepScheme scheme = creep.scheme();
    for (std::size_t i = 0; i < creep.chains().size(); ++i) {
        const Chain& chain = creep.chains()[i];
        changes.step.push_back(step_of(chain, scheme, duration));
        changes.joint_change.push_back(
            change_of_step(chain, chain_change[i], scheme, duration, duration_change));
        changes.rock_change.push_back(
            change_of_step(chain, no_change(chain), scheme, duration, duration_change));
    }
    changes.chain_change = std::move(chain_change);
    return changes;
}

CreepChanges::CreepChanges(const Creep& creep, const joint::ContactChanges& contacts,
                           const rock::ZoneChanges& zones)
    : before_(creep.springs().size(), 0.0), crept_(creep.crept_displacement().size(), 0.0),
      before_stress_(creep.shears().size(), Vector3d::Zero()),
      crept_strain_(creep.crept_strain().size(), Vector3d::Zero())
{
    for (const Creep::Spring& spring : creep.springs())
        reference_.push_back(contacts.traction[spring.contact][spring.direction]);
    for (const Creep::Shear& shear : creep.shears())
        reference_stress_.push_back(zones.initial_stress[shear.zone]);
}

void CreepChanges::begin(const Creep& creep, const StepChanges& steps, const mechanics::Assembly& assembly,
                         joint::ContactChanges& contacts, rock::ZoneChanges& zones)
{
    begin_springs(creep, steps, assembly.contacts, contacts);
    begin_shears(creep, steps, assembly.zones, zones);
}

void CreepChanges::end(const Creep& creep, const StepChanges& steps, const mechanics::Assembly& assembly,
                       joint::ContactChanges& contacts, rock::ZoneChanges& zones)
{
    end_springs(creep, steps, assembly.contacts, contacts);
    end_shears(creep, steps, assembly.zones, zones);
}

// The stiffnesses and offsets that contacts act with during the step.
void CreepChanges::begin_springs(const Creep& creep, const StepChanges& steps,
                                 const joint::Contacts& contacts, joint::ContactChanges& changes)
{
    for (std::size_t s = 0; s < creep.springs().size(); ++s) {
        const Creep::Spring& spring = creep.springs()[s];
        if (is_removed(contacts, spring))
            continue;
        const StepWeights &step = steps.step[spring.chain], &by = steps.joint_change[spring.chain];
        const Index c = spring.contact;
        const int i = spring.direction;
        before_[s] = changes.traction[c][i] - reference_[s];
        double offset = by.compliance * (contacts.initial_traction[c][i] - spring.reference) +
                        step.compliance * (changes.initial_traction[c][i] - reference_[s]);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = spring.first_unit + u;
            const AtStart<double> start{creep.crept_displacement()[unit], spring.before},
                start_change{crept_[unit], before_[s]};
            offset += change_by_start(by.units[u], start, step.units[u], start_change);
        }
        changes.stiffness[c][i] = by.acting_stiffness;
        changes.offset[c][i] = offset;
    }
}

// The shear moduli and offsets that zones act with during the step.
void CreepChanges::begin_shears(const Creep& creep, const StepChanges& steps, const rock::Zones& zones,
                                rock::ZoneChanges& changes)
{
    for (std::size_t s = 0; s < creep.shears().size(); ++s) {
        const Creep::Shear& shear = creep.shears()[s];
        if (!zones.is_present[shear.zone])
            continue;
        const StepWeights &step = steps.step[shear.chain], &by = steps.rock_change[shear.chain];
        Vector3d crept(0, 0, 0), offset(0, 0, 0);
        for (std::size_t u = 0; u < step.units.size(); ++u)
            crept += crept_strain_[shear.first_unit + u];
        before_stress_[s] = rock::deviatoric(shear.bulk_modulus, creep.chains()[shear.chain].spring / 2,
                                             crept, changes.stress[shear.zone] - reference_stress_[s]);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = shear.first_unit + u;
            const AtStart<Vector3d> start{creep.crept_strain()[unit], shear.before},
                start_change{crept_strain_[unit], before_stress_[s]};
            offset += change_by_start(step.units[u], start_change, by.units[u], start);
        }
        changes.shear_modulus[shear.zone] = by.acting_stiffness / 2;
        changes.initial_stress[shear.zone] =
            reference_stress_[s] - step.acting_stiffness * offset - by.acting_stiffness * shear.offset;
    }
}

// Creep is updated. Contacts have their own stiffnesses again, with the creep displacement so far as offset.
void CreepChanges::end_springs(const Creep& creep, const StepChanges& steps, const joint::Contacts& contacts,
                               joint::ContactChanges& changes)
{
    for (std::size_t s = 0; s < creep.springs().size(); ++s) {
        const Creep::Spring& spring = creep.springs()[s];
        const StepWeights &step = steps.step[spring.chain], &by = steps.joint_change[spring.chain];
        const Index c = spring.contact;
        const int i = spring.direction;
        const double after = contacts.traction[c][i] - spring.reference,
                     after_change = changes.traction[c][i] - reference_[s];
        double offset = 0;
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = spring.first_unit + u;
            const AtStart<double> start{creep.crept_displacement()[unit], spring.before},
                start_change{crept_[unit], before_[s]};
            if (!is_removed(contacts, spring))
                crept_[unit] = change_by_start(by.units[u], start, step.units[u], start_change) +
                               by.units[u].last * after + step.units[u].last * after_change;
            offset += crept_[unit];
        }
        changes.stiffness[c][i] = steps.chain_change[spring.chain].spring;
        changes.offset[c][i] = offset;
    }
}

// Creep is updated. Zones have their own shear moduli again, with the creep strain so far as offset.
void CreepChanges::end_shears(const Creep& creep, const StepChanges& steps, const rock::Zones& zones,
                              rock::ZoneChanges& changes)
{
    for (std::size_t s = 0; s < creep.shears().size(); ++s) {
        const Creep::Shear& shear = creep.shears()[s];
        const Index z = shear.zone;
        if (!zones.is_present[z])
            continue;
        const StepWeights &step = steps.step[shear.chain], &by = steps.rock_change[shear.chain];
        const double modulus = step.acting_stiffness / 2, modulus_change = by.acting_stiffness / 2;
        const Vector3d now = zones.stress[z] - shear.reference,
                       now_change = changes.stress[z] - reference_stress_[s];
        // initial stress = reference - 2 G_t offset
        const Vector3d offset_change =
            (reference_stress_[s] - changes.initial_stress[z] - 2 * modulus_change * shear.offset) /
            (2 * modulus);
        const Vector3d after = rock::deviatoric(shear.bulk_modulus, modulus, shear.offset, now),
                       after_change =
                           rock::change_of_deviatoric(shear.bulk_modulus, modulus, modulus_change,
                                                      shear.offset, offset_change, now, now_change);
        Vector3d crept(0, 0, 0);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = shear.first_unit + u;
            const AtStart<Vector3d> start{creep.crept_strain()[unit], shear.before},
                start_change{crept_strain_[unit], before_stress_[s]};
            crept_strain_[unit] = change_by_start(step.units[u], start_change, by.units[u], start) +
                                  step.units[u].last * after_change + by.units[u].last * after;
            crept += crept_strain_[unit];
        }
        changes.shear_modulus[z] = 0;
        changes.initial_stress[z] = reference_stress_[s] - creep.chains()[shear.chain].spring * crept;
    }
}

} // namespace jointcreep::creep
