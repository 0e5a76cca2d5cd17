// demsolve: find a jointed section's equilibrium, excavate it in stages, and let its joints creep.
//
//   demsolve joints.h5 -o result.h5
//
// Reads   joints.h5   blocks, equivalent joints, the scene             (from strength-averaging)
// Writes  result.h5   the same, zones, histories, states of all stages (docs/file-format.md)
//
// The method is solve() below: every step is one call into libs/.

#include "program.hpp"

#include "creep/published.hpp"
#include "mechanics/assembly.hpp"
#include "mechanics/excavation.hpp"
#include "mechanics/loading.hpp"
#include "mechanics/recorder.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "model/version.hpp"
#include "relaxation/relax.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"
#include "zoning/zone.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

using namespace jointcreep;

namespace
{

const Program program{
    .name = "demsolve",
    .summary = "Excavates a jointed section in stages and lets its joints creep.",
    .input = "joints.h5",
    .output = "result.h5",
    .options = {{"threads", "N", "threads of the solver; they do not change the result (default 1)"},
                {"zone-size", "M", "longest side of zones [m] (default: the scene's)"},
                {"tolerance", "T", "out-of-balance ratio of an equilibrium (default: the scene's)"},
                {"creep-step", "DAYS", "creep step [day] (default: the scene's)"},
                {"no-creep", "", "excavate only"},
                {"states", "N", "record the whole section every N creep steps too (default: at dates only)"},
                {"trace", "N", "record points and gauges every N solver steps"}},
    .example = "demsolve joints.h5 --threads 2 -o result.h5",
};

// A thread with fewer zones than this spends its time waiting for the others.
constexpr int zones_per_thread = 2000;

// Takes the command line's choices into the scene, and returns them as the result file records them.
std::string choose(const Arguments& arguments, Scene& scene)
{
    std::string chosen;
    const auto note = [&](const char* name, const std::string& value) {
        chosen += (chosen.empty() ? "--" : " --") + std::string(name) + (value.empty() ? "" : " " + value);
    };
    if (const auto size = arguments.number("zone-size")) {
        require(*size > 0 && *size <= 1e6, "--zone-size", *size, "m", "must be above 0 and at most 1e6");
        scene.zone_size = *size;
        note("zone-size", shown(*size));
    }
    if (const auto tolerance = arguments.number("tolerance")) {
        require(*tolerance >= 1e-12 && *tolerance <= 1e-2, "--tolerance", *tolerance, "(ratio)",
                "must be between 1e-12 and 0.01");
        scene.equilibrium.tolerance = *tolerance;
        note("tolerance", shown(*tolerance));
    }
    if (const auto step = arguments.number("creep-step")) {
        require(*step > 0 && *step <= 1e6, "--creep-step", *step, "day", "must be above 0 and at most 1e6");
        if (arguments.has("no-creep"))
            throw input_error("--creep-step and --no-creep do not go together");
        if (!scene.creep)
            throw input_error("--creep-step: the scene has no [creep]");
        scene.creep->step = *step * unit::day;
        scene.creep->tolerance.reset();
        note("creep-step", shown(*step));
    }
    if (arguments.has("no-creep")) {
        scene.creep.reset();
        note("no-creep", "");
    }
    for (const char* option : {"states", "trace"})
        if (const auto every = arguments.whole_number(option, 1, 1000000000))
            note(option, std::to_string(*every));
    return chosen;
}

// How far the gridpoint that moved farthest has moved [m].
double largest_move(const std::vector<Eigen::Vector2d>& from, const std::vector<Eigen::Vector2d>& to)
{
    double largest = 0;
    for (std::size_t g = 0; g < from.size(); ++g)
        largest = std::max(largest, (to[g] - from[g]).norm());
    return largest;
}

// What an edge's joint is called: its set, or the material of the joint that a boundary rests on.
std::string joint_name(const Scene& scene, const Network& network, Index edge)
{
    const Index joint = network.blocks.edge_joint[edge];
    return joint < 0 ? scene.boundaries[network.blocks.edge_boundary[edge]].joint
                     : network.names.joint_set[network.joints.set[joint]];
}

// Steps of equal length, no longer than `step`, from one time to another [s].
int creep_steps(double from, double to, double step)
{
    constexpr double most = 1e6;
    const double n = std::ceil((to - from) / step * (1 - 1e-12));
    if (n > most)
        throw input_error("creep step of " + shown(step / unit::day) + " day: that makes " + shown(n) +
                          " steps from day " + shown(from / unit::day) + " to day " + shown(to / unit::day) +
                          "; wanted at most " + shown(most));
    return static_cast<int>(n);
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
    for (const MeasuringPoint& point : scene.points)
        if (point.first_reading > 0)
            dates.insert(point.first_reading);
    return dates;
}

struct Solution {
    Result result;
    mechanics::Assembly assembly;
    std::map<std::string, Index> beyond_strength; // contacts by joint: what the in-situ stress breaks
    bool creeps = false;
    std::optional<double> end_of_creep; // since start [s], where the scene's stop rate ended it early
};

// What the result file is to hold besides histories and the states at dates; 0 is never.
struct Recording {
    std::uint64_t state_every = 0; // creep steps
    std::uint64_t trace_every = 0; // solver steps
};

Solution solve(const Scene& scene, const Network& network, const EquivalentJoints& joints, int threads,
               const Recording& recording, Progress& progress)
{
    Solution solution;
    Result& result = solution.result;

    // 1. Divide the blocks into zones and load them with the in-situ stress.
    progress.show(0, "zones");
    result.mesh = zoning::zone(scene, network.blocks);
    mechanics::Assembly& rock = solution.assembly = mechanics::assemble(scene, network, joints, result.mesh);
    rock.threads =
        std::min(threads, 1 + static_cast<int>(result.mesh.zone_gridpoint.size()) / zones_per_thread);
    mechanics::Loading loading(scene, result.mesh);
    loading.apply(rock, 0);
    const mechanics::Recorder recorder(scene, network.blocks, result.mesh);

    double now = 0;         // since start [s]
    double solver_time = 0; // over all equilibria [s]
    std::uint64_t steps = 0, creep_steps_done = 0;
    const auto equilibrate = [&] {
        double last = 0;
        const auto observe = [&](double time) {
            last = time;
            if (recording.trace_every > 0 && ++steps % recording.trace_every == 0)
                recorder.record_trace(result, now, solver_time + time, rock);
        };
        const mechanics::Certificate certificate = relaxation::relax(
            rock, scene.equilibrium, recording.trace_every > 0 ? observe : relaxation::StepObserver{});
        solver_time += last;
        recorder.record_equilibrium(result, now, certificate);
    };

    // 2. The in-situ equilibrium. Everything is counted from here.
    progress.show(0, "in-situ equilibrium");
    equilibrate();
    for (std::size_t c = 0; c < rock.contacts.status.size(); ++c)
        if (rock.contacts.status[c] != ContactStatus::stuck)
            ++solution.beyond_strength[joint_name(scene, network, result.mesh.contact_edge[c])];
    start_from_here(rock);
    loading.apply(rock, 0);
    creep::Published creep(result.mesh, joints, rock.contacts.traction);
    recorder.record_history(result, now, "", rock);
    recorder.record_state(result, now, "", rock);
    solution.creeps = scene.creep && creep::creeps(joints);

    // After this nothing happens but creep.
    const std::set<double> corners = loading.corners();
    const double last_event = std::max(scene.stages.empty() ? 0.0 : scene.stages.back().time,
                                       corners.empty() ? 0.0 : *corners.rbegin());
    for (const double date : dates_of(scene, loading)) {
        if (solution.end_of_creep)
            break;
        // 3. Creep up to the next date, in equal steps no longer than the scene's.
        const double start = now;
        const bool creeps = solution.creeps;
        const bool is_loaded = loading.changes(start, date);
        const int n_steps = std::max(is_loaded ? scene.equilibrium.unloading_increments : 1,
                                     creeps ? creep_steps(start, date, *scene.creep->step) : 1);
        for (int i = 1; i <= n_steps; ++i) {
            progress.show(now / scene.end, "day " + std::to_string(std::lround(now / unit::day)));
            const double next = i == n_steps ? date : start + (date - start) * i / n_steps;
            const bool may_stop = creeps && scene.creep->stop_rate && start >= last_event;
            const std::vector<Eigen::Vector2d> before =
                may_stop ? rock.displacement : std::vector<Eigen::Vector2d>{};
            const double duration = next - now;
            if (creeps)
                creep.advance(duration, rock.contacts.traction, rock.contacts.offset);
            now = next;
            if (is_loaded)
                loading.apply(rock, now);
            if (creeps || is_loaded)
                equilibrate();
            recorder.record_history(result, now, "", rock);
            if (creeps && recording.state_every > 0 && ++creep_steps_done % recording.state_every == 0 &&
                i < n_steps)
                recorder.record_state(result, now, "", rock);
            if (may_stop && largest_move(before, rock.displacement) < *scene.creep->stop_rate * duration) {
                solution.end_of_creep = now;
                break;
            }
        }
        recorder.record_state(result, now, "", rock);

        // 4. Take away what the date's stage removes; unload what is left.
        for (std::size_t s = 0; s < scene.stages.size(); ++s) {
            const Stage& stage = scene.stages[s];
            if (stage.time != date)
                continue;
            progress.show(now / scene.end, stage.name);
            const auto released =
                mechanics::excavate(rock, network.blocks, result.mesh, loading, static_cast<Index>(s));
            const std::vector<Eigen::Vector2d> load = rock.load;
            const int n = scene.equilibrium.unloading_increments;
            for (int i = 1; i <= n; ++i) {
                const double held = 1 - static_cast<double>(i) / n;
                for (std::size_t g = 0; g < load.size(); ++g)
                    rock.load[g] = load[g] + held * released[g];
                equilibrate();
            }
            recorder.record_history(result, now, stage.name, rock);
            recorder.record_state(result, now, stage.name, rock);
        }
        recorder.start_readings(result, now);
    }
    for (const MeasuringPoint& point : scene.points)
        if (point.first_reading > now) // creep has ended before: nothing moves until then
            recorder.start_readings(result, point.first_reading);
    return solution;
}

void report(const Network& network, const Scene& scene, const Solution& solution)
{
    const Result& result = solution.result;
    const zoning::MeshQuality quality = zoning::quality_of(result.mesh);
    const auto& equilibria = result.equilibria;
    std::int64_t steps = 0;
    for (const Index n : equilibria.steps)
        steps += n;
    std::array<Index, 4> contacts{};
    for (const ContactStatus status : solution.assembly.contacts.status)
        ++contacts[static_cast<std::size_t>(status)];

    Summary summary;
    summary.add("blocks", network.blocks.block_area.size());
    summary.add("zones", result.mesh.zone_gridpoint.size());
    summary.add("gridpoints", result.mesh.gridpoint.size());
    summary.add("contacts", result.mesh.contact_edge.size());
    summary.add("shortest block edge", network.blocks.report.shortest_edge, "m");
    summary.add("shortest zone side", quality.shortest_side, "m");
    summary.add("smallest zone altitude", quality.smallest_altitude, "m");
    summary.add("smallest zone angle", quality.smallest_angle / unit::deg, "deg");
    summary.add("stages", scene.stages.size());
    summary.add("equilibria", equilibria.steps.size());
    summary.add("solver steps", steps);
    summary.add("largest out-of-balance ratio", *std::max_element(equilibria.out_of_balance_ratio.begin(),
                                                                  equilibria.out_of_balance_ratio.end()));
    if (scene.creep && !solution.creeps)
        summary.add("warning: no creep", std::string("no joint of the section has Kelvin constants"));
    if (solution.end_of_creep)
        summary.add("creep ended early", *solution.end_of_creep / unit::day, "day");
    summary.add("contacts stuck", contacts[static_cast<std::size_t>(ContactStatus::stuck)]);
    summary.add("contacts slipping", contacts[static_cast<std::size_t>(ContactStatus::slipping)]);
    summary.add("contacts open", contacts[static_cast<std::size_t>(ContactStatus::open)]);
    for (const auto& [joint, n] : solution.beyond_strength)
        summary.add("warning: beyond strength in situ",
                    std::to_string(n) + " contacts of joint \"" + joint + "\"");
    summary.print();
}

// The published creep step is stable up to a limit that the joints set; beyond it its answer would be wrong.
void check_creep_step(const Scene& scene, const Network& network, const EquivalentJoints& joints)
{
    if (!scene.creep)
        return;
    if (scene.creep->scheme != CreepScheme::published || !scene.creep->step)
        throw input_error("[creep]: demsolve knows the published scheme with step_days alone so far");
    const creep::StepLimit limit = creep::longest_step(joints);
    if (*scene.creep->step < limit.step)
        return;
    throw input_error("creep step of " + shown(*scene.creep->step / unit::day) +
                      " day: the published scheme is stable only below " + shown(limit.step / unit::day) +
                      " day, the limit of joint \"" + joint_name(scene, network, limit.edge) + "\"");
}

void solve_and_write(const Arguments& arguments)
{
    const std::string& input = arguments.input();
    check_writable(arguments.output());
    const JointsFile file = read_joints(input);
    Scene scene = parse_scene(file.provenance.scene, input + ": /scene");
    const std::string options = choose(arguments, scene);
    check_creep_step(scene, file.network, file.equivalent);
    const auto threads = static_cast<int>(arguments.whole_number("threads", 1, 1024).value_or(1));
    const Recording recording{arguments.whole_number("states", 1, 1000000000).value_or(0),
                              arguments.whole_number("trace", 1, 1000000000).value_or(0)};

    const Solution solution = [&] {
        Progress progress(arguments.quiet()); // wiped out before the closing screen
        return solve(scene, file.network, file.equivalent, threads, recording, progress);
    }();

    Provenance provenance = file.provenance;
    provenance.program.push_back(program.name);
    provenance.version.emplace_back(version());
    provenance.input_sha256.push_back(sha256_of(input));
    provenance.options.push_back(options);
    write_result(arguments.output(), provenance, file.network, file.equivalent, solution.result);
    if (!arguments.quiet())
        report(file.network, scene, solution);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, solve_and_write);
}
