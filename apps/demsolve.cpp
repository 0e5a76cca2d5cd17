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
#include "demsolve_search.hpp"
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

#include <memory>
#include <optional>
#include <utility>

using namespace jointcreep;
using analysis::Ending;
using analysis::Trial;

namespace
{

const Program program{
    .name = "demsolve",
    .summary = "Computes the equilibrium, the excavation in stages, and the creep of a jointed section.",
    .input = "joints.h5",
    .output = "result.h5",
    .options = demsolve::options(),
    .example = "demsolve joints.h5 --threads 2 -o result.h5",
};

using demsolve::RunOf;
using demsolve::RunWith;

// Runs with twice as many increments each, until the results hardly change. The last one. Without an equilibrium the run
// that has none.
std::unique_ptr<Trial> run_by_increments(double factor, Scene scene, const RunWith& run_with,
                                         demsolve::Files& files, Summary& summary)
{
    std::unique_ptr<Trial> coarser, run;
    double change = 0;
    auto& increments = scene.equilibrium.unloading_increments;
    for (;; increments *= 2) {
        coarser = std::move(run);
        run = run_with({.scene = scene, .factor = factor});
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
        files.warn("from half as many increments results still change by " + rounded(100 * change) +
                   " percent");
    return run;
}

// One run, written; the run itself.
std::unique_ptr<Trial> run_once(const demsolve::StrengthReduction& reduction, const Scene& scene,
                                const RunWith& run_with, demsolve::Files& files,
                                std::optional<store::CheckpointFile> kept, Summary& summary)
{
    RunOf of{.scene = scene, .factor = reduction.factor, .from = std::move(kept)};
    if (files.has_checkpoint())
        of.keep = [&](const Result& so_far, const Checkpoint& checkpoint) {
            files.write_checkpoint(reduction, so_far, checkpoint);
        };
    std::unique_ptr<Trial> run = scene.equilibrium.increments_tolerance
                                     ? run_by_increments(reduction.factor, scene, run_with, files, summary)
                                     : run_with(std::move(of));
    if (run->is_stopped())
        files.stop("stopped; " + files.write_failed(*run) +
                   (scene.equilibrium.increments_tolerance
                        ? ""
                        : ". With --checkpoint FILE a stopped run can continue"));
    if (run->outcome().ending != Ending::stands)
        throw equilibrium_error(run->message() + '\n' + files.write_failed(*run) +
                                demsolve::warning_lines(*run));
    files.write_result(*run);
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
    if (reduction.search || reduction.factor != 1)
        if (const std::string merged = demsolve::merging_warning(scene, file.network.blocks); !merged.empty())
            files.warn(merged);

    // 2. Recording, and the state of a checkpoint, if there is one.
    const analysis::Recording recording = demsolve::recording(arguments);
    Summary summary;
    std::optional<store::CheckpointFile> kept = files.kept_before(scene, reduction);
    if (kept)
        summary.add("continued from", demsolve::place_of(kept->checkpoint, scene));

    // 3. The analysis: in-situ equilibrium, excavation in stages, creep.
    const RunWith run_with = [&](RunOf of) {
        Progress progress(program.name, arguments.quiet());
        analysis::Recording with_checkpoints = recording;
        with_checkpoints.keep = of.keep;
        with_checkpoints.keep_beginning = reduction.search.has_value();
        auto trial = of_file(input, [&] {
            return std::make_unique<Trial>(
                of.scene, file.network, file.equivalent, of.factor, of.most_displacement, threads,
                with_checkpoints, [&](const analysis::Progress& now) {
                    if (of.stop.stop_requested())
                        throw demsolve::Dropped();
                    if (is_asked_to_stop() && !of.keep)
                        throw analysis::Stopped();
                    if (const auto which = of.which())
                        progress.show(now.fraction, [&](std::size_t most) {
                            return demsolve::what_is_done(*which, now, scene.end > 0, most);
                        });
                });
        });
        of_file(of.from ? files.checkpoint() : input, [&] {
            if (of.from)
                trial->go_on(std::move(of.from->result), std::move(of.from->checkpoint));
            else
                trial->run();
        });
        return trial;
    };

    // 4. Once, or with strengths divided by factors until rock moves.
    const std::unique_ptr<Trial> run =
        reduction.search
            ? demsolve::bracket_safety(reduction, scene, run_with, files, std::move(kept), summary)
            : run_once(reduction, scene, run_with, files, std::move(kept), summary);
    demsolve::add_run(summary, file.network, *run);
    summary.count_warnings(files.warnings_said(), file.provenance.warnings.text.size());
    summary.print(arguments);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, solve);
}
