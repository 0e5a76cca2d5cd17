#include "demsolve_search.hpp"

#include "model/error.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

namespace jointcreep::demsolve
{

using analysis::Bracket;
using analysis::Outcome;
using analysis::Trial;

namespace
{

// "at least 1, below 1.5"
std::string in_words(const Bracket& bracket)
{
    std::string words = bracket.stands ? "at least " + shown(*bracket.stands) : "";
    if (bracket.not_above) {
        words += (words.empty() ? "" : ", ") + std::string(bracket.fails() ? "below " : "undecided at ") +
                 shown(*bracket.not_above);
    }
    return words;
}

// "strengths / 1.5", "strengths x 64".
std::string strengths_by(double factor)
{
    return factor < 1 ? "strengths x " + rounded(1 / factor) : "strengths / " + shown(factor);
}

// Whether these are no more than the reference of displacements, a run whose factor nobody asks for.
bool is_reference_only(const Safety& trials)
{
    return trials.factor.size() == 1 && trials.factor[0] < 1 && trials.stands[0] > 0;
}

// " (at least 1)", " (1 to 1.5)", "?" where the upper end is undecided; "" as long as no run has said anything.
std::string in_brief(const Safety& trials)
{
    const Bracket bracket = analysis::bracket_of(trials);
    const bool has_lower = bracket.stands && *bracket.stands != trials.factor[0];
    const std::string lower = has_lower ? rounded(*bracket.stands) : "";
    if (!bracket.not_above)
        return has_lower ? " (at least " + lower + ')' : "";
    return " (" + (has_lower ? lower + " to " : std::string("below ")) + rounded(*bracket.not_above) +
           (bracket.fails() ? ")" : "?)");
}

// "run 4, strengths / 1.5: fails; factor of safety at least 1, below 1.5; at most 5 more runs". The first
// run is the reference of displacements.
std::string last_run_in_words(const Safety& so_far, const analysis::Search& search)
{
    const std::optional<int> left = is_reference_only(so_far) ? std::nullopt : search.runs_left(so_far);
    const Index stands = so_far.stands.back();
    return "run " + std::to_string(so_far.factor.size()) + ", " + strengths_by(so_far.factor.back()) +
           (stands > 0    ? ": stable"
            : stands == 0 ? ": fails"
                          : ": undecided") +
           (is_reference_only(so_far) ? ", for comparison"
                                      : "; factor of safety " + in_words(analysis::bracket_of(so_far))) +
           (left.value_or(0) == 0 ? ""
            : *left == 1          ? "; at most 1 more run"
                                  : "; at most " + std::to_string(*left) + " more runs");
}

// The runs of a search. The progress of the next one is shown.
class SaidRuns : public analysis::Runs
{
public:
    SaidRuns(const analysis::Search& search, const Scene& scene, const RunWith& run_with, const Files& files,
             std::string of_what)
        : search_(search), scene_(scene), run_with_(run_with), files_(files), of_what_(std::move(of_what))
    {
    }

    Outcome run(double factor, double most_displacement, const std::stop_token& stop) override
    {
        RunOf of = wanted(factor, most_displacement);
        of.stop = stop;
        auto run = run_with_(std::move(of));
        if (run->is_stopped())
            throw analysis::Stopped();
        const Outcome outcome = run->outcome();
        const std::lock_guard lock(mutex_);
        run_[factor] = std::move(run);
        return outcome;
    }

    void is_next(double factor, const Safety& before) override
    {
        const std::lock_guard lock(mutex_);
        next_ = factor;
        before_ = before;
        const std::string known = known_so_far();
        which_ = {of_what_ + strengths_by(factor) +
                      (known.empty() ? "" : " (factor of safety " + known + ")") + ", ",
                  (of_what_.empty() ? "" : "coarse, ") +
                      (factor < 1 && before.factor.empty() ? strengths_by(factor) : "F " + rounded(factor)) +
                      in_brief(before) + ", "};
    }

    void has_ended(const Safety& so_far) override
    {
        const std::lock_guard lock(mutex_);
        files_.say(of_what_ + last_run_in_words(so_far, search_));
        const Bracket bracket = analysis::bracket_of(so_far);
        for (const double factor : so_far.factor) // results are large, and only those of these two are needed
            if (factor != bracket.stands && factor != bracket.not_above)
                run_.erase(factor);
    }

    void is_dropped(double factor) override
    {
        const std::lock_guard lock(mutex_);
        run_.erase(factor);
    }

    // The bracket by the runs that have ended; "" as long as these say nothing.
    std::string known_so_far() const
    {
        return is_reference_only(before_) ? "" : in_words(analysis::bracket_of(before_));
    }

    // The run at an end of the bracket; none: an earlier search made it.
    std::unique_ptr<Trial> run_of(double factor) { return std::move(run_[factor]); }

protected:
    virtual RunOf wanted(double factor, double most_displacement)
    {
        return {.scene = scene_,
                .factor = factor,
                .most_displacement = most_displacement,
                .which = [this, factor]() -> std::optional<Which> {
                    const std::lock_guard lock(mutex_);
                    return next_ == factor ? std::optional(which_) : std::nullopt;
                }};
    }

    const analysis::Search search_;
    const Scene& scene_;
    const RunWith& run_with_;
    const Files& files_;
    std::string of_what_;
    std::mutex mutex_;
    double next_ = 0;
    Which which_{};                                  // what the next one is called
    Safety before_{};                                // runs before the next one
    std::map<double, std::unique_ptr<Trial>> run_{}; // by factor
};

// With checkpoints. The next run writes them; runs beside it keep their last one, and write it when they are next.
class KeptRuns : public SaidRuns
{
public:
    KeptRuns(const StrengthReduction& reduction, const analysis::Search& search, const Scene& scene,
             const RunWith& run_with, const Files& files, std::optional<store::CheckpointFile> from)
        : SaidRuns(search, scene, run_with, files, ""), reduction_(reduction), from_(std::move(from))
    {
    }

    void is_next(double factor, const Safety& before) override
    {
        SaidRuns::is_next(factor, before);
        const std::lock_guard lock(mutex_);
        if (const auto found = kept_.find(factor); found != kept_.end())
            write(found->second.first, found->second.second);
        kept_.clear();
    }

    void has_ended(const Safety& so_far) override
    {
        files_.keep_last_checkpoint(so_far.stands.back() > 0);
        SaidRuns::has_ended(so_far);
    }

private:
    RunOf wanted(double factor, double most_displacement) override
    {
        RunOf run = SaidRuns::wanted(factor, most_displacement);
        if (!files_.has_checkpoint())
            return run;
        const std::lock_guard lock(mutex_);
        if (next_ == factor)
            run.from = std::exchange(from_, std::nullopt);
        run.keep = [this, factor](const Result& so_far, const Checkpoint& checkpoint) {
            const std::lock_guard while_kept(mutex_);
            if (next_ == factor)
                write(so_far, checkpoint);
            else
                kept_.insert_or_assign(factor, std::pair(so_far, checkpoint));
        };
        return run;
    }

    void write(const Result& so_far, const Checkpoint& checkpoint)
    {
        files_.write_checkpoint(reduction_, so_far, checkpoint, before_);
    }

    const StrengthReduction& reduction_;
    std::optional<store::CheckpointFile> from_; // of an interrupted search
    std::map<double, std::pair<Result, Checkpoint>> kept_{};
};

// Where rock yields in quadratic zones: a search with zones twice as large. Zones of constant strain lock whatever their
// size, so that the difference of two sizes says little.
std::optional<MeshEstimate> estimate_mesh(const Scene& scene, const RunWith& run_with, const Files& files,
                                          const SafetySearch& search, const Bracket& bracket,
                                          std::size_t zones)
{
    if (!scene.has_rock_that_yields() || !scene.zones_are_quadratic() || !search.estimates_mesh ||
        !bracket.not_above)
        return std::nullopt;
    Scene with_coarse = scene;
    set_zone_size(with_coarse, 2 * scene.zone_size);
    const analysis::Search near{search.width, search.runs_away, *bracket.stands};
    SaidRuns runs(near, with_coarse, run_with, files, "with zones twice as large, ");
    Bracket coarse = analysis::bracket_by(near, runs, search.at_once);
    const auto any = runs.run_of(coarse.stands.value_or(coarse.not_above.value_or(0)));
    return MeshEstimate{std::move(coarse),
                        static_cast<double>(any->analysis().result().mesh.zone_gridpoint.size()) /
                            static_cast<double>(zones)};
}

} // namespace

std::unique_ptr<Trial> bracket_safety(const StrengthReduction& reduction, const Scene& scene,
                                      const RunWith& run_with, Files& files,
                                      std::optional<store::CheckpointFile> kept, Summary& summary)
{
    const analysis::Search search{reduction.search->width, reduction.search->runs_away};
    const Safety made_before = kept ? kept->safety : Safety{};
    if (!made_before.factor.empty())
        files.say("from " + files.checkpoint() + ": " + last_run_in_words(made_before, search));
    KeptRuns runs(reduction, search, scene, run_with, files, std::move(kept));
    Bracket bracket;
    try {
        bracket = analysis::bracket_by(search, runs, reduction.search->at_once, made_before);
    } catch (const analysis::Stopped&) {
        const std::string known = runs.known_so_far();
        files.stop("stopped; " +
                   (known.empty() ? "nothing is known of the factor of safety yet"
                                  : "the factor of safety is " + known) +
                   ". With --checkpoint FILE a stopped search can continue");
    }
    const auto run_of = [&](std::optional<double> factor, bool stood) -> std::unique_ptr<Trial> {
        if (!factor)
            return nullptr;
        if (auto made = runs.run_of(*factor))
            return made;
        const auto& all = bracket.trials.factor;
        const auto number =
            static_cast<std::size_t>(std::find(all.begin(), all.end(), *factor) - all.begin());
        auto again =
            run_with({.scene = scene,
                      .factor = *factor,
                      .most_displacement = search.most_displacement(number == 0 ? Safety{} : bracket.trials),
                      .from = files.kept_run(stood, number, scene, reduction)});
        if (again->is_stopped())
            files.stop("stopped; the factor of safety is " + in_words(bracket) +
                       ". The same command continues from " + files.checkpoint());
        return again;
    };
    std::unique_ptr<Trial> run = run_of(bracket.stands, true), failed = run_of(bracket.not_above, false);
    if (!run)
        throw equilibrium_error("with strengths " + shown(1 / failed->factor()) +
                                " times as large there is still " + failed->message() + '\n' +
                                files.write_failed(*failed, bracket.trials));
    add_safety(summary, bracket, failed ? failed->message() : "");
    if (failed && failed->outcome().ending == analysis::Ending::undecided)
        files.warn("undecided with strengths divided by " + shown(*bracket.not_above) +
                   ": the factor of safety may be above " + shown(*bracket.stands));
    std::optional<MeshEstimate> estimate;
    try {
        estimate = estimate_mesh(scene, run_with, files, *reduction.search, bracket,
                                 run->analysis().result().mesh.zone_gridpoint.size());
    } catch (const analysis::Stopped&) {
        files.warn("stopped before the mesh's share of the factor was known");
    }
    if (estimate) {
        bracket.trials.coarse_factor = estimate->coarse.trials.factor;
        bracket.trials.coarse_stands = estimate->coarse.trials.stands;
        bracket.trials.coarse_largest_displacement = estimate->coarse.trials.largest_displacement;
        if (const std::string warning = mesh_warning(bracket, *estimate); !warning.empty())
            files.warn(warning);
    }
    if (scene.has_rock_that_yields() && !scene.zones_are_quadratic())
        files.warn(
            "zones of constant strain lock where rock yields: the factor of safety may be too high by tens of "
            "percent; use zones of kind \"quadratic\"");
    files.write_result(*run, bracket.trials);
    if (failed)
        summary.add("run without equilibrium, strengths / " + shown(*bracket.not_above),
                    files.write_failed(*failed, bracket.trials));
    files.stop("stopped; the factor of safety is " + in_words(bracket) + ", and its files are written");
    if (estimate)
        add_mesh_estimate(summary, bracket, *estimate);
    return run;
}

} // namespace jointcreep::demsolve
