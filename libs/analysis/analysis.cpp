#include "analysis/analysis.hpp"

#include "joint/equivalent.hpp"
#include "mechanics/excavation.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "relaxation/relax.hpp"
#include "zoning/zone.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace jointcreep::analysis
{

using mechanics::Vector2d;

namespace
{

// A thread with fewer zones than this spends its time waiting for the others.
constexpr int zones_per_thread = 2000;

// Of a stage's increment or a creep step, where the implicit engine finds no equilibrium at its end.
constexpr int most_halvings = 5;

// Of one creep step where contacts close: in rock full of open joints some close all the time.
constexpr int most_cuts = 6;

// By how much of its largest part the energy balance of a dynamic analysis may be off.
constexpr double energy_closes = 0.01;

// What an edge's joint is called: its set, or the material of the joint that a boundary rests on.
std::string joint_name(const Scene& scene, const Network& network, Index edge)
{
    const Index joint = network.blocks.edge_joint[edge];
    return joint < 0 ? scene.boundaries[network.blocks.edge_boundary[edge]].joint
                     : network.names.joint_set[network.joints.set[joint]];
}

// Throws if steps of a fixed length would be more than anyone can want.
void check_number_of_steps(double from, double to, const CreepSettings& creep)
{
    constexpr double most = 1e6;
    if (creep.step && (to - from) / *creep.step > most)
        throw input_error("creep step of " + shown(*creep.step / unit::day) + " day: that makes " +
                          shown(std::ceil((to - from) / *creep.step)) + " steps from day " +
                          shown(from / unit::day) + " to day " + shown(to / unit::day) + "; wanted at most " +
                          shown(most));
}

// The times when something other than creep happens: stages, corners of the loading, first readings, the end.
std::set<double> dates_of(const Scene& scene, const mechanics::Loading& loading)
{
    std::set<double> dates{scene.end};
    for (const double time : loading.corners())
        if (time > 0 && time < scene.end)
            dates.insert(time);
    for (const Stage& stage : scene.stages)
        dates.insert(stage.time);
    for (const MonitoringPoint& point : scene.points)
        if (point.first_reading > 0)
            dates.insert(point.first_reading);
    return dates;
}

// Dynamic relaxation where the scene or the user asks for it. Otherwise the implicit engine, and dynamic
// relaxation where that fails.
EngineChoice engine_for(const Scene& scene, const Recording& recording)
{
    const bool needs_relaxation =
        scene.equilibrium.masses == Masses::real || recording.step_history_every > 0;
    if (scene.equilibrium.engine == EngineChoice::implicit && recording.step_history_every > 0)
        throw input_error(
            "--step-history records steps of dynamic relaxation; the implicit engine has none. Choose "
            "--engine auto or relaxation");
    if (!recording.parameters.empty()) { // masses make no difference at rest
        if (scene.large_displacements)
            throw input_error(
                "sensitivities are of small displacements; wanted a scene without [large_displacements]");
        for (const Rock& rock : scene.rocks)
            if (rock.law != RockLaw::elastic)
                throw input_error(
                    "sensitivities are those of elastic rock; wanted law = \"elastic\" of [[rock]] \"" +
                    rock.name + "\"");
        if (scene.equilibrium.engine == EngineChoice::relaxation || recording.step_history_every > 0)
            throw input_error(
                "sensitivities are found by the implicit engine; wanted an equilibrium.engine other than "
                "\"relaxation\", and no step history");
        return EngineChoice::implicit;
    }
    if (scene.equilibrium.engine == EngineChoice::automatic && needs_relaxation)
        return EngineChoice::relaxation;
    return scene.equilibrium.engine;
}

// The published creep step is stable up to a limit that joints and rocks set; beyond it its answer would be
// wrong. A fixed step beyond it is refused; chosen steps stay below.
std::optional<StableLimit> limit_of_published(const Scene& scene, const Network& network,
                                              const EquivalentJoints& joints)
{
    if (!scene.creep || scene.creep->scheme != CreepScheme::published)
        return {};
    const creep::StepLimit limit = creep::longest_step(joints, scene.rocks);
    if (limit.rock < 0 && limit.edge < 0)
        return {};
    const std::string of = limit.rock >= 0 ? "rock \"" + scene.rocks[limit.rock].name + "\""
                                           : "joint \"" + joint_name(scene, network, limit.edge) + "\"";
    if (scene.creep->step && *scene.creep->step >= limit.step)
        throw unstable_step("creep step of " + shown(*scene.creep->step / unit::day) +
                            " day: the published scheme is stable only below " +
                            shown(limit.step / unit::day) + " day, the limit of " + of);
    return StableLimit{limit.step, of};
}

std::vector<char> rigid_zones(const Scene& scene, const Network& network, const Mesh& mesh)
{
    const std::vector<std::string>& rigid = scene.large_displacements->rigid_rocks;
    std::vector<char> is_rigid;
    for (const Index block : mesh.zone_block) {
        const std::string& rock = scene.rocks[network.blocks.block_rock[block]].name;
        is_rigid.push_back(std::find(rigid.begin(), rigid.end(), rock) != rigid.end() ? 1 : 0);
    }
    return is_rigid;
}

// What the joint of each contact is made of, by its number in the scene.
std::vector<Index> material_of_contacts(const Scene& scene, const Network& network, const Mesh& mesh)
{
    std::vector<Index> number;
    for (const Index edge : mesh.contact_edge)
        number.push_back(
            static_cast<Index>(&joint::material_of(scene, network, static_cast<std::size_t>(edge)) -
                               scene.joint_materials.data()));
    return number;
}

// Of contacts that form in a dynamic analysis: friction alone, the residual one where there is one.
joint::Law law_of_new_contacts(const Scene& scene)
{
    const auto material =
        std::find_if(scene.joint_materials.begin(), scene.joint_materials.end(),
                     [&](const auto& m) { return m.name == scene.large_displacements->new_contacts; });
    return joint::unbonded(joint::law_of(*material));
}

} // namespace

// 1. Divide the blocks into zones and load them with the in-situ stress.
Analysis::Analysis(const Scene& scene, const Network& network, const EquivalentJoints& joints, int threads,
                   const Recording& recording, const Observer& observe)
    : scene_(scene), network_(network), joints_(joints), recording_(recording), observe_(observe),
      engine_(engine_for(scene, recording)), result_{.mesh = zoning::zone(scene, network.blocks),
                                                     .history = {},
                                                     .states = {},
                                                     .equilibria = {},
                                                     .step_history = {},
                                                     .dynamics = {}},
      rock_(mechanics::assemble(scene, network, joints, result_.mesh)), loading_(scene, result_.mesh),
      recorder_(scene, network.blocks, result_.mesh)
{
    stable_limit_ = limit_of_published(scene, network, joints);
    rock_.threads =
        std::min(threads, 1 + static_cast<int>(result_.mesh.zone_gridpoint.size()) / zones_per_thread);
    loading_.apply(rock_, 0);
    if (!recording.parameters.empty())
        sensitivity_.emplace(recording.parameters, scene, result_.mesh, rock_);
    sensitivities_.resize(recording.parameters.size());
}

void Analysis::run()
{
    settle_in_situ();
    if (scene_.large_displacements)
        start_dynamics();
    prepare_creep();
    follow_schedule(false);
}

void Analysis::go_on(Result so_far, Checkpoint kept)
{
    so_far.mesh = std::move(result_.mesh);
    result_ = std::move(so_far);
    if (scene_.large_displacements)
        prepare_dynamics();
    prepare_creep();
    transfer(Transfer(Transfer::Way::restore), kept);
    follow_schedule(true);
}

void Analysis::prepare_creep()
{
    if (scene_.creep) {
        creep_.emplace(scene_, network_, joints_, result_.mesh, rock_);
        if (sensitivity_)
            sensitivity_->start_creep(*creep_);
        if (creep_->anything_creeps()) {
            step_.emplace(*scene_.creep, creep_->fastest_rate(),
                          stable_limit_ ? stable_limit_->step : std::numeric_limits<double>::infinity());
            if (creep::is_second_order(scene_.creep->scheme))
                closing_.emplace(step_->closing_tolerance()); // the others are of first order anyway
        }
    }
}

// From the start, or from the stage that a checkpoint stands before.
void Analysis::follow_schedule(bool is_at_stage)
{
    // After this nothing happens but creep.
    const std::set<double> corners = loading_.corners();
    const double last_event = std::max(scene_.stages.empty() ? 0.0 : scene_.stages.back().time,
                                       corners.empty() ? 0.0 : *corners.rbegin());
    for (const double date : dates_of(scene_, loading_)) {
        if (end_of_creep_)
            break;
        if (date < now_)
            continue;
        if (is_at_stage) {
            // creep has come here before
        } else if (dynamics_)
            rest_until(date);
        else
            creep_until(date, now_ >= last_event);
        const auto n_stages = static_cast<Index>(scene_.stages.size());
        for (; next_stage_ < n_stages && scene_.stages[next_stage_].time == date; ++next_stage_) {
            if (recording_.keep && !is_at_stage) {
                Checkpoint kept;
                transfer(Transfer(Transfer::Way::keep), kept);
                recording_.keep(result_, kept);
            }
            is_at_stage = false;
            excavate(scene_.stages[next_stage_], next_stage_);
        }
        recorder_.start_readings(result_, now_);
    }
    for (const MonitoringPoint& point : scene_.points)
        if (point.first_reading > now_) // creep has ended before: nothing moves until then
            recorder_.start_readings(result_, point.first_reading);
}

void Analysis::transfer(const Transfer& to, Checkpoint& kept)
{
    // All members, lest a new one is forgotten. What is not passed on is made from the scene, or found anew
    // in a stage.
    auto& [scene, network, joints, recording, observe, engine, result, rock, loading, recorder, implicit,
           dynamics, creep, step, closing, sensitivity, sensitivities, now, next_stage, stage, solver_time,
           solver_steps, creep_steps, convergence, effort, last_move, cuts_left, last_step, stable_limit,
           end_of_creep, beyond_strength, yielded_in_situ, given_up, energy_off, largest_error,
           largest_energy] = *this;
    to.value(next_stage, kept.stage);
    to.value(now, kept.time);
    if (to.restores())
        loading.apply(rock, now);
    mechanics::transfer(to, rock, kept);
    if (dynamics)
        dynamics->transfer(to, kept.dynamics);
    if (creep)
        creep->transfer(to, kept);
    if (step)
        step->transfer(to, kept);
    to.value(solver_time, kept.solver_time);
    // Only what is left over from the last that was recorded counts.
    std::uint64_t since_record = solver_steps % std::max<std::uint64_t>(recording.step_history_every, 1),
                  since_state = creep_steps % std::max<std::uint64_t>(recording.state_every, 1);
    to.value(since_record, kept.steps_since_record);
    to.value(since_state, kept.steps_since_state);
    solver_steps = since_record;
    creep_steps = since_state;
    const std::array<std::map<std::string, Index>*, 4> remarks{&beyond_strength, &yielded_in_situ, &given_up,
                                                               &energy_off};
    if (to.restores())
        for (std::size_t r = 0; r < kept.remark.size(); ++r)
            (*remarks.at(kept.remark_kind[r]))[kept.remark[r]] = kept.remark_count[r];
    else
        for (std::size_t kind = 0; kind < remarks.size(); ++kind)
            for (const auto& [remark, n] : *remarks[kind]) {
                kept.remark_kind.push_back(static_cast<Index>(kind));
                kept.remark.push_back(remark);
                kept.remark_count.push_back(n);
            }
}

// 2. The in-situ equilibrium. Everything is counted from here.
void Analysis::settle_in_situ()
{
    observe_(0, "in-situ equilibrium");
    const mechanics::State given = state_of(rock_);
    try {
        check_held();
        if (!settles_nearby({}, 0))
            settle_by_relaxation(0);
    } catch (const equilibrium_error&) {
        go_back(rock_, given);
        record("", true);
        throw;
    }
    yielded_in_situ_ = yielded();
    const mechanics::Contacts& contacts = rock_.contacts;
    for (std::size_t c = 0; c < contacts.status.size(); ++c)
        if (contacts.status[c] != ContactStatus::stuck)
            ++beyond_strength_[joint_name(scene_, network_, result_.mesh.contact_edge[c])];
    if (sensitivity_) {
        sensitivity_->settle(rock_, implicit_, 0);
        sensitivity_->start_from_here(rock_);
    }
    start_from_here(rock_);
    loading_.apply(rock_, 0);
    record_equilibrium();
    record("", true);
}

// 3. Creep, and what the loading does meanwhile, up to a date. It may stop where the scene's stop rate is
// reached.
void Analysis::creep_until(double date, bool may_stop)
{
    const bool is_loaded = loading_.changes(now_, date);
    const double longest = is_loaded ? (date - now_) / scene_.equilibrium.unloading_increments : date - now_;
    if (is_loaded)
        start_afresh();
    if (creeps())
        check_number_of_steps(now_, date, *scene_.creep);
    const auto next = [&] {
        const double remaining = date - now_;
        const double step = creeps() ? step_->next(remaining, longest) : std::min(remaining, longest);
        return step < (1 - 1e-12) * remaining ? now_ + step : date;
    };
    while (now_ < date && !end_of_creep_) {
        observe_(now_ / scene_.end, "day " + std::to_string(std::lround(now_ / unit::day)));
        const double target = next();
        cuts_left_ = most_cuts;
        while (now_ < target && !end_of_creep_) {
            if (!step_to(target, is_loaded))
                break;
            if (may_stop && creeps() && scene_.creep->stop_rate && is_slower_than(*scene_.creep->stop_rate))
                end_of_creep_ = now_;
            if (now_ < target && !end_of_creep_)
                continue; // cut short where a contact closes: times stay the same whatever contacts do
            const bool is_due = recording_.state_every > 0 && creeps() &&
                                ++creep_steps_ % recording_.state_every == 0 && now_ < date;
            record("", is_due);
        }
    }
    recorder_.record_state(result_, now_, "", rock_);
}

// 3, where rock may move far: between stages it is at rest.
void Analysis::rest_until(double date)
{
    if (date == now_)
        return;
    now_ = date;
    record("", true);
}

// One step of creep and loading, to the target or to where an open contact closes before. False if its error
// is too large: then nothing has happened but that the next step will be shorter.
bool Analysis::step_to(double target, bool is_loaded)
{
    if (!creeps() && !is_loaded) {
        now_ = target;
        return true;
    }
    const mechanics::State start = state_of(rock_);
    const std::optional<creep::Creep> creep_at_start = creep_;
    if (closing_)
        closing_->start(rock_);
    const std::optional<sensitivity::Sensitivity> sensitivity_at_start = sensitivity_;
    if (sensitivity_)
        sensitivity_->start_step(rock_);
    double end = target;
    int halvings = engine_ == EngineChoice::relaxation ? most_halvings : 0;
    for (;;) {
        if (creeps())
            creep_->begin(end - now_, rock_);
        loading_.apply(rock_, end);
        std::vector<Vector2d> guess = last_move_; // creep slows down
        for (Vector2d& move : guess)
            move *= 0.9 * (end - now_) / last_step_;
        bool is_found = true;
        try {
            if (halvings == most_halvings) // all the way then, by dynamic relaxation
                settle_by_relaxation(end);
            else
                is_found = settles_nearby(guess, end);
        } catch (const equilibrium_error&) {
            go_back(rock_, start);
            recorder_.record_state(result_, now_, "", rock_);
            throw;
        }
        if (!is_found) {
            ++halvings;
            end = halvings < most_halvings ? now_ + (end - now_) / 2 : target;
            if (sensitivity_)
                sensitivity_->shorten(0.5);
            continue;
        }
        const double longest =
            closing_ && cuts_left_ > 0 ? closing_->longest_step(rock_, end - now_) : end - now_;
        if (longest >= end - now_ || longest < 1e-9 * (target - now_))
            break;
        --cuts_left_;
        if (sensitivity_)
            sensitivity_->cut(closing_->last_cut(), *creep_, end - now_, rock_, implicit_, end);
        go_back(rock_, start);
        end = now_ + longest;
    }
    if (sensitivity_) {
        if (creeps())
            sensitivity_->creep_step(*creep_, end - now_, rock_, implicit_, end);
        else
            sensitivity_->settle(rock_, implicit_, end);
    }
    if (creeps() && !step_->stands(end - now_, creep_->end(rock_))) {
        sensitivity_ = sensitivity_at_start;
        go_back(rock_, start);
        creep_ = creep_at_start;
        loading_.apply(rock_, now_);
        return false;
    }
    if (closing_)
        closing_->finish(rock_, end - now_);
    if (closing_ && sensitivity_)
        sensitivity_->finish_step(*closing_, end - now_, end == target, rock_);
    last_step_ = end - now_;
    last_move_ = rock_.displacement;
    for (std::size_t g = 0; g < last_move_.size(); ++g)
        last_move_[g] -= start.displacement[g];
    now_ = end;
    record_equilibrium();
    if (end < target && step_) // cut short
        step_->start_afresh();
    return true;
}

// Whether every gridpoint moved more slowly in the last step [m/s].
bool Analysis::is_slower_than(double rate) const
{
    return std::all_of(last_move_.begin(), last_move_.end(),
                       [&](const Vector2d& move) { return move.norm() < rate * last_step_; });
}

// 4. Take away what a stage removes; unload what is left.
void Analysis::excavate(const Stage& stage, Index number)
{
    observe_(now_ / scene_.end, stage.name);
    stage_ = stage.name;
    if (sensitivity_)
        sensitivity_->before_excavation(rock_);
    const auto released = mechanics::excavate(rock_, network_.blocks, result_.mesh, loading_, number);
    if (sensitivity_)
        sensitivity_->after_excavation(rock_);
    if (dynamics_) {
        dynamics_->start();
        move(stage);
        stage_.clear();
        return;
    }
    check_held();
    const std::vector<Vector2d> load = rock_.load;
    // In the scene's increments; in smaller ones where the implicit engine finds no equilibrium nearby.
    const int finest = engine_ == EngineChoice::relaxation ? 1 : 1 << most_halvings;
    const int n = finest * scene_.equilibrium.unloading_increments;
    for (int done = 0, increment = finest; done < n;) {
        const double held = 1 - static_cast<double>(done + increment) / n;
        for (std::size_t g = 0; g < load.size(); ++g)
            rock_.load[g] = load[g] + held * released[g];
        if (!settles_nearby({}, now_)) {
            if (increment > 1) {
                increment /= 2;
                continue;
            }
            settle_by_relaxation(now_);
        }
        if (sensitivity_)
            sensitivity_->settle(rock_, implicit_, now_, held);
        done += increment;
        record_equilibrium();
    }
    start_afresh();
    record(stage.name, true);
    if (stage.reset_displacements)
        mechanics::Recorder::reset(result_);
    stage_.clear();
}

void Analysis::prepare_dynamics()
{
    dynamics_.emplace(rock_, result_.mesh, material_of_contacts(scene_, network_, result_.mesh),
                      rigid_zones(scene_, network_, result_.mesh), law_of_new_contacts(scene_),
                      large_displacements::Settings{scene_.large_displacements->stiffness_damping,
                                                    scene_.large_displacements->mass_damping,
                                                    scene_.large_displacements->release,
                                                    scene_.equilibrium.tolerance});
}

// 2, where rock may move far: contacts between faces are a little other than those between gridpoints, and
// find their equilibrium first.
void Analysis::start_dynamics()
{
    prepare_dynamics();
    follow_dynamics(std::numeric_limits<double>::infinity());
    effort_ = {};
    dynamics_->count_from_here();
}

// Steps until rock is at rest, or a time has come [s].
bool Analysis::follow_dynamics(double until)
{
    while (dynamics_->time() < until) {
        try {
            dynamics_->step();
            ++effort_.steps;
            if (effort_.steps % large_displacements::Dynamics::check_every == 0 && dynamics_->is_at_rest())
                return true;
        } catch (const mechanics::no_equilibrium& error) {
            give_up_dynamics(error);
        } catch (const equilibrium_error& error) {
            fail({.reason = error.what()}, now_);
        }
        if (dynamics_->time() > scene_.large_displacements->longest)
            give_up_dynamics(
                dynamics_->moves_on("no rest within " + shown(scene_.large_displacements->longest) + " s"));
    }
    return false;
}

// 4, where rock may move far: follow it until it is at rest.
void Analysis::move(const Stage& stage)
{
    double due = 0;
    largest_energy_ = largest_error_ = 0;
    do {
        observe_(now_ / scene_.end, stage.name + ", " + shown(due) + " s");
        due = std::max(due + scene_.large_displacements->record_every, // once a step at most
                       std::nextafter(dynamics_->time(), std::numeric_limits<double>::infinity()));
        dynamics_->put_back();
        recorder_.record_state(result_, now_, "", rock_);
        record_dynamics();
    } while (!follow_dynamics(due));
    dynamics_->put_back();
    const large_displacements::Energy energy = dynamics_->energy();
    convergence_ = {.steps = effort_.steps,
                    .unbalanced_force_ratio = dynamics_->unbalanced_force_ratio(),
                    .contact_force_change = dynamics_->contact_force_change(),
                    .remaining_displacement = -1,
                    .work_of_loads = energy.work,
                    .stored = energy.stored,
                    .dissipated = energy.friction,
                    .damped = energy.damped};
    effort_.searches = 1;
    record_equilibrium();
    record(stage.name, true);
    record_dynamics();
    check_energy();
    if (stage.reset_displacements)
        mechanics::Recorder::reset(result_);
}

// Keeps the state that a dynamic analysis has come to, and says what moves.
void Analysis::give_up_dynamics(const mechanics::no_equilibrium& error)
{
    dynamics_->put_back();
    record("", true);
    record_dynamics();
    check_energy();
    fail(failure_of(error, result_.mesh, rock_), now_);
}

void Analysis::record_dynamics()
{
    DynamicsHistory& dynamics = result_.dynamics;
    const large_displacements::Energy energy = dynamics_->energy();
    dynamics.time.push_back(now_ / unit::day);
    dynamics.dynamic_time.push_back(dynamics_->time());
    dynamics.state.push_back(static_cast<Index>(result_.states.time.size()) - 1);
    dynamics.work_of_loads.push_back(energy.work);
    dynamics.kinetic_energy.push_back(energy.kinetic);
    dynamics.stored_energy.push_back(energy.stored);
    dynamics.friction_energy.push_back(energy.friction);
    dynamics.damped_energy.push_back(energy.damped);
    dynamics.fastest.push_back(dynamics_->fastest());
    dynamics.unbalanced_force_ratio.push_back(dynamics_->unbalanced_force_ratio());
    for (const double part : {energy.work, energy.kinetic, energy.stored, energy.friction, energy.damped})
        largest_energy_ = std::max(largest_energy_, std::abs(part));
    largest_error_ = std::max(largest_error_, std::abs(energy.error()));
    const auto block_of = [&](Index zone) { return zone < 0 ? zone : result_.mesh.zone_block[zone]; };
    for (const large_displacements::Touching& contact : dynamics_->touching()) {
        dynamics.contact_block.push_back({block_of(contact.zone[0]), block_of(contact.zone[1])});
        dynamics.contact_from.push_back(contact.between[0]);
        dynamics.contact_to.push_back(contact.between[1]);
        dynamics.contact_normal.push_back(contact.normal);
        dynamics.contact_traction.push_back(contact.traction);
        dynamics.contact_closing.push_back(contact.closing);
        dynamics.contact_slips.push_back(contact.is_slipping ? 1 : 0);
    }
    dynamics.first_contact.push_back(static_cast<Index>(dynamics.contact_block.size()));
}

// Of the dynamic analysis that has ended. Where rock only settles, all parts are small, and an error of the
// first step, which goes with the square of its length, is not small beside them.
void Analysis::check_energy()
{
    const double off = largest_error_ / largest_energy_;
    if (dynamics_->has_moved() && off > energy_closes)
        energy_off_[stage_] = static_cast<Index>(std::lround(100 * std::min(off, 1e6)));
}

// After a sudden change of loads: what was learnt from the steps before no longer holds.
void Analysis::start_afresh()
{
    last_move_.clear();
    if (step_)
        step_->start_afresh();
    if (closing_)
        closing_->start_afresh();
    if (sensitivity_)
        sensitivity_->start_afresh();
}

// Equilibrium by the implicit engine, unless only dynamic relaxation is asked for; false if there is none
// nearby. All rock is elastic in it. Where some is beyond its strength in the end, dynamic relaxation goes on
// from there.
bool Analysis::settles_nearby(const std::vector<Vector2d>& guess, double time)
{
    if (engine_ == EngineChoice::relaxation)
        return false;
    rock_.zones.holds_yield = true;
    const auto found = implicit_.equilibrate(rock_, scene_.equilibrium, guess);
    ++effort_.searches;
    effort_.factorisations += implicit_.factorisations();
    effort_.solves += implicit_.solves();
    effort_.steps += implicit_.corrections();
    if (found) {
        convergence_ = *found;
        if (const Index zone = weakest_zone(rock_); zone >= 0)
            yield_by_relaxation(time, zone);
    }
    rock_.zones.holds_yield = false;
    return found.has_value();
}

// From an elastic equilibrium in which this zone is beyond its strength.
void Analysis::yield_by_relaxation(double time, Index zone)
{
    rock_.zones.holds_yield = false;
    if (engine_ == EngineChoice::implicit) {
        const auto& [a, b, c] = result_.mesh.zone_gridpoint[zone];
        const std::vector<Vector2d>& at = result_.mesh.gridpoint;
        fail(failure_of(
                 mechanics::no_equilibrium("the rock at " + shown(Vector2d((at[a] + at[b] + at[c]) / 3)) +
                                           " yields (--engine auto would continue by dynamic relaxation)"),
                 result_.mesh, rock_),
             time);
    }
    mechanics::Convergence elastic = convergence_;
    const double beyond_strength = stored_energy(rock_);
    find_forces(rock_);
    const double lost = beyond_strength - stored_energy(rock_); // nothing has moved
    elastic.stored -= lost;
    elastic.dissipated += lost;
    settle_by_relaxation(time, "rock yields");
    convergence_.work_of_loads += elastic.work_of_loads;
    convergence_.stored += elastic.stored;
    convergence_.dissipated += elastic.dissipated;
    convergence_.damped += elastic.damped;
}

std::map<std::string, Index> Analysis::yielded() const
{
    std::map<std::string, Index> zones;
    for (std::size_t z = 0; z < rock_.zones.yielding_number.size(); ++z)
        if (const Index number = rock_.zones.yielding_number[z];
            number >= 0 && rock_.zones.is_present[z] && !rock_.zones.yielding[number].plastic.isZero(0))
            ++zones[scene_.rocks[network_.blocks.block_rock[result_.mesh.zone_block[z]]].name];
    return zones;
}

// Equilibrium by dynamic relaxation, unless only the implicit engine is asked for.
void Analysis::settle_by_relaxation(double time, const std::string& reason)
{
    if (engine_ == EngineChoice::implicit)
        fail(failure_of(mechanics::no_equilibrium("none nearby: " + implicit_.reason() +
                                                  " (--engine auto would continue by dynamic relaxation)"),
                        result_.mesh, rock_),
             time);
    if (engine_ == EngineChoice::automatic)
        ++given_up_[reason.empty() ? implicit_.reason() : reason];
    ++effort_.searches;
    double last = 0;
    const auto observe = [&](double since_start) {
        last = since_start;
        if (recording_.step_history_every > 0 && ++solver_steps_ % recording_.step_history_every == 0)
            recorder_.record_step(result_, time, solver_time_ + since_start, rock_);
    };
    try {
        convergence_ =
            relaxation::relax(rock_, scene_.equilibrium,
                              recording_.step_history_every > 0 ? observe : relaxation::StepObserver{});
    } catch (const mechanics::no_equilibrium& error) {
        fail(failure_of(error, result_.mesh, rock_), time);
    }
    effort_.steps += convergence_.steps;
    solver_time_ += last;
}

// Rock that nothing holds falls without end: it is named, and no step is taken.
void Analysis::check_held()
{
    Failure failure = failure_of_unheld(result_.mesh, rock_);
    if (failure.block.empty())
        return;
    failure.moves_on = 1;
    failure.reason = "no equilibrium: no boundary and no contact holds some of the rock";
    fail(std::move(failure), now_);
}

void Analysis::fail(Failure failure, double time)
{
    failure.time = time / unit::day;
    failure.stage = stage_;
    std::string message = failure.reason + "\non day " + shown(failure.time);
    if (!stage_.empty())
        message += ", stage \"" + stage_ + "\"";
    if (!failure.block.empty())
        message +=
            (failure.moves_on ? "; what moves: " : "; what moved most: ") + mechanics::shown_blocks(failure);
    if (failure.steps > 0)
        message += ", in the last " + std::to_string(failure.steps) + " steps";
    if (failure.seconds > 0)
        message += ", " + shown(failure.seconds) + " s";
    result_.failure = std::move(failure);
    throw equilibrium_error(message);
}

void Analysis::record_equilibrium()
{
    recorder_.record_equilibrium(result_, now_, convergence_, effort_);
    effort_ = {};
}

void Analysis::record(const std::string& event, bool with_state)
{
    recorder_.record_history(result_, now_, event, rock_);
    for (std::size_t p = 0; p < sensitivities_.size(); ++p)
        recorder_.append_at_points(sensitivities_[p], sensitivity_->displacement(p), rock_);
    if (with_state)
        recorder_.record_state(result_, now_, event, rock_);
}

} // namespace jointcreep::analysis
