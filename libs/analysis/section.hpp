// What all parts of an analysis share: the section and its rock, the present time, and the results so far.

#pragma once

#include "implicit/equilibrium.hpp"
#include "mechanics/assembly.hpp"
#include "mechanics/loading.hpp"
#include "mechanics/recorder.hpp"
#include "model/checkpoint.hpp"
#include "sensitivity/sensitivity.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace jointcreep::analysis
{

using mechanics::Vector2d;

// What is to be recorded besides histories and the states at dates; 0 is never.
struct Recording {
    std::uint64_t state_every = 0;        // creep steps
    std::uint64_t step_history_every = 0; // solver steps
    // Parameters of sensitivities, found with the histories by the implicit engine alone.
    std::vector<Scaled> parameters{};
    // Gets the state before every stage, and the result so far; and whenever that much time has passed, if it is given.
    std::function<void(const Result&, const Checkpoint&)> keep{};
    std::optional<std::chrono::duration<double>> keep_every{};
    std::function<bool()> keep_now = [] {
        return false;
    };                           // and at the next possible moment when this says so
    bool keep_beginning = false; // also before the in-situ equilibrium
};

// Where an analysis is.
struct Progress {
    double fraction = 0;          // that is done: mean of the shares of stages and of time [-]
    std::string what;             // the stage; "": creep between stages
    std::string more;             // about a dynamic analysis, or ""
    std::optional<double> time{}; // since start [s]; none: before it, in situ
    const mechanics::Convergence* search = nullptr; // for equilibrium, if one is going on
    double tolerance = 0;                           // of its unbalanced force ratio
};

// Called often. It may throw Stopped to end the analysis.
struct Stopped {
};
using Observer = std::function<void(const Progress&)>;

// What the summary counts.
struct Findings {
    using Counts = std::map<std::string, Index>;
    Counts at_yield_in_situ; // contacts by joint: joints at yield in the initial stress state
    Counts yielded_in_situ;  // zones by rock, yielded in the initial stress state
    Counts given_up;         // equilibria by the reason for which the implicit engine found none
    Counts energy_off;       // error of the energy balance of dynamic analyses, by stage [percent]
    Counts slid;             // creep steps, by the day and the blocks that slid

    // The order is that of checkpoints.
    static constexpr std::array<Counts Findings::*, 5> all{&Findings::at_yield_in_situ,
                                                           &Findings::yielded_in_situ, &Findings::given_up,
                                                           &Findings::energy_off, &Findings::slid};
    void transfer(const Transfer& to, Checkpoint& kept);
};
static_assert(sizeof(Findings) == Findings::all.size() * sizeof(Findings::Counts));

// The last equilibrium, and what it has cost.
struct Settled {
    mechanics::Convergence convergence;
    mechanics::Effort effort; // since the last equilibrium that was recorded
};

struct Section {
    // 1. Divides the blocks into zones and loads them with the in-situ stress. Throws input_error where the
    // engine asked for cannot do what is asked for, and for monitoring points and gauges that have no place.
    Section(const Scene& scene_of, const Network& network_of, const EquivalentJoints& joints_of, int threads,
            const Recording& recording, Observer observer);
    Section(const Section&) = delete; // its parts refer to each other
    Section& operator=(const Section&) = delete;

    const Mesh& mesh() const { return result.mesh; }
    // Tells the observer what is being done, and how far a search for equilibrium has come.
    void say(const std::string& what, const std::string& more = "")
    {
        const bool is_in_situ = stage.empty() && now == 0 && !what.empty();
        progress = {.fraction = share_done(),
                    .what = what,
                    .more = more,
                    .time = is_in_situ ? std::nullopt : std::optional(now),
                    .tolerance = scene.equilibrium.tolerance};
        observe(progress);
    }
    // Mean of the shares of stages and of the scene's time. A stage takes no time of the scene, but much of the computation.
    double share_done() const
    {
        const double of_time = now / scene.end;
        if (scene.stages.empty())
            return of_time;
        const auto n =
            std::ranges::count_if(scene.stages, [this](const Stage& one) { return one.time < now; });
        return (static_cast<double>(n) / static_cast<double>(scene.stages.size()) + of_time) / 2;
    }
    void say_search(const mechanics::Convergence& so_far)
    {
        progress.search = &so_far;
        observe(progress);
        progress.search = nullptr;
    }

    // What a checkpoint keeps of it.
    void transfer(const Transfer& to, Checkpoint& kept);

    const Scene& scene;
    const Network& network;
    const EquivalentJoints& joints;
    Observer observe;
    Progress progress{};
    EngineChoice engine;
    Result result;
    // Sensitivities of the histories' displacements, [parameter][time, point]: per unit of the parameter's
    // logarithm [m].
    std::vector<std::vector<Vector2d>> sensitivities;
    mechanics::Assembly assembly;
    mechanics::Loading loading;
    mechanics::Recorder recorder;
    double now = 0;    // since start [s]
    std::string stage; // being excavated, or ""
    Settled settled;
    Findings findings;
    SearchKeeper* keeper = nullptr; // of long searches for equilibrium, if they are kept
};

// Contacts, by joint, that do not stick.
Findings::Counts contacts_at_yield(const Section& section);
// Zones, by rock, that have yielded.
Findings::Counts yielded_zones(const Section& section);

// Ends the analysis: there is no equilibrium at `time` since start [s]. The failure is in the result;
// throws equilibrium_error with the moving blocks, the day and the stage.
[[noreturn]] void fail(Section& section, Failure failure, double time);

} // namespace jointcreep::analysis
