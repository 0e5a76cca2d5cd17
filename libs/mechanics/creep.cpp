#include "mechanics/creep.hpp"

#include <algorithm>

namespace jointcreep::mechanics
{

Creep::Creep(const Scene& scene, const Network& network, const EquivalentJoints& joints, const Mesh& mesh,
             const Assembly& assembly)
{
    if (!scene.creep)
        return;
    scheme_ = scene.creep->scheme;
    for_each_force(
        [&](const auto& force, auto& creeping) {
            creeping = {force, scene, network, joints, mesh};
        },
        assembly, forces_);
}

bool Creep::anything_creeps() const
{
    bool any = false;
    for_each_force([&](const auto& creeping) { any = any || creeping.creeps(); }, forces_);
    return any;
}

double Creep::fastest_rate() const
{
    double fastest = 0;
    for_each_force(
        [&](const auto& creeping) { fastest = std::max(fastest, creep::fastest_rate(creeping.chains())); },
        forces_);
    return fastest;
}

void Creep::begin(double duration, Assembly& assembly, bool loads_change)
{
    scheme_of_step_ = creep::scheme_of_step(scheme_, loads_change);
    for_each_force([&](auto& creeping, auto& force) { creeping.begin(force, scheme_of_step_, duration); },
                   forces_, assembly);
}

double Creep::end(Assembly& assembly)
{
    double error = 0;
    for_each_force([&](auto& creeping, auto& force) { error = std::max(error, creeping.end(force)); },
                   forces_, assembly);
    return error;
}

void Creep::cancel(Assembly& assembly)
{
    for_each_force([](auto& creeping, auto& force) { creeping.cancel(force); }, forces_, assembly);
}

void Creep::transfer(const Transfer& to, Checkpoint& kept)
{
    for_each_force([&](auto& creeping) { creeping.transfer(to, kept); }, forces_);
}

creep::StepLimit longest_stable_step(const Scene& scene, const Network& network,
                                     const EquivalentJoints& joints)
{
    creep::StepLimit limit;
    for_each_force(
        [&]<class Creeping>(const Creeping&) {
            const creep::StepLimit its = Creeping::longest_stable_step(scene, network, joints);
            if (its.step < limit.step)
                limit = its;
        },
        CreepingForces{});
    return limit;
}

} // namespace jointcreep::mechanics
