#include "sensitivity/sensitivity.hpp"

#include "joint/spring_factors.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

namespace jointcreep::sensitivity
{

using mechanics::Assembly;

void scale(EquivalentJoints& joints, InSituStress& stress, Scaled scaled, double factor)
{
    if (scaled.quantity == Scaled::horizontal_stress)
        stress.multiply_horizontal(factor);
    else
        joint::multiply(joints, scaled, factor);
}

Sensitivity::Sensitivity(std::vector<Scaled> parameters, const Scene& scene, const Mesh& mesh,
                         const Assembly& assembly)
    : parameters_(std::move(parameters))
{
    for_each_force(
        [&](const auto& force, auto& its_start) {
            check_sensitivities(force, scene);
            its_start = state_of(force);
        },
        assembly, start_);
    const std::size_t n = assembly.contacts.law.size();
    const std::vector<Vector2d> no_gridpoints(assembly.position.size(), Vector2d::Zero());
    for (const Scaled parameter : parameters_) {
        Change& change = changes_.emplace_back();
        change.displacement = change.released = no_gridpoints;
        for_each_force([&](const auto& force,
                           auto& its_change) { its_change = changed_by(force, parameter, scene, mesh); },
                       assembly, change.forces);
        change.opening.assign(n, 0.0);
        change.rate.assign(n, 0.0);
    }
}

std::vector<Vector2d> Sensitivity::forces(const Assembly& assembly, const Change& change)
{
    std::vector<Vector2d> all(assembly.position.size(), Vector2d::Zero());
    for_each_force([&](const auto& force, const auto& its_change) { add_forces(force, its_change, all); },
                   assembly, change.forces);
    give_forces_to_leaders(assembly, all);
    return all;
}

std::vector<Vector2d> Sensitivity::forces_at_fixed_gridpoints(const Assembly& assembly,
                                                              const Change& change) const
{
    std::vector<Vector2d> all(assembly.position.size(), Vector2d::Zero());
    for_each_force(
        [&](const auto& force, const auto& its_change, const auto& its_start) {
            add_forces_at_fixed_gridpoints(force, its_change, its_start, assembly.displacement, all);
        },
        assembly, change.forces, start_);
    give_forces_to_leaders(assembly, all);
    return all;
}

void Sensitivity::settle(const Assembly& assembly, implicit::Solver& engine, double time, double held)
{
    mechanics::Tangents tangents;
    for_each_force([](const auto& force, const auto& its_start,
                      auto& its_tangents) { its_tangents = tangents_of_responses(force, its_start); },
                   assembly, start_, tangents);
    for (Change& change : changes_) {
        std::vector<Vector2d> force = forces_at_fixed_gridpoints(assembly, change);
        if (held > 0)
            for (std::size_t g = 0; g < force.size(); ++g)
                force[g] += held * change.released[g];
        const implicit::Stiffness& stiffness = engine.stiffness();
        const implicit::VectorXd x =
            engine.solve_linear(assembly, tangents, stiffness.gathered(assembly, force));
        if (x.size() != stiffness.size())
            throw equilibrium_error("no sensitivities on day " + rounded(time / unit::day, 7) +
                                    ": some rock is held by slipping joints only");
        change.displacement.assign(force.size(), Vector2d::Zero());
        stiffness.add_to(change.displacement, x, 1);
        for_each_force(
            [&](const auto& force_of, const auto& its_start, auto& its_change) {
                take_response(force_of, its_start, assembly.displacement, change.displacement, its_change);
            },
            assembly, start_, change.forces);
    }
    for_each_force([](const auto& force, auto& its_start) { its_start = state_of(force); }, assembly, start_);
}

void Sensitivity::start_from_here(const Assembly& assembly)
{
    for (Change& change : changes_) {
        for_each_force(
            [&](const auto& force, auto& its_start, auto& its_change) {
                start_changes_from_here(force, change.displacement, its_change, its_start);
            },
            assembly, start_, change.forces);
        change.displacement.assign(change.displacement.size(), Vector2d::Zero());
    }
}

void Sensitivity::start_creep(const mechanics::Creep& creep)
{
    for (Change& change : changes_)
        for_each_force(
            [](const auto& creeping, const auto& its_change, auto& of_creep) {
                of_creep = {creeping, its_change};
            },
            creep.forces(), change.forces, change.creep);
}

void Sensitivity::creep_step(const mechanics::Creep& creep, double duration, const Assembly& assembly,
                             implicit::Solver& engine, double time)
{
    std::vector<mechanics::OfEachForce<creep::StepChanges>> steps(changes_.size());
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        Change& change = changes_[p];
        for_each_force(
            [&](const auto& creeping, const auto& force, auto& its_steps, auto& of_creep, auto& its_change) {
                its_steps = creep::step_changes(creeping.chains(), chain_changes(creeping, parameters_[p]),
                                                creep.scheme(), duration, change.duration);
                of_creep.begin(creeping, its_steps, force, its_change);
            },
            creep.forces(), assembly, steps[p], change.creep, change.forces);
    }
    settle(assembly, engine, time);
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        Change& change = changes_[p];
        find_openings(assembly, change); // with the stiffnesses of the step, as joint::Closing has them
        for_each_force([](const auto& creeping, const auto& force, const auto& its_steps, auto& of_creep,
                          auto& its_change) { of_creep.end(creeping, its_steps, force, its_change); },
                       creep.forces(), assembly, steps[p], change.creep, change.forces);
    }
}

double Sensitivity::opening(const Assembly& assembly, const Change& change, std::size_t c)
{
    return change_of_opening(assembly.contacts, change.forces.contacts, change.displacement, c);
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

void Sensitivity::cut(const joint::Closing::Cut& cut, const mechanics::Creep& creep, double duration,
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

void Sensitivity::finish_step(const joint::Closing& closing, double duration, bool is_whole,
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
