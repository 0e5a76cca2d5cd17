#include "joint/creep_changes.hpp"

namespace jointcreep::joint
{

namespace
{

using creep::AtStart;
using creep::StepWeights;

bool is_removed(const Contacts& contacts, const CreepingContacts::Spring& spring)
{
    return contacts.status[spring.contact] == ContactStatus::removed;
}

} // namespace

std::vector<Chain> chain_changes(const CreepingContacts& creeping, Scaled scaled)
{
    std::vector<Chain> changes;
    for (const Chain& chain : creeping.chains()) {
        const bool its = scaled.is_of(chain.constants % 2, chain.constants / 2),
                   all = its && scaled.quantity == Scaled::joint_stiffness,
                   stiffness = all || (its && scaled.quantity == Scaled::kelvin_stiffness),
                   viscosity = all || (its && scaled.quantity == Scaled::kelvin_viscosity);
        Chain& change = changes.emplace_back(Chain{all ? chain.spring : 0.0, {}});
        for (const KelvinUnit& unit : chain.units)
            change.units.push_back({stiffness ? unit.stiffness : 0.0, viscosity ? unit.viscosity : 0.0});
    }
    return changes;
}

CreepingContactChanges::CreepingContactChanges(const CreepingContacts& creeping,
                                               const ContactChanges& contacts)
    : before_(creeping.springs().size(), 0.0), crept_(creeping.crept().size(), 0.0)
{
    for (const CreepingContacts::Spring& spring : creeping.springs())
        reference_.push_back(contacts.traction[spring.contact][spring.direction]);
}

// The stiffnesses and offsets that contacts act with during the step.
void CreepingContactChanges::begin(const CreepingContacts& creeping, const creep::StepChanges& steps,
                                   const Contacts& contacts, ContactChanges& changes)
{
    for (std::size_t s = 0; s < creeping.springs().size(); ++s) {
        const CreepingContacts::Spring& spring = creeping.springs()[s];
        if (is_removed(contacts, spring))
            continue;
        const StepWeights &step = steps.step[spring.chain], &by = steps.step_change[spring.chain];
        const Index c = spring.contact;
        const int i = spring.direction;
        before_[s] = changes.traction[c][i] - reference_[s];
        double offset = by.compliance * (contacts.initial_traction[c][i] - spring.reference) +
                        step.compliance * (changes.initial_traction[c][i] - reference_[s]);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = spring.first_unit + u;
            const AtStart<double> start{creeping.crept()[unit], spring.before},
                start_change{crept_[unit], before_[s]};
            offset += change_by_start(by.units[u], start, step.units[u], start_change);
        }
        changes.stiffness[c][i] = by.acting_stiffness;
        changes.offset[c][i] = offset;
    }
}

// Creep is updated. Contacts have their own stiffnesses again, with the creep displacement so far as offset.
void CreepingContactChanges::end(const CreepingContacts& creeping, const creep::StepChanges& steps,
                                 const Contacts& contacts, ContactChanges& changes)
{
    for (std::size_t s = 0; s < creeping.springs().size(); ++s) {
        const CreepingContacts::Spring& spring = creeping.springs()[s];
        const StepWeights &step = steps.step[spring.chain], &by = steps.step_change[spring.chain];
        const Index c = spring.contact;
        const int i = spring.direction;
        const double after = contacts.traction[c][i] - spring.reference,
                     after_change = changes.traction[c][i] - reference_[s];
        double offset = 0;
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            const std::size_t unit = spring.first_unit + u;
            const AtStart<double> start{creeping.crept()[unit], spring.before},
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

} // namespace jointcreep::joint
