#include "analysis/dynamic_stage.hpp"

#include "joint/chain.hpp"
#include "joint/equivalent.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace jointcreep::analysis
{

using large_displacements::Dynamics;
using large_displacements::Energy;

namespace
{

// In words, to a ten-thousandth.
std::string day_of(double time)
{
    return "day " + shown(std::round(1e4 * time / unit::day) / 1e4);
}

// A larger error of the energy balance of a dynamic analysis, over its largest energy, is told, also where the scene
// allows it [-].
constexpr double error_to_tell = 0.01;

std::string energy_said(double off)
{
    return "the energy balance of the dynamic analysis is off by " + rounded(100 * off) +
           " percent of its largest energy";
}

std::vector<char> rigid_zones(const Section& section)
{
    const std::vector<std::string>& rigid = section.scene.large_displacements->rigid_rocks;
    std::vector<char> is_rigid;
    for (const Index block : section.mesh().zone_block) {
        const std::string& rock = section.scene.rocks[section.network.blocks.block_rock[block]].name;
        is_rigid.push_back(std::find(rigid.begin(), rigid.end(), rock) != rigid.end() ? 1 : 0);
    }
    return is_rigid;
}

// What the joint of each contact is made of, by its number in the scene.
std::vector<Index> material_of_contacts(const Section& section)
{
    const std::vector<Index> of_edge = joint::materials_of(section.scene, section.network);
    std::vector<Index> number;
    for (const Index edge : section.mesh().contact_edge)
        number.push_back(of_edge[edge]);
    return number;
}

// The material of contacts that form in a dynamic analysis.
Index material_of_new_contacts(const Scene& scene)
{
    const auto material =
        std::find_if(scene.joint_materials.begin(), scene.joint_materials.end(),
                     [&](const auto& m) { return m.name == scene.large_displacements->new_contacts; });
    return static_cast<Index>(material - scene.joint_materials.begin());
}

// Their law: friction only, the residual one where there is one.
joint::Law law_of_new_contacts(const Scene& scene)
{
    return joint::unbonded(joint::law_of(scene.joint_materials[material_of_new_contacts(scene)]));
}

large_displacements::Settings settings_of(const Scene& scene)
{
    return {scene.large_displacements->stiffness_damping, scene.large_displacements->mass_damping,
            scene.large_displacements->release, scene.equilibrium.tolerance};
}

} // namespace

DynamicStage::DynamicStage(Section& section, const Watchers& watchers)
    : section_(section), watchers_(watchers),
      dynamics_(section.assembly, section.mesh(), material_of_contacts(section), rigid_zones(section),
                law_of_new_contacts(section.scene), settings_of(section.scene))
{
    if (!section.scene.creep)
        return;
    const Index number = material_of_new_contacts(section.scene);
    const JointMaterial& material = section.scene.joint_materials[number];
    dynamics_.creep_by(section.joints,
                       {joint::chain_of(material, number, 0), joint::chain_of(material, number, 1)});
}

// Whether this analysis continues an earlier run from its checkpoint.
bool DynamicStage::goes_on()
{
    return section_.keeper != nullptr && section_.keeper->search_begins([this](Tape& tape) { pass(tape); });
}

void DynamicStage::pass(Tape& tape)
{
    tape(due_, largest_energy_, largest_error_, section_.settled.effort.steps, dynamics_);
    // Joints only: dynamics_ keeps rock's. Creep displacements of contacts are those of the last time their forces were put back.
    joint::pass(tape, section_.assembly.contacts);
    tape(section_.assembly.contacts.offset);
}

void DynamicStage::settle_in_situ()
{
    goes_on();
    comes_to_rest(std::numeric_limits<double>::infinity());
    section_.settled.effort = {};
    dynamics_.count_from_here();
}

void DynamicStage::run(bool is_last)
{
    constexpr double never = std::numeric_limits<double>::infinity();
    const double stop = is_last ? section_.scene.large_displacements->stop.value_or(never) : never;
    dynamics_.start();
    begin_records();
    const bool rests = moves_to_rest(stop, goes_on());
    dynamics_.put_back();
    if (rests) {
        note_rest();
        watchers_.tell(&Watcher::equilibrium_ends, 0.0);
    }
    watchers_.row_and_state_are_due(section_.stage);
    record();
    check_energy();
}

void DynamicStage::begin_records()
{
    largest_energy_ = largest_error_ = 0;
    due_ = 0;
}

// Moves until rest, or until a time [s], with records of it; whether it rests. `is_recorded`: the present state is.
bool DynamicStage::moves_to_rest(double stop, bool is_recorded)
{
    bool rests = false;
    while (!rests && dynamics_.time() < stop) {
        if (!std::exchange(is_recorded, false)) {
            due_ = std::max(due_ + section_.scene.large_displacements->record_every, // once a step at most
                            std::nextafter(dynamics_.time(), std::numeric_limits<double>::infinity()));
            dynamics_.put_back();
            watchers_.tell(&Watcher::state_is_due, "");
            record();
        }
        rests = comes_to_rest(std::min(due_, stop));
    }
    return rests;
}

void DynamicStage::say()
{
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.4g s, largest velocity %.2g m/s", dynamics_.time(),
                  dynamics_.fastest());
    const std::string what = !section_.stage.empty() ? section_.stage
                             : section_.now > 0      ? "creep"
                                                     : "in situ";
    section_.say(what, text.data());
}

// Steps until rock is at rest, or until a time has come [s].
bool DynamicStage::comes_to_rest(double until)
{
    const double longest = section_.scene.large_displacements->longest;
    Index& steps = section_.settled.effort.steps;
    while (dynamics_.time() < until) {
        try {
            dynamics_.step();
            ++steps;
            if (steps % Dynamics::check_every == 0 && dynamics_.is_at_rest())
                return true;
        } catch (const mechanics::no_equilibrium& error) {
            give_up(error);
        } catch (const equilibrium_error& error) {
            fail(section_, {.reason = error.what()}, section_.now);
        }
        if (steps % Dynamics::check_every == 0)
            say();
        if (dynamics_.time() > longest)
            give_up(dynamics_.moves_on("no rest within " + shown(longest) + " s"));
        if (section_.keeper != nullptr && !is_creeping_ && steps % Dynamics::check_every == 0)
            section_.keeper->search_goes_on([this](Tape& tape) { pass(tape); });
    }
    return false;
}

void DynamicStage::begin_creep(CreepScheme scheme, double duration)
{
    dynamics_.transfer(Transfer(Transfer::Way::keep), before_creep_);
    dynamics_.begin_creep(scheme, duration);
    is_creeping_ = true;
    ++section_.settled.effort.searches;
}

bool DynamicStage::creeps_to_rest(CreepScheme scheme, double duration)
{
    begin_creep(scheme, duration);
    Index& steps = section_.settled.effort.steps;
    try {
        while (!dynamics_.slides() && dynamics_.time() <= section_.scene.large_displacements->longest) {
            for (Index i = 0; i < Dynamics::check_every; ++i, ++steps)
                dynamics_.step();
            if (dynamics_.is_at_rest())
                return true;
        }
    } catch (const equilibrium_error&) {
        // undone, as what slides
    }
    undo_creep();
    return false;
}

double DynamicStage::end_creep()
{
    is_creeping_ = false;
    return dynamics_.end_creep();
}

void DynamicStage::accept_creep()
{
    dynamics_.put_back();
    const Index searches = section_.settled.effort.searches;
    note_rest();
    section_.settled.effort.searches = searches;
}

void DynamicStage::undo_creep()
{
    if (is_creeping_)
        dynamics_.leave_creep();
    is_creeping_ = false;
    dynamics_.transfer(Transfer(Transfer::Way::restore), before_creep_);
}

void DynamicStage::creep_and_slide(CreepScheme scheme, double end)
{
    const std::vector<Vector2d> before = section_.assembly.displacement;
    begin_creep(scheme, end - section_.now);
    section_.now = end;
    begin_records();
    moves_to_rest(std::numeric_limits<double>::infinity(), false);
    end_creep();
    accept_creep();
    watchers_.tell(&Watcher::state_is_due, "");
    record();
    check_energy();
    if (!dynamics_.has_moved())
        return;
    mechanics::no_equilibrium slide("");
    slide.motion = section_.assembly.displacement;
    for (std::size_t g = 0; g < before.size(); ++g)
        slide.motion[g] -= before[g];
    ++section_.findings.slid[day_of(end) + ": " +
                             mechanics::shown_blocks(failure_of(slide, section_.mesh(), section_.assembly))];
}

// Records the present state, and ends the analysis with the blocks that move.
void DynamicStage::give_up(const mechanics::no_equilibrium& error)
{
    dynamics_.put_back();
    watchers_.row_and_state_are_due("");
    record();
    Failure failure = failure_of(error, section_.mesh(), section_.assembly);
    if (const double off = energy_error(); !(off <= section_.scene.large_displacements->energy_tolerance))
        failure.reason += "; " + energy_said(off);
    fail(section_, std::move(failure), section_.now);
}

// The convergence report of the equilibrium at rest.
void DynamicStage::note_rest()
{
    const Energy energy = dynamics_.energy();
    auto& [convergence, effort] = section_.settled;
    convergence = {.steps = effort.steps,
                   .unbalanced_force_ratio = dynamics_.unbalanced_force_ratio(),
                   .contact_force_change = dynamics_.contact_force_change(),
                   .remaining_displacement = -1,
                   .work_of_loads = energy.work,
                   .stored = energy.stored,
                   .dissipated = energy.friction,
                   .damped = energy.damped};
    effort.searches = 1;
}

// Adds the state that was recorded last to the dynamic history.
void DynamicStage::record()
{
    DynamicsHistory& history = section_.result.dynamics;
    history.time.push_back(section_.now / unit::day);
    history.dynamic_time.push_back(dynamics_.time());
    history.state.push_back(static_cast<Index>(section_.result.states.time.size()) - 1);
    history.fastest.push_back(dynamics_.fastest());
    history.unbalanced_force_ratio.push_back(dynamics_.unbalanced_force_ratio());
    record_energy();
    const auto block_of = [&](Index zone) { return zone < 0 ? zone : section_.mesh().zone_block[zone]; };
    for (const large_displacements::Touching& contact : dynamics_.touching()) {
        history.contact_block.push_back({block_of(contact.zone[0]), block_of(contact.zone[1])});
        history.contact_from.push_back(contact.between[0]);
        history.contact_to.push_back(contact.between[1]);
        history.contact_normal.push_back(contact.normal);
        history.contact_traction.push_back(contact.traction);
        history.contact_closing.push_back(contact.closing);
        history.contact_slips.push_back(contact.is_slipping ? 1 : 0);
    }
    history.first_contact.push_back(static_cast<Index>(history.contact_block.size()));
}

void DynamicStage::record_energy()
{
    DynamicsHistory& history = section_.result.dynamics;
    const Energy energy = dynamics_.energy();
    history.work_of_loads.push_back(energy.work);
    history.kinetic_energy.push_back(energy.kinetic);
    history.stored_energy.push_back(energy.stored);
    history.friction_energy.push_back(energy.friction);
    history.damped_energy.push_back(energy.damped);
    for (const double part : {energy.work, energy.kinetic, energy.stored, energy.friction, energy.damped})
        largest_energy_ = std::max(largest_energy_, std::abs(part));
    largest_error_ = std::max(largest_error_, std::abs(energy.error()));
}

// Error of the energy balance of the dynamic analysis that has ended, over its largest energy [-]; told if it is large.
// Where rock only settles, all energies are small. The error of the first step, which is proportional to the square of
// its length, is then not small beside them, and 0 is returned.
double DynamicStage::energy_error()
{
    if (!dynamics_.has_moved())
        return 0;
    const double off = largest_error_ / largest_energy_;
    const bool is_creep = section_.stage.empty() && section_.now > 0;
    if (!(off <= error_to_tell))
        section_.findings.energy_off[is_creep ? "creep to " + day_of(section_.now) : section_.stage] =
            static_cast<Index>(std::lround(off < 1e6 ? 100 * off : 1e8));
    return off;
}

// The guard of dynamic analyses, see analysis/guards.hpp.
void DynamicStage::check_energy()
{
    const double off = energy_error(), tolerance = section_.scene.large_displacements->energy_tolerance;
    if (!(off <= tolerance))
        fail(section_,
             {.reason =
                  energy_said(off) + "; allowed: " + rounded(100 * tolerance) +
                  " percent. Smaller zones ([zones] size_m), or more stiffness damping, reduce the error; "
                  "[large_displacements] energy_tolerance allows it"},
             section_.now);
}

} // namespace jointcreep::analysis
