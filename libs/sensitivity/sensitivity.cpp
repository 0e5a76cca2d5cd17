#include "sensitivity/sensitivity.hpp"

#include "joint/spring_factors.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

namespace jointcreep::sensitivity
{

using mechanics::Assembly;

namespace
{

joint::ContactChanges changes_of(const joint::Contacts& contacts, Parameter parameter, const Scene& scene,
                                 const Mesh& mesh)
{
    switch (parameter) {
    case Parameter::joint_stiffness:
        return changed_by_stiffness(contacts);
    case Parameter::horizontal_stress:
        return changed_by_horizontal_stress(contacts, scene.in_situ_stress, mesh);
    case Parameter::kelvin_stiffness:
    case Parameter::kelvin_viscosity:
        break;
    }
    return unchanged(contacts);
}

rock::ZoneChanges changes_of(const rock::Zones& zones, Parameter parameter)
{
    return parameter == Parameter::horizontal_stress ? changed_by_horizontal_stress(zones) : unchanged(zones);
}

// Of chains of joints.
std::vector<Chain> changes_of(const std::vector<Chain>& chains, Parameter parameter)
{
    const bool all = parameter == Parameter::joint_stiffness;
    std::vector<Chain> changes;
    for (const Chain& chain : chains) {
        Chain& change = changes.emplace_back(Chain{all ? chain.spring : 0.0, {}});
        for (const KelvinUnit& unit : chain.units)
            change.units.push_back({all || parameter == Parameter::kelvin_stiffness ? unit.stiffness : 0.0,
                                    all || parameter == Parameter::kelvin_viscosity ? unit.viscosity : 0.0});
    }
    return changes;
}

void take_ties(const Assembly& assembly, std::vector<Vector2d>& force)
{
    for (const auto& [follower, leader] : assembly.tied) {
        force[leader] += force[follower];
        force[follower].setZero();
    }
}

} // namespace

void scale(EquivalentJoints& joints, InSituStress& stress, Parameter parameter, double factor)
{
    switch (parameter) {
    case Parameter::joint_stiffness:
        return joint::multiply_stiffness(joints, factor);
    case Parameter::kelvin_stiffness:
        return joint::multiply_kelvin_stiffness(joints, factor);
    case Parameter::kelvin_viscosity:
        return joint::multiply_viscosity(joints, factor);
    case Parameter::horizontal_stress:
        return stress.multiply_horizontal(factor);
    }
}

Sensitivity::Sensitivity(std::vector<Parameter> parameters, const Scene& scene, const Mesh& mesh,
                         const Assembly& assembly)
    : parameters_(std::move(parameters))
{
    check_sensitivities(assembly.contacts);
    const std::size_t n = assembly.contacts.law.size();
    start_.assign(n, {});
    const std::vector<Vector2d> no_gridpoints(assembly.position.size(), Vector2d::Zero());
    for (const Parameter parameter : parameters_)
        changes_.push_back({.displacement = no_gridpoints,
                            .released = no_gridpoints,
                            .contacts = changes_of(assembly.contacts, parameter, scene, mesh),
                            .zones = changes_of(assembly.zones, parameter),
                            .creep = {},
                            .opening_before = {},
                            .opening = std::vector<double>(n, 0.0),
                            .rate = std::vector<double>(n, 0.0)});
}

std::vector<Vector2d> Sensitivity::forces(const Assembly& assembly, const Change& change)
{
    std::vector<Vector2d> force(assembly.position.size(), Vector2d::Zero());
    add_forces(assembly.zones, change.zones.stress, force);
    add_forces(assembly.contacts, change.contacts.traction, force);
    take_ties(assembly, force);
    return force;
}

std::vector<Vector2d> Sensitivity::forces_at_fixed_gridpoints(const Assembly& assembly,
                                                              const Change& change) const
{
    std::vector<Vector2d> force(assembly.position.size(), Vector2d::Zero());
    add_forces(assembly.zones,
               stresses_at_fixed_gridpoints(assembly.zones, change.zones, assembly.displacement), force);
    add_forces(assembly.contacts, tractions_at_fixed_gridpoints(assembly.contacts, change.contacts, start_),
               force);
    take_ties(assembly, force);
    return force;
}

void Sensitivity::settle(const Assembly& assembly, implicit::Solver& engine, double time, double held)
{
    const mechanics::Tangents tangents{.contacts = tangents_of_responses(assembly.contacts, start_)};
    for (Change& change : changes_) {
        std::vector<Vector2d> force = forces_at_fixed_gridpoints(assembly, change);
        if (held > 0)
            for (std::size_t g = 0; g < force.size(); ++g)
                force[g] += held * change.released[g];
        const implicit::Stiffness& stiffness = engine.stiffness();
        const implicit::VectorXd x =
            engine.solve_linear(assembly, tangents, stiffness.gathered(assembly, force));
        if (x.size() != stiffness.size())
            throw equilibrium_error("no sensitivities on day " + shown(time / unit::day) +
                                    ": some rock is held by slipping joints only");
        change.displacement.assign(force.size(), Vector2d::Zero());
        stiffness.add_to(change.displacement, x, 1);
        take_response(assembly.contacts, start_, change.displacement, change.contacts);
        take_response(assembly.zones, assembly.displacement, change.displacement, change.zones);
    }
    start_ = assembly.contacts.state;
}

void Sensitivity::start_from_here(const Assembly& assembly)
{
    for (Change& change : changes_) {
        joint::start_from_here(assembly.contacts, change.displacement, change.contacts);
        rock::start_from_here(change.zones);
        change.displacement.assign(change.displacement.size(), Vector2d::Zero());
    }
    joint::forget_slip(start_);
}

void Sensitivity::start_creep(const creep::Creep& creep)
{
    for (Change& change : changes_)
        change.creep = creep::CreepChanges(creep, change.contacts, change.zones);
}

void Sensitivity::creep_step(const creep::Creep& creep, double duration, const Assembly& assembly,
                             implicit::Solver& engine, double time)
{
    std::vector<creep::StepChanges> steps;
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        Change& change = changes_[p];
        steps.push_back(
            step_changes(creep, changes_of(creep.chains(), parameters_[p]), duration, change.duration));
        change.creep.begin(creep, steps[p], assembly, change.contacts, change.zones);
    }
    settle(assembly, engine, time);
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        Change& change = changes_[p];
        find_openings(assembly, change); // with the stiffnesses of the step, as creep::Closing has them
        change.creep.end(creep, steps[p], assembly, change.contacts, change.zones);
    }
}

double Sensitivity::opening(const Assembly& assembly, const Change& change, std::size_t c)
{
    return change_of_opening(assembly.contacts, change.contacts, change.displacement, c);
}

void Sensitivity::find_openings(const Assembly& assembly, Change& change)
{
    for (std::size_t c = 0; c < change.opening.size(); ++c)
        change.opening[c] = opening(assembly, change, c);
}

void Sensitivity::start_step(const Assembly& assembly)
{
    for (Change& change : changes_) {
        find_openings(assembly, change);
        change.opening_before = change.opening;
        change.duration = -change.now; // up to a time that no parameter changes
    }
}

void Sensitivity::shorten(double share)
{
    for (Change& change : changes_)
        change.duration *= share;
}

void Sensitivity::cut(const creep::Closing::Cut& cut, const creep::Creep& creep, double duration,
                      const Assembly& assembly, implicit::Solver& engine, double time)
{
    if (cut.is_by_rate) {
        for (Change& change : changes_)
            change.duration =
                cut.share / cut.rate *
                (cut.opening / cut.rate * change.rate[cut.contact] - change.opening_before[cut.contact]);
        return;
    }
    Sensitivity trial = *this;
    trial.creep_step(creep, duration, assembly, engine, time);
    const double way = cut.opening - cut.closed;
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        const double opening = changes_[p].opening_before[cut.contact],
                     closed = cut.closed < 0 ? trial.changes_[p].opening[cut.contact] : 0.0;
        changes_[p].duration = cut.share *
                               (changes_[p].duration * cut.opening +
                                duration * (cut.opening * closed - cut.closed * opening) / way) /
                               way;
    }
}

void Sensitivity::finish_step(const creep::Closing& closing, double duration, bool is_whole,
                              const Assembly& assembly)
{
    for (Change& change : changes_) {
        for (std::size_t c = 0; c < change.opening.size(); ++c) {
            change.rate[c] = 0;
            if (closing.was_open(c) && assembly.contacts.status[c] == ContactStatus::open)
                change.rate[c] = (opening(assembly, change, c) - change.opening_before[c] -
                                  closing.rate(c) * change.duration) /
                                 duration;
        }
        change.now = is_whole ? 0.0 : change.now + change.duration;
        change.duration = 0;
    }
}

void Sensitivity::start_afresh()
{
    for (Change& change : changes_)
        change.rate.assign(change.rate.size(), 0.0);
}

void Sensitivity::before_excavation(const Assembly& assembly)
{
    for (Change& change : changes_)
        change.released = forces(assembly, change);
}

void Sensitivity::after_excavation(const Assembly& assembly)
{
    for (Change& change : changes_) {
        const std::vector<Vector2d> left = forces(assembly, change);
        for (std::size_t g = 0; g < left.size(); ++g)
            change.released[g] -= left[g];
    }
}

} // namespace jointcreep::sensitivity
