// demsolve: find a jointed section's equilibrium, excavate it in stages, and let its joints creep.
//
//   demsolve joints.h5 -o result.h5
//   demsolve joints.h5 --factor-of-safety -o result.h5
//
// Reads   joints.h5   blocks, equivalent joints, the scene             (from strength-averaging)
// Writes  result.h5   the same, zones, histories, states of all stages (docs/file-format.md)
//
//         result.failed.h5   where there is no equilibrium: the run up to there, and the moving blocks
//         checkpoint.h5      if asked for: the run up to a stage, to continue from
//
// The method is in libs/analysis. Options are in demsolve_settings, files in demsolve_files, and the summary
// is in demsolve_summary.

#include "demsolve_files.hpp"
#include "demsolve_settings.hpp"
#include "demsolve_summary.hpp"
#include "program.hpp"

#include "analysis/increments.hpp"
#include "analysis/safety.hpp"
#include "model/error.hpp"
#include "scene/scene.hpp"
#include "scene/shared_settings.hpp"
#include "store/files.hpp"
#include "zoning/cost.hpp"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

using namespace jointcreep;
using analysis::Bracket;
using analysis::Ending;
using analysis::Trial;

namespace
{

const Program program{
    .name = "demsolve",
    .summary = "Excavates a jointed section in stages and lets joints and rock creep.",
    .input = "joints.h5",
    .output = "result.h5",
    .options = demsolve::options(),
    .example = "demsolve joints.h5 --threads 2 -o result.h5",
};

using Kept = std::optional<store::CheckpointFile>;

// A run with strengths divided by a factor, which fails where displacement is more than that [m]. It continues from a
// checkpoint, if there is one; its own ones have the runs before, and without these it writes none.
using RunWith = std::function<std::unique_ptr<Trial>(
    const Scene& scene, double factor, double most_displacement, Kept kept, const Safety* runs_before)>;

// Runs with twice as many increments each, until the results hardly change. The last one. Without an equilibrium the run
// that has none.
std::unique_ptr<Trial> run_by_increments(double factor, Scene scene, const RunWith& run_with,
                                         demsolve::Files& files, Summary& summary)
{
    const Safety none;
    std::unique_ptr<Trial> coarser, run;
    double change = 0;
    auto& increments = scene.equilibrium.unloading_increments;
    for (;; increments *= 2) {
        coarser = std::move(run);
        run = run_with(scene, factor, std::numeric_limits<double>::infinity(), std::nullopt, &none);
        if (run->outcome().ending != Ending::stands)
            return run;
        if (coarser)
            change = analysis::change_between(coarser->analysis().result(), run->analysis().result());
        const bool is_last = 2 * increments > scene::numbers_of_increments.most;
        if ((coarser && change <= *scene.equilibrium.increments_tolerance) || is_last)
            break;
    }
    summary.add("unloading increments, chosen", increments);
    summary.add("  change from half as many", change);
    if (change > *scene.equilibrium.increments_tolerance)
        files.warn("from half as many increments results still change by " + shown(100 * change) +
                   " percent");
    return run;
}

// One run, written; the run itself.
std::unique_ptr<Trial> run_once(double factor, const Scene& scene, const RunWith& run_with,
                                demsolve::Files& files, Kept kept, Summary& summary)
{
    const Safety none;
    std::unique_ptr<Trial> run =
        scene.equilibrium.increments_tolerance
            ? run_by_increments(factor, scene, run_with, files, summary)
            : run_with(scene, factor, std::numeric_limits<double>::infinity(), std::move(kept), &none);
    if (run->outcome().ending != Ending::stands)
        throw equilibrium_error(run->message() + '\n' + files.write_failed(*run) +
                                demsolve::warning_lines(*run));
    files.write_result(*run);
    return run;
}

// Where rock yields in quadratic zones: a search with zones twice as large. Zones of constant strain lock whatever their
// size, so that the difference of two sizes says little.
std::optional<demsolve::MeshEstimate> estimate_mesh(const Scene& scene, const RunWith& run_with,
                                                    const demsolve::SafetySearch& search,
                                                    const Bracket& bracket, std::size_t zones)
{
    if (!scene.has_rock_that_yields() || !scene.zones_are_quadratic() || !search.estimates_mesh ||
        !bracket.not_above)
        return std::nullopt;
    Scene with_coarse = scene;
    demsolve::set_zone_size(with_coarse, 2 * scene.zone_size);
    std::size_t coarse_zones = 0;
    Bracket coarse = analysis::bracket_near(
        *bracket.stands,
        [&](double factor, double most_displacement, const Safety&) {
            const auto run = run_with(with_coarse, factor, most_displacement, std::nullopt, nullptr);
            coarse_zones = run->analysis().result().mesh.zone_gridpoint.size();
            return run->outcome();
        },
        search.width, search.runs_away);
    return demsolve::MeshEstimate{std::move(coarse),
                                  static_cast<double>(coarse_zones) / static_cast<double>(zones)};
}

// Runs with different factors. Writes and returns the run of the largest factor at which every equilibrium is found.
// Writes the run of the next larger factor as failed. Runs that an earlier search has made are not made again, but for
// these two, from their last checkpoint.
std::unique_ptr<Trial> bracket_safety(const demsolve::StrengthReduction& reduction, const Scene& scene,
                                      const RunWith& run_with, demsolve::Files& files, Kept kept,
                                      Summary& summary)
{
    const Safety made_before = kept ? kept->safety : Safety{};
    struct Made {
        double factor, most_displacement;
        std::size_t number;
        std::unique_ptr<Trial> run; // none: by an earlier search
    };
    std::optional<Made> stands, falls; // the last ones
    Bracket bracket = analysis::bracket_of(
        [&](double factor, double most_displacement, const Safety& so_far) {
            const std::size_t number = so_far.factor.size();
            Made made{factor, most_displacement, number, nullptr};
            analysis::Outcome outcome{};
            if (number < made_before.factor.size())
                outcome = analysis::outcome_of(made_before, number);
            else {
                made.run =
                    run_with(scene, factor, most_displacement, std::exchange(kept, std::nullopt), &so_far);
                outcome = made.run->outcome();
                files.keep_last_checkpoint(outcome.ending == Ending::stands);
            }
            (outcome.ending == Ending::stands ? stands : falls) = std::move(made);
            return outcome;
        },
        reduction.search->width, reduction.search->runs_away);
    const auto run_of = [&](std::optional<Made>& made, bool stood) {
        if (made && !made->run)
            made->run = run_with(scene, made->factor, made->most_displacement,
                                 files.kept_run(stood, made->number, scene, reduction), nullptr);
        return made ? std::move(made->run) : nullptr;
    };
    std::unique_ptr<Trial> run = run_of(stands, true), failed = run_of(falls, false);
    if (!run)
        throw equilibrium_error("with strengths " + shown(1 / failed->factor()) +
                                " times as large there is still " + failed->message() + '\n' +
                                files.write_failed(*failed, bracket.trials));
    demsolve::add_safety(summary, bracket, failed ? failed->message() : "");
    const auto estimate = estimate_mesh(scene, run_with, *reduction.search, bracket,
                                        run->analysis().result().mesh.zone_gridpoint.size());
    if (estimate) {
        bracket.trials.coarse_factor = estimate->coarse.trials.factor;
        bracket.trials.coarse_stands = estimate->coarse.trials.stands;
        bracket.trials.coarse_largest_displacement = estimate->coarse.trials.largest_displacement;
        if (const std::string warning = demsolve::mesh_warning(bracket, *estimate); !warning.empty())
            files.warn(warning);
    }
    if (scene.has_rock_that_yields() && !scene.zones_are_quadratic())
        files.warn(
            "zones of constant strain lock where rock yields: the factor of safety may be too high by tens of "
            "percent; use zones of kind \"quadratic\"");
    files.write_result(*run, bracket.trials);
    if (failed)
        summary.add("  at this factor", files.write_failed(*failed, bracket.trials));
    if (estimate)
        demsolve::add_mesh_estimate(summary, bracket, *estimate);
    return run;
}

void solve(const Arguments& arguments)
{
    const std::string& input = arguments.input();
    store::check_writable(arguments.output());

    // 1. The section, with the settings of the command line in place of its scene's.
    const store::JointsFile file = store::read_joints(input);
    Scene scene = scene::parse_scene_of_file(file.provenance.scene, input, file.network);
    const std::string end = demsolve::end_scene(arguments, scene);
    const std::string options = demsolve::replace_settings(arguments, scene);
    demsolve::Files files(arguments, program.name, file, options, end);
    const demsolve::StrengthReduction reduction = demsolve::strength_reduction(arguments, scene);
    const int threads = arguments.threads();

    const std::string where = input + (arguments.has("zone-size") ? ", --zone-size" : ": /scene");
    if (const std::string cost = zoning::check_cost(scene, file.network.blocks, where); !cost.empty())
        files.warn(cost);

    // 2. Recording, and the state of a checkpoint, if there is one.
    const analysis::Recording recording = demsolve::recording(arguments);
    Summary summary;
    Kept kept = files.kept_before(scene, reduction);
    if (kept)
        summary.add("continued from", demsolve::place_of(kept->checkpoint, scene));

    // 3. The analysis: in-situ equilibrium, excavation in stages, creep.
    const RunWith run_with = [&](const Scene& of, double divisor, double most_displacement, Kept from,
                                 const Safety* runs_before) {
        Progress progress(program.name, arguments.quiet());
        const std::string which = reduction.search ? "strengths / " + shown(divisor) + ", " : "";
        analysis::Recording with_checkpoints = recording;
        if (files.has_checkpoint() && runs_before != nullptr) {
            with_checkpoints.keep_beginning = reduction.search.has_value();
            with_checkpoints.keep = [&](const Result& so_far, const Checkpoint& checkpoint) {
                files.write_checkpoint(reduction, so_far, checkpoint, *runs_before);
            };
        }
        auto trial = of_file(input, [&] {
            return std::make_unique<Trial>(
                of, file.network, file.equivalent, divisor, most_displacement, threads, with_checkpoints,
                [&progress, which](const analysis::Progress& now) {
                    progress.show(now.fraction, [&] { return which + demsolve::what_is_done(now); });
                });
        });
        of_file(from ? files.checkpoint() : input, [&] {
            if (from)
                trial->go_on(std::move(from->result), std::move(from->checkpoint));
            else
                trial->run();
        });
        return trial;
    };

    // 4. Once, or with strengths divided by factors until rock moves.
    const std::unique_ptr<Trial> run =
        reduction.search ? bracket_safety(reduction, scene, run_with, files, std::move(kept), summary)
                         : run_once(reduction.factor, scene, run_with, files, std::move(kept), summary);
    demsolve::add_run(summary, file.network, *run);
    summary.print(arguments);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, solve);
}
