#include "joint/creep.hpp"

#include "joint/chain.hpp"
#include "joint/equivalent.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace jointcreep::joint
{

CreepingContacts::CreepingContacts(const Contacts& contacts, const Scene& /*scene*/,
                                   const Network& /*network*/, const EquivalentJoints& joints,
                                   const Mesh& mesh)
{
    std::map<Index, std::array<Index, 2>> of_edge; // chains
    std::size_t units = 0;
    for (std::size_t c = 0; c < mesh.contact_edge.size(); ++c) {
        const auto [found, is_new] = of_edge.try_emplace(mesh.contact_edge[c]);
        for (int i = 0; i < 2; ++i) {
            if (is_new)
                found->second[i] = creep::number_of(chain_of(joints, mesh.contact_edge[c], i), chains_);
            const Index chain = found->second[i];
            if (chain < 0)
                continue;
            springs_.push_back({static_cast<Index>(c), i, chain, units, contacts.traction[c][i]});
            units += chains_[chain].units.size();
        }
    }
    crept_.assign(units, 0.0);
}

creep::StepLimit CreepingContacts::longest_stable_step(const Scene& scene, const Network& network,
                                                       const EquivalentJoints& joints)
{
    creep::StepLimit limit;
    for (std::size_t e = 0; e < joints.normal_stiffness.size(); ++e)
        for (const int direction : {0, 1})
            creep::lower(limit, chain_of(joints, e, direction), [&] {
                return "joint \"" + joint_name(scene, network, static_cast<Index>(e)) + "\"";
            });
    return limit;
}

void CreepingContacts::set(Contacts& contacts, const Spring& spring, double stiffness, double offset)
{
    Law& law = contacts.law[spring.contact];
    (spring.direction == 0 ? k_n(law) : k_s(law)) = stiffness;
    contacts.offset[spring.contact][spring.direction] = offset;
}

double CreepingContacts::crept(const Spring& spring) const
{
    double sum = 0;
    for (std::size_t u = 0; u < chains_[spring.chain].units.size(); ++u)
        sum += crept_[spring.first_unit + u];
    return sum;
}

void CreepingContacts::begin(Contacts& contacts, CreepScheme scheme, double duration)
{
    steps_ = creep::steps_of(chains_, scheme, duration);
    for (Spring& spring : springs_) {
        if (contacts.status[spring.contact] == ContactStatus::removed)
            continue;
        if (!is_under_way_)
            spring.before = contacts.traction[spring.contact][spring.direction] - spring.reference;
        const creep::StepWeights& step = steps_[spring.chain];
        // Where a contact is open in situ its spring would carry `initial`, not the reference, 0.
        const double initial = contacts.initial_traction[spring.contact][spring.direction];
        spring.offset = step.compliance * (initial - spring.reference);
        for (std::size_t u = 0; u < step.units.size(); ++u)
            spring.offset +=
                step.units[u].decay * crept_[spring.first_unit + u] + step.units[u].first * spring.before;
        set(contacts, spring, step.acting_stiffness, spring.offset);
    }
    is_under_way_ = true;
}

double CreepingContacts::end(Contacts& contacts)
{
    double error = 0;
    for (const Spring& spring : springs_) {
        if (contacts.status[spring.contact] == ContactStatus::removed)
            continue;
        const creep::StepWeights& step = steps_[spring.chain];
        const double after = contacts.traction[spring.contact][spring.direction] - spring.reference;
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            double& displacement = crept_[spring.first_unit + u];
            displacement = step.units[u].decay * displacement + step.units[u].first * spring.before +
                           step.units[u].last * after;
        }
        error = std::max(error, step.doubt * std::abs(after - spring.before));
    }
    cancel(contacts);
    return error;
}

void CreepingContacts::cancel(Contacts& contacts)
{
    for (const Spring& spring : springs_)
        set(contacts, spring, chains_[spring.chain].spring, crept(spring));
    is_under_way_ = false;
}

void CreepingContacts::transfer(const Transfer& to, Checkpoint& kept)
{
    // The scene has the rest, and begin() computes again what else springs need.
    to.values(springs_, kept.reference, &Spring::reference);
    to.values(crept_, kept.crept);
}

} // namespace jointcreep::joint
