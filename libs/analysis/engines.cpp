#include "analysis/engines.hpp"

#include "mechanics/failure.hpp"
#include "model/error.hpp"
#include "relaxation/relax.hpp"

namespace jointcreep::analysis
{

void Engines::settle(double time)
{
    if (!settles_nearby({}, time))
        settle_by_relaxation(time);
}

// All rock is elastic in it. Where some is beyond its strength in the end, dynamic relaxation goes on from
// there.
bool Engines::settles_nearby(const std::vector<Vector2d>& guess, double time)
{
    if (section_.engine == EngineChoice::relaxation)
        return false;
    auto& [convergence, effort] = section_.settled;
    section_.rock.zones.holds_yield = true;
    const auto found = implicit_.equilibrate(section_.rock, section_.scene.equilibrium, guess);
    ++effort.searches;
    effort.factorisations += implicit_.factorisations();
    effort.solves += implicit_.solves();
    effort.steps += implicit_.corrections();
    if (found) {
        convergence = *found;
        if (const Index zone = rock::weakest(section_.rock.zones); zone >= 0)
            yield_by_relaxation(time, zone);
    }
    section_.rock.zones.holds_yield = false;
    return found.has_value();
}

// From an elastic equilibrium in which this zone is beyond its strength.
void Engines::yield_by_relaxation(double time, Index zone)
{
    section_.rock.zones.holds_yield = false;
    if (section_.engine == EngineChoice::implicit) {
        const auto& [a, b, c] = section_.mesh().zone_gridpoint[section_.rock.zones.zone_of(zone)];
        const std::vector<Vector2d>& at = section_.mesh().gridpoint;
        const mechanics::no_equilibrium error("the rock at " + shown(Vector2d((at[a] + at[b] + at[c]) / 3)) +
                                              " yields (--engine auto would continue by dynamic relaxation)");
        fail(section_, failure_of(error, section_.mesh(), section_.rock), time);
    }
    mechanics::Convergence& convergence = section_.settled.convergence;
    mechanics::Convergence elastic = convergence;
    const double before = stored_energy(section_.rock);
    find_forces(section_.rock);
    const double lost = before - stored_energy(section_.rock); // nothing has moved
    elastic.stored -= lost;
    elastic.dissipated += lost;
    settle_by_relaxation(time, "rock yields");
    convergence.work_of_loads += elastic.work_of_loads;
    convergence.stored += elastic.stored;
    convergence.dissipated += elastic.dissipated;
    convergence.damped += elastic.damped;
}

void Engines::settle_by_relaxation(double time, const std::string& reason)
{
    if (section_.engine == EngineChoice::implicit) {
        const mechanics::no_equilibrium error("none nearby: " + implicit_.reason() +
                                              " (--engine auto would continue by dynamic relaxation)");
        fail(section_, failure_of(error, section_.mesh(), section_.rock), time);
    }
    if (section_.engine == EngineChoice::automatic)
        ++section_.findings.given_up[reason.empty() ? implicit_.reason() : reason];
    ++section_.settled.effort.searches;
    try {
        section_.settled.convergence = relax(time);
    } catch (const mechanics::no_equilibrium& error) {
        fail(section_, failure_of(error, section_.mesh(), section_.rock), time);
    }
    section_.settled.effort.steps += section_.settled.convergence.steps;
}

mechanics::Convergence Engines::relax(double time)
{
    const Equilibrium& settings = section_.scene.equilibrium;
    if (!step_history_.is_wanted())
        return relaxation::relax(section_.rock, settings);
    step_history_.begin(time);
    const auto convergence = relaxation::relax(section_.rock, settings,
                                               [&](double since_begin) { step_history_.step(since_begin); });
    step_history_.end();
    return convergence;
}

// No step is taken.
void Engines::check_held()
{
    Failure failure = mechanics::failure_of_unheld(section_.mesh(), section_.rock);
    if (failure.block.empty())
        return;
    failure.moves_on = 1;
    failure.reason = "no equilibrium: no boundary and no contact holds some of the rock";
    fail(section_, std::move(failure), section_.now);
}

} // namespace jointcreep::analysis
