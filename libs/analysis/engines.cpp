#include "analysis/engines.hpp"

#include "mechanics/failure.hpp"
#include "model/error.hpp"
#include "relaxation/relax.hpp"

namespace jointcreep::analysis
{

void Engines::settle(double time)
{
    if (!settles_nearby({}))
        settle_by_relaxation(time);
}

// First with all rock elastic, which is quicker. Where some is beyond its strength then, again from the start with rock
// that yields; the elastic equilibrium is the first guess.
bool Engines::settles_nearby(const std::vector<Vector2d>& guess)
{
    if (section_.engine == EngineChoice::relaxation)
        return false;
    mechanics::Assembly& assembly = section_.assembly;
    const auto find = [&](const std::vector<Vector2d>& from) {
        auto& [convergence, effort] = section_.settled;
        has_learnt_ = true;
        const auto found = implicit_.equilibrate(assembly, section_.scene.equilibrium, from);
        ++effort.searches;
        effort.factorisations += implicit_.factorisations();
        effort.solves += implicit_.solves();
        effort.steps += implicit_.corrections();
        if (found)
            convergence = *found;
        return found.has_value();
    };
    if (!yields(assembly))
        return find(guess);
    const mechanics::State start = state_of(assembly);
    for_each_force([](auto& one) { hold_yield(one, true); }, assembly);
    const bool found = find(guess);
    bool is_within = true;
    for_each_force(
        [&](auto& one) {
            hold_yield(one, false);
            is_within = is_within && is_within_strength(one);
        },
        assembly);
    if (found && is_within)
        return true;
    std::vector<Vector2d> elastic = assembly.displacement;
    for (std::size_t g = 0; g < elastic.size(); ++g)
        elastic[g] -= start.displacement[g];
    go_back(assembly, start);
    return find(found ? elastic : guess);
}

void Engines::settle_by_relaxation(double time)
{
    if (section_.engine != EngineChoice::relaxation && implicit_.collapse())
        fail(section_, failure_of(*implicit_.collapse(), section_.mesh(), section_.assembly), time);
    if (section_.engine == EngineChoice::implicit) {
        const mechanics::no_equilibrium error("none nearby: " + implicit_.reason() +
                                              " (--engine auto would continue by dynamic relaxation)");
        fail(section_, failure_of(error, section_.mesh(), section_.assembly), time);
    }
    if (section_.engine == EngineChoice::automatic)
        ++section_.findings.given_up[implicit_.reason()];
    ++section_.settled.effort.searches;
    try {
        section_.settled.convergence = relax(time);
    } catch (const mechanics::no_equilibrium& error) {
        fail(section_, failure_of(error, section_.mesh(), section_.assembly), time);
    }
    section_.settled.effort.steps += section_.settled.convergence.steps;
    forget();
}

mechanics::Convergence Engines::relax(double time)
{
    const Equilibrium& settings = section_.scene.equilibrium;
    if (!step_recorder_.is_wanted())
        return relaxation::relax(section_.assembly, settings, {}, section_.keeper, tell_);
    step_recorder_.begin(time);
    const auto convergence = relaxation::relax(
        section_.assembly, settings, [&](double since_begin) { step_recorder_.step(since_begin); },
        section_.keeper, tell_);
    step_recorder_.end();
    return convergence;
}

// No step is taken.
void Engines::check_supported()
{
    Failure failure = mechanics::failure_of_unsupported(section_.mesh(), section_.assembly);
    if (failure.block.empty())
        return;
    failure.moves_on = 1;
    failure.reason = "no equilibrium: no boundary and no contact supports some of the rock";
    fail(section_, std::move(failure), section_.now);
}

} // namespace jointcreep::analysis
