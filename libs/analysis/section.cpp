#include "analysis/section.hpp"

#include "joint/equivalent.hpp"
#include "mechanics/failure.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "zoning/zone.hpp"

#include <algorithm>

namespace jointcreep::analysis
{

namespace
{

// A thread with fewer zones than this spends its time waiting for the others.
constexpr int zones_per_thread = 2000;

// Sensitivities are found by the implicit engine alone, and at small displacements. Forces have checks of their own.
void check_sensitivities(const Scene& scene, const Recording& recording)
{
    if (scene.large_displacements)
        throw input_error(
            "sensitivities are of small displacements; expected a scene without [large_displacements]");
    if (scene.equilibrium.engine == EngineChoice::relaxation || recording.step_history_every > 0)
        throw input_error(
            "sensitivities are found by the implicit engine; expected an equilibrium.engine other "
            "than \"relaxation\", and no step history");
}

// Dynamic relaxation where the scene or the user asks for it. Otherwise the implicit engine, and dynamic
// relaxation where that fails.
EngineChoice engine_for(const Scene& scene, const Recording& recording)
{
    const EngineChoice asked_for = scene.equilibrium.engine;
    if (asked_for == EngineChoice::implicit && recording.step_history_every > 0)
        throw input_error(
            "--step-history records steps of dynamic relaxation; the implicit engine has none. Choose "
            "--engine auto or relaxation");
    if (!recording.parameters.empty()) {
        check_sensitivities(scene, recording);
        return EngineChoice::implicit; // masses make no difference at rest
    }
    const bool needs_relaxation =
        scene.equilibrium.masses == Masses::real || recording.step_history_every > 0;
    if (asked_for == EngineChoice::automatic && needs_relaxation)
        return EngineChoice::relaxation;
    return asked_for;
}

} // namespace

void Findings::transfer(const Transfer& to, Checkpoint& kept)
{
    if (to.restores())
        for (std::size_t r = 0; r < kept.remark.size(); ++r)
            (this->*all.at(kept.remark_kind[r]))[kept.remark[r]] = kept.remark_count[r];
    else
        for (std::size_t kind = 0; kind < all.size(); ++kind)
            for (const auto& [remark, n] : this->*all[kind]) {
                kept.remark_kind.push_back(static_cast<Index>(kind));
                kept.remark.push_back(remark);
                kept.remark_count.push_back(n);
            }
}

Section::Section(const Scene& scene_of, const Network& network_of, const EquivalentJoints& joints_of,
                 int threads, const Recording& recording, Observer observer)
    : scene(scene_of), network(network_of), joints(joints_of), observe(std::move(observer)),
      engine(engine_for(scene, recording)), result{.mesh = zoning::zone(scene, network.blocks),
                                                   .history = {},
                                                   .states = {},
                                                   .equilibria = {},
                                                   .step_history = {},
                                                   .dynamics = {}},
      assembly(mechanics::assemble(scene, network, joints, result.mesh)), loading(scene, result.mesh),
      recorder(scene, network.blocks, result.mesh)
{
    assembly.threads =
        std::min(threads, 1 + static_cast<int>(result.mesh.zone_gridpoint.size()) / zones_per_thread);
    loading.apply(assembly, 0);
    recorder.begin(result);
    result.states.initial_gap.assign(assembly.contacts.gridpoint.size(), 0.0); // until the first state
}

void Section::transfer(const Transfer& to, Checkpoint& kept)
{
    to.value(now, kept.time);
    if (to.restores())
        loading.apply(assembly, now);
    mechanics::transfer(to, assembly, kept);
    findings.transfer(to, kept);
}

Findings::Counts contacts_at_yield(const Section& section)
{
    Findings::Counts contacts;
    const std::vector<ContactStatus>& status = section.assembly.contacts.status;
    for (std::size_t c = 0; c < status.size(); ++c)
        if (status[c] != ContactStatus::stuck)
            ++contacts[joint::joint_name(section.scene, section.network, section.mesh().contact_edge[c])];
    return contacts;
}

Findings::Counts yielded_zones(const Section& section)
{
    Findings::Counts zones;
    const std::vector<Index>& block = section.mesh().zone_block;
    for (std::size_t zone = 0; zone < block.size(); ++zone)
        if (has_yielded(section.assembly.zones, zone))
            ++zones[section.scene.rocks[section.network.blocks.block_rock[block[zone]]].name];
    return zones;
}

void fail(Section& section, Failure failure, double time)
{
    failure.time = time / unit::day;
    failure.stage = section.stage;
    std::string message = failure.reason + "\non day " + rounded(failure.time, 7);
    if (!failure.stage.empty())
        message += ", stage \"" + failure.stage + "\"";
    if (!failure.block.empty())
        message += (failure.moves_on ? "; moving blocks: " : "; blocks that moved most: ") +
                   mechanics::shown_blocks(failure);
    if (failure.steps > 0)
        message += ", in the last " + std::to_string(failure.steps) + " steps of the solver";
    if (failure.seconds > 0)
        message += ", " + rounded(failure.seconds) + " s";
    section.result.failure = std::move(failure);
    throw equilibrium_error(message);
}

} // namespace jointcreep::analysis
