// demsolve: find a jointed section's equilibrium, excavate it in stages, and let its joints creep.
//
//   demsolve joints.h5 -o result.h5
//
// Reads   joints.h5   blocks, equivalent joints, the scene             (from strength-averaging)
// Writes  result.h5   the same, zones, histories, states of all stages (docs/file-format.md)
//
//         result.failed.h5   where there is no equilibrium: the run up to there, and what moves
//         checkpoint.h5      if asked for: the run up to a stage, to go on from
//
// The method is in libs/analysis.

#include "program.hpp"

#include "analysis/analysis.hpp"
#include "analysis/safety.hpp"
#include "joint/strength_factor.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "model/version.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"
#include "zoning/zone.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

using namespace jointcreep;
using analysis::Analysis;
using analysis::Bracket;
using analysis::Ending;
using analysis::Observer;
using analysis::Recording;

namespace
{

const Program program{
    .name = "demsolve",
    .summary = "Excavates a jointed section in stages and lets joints and rock creep.",
    .input = "joints.h5",
    .output = "result.h5",
    .options = {{"threads", "N", "threads of the solver; they do not change the result (default 1)"},
                {"zone-size", "M",
                 "longest side of zones [m]; size_at_faces_m changes in proportion (default: the scene's)"},
                {"tolerance", "T", "unbalanced force ratio of an equilibrium (default: the scene's)"},
                {"engine", "NAME",
                 "auto, relaxation (dynamic relaxation) or implicit (default: the scene's)"},
                {"creep-scheme", "NAME",
                 "published, backward, linear-force or fitted (default: the scene's)"},
                {"creep-step", "DAYS", "creep step of a fixed length [day] (default: the scene's)"},
                {"creep-tolerance", "M",
                 "error of a creep step, by which its length is chosen [m] (default: the scene's)"},
                {"no-creep", "", "excavate only"},
                {"strength-factor", "F",
                 "divide all strengths of joints and of rock that yields by F: cohesion, tensile strength, "
                 "tan(friction angle) and tan(dilation angle), or what Barton and Bandis's law bears "
                 "(default 1)"},
                {"factor-of-safety", "",
                 "bracket the largest F with which every equilibrium is found, by runs with different F; "
                 "result.h5 is of that F, result.failed.h5 of the next one"},
                {"safety-width", "W", "width of that bracket, over F (default 0.01)"},
                {"until", "DAY", "end there instead of at the scene's end, before or after it [day]"},
                {"checkpoint", "FILE",
                 "before every stage, keep there what it begins with; if FILE exists, go on from it"},
                {"states", "N", "record the whole section every N creep steps too (default: at dates only)"},
                {"step-history", "N", "record points and gauges every N solver steps"}},
    .example = "demsolve joints.h5 --threads 2 -o result.h5",
};

// A word of a scene as the command line has it: without blanks.
std::string as_option(std::string_view word)
{
    std::string option(word);
    std::replace(option.begin(), option.end(), ' ', '-');
    return option;
}

template <class Choice>
Choice chosen_from(const scene::Words<Choice>& words, const std::string& option, const std::string& name)
{
    std::string all;
    for (const auto& [word, choice] : words) {
        if (as_option(word) == name)
            return choice;
        all += (all.empty() ? "" : ", ") + as_option(word);
    }
    throw input_error("--" + option + ": \"" + name + "\" is none of " + all);
}

std::string named(EngineChoice engine)
{
    for (const auto& [word, choice] : scene::engine_words())
        if (choice == engine)
            return std::string(word);
    return "";
}

// Takes the command line's choices into the scene, and returns them as the result file records them.
std::string choose(const Arguments& arguments, Scene& scene)
{
    std::string chosen;
    const auto note = [&](const char* name, const std::string& value) {
        chosen += (chosen.empty() ? "--" : " --") + std::string(name) + (value.empty() ? "" : " " + value);
    };
    if (const auto size = arguments.number("zone-size", scene::zone_sizes, "m")) {
        if (scene.zone_size_at_faces)
            *scene.zone_size_at_faces *= *size / scene.zone_size;
        scene.zone_size = *size;
        note("zone-size", shown(*size));
    }
    if (const auto tolerance = arguments.number("tolerance", scene::equilibrium_tolerances, "(ratio)")) {
        scene.equilibrium.tolerance = *tolerance;
        note("tolerance", shown(*tolerance));
    }
    if (const auto engine = arguments.text("engine")) {
        scene.equilibrium.engine = chosen_from(scene::engine_words(), "engine", *engine);
        note("engine", *engine);
    }
    for (const char* option : {"creep-scheme", "creep-step", "creep-tolerance"}) {
        if (!arguments.has(option))
            continue;
        if (arguments.has("no-creep"))
            throw input_error("--" + std::string(option) + " and --no-creep do not go together");
        if (!scene.creep)
            throw input_error("--" + std::string(option) + ": the scene has no [creep]");
    }
    if (const auto scheme = arguments.text("creep-scheme")) {
        scene.creep->scheme = chosen_from(scene::creep_scheme_words(), "creep-scheme", *scheme);
        note("creep-scheme", *scheme);
    }
    if (const auto step = arguments.number("creep-step", scene::creep_steps, "day")) {
        if (arguments.has("creep-tolerance"))
            throw input_error("--creep-step and --creep-tolerance do not go together");
        scene.creep->step = *step * unit::day;
        scene.creep->tolerance.reset();
        note("creep-step", shown(*step));
    }
    if (const auto tolerance = arguments.number("creep-tolerance", scene::creep_tolerances, "m")) {
        scene.creep->step.reset();
        scene.creep->tolerance = *tolerance;
        note("creep-tolerance", shown(*tolerance));
    }
    if (arguments.has("no-creep")) {
        scene.creep.reset();
        note("no-creep", "");
    }
    if (arguments.has("checkpoint") && arguments.has("factor-of-safety"))
        throw input_error("--checkpoint and --factor-of-safety do not go together");
    for (const char* option : {"states", "step-history"})
        if (const auto every = arguments.whole_number(option, 1, 1000000000)) {
            if (scene.large_displacements)
                throw input_error(
                    "--" + std::string(option) +
                    ": the scene has [large_displacements], which records the section every record_every_s");
            note(option, std::to_string(*every));
        }
    return chosen;
}

std::string off_by(Index percent, const std::string& stage)
{
    return "off by " + std::to_string(percent) + " percent in the dynamic analysis " +
           (stage.empty() ? "in situ" : "of stage \"" + stage + "\"");
}

void report(const Network& network, const Scene& scene, const Analysis& analysis, Summary summary)
{
    const Result& result = analysis.result();
    const zoning::MeshQuality quality = zoning::quality_of(result.mesh);
    const auto& equilibria = result.equilibria;
    const auto sum = [](const std::vector<Index>& numbers) {
        return std::accumulate(numbers.begin(), numbers.end(), std::int64_t{0});
    };
    const auto by_factor = sum(equilibria.is_implicit);
    std::array<Index, 4> contacts{};
    for (const ContactStatus status : analysis.rock().contacts.status)
        ++contacts[static_cast<std::size_t>(status)];

    summary.add("blocks", network.blocks.block_area.size());
    summary.add("zones", result.mesh.zone_gridpoint.size());
    summary.add("gridpoints", result.mesh.gridpoint.size());
    summary.add("contacts", result.mesh.contact_edge.size());
    summary.add("shortest block edge", network.blocks.report.shortest_edge, "m");
    summary.add("shortest zone side", quality.shortest_side, "m");
    summary.add("smallest zone altitude", quality.smallest_altitude, "m");
    summary.add("smallest zone angle", quality.smallest_angle / unit::deg, "deg");
    summary.add("stages", scene.stages.size());
    const bool chose = scene.equilibrium.engine == EngineChoice::automatic;
    summary.add("engine",
                analysis.engine() == EngineChoice::automatic
                    ? std::string("implicit, and dynamic relaxation where that gives up (auto)")
                    : named(analysis.engine()) + (chose ? " (auto: real masses or a step history)" : ""));
    summary.add("equilibria by the implicit engine", by_factor);
    summary.add("equilibria by dynamic relaxation",
                static_cast<std::int64_t>(equilibria.is_implicit.size()) - by_factor);
    for (const auto& [reason, n] : analysis.findings().given_up)
        summary.add("implicit engine gave up", std::to_string(n) + " times: " + reason);
    summary.add("equilibria rejected or sought in vain",
                sum(equilibria.searches) - static_cast<std::int64_t>(equilibria.searches.size()));
    summary.add("solver steps", sum(equilibria.steps));
    summary.add("factorisations", sum(equilibria.factorisations));
    summary.add("back-substitutions", sum(equilibria.solves));
    summary.add("largest unbalanced force ratio", *std::max_element(equilibria.unbalanced_force_ratio.begin(),
                                                                    equilibria.unbalanced_force_ratio.end()));
    summary.add(
        "largest remaining displacement, by estimate",
        *std::max_element(equilibria.remaining_displacement.begin(), equilibria.remaining_displacement.end()),
        "m");
    if (scene.creep && !analysis.creeps())
        summary.add("warning: no creep", std::string("neither joints nor rocks of the section creep"));
    if (const auto& limit = analysis.stable_limit())
        summary.add("creep steps below", shown(limit->step / unit::day) + " day: " + limit->of);
    if (analysis.end_of_creep())
        summary.add("creep ended early", *analysis.end_of_creep() / unit::day, "day");
    summary.add("contacts stuck", contacts[static_cast<std::size_t>(ContactStatus::stuck)]);
    summary.add("contacts slipping", contacts[static_cast<std::size_t>(ContactStatus::slipping)]);
    summary.add("contacts open", contacts[static_cast<std::size_t>(ContactStatus::open)]);
    for (const auto& [joint, n] : analysis.findings().beyond_strength)
        summary.add("warning: beyond strength in situ",
                    std::to_string(n) + " contacts of joint \"" + joint + "\"");
    for (const auto& [rock, n] : analysis.findings().yielded_in_situ)
        summary.add("warning: beyond strength in situ",
                    std::to_string(n) + " zones of rock \"" + rock + "\"");
    for (const auto& [rock, n] : analysis.yielded())
        summary.add("zones yielded since", std::to_string(n) + " of rock \"" + rock + "\"");
    for (const auto& [stage, percent] : analysis.findings().energy_off)
        summary.add("warning: account of energy", off_by(percent, stage));
    summary.print();
}

// A run with strengths divided by a factor.
struct Run {
    Run(const Scene& given, const store::JointsFile& file, double divisor, int threads,
        const Recording& recording, const Observer& observe, std::optional<store::CheckpointFile> from = {})
        : factor(divisor), scene(divisor == 1 ? given : joint::with_strength_divided(given, divisor)),
          joints(divisor == 1 ? file.equivalent : joint::with_strength_divided(file.equivalent, divisor)),
          analysis(scene, file.network, joints, threads, recording, observe)
    {
        try {
            if (from)
                analysis.go_on(std::move(from->result), std::move(from->checkpoint));
            else
                analysis.run();
        } catch (const equilibrium_error& error) {
            message = error.what();
        }
    }

    Ending ending() const
    {
        if (message.empty())
            return Ending::stands;
        return analysis.result().failure.moves_on ? Ending::falls : Ending::undecided;
    }

    double factor;
    Scene scene;
    EquivalentJoints joints;
    Analysis analysis;
    std::string message{}; // why there is no equilibrium; empty: every one was found
};

std::string warnings_of(const Run& run)
{
    std::string lines;
    for (const auto& [stage, percent] : run.analysis.findings().energy_off)
        lines += "\nwarning: account of energy " + off_by(percent, stage);
    return lines;
}

class Writer
{
public:
    // A run that ends on another day may go on from the same checkpoint: `end` is no part of `options`.
    Writer(const Arguments& arguments, const store::JointsFile& file, std::string options, std::string end)
        : input_(arguments.input()), output_(arguments.output()), failed_(failed_name(output_)), file_(file),
          provenance_(file.provenance), options_(std::move(options)), end_(std::move(end))
    {
        store::check_writable(output_);
        if (std::error_code absent; std::filesystem::equivalent(arguments.input(), failed_, absent))
            throw input_error(arguments.input() + ": a run without equilibrium would be written there; " +
                              "wanted another name than " + output_);
        provenance_.program.push_back(program.name);
        provenance_.version.emplace_back(version());
        provenance_.input_sha256.push_back(store::sha256_of(arguments.input()));
    }

    void write(const Run& run, const Safety& safety = {}) const { write(run, safety, output_); }

    void write_checkpoint(const std::string& path, double factor, const Result& so_far,
                          const Checkpoint& checkpoint) const
    {
        store::write_checkpoint(path, provenance(options_of(factor)), file_.network, file_.equivalent, so_far,
                                checkpoint);
    }

    // Throws if this run would not have come by where the checkpoint is, bit by bit.
    void check_same_run(const std::string& path, double factor, const store::CheckpointFile& kept) const
    {
        const Provenance here = provenance(options_of(factor));
        const auto check = [&](const char* dataset, const std::vector<std::string>& of_kept,
                               const std::vector<std::string>& of_here, const std::string& wanted) {
            if (of_kept != of_here)
                throw input_error(path + ": " + dataset + " is \"" + (of_kept.empty() ? "" : of_kept.back()) +
                                  "\"; wanted " + wanted + ". Delete the checkpoint to begin anew");
        };
        check("/provenance/input_sha256", kept.provenance.input_sha256, here.input_sha256,
              "that of " + input_ + ", \"" + here.input_sha256.back() + '"');
        check("/provenance/version", kept.provenance.version, here.version,
              "\"" + here.version.back() + "\", this program's, as another one may compute otherwise");
        check("/provenance/options", kept.provenance.options, here.options,
              "the same options, \"" + here.options.back() + '"');
    }

    // Returns what to say of it.
    std::string write_failed(const Run& run, const Safety& safety = {}) const
    {
        if (std::error_code none;
            std::filesystem::exists(output_, none) && !std::filesystem::is_regular_file(output_, none))
            return ""; // a device, say: it has no neighbours
        try {
            write(run, safety, failed_);
            return "the run up to there is in " + failed_;
        } catch (const file_error& error) {
            return std::string("the run up to there is lost: ") + error.what();
        }
    }

private:
    void write(const Run& run, const Safety& safety, const std::string& path) const
    {
        std::string options = options_of(run.factor);
        if (!end_.empty())
            options += (options.empty() ? "" : " ") + end_;
        store::write_result(path, provenance(options), file_.network, file_.equivalent, run.analysis.result(),
                            safety);
    }

    std::string options_of(double factor) const
    {
        std::string options = factor == 1 ? "" : "--strength-factor " + shown(factor);
        if (!options.empty() && !options_.empty())
            options += ' ';
        return options + options_;
    }

    Provenance provenance(const std::string& options) const
    {
        Provenance provenance = provenance_;
        provenance.options.push_back(options);
        return provenance;
    }

    std::string input_, output_, failed_;
    const store::JointsFile& file_;
    Provenance provenance_;
    std::string options_, end_;
};

double wanted_factor(const Arguments& arguments)
{
    const double factor = arguments.number("strength-factor", from(1e-3).to(1e3), "(ratio)").value_or(1);
    if (arguments.has("strength-factor") && arguments.has("factor-of-safety"))
        throw input_error("--strength-factor and --factor-of-safety do not go together");
    return factor;
}

double wanted_width(const Arguments& arguments, const Scene& scene)
{
    const double width = arguments.number("safety-width", from(1e-4).to(1), "(ratio)").value_or(0.01);
    if (!arguments.has("factor-of-safety")) {
        if (arguments.has("safety-width"))
            throw input_error("--safety-width goes with --factor-of-safety only");
        return width;
    }
    require(width >= 100 * scene.equilibrium.tolerance, "--safety-width", width, "(ratio)",
            "must be at least 100 times the tolerance of equilibria, " + shown(scene.equilibrium.tolerance) +
                ", which tells rest from movement");
    if (scene.equilibrium.engine == EngineChoice::implicit)
        throw input_error("--factor-of-safety: the implicit engine cannot tell rock that moves on from an "
                          "equilibrium it does not find; wanted --engine auto or relaxation");
    return width;
}

// What a bracket is, and what moves at its upper end.
void add_safety(Summary& summary, const Bracket& bracket, const std::string& why)
{
    summary.add("factor of safety, at least", shown(*bracket.stands));
    const Safety& trials = bracket.trials;
    summary.add("runs", trials.factor.size());
    if (!bracket.not_above) {
        summary.add("factor of safety, below", std::string("none found: strength decides nothing"));
        return;
    }
    const auto upper =
        std::find(trials.factor.begin(), trials.factor.end(), *bracket.not_above) - trials.factor.begin();
    summary.add(trials.stands[upper] == 0 ? "factor of safety, below" : "warning: no answer at",
                shown(*bracket.not_above));
    std::size_t from = 0;
    for (std::size_t end = 0; end != std::string::npos; from = end + 1) {
        end = why.find('\n', from);
        summary.add("  there", why.substr(from, end == std::string::npos ? end : end - from));
    }
    if (trials.stands[upper] != 0) { // one that fails may be known all the same
        double fails = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < trials.factor.size(); ++i)
            if (trials.stands[i] == 0)
                fails = std::min(fails, trials.factor[i]);
        if (std::isfinite(fails))
            summary.add("factor of safety, below", shown(fails));
    }
}

// Lets the scene end on the day of --until, if given; returns that option as the result file records it.
std::string end_scene(const Arguments& arguments, Scene& scene)
{
    const auto day = arguments.number("until", above(0).to(scene::farthest_day), "day");
    if (!day)
        return "";
    scene.end = *day * unit::day;
    std::erase_if(scene.stages, [&](const Stage& stage) { return stage.time > scene.end; });
    for (MonitoringPoint& point : scene.points)
        point.first_reading = std::min(point.first_reading, scene.end);
    return "--until " + shown(*day);
}

// What --checkpoint has kept before, if anything.
std::optional<store::CheckpointFile> kept_before(const Arguments& arguments, const Scene& scene,
                                                 const Writer& writer, double factor)
{
    const auto path = arguments.text("checkpoint");
    if (!path)
        return {};
    store::check_writable(*path);
    for (const std::string& other : {arguments.input(), arguments.output(), failed_name(arguments.output())})
        if (std::filesystem::weakly_canonical(*path) == std::filesystem::weakly_canonical(other))
            throw input_error("--checkpoint " + *path + " is " + other + ", too; give it another name");
    if (!std::filesystem::exists(*path))
        return {};
    store::CheckpointFile kept = store::read_checkpoint(*path);
    writer.check_same_run(*path, factor, kept);
    if (kept.checkpoint.time > scene.end)
        throw input_error(*path + ": /checkpoint/time is day " + shown(kept.checkpoint.time / unit::day) +
                          "; wanted not after --until " + shown(scene.end / unit::day));
    return kept;
}

void solve_and_write(const Arguments& arguments)
{
    const std::string& input = arguments.input();
    store::check_writable(arguments.output());
    const store::JointsFile file = store::read_joints(input);
    Scene scene = scene::parse_scene(file.provenance.scene, input + ": /scene");
    const std::string end = end_scene(arguments, scene);
    const Writer writer(arguments, file, choose(arguments, scene), end);
    const double factor = wanted_factor(arguments), width = wanted_width(arguments, scene);
    if (scene.large_displacements && arguments.has("factor-of-safety"))
        throw input_error(
            "--factor-of-safety: the scene has [large_displacements], where what fails comes to rest again; "
            "wanted one without");
    const auto threads = static_cast<int>(arguments.whole_number("threads", 1, 1024).value_or(1));
    Recording recording{arguments.whole_number("states", 1, 1000000000).value_or(0),
                        arguments.whole_number("step-history", 1, 1000000000).value_or(0)};
    std::optional<store::CheckpointFile> kept = kept_before(arguments, scene, writer, factor);
    if (const auto path = arguments.text("checkpoint"))
        recording.keep = [&writer, path, factor](const Result& so_far, const Checkpoint& checkpoint) {
            writer.write_checkpoint(*path, factor, so_far, checkpoint);
        };

    std::optional<Progress> progress(arguments.quiet());
    const auto run_with = [&](double divisor) {
        const std::string which =
            arguments.has("factor-of-safety") ? "strengths / " + shown(divisor) + ", " : "";
        return std::make_unique<Run>(
            scene, file, divisor, threads, recording,
            [&](double fraction, const std::string& what) { progress->show(fraction, which + what); },
            std::exchange(kept, std::nullopt));
    };
    Summary summary;
    if (kept)
        summary.add("went on from", "stage \"" + scene.stages.at(kept->checkpoint.stage).name + "\", day " +
                                        shown(kept->checkpoint.time / unit::day));
    std::unique_ptr<Run> run, failed; // the one with the largest factor that stands, and the one above
    if (arguments.has("factor-of-safety")) {
        const Bracket bracket = analysis::bracket_of(
            [&](double divisor) {
                std::unique_ptr<Run> made = run_with(divisor);
                const Ending ending = made->ending();
                (ending == Ending::stands ? run : failed) = std::move(made);
                return ending;
            },
            width);
        progress.reset(); // wiped out before the summary
        if (!run)
            throw equilibrium_error("with strengths " + shown(1 / failed->factor) +
                                    " times as large there is still " + failed->message + '\n' +
                                    writer.write_failed(*failed, bracket.trials));
        add_safety(summary, bracket, failed ? failed->message : "");
        writer.write(*run, bracket.trials);
        if (failed)
            summary.add("  there", writer.write_failed(*failed, bracket.trials));
    } else {
        run = run_with(factor);
        progress.reset();
        if (!run->message.empty())
            throw equilibrium_error(run->message + '\n' + writer.write_failed(*run) + warnings_of(*run));
        writer.write(*run);
    }
    if (!arguments.quiet())
        report(file.network, scene, run->analysis, summary);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, solve_and_write);
}
