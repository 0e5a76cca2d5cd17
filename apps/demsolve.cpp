// demsolve: find a jointed section's equilibrium, excavate it in stages, and let its joints creep.
//
//   demsolve joints.h5 -o result.h5
//   demsolve joints.h5 --factor-of-safety -o result.h5
//
// Reads   joints.h5   blocks, equivalent joints, the scene             (from strength-averaging)
// Writes  result.h5   the same, zones, histories, states of all stages (docs/file-format.md)
//
//         result.failed.h5   where there is no equilibrium: the run up to there, and what moves
//         checkpoint.h5      if asked for: the run up to a stage, to continue from
//
// The method is in libs/analysis. Options are in demsolve_settings, files in demsolve_files, and the summary
// is in demsolve_summary.

#include "demsolve_files.hpp"
#include "demsolve_settings.hpp"
#include "demsolve_summary.hpp"
#include "program.hpp"

#include "analysis/safety.hpp"
#include "model/error.hpp"
#include "scene/scene.hpp"
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

// A run with strengths divided by a factor, which fails where displacement is more than that [m].
using RunWith = std::function<std::unique_ptr<Trial>(double factor, double most_displacement)>;

// One run, written; the run itself.
std::unique_ptr<Trial> run_once(double factor, const RunWith& run_with, const demsolve::Files& files)
{
    std::unique_ptr<Trial> run = run_with(factor, std::numeric_limits<double>::infinity());
    if (run->outcome().ending != Ending::stands)
        throw equilibrium_error(run->message() + '\n' + files.write_failed(*run) +
                                demsolve::warning_lines(*run));
    files.write_result(*run);
    return run;
}

// Runs with different factors. Writes and returns the run of the largest factor at which every equilibrium is found.
// Writes the run of the next larger factor as failed.
std::unique_ptr<Trial> bracket_safety(const demsolve::SafetySearch& safety, const RunWith& run_with,
                                      const demsolve::Files& files, Summary& summary)
{
    std::unique_ptr<Trial> run, failed;
    const Bracket bracket = analysis::bracket_of(
        [&](double factor, double most_displacement) {
            std::unique_ptr<Trial> made = run_with(factor, most_displacement);
            const analysis::Outcome outcome = made->outcome();
            (outcome.ending == Ending::stands ? run : failed) = std::move(made);
            return outcome;
        },
        safety.width, safety.runs_away);
    if (!run)
        throw equilibrium_error("with strengths " + shown(1 / failed->factor()) +
                                " times as large there is still " + failed->message() + '\n' +
                                files.write_failed(*failed, bracket.trials));
    demsolve::add_safety(summary, bracket, failed ? failed->message() : "");
    files.write_result(*run, bracket.trials);
    if (failed)
        summary.add("  there", files.write_failed(*failed, bracket.trials));
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
    const auto [factor, search] = demsolve::strength_reduction(arguments, scene);
    const int threads = arguments.threads();

    const std::string where = input + (arguments.has("zone-size") ? ", --zone-size" : ": /scene");
    if (const std::string cost = zoning::check_cost(scene, file.network.blocks, where); !cost.empty())
        files.warn(cost);

    // 2. Recording, and the state of a checkpoint, if there is one.
    analysis::Recording recording = demsolve::recording(arguments);
    Summary summary;
    std::optional<store::CheckpointFile> kept = files.kept_before(arguments, scene, factor);
    if (kept)
        summary.add("continued from", demsolve::place_of(kept->checkpoint, scene));
    if (const auto path = arguments.text("checkpoint"))
        recording.keep = [&files, path, factor = factor](const Result& so_far, const Checkpoint& checkpoint) {
            files.write_checkpoint(*path, factor, so_far, checkpoint);
        };

    // 3. The analysis: in-situ equilibrium, excavation in stages, creep.
    const RunWith run_with = [&, is_bracket = search.has_value()](double divisor, double most_displacement) {
        Progress progress(arguments.quiet());
        const std::string which = is_bracket ? "strengths / " + shown(divisor) + ", " : "";
        return of_file(input, [&] {
            auto run = std::make_unique<Trial>(scene, file.network, file.equivalent, divisor,
                                               most_displacement, threads, recording,
                                               [&progress, which](double fraction, const std::string& what) {
                                                   progress.show(fraction, which + what);
                                               });
            if (kept)
                run->go_on(std::move(kept->result), std::move(kept->checkpoint));
            else
                run->run();
            return run;
        });
    };

    // 4. Once, or with strengths divided by factors until rock moves.
    const std::unique_ptr<Trial> run =
        search ? bracket_safety(*search, run_with, files, summary) : run_once(factor, run_with, files);
    demsolve::add_run(summary, file.network, *run);
    summary.print(arguments);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, solve);
}
