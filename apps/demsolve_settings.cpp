#include "demsolve_settings.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "scene/scene.hpp"
#include "scene/shared_settings.hpp"

#include <algorithm>
#include <functional>
#include <string_view>

namespace jointcreep::demsolve
{

namespace
{

constexpr std::uint64_t most_steps = 1000000000; // between two records

// A word of a scene as the command line has it: without blanks.
std::string as_option(std::string_view word)
{
    std::string option(word);
    std::replace(option.begin(), option.end(), ' ', '-');
    return option;
}

// A word of earlier versions, refused by a message that has the new one.
struct RenamedWord {
    std::string_view before, now;
};

// "published, backward, linear-force or fitted": `last` stands before the last one.
template <class Choice>
std::string listed(const keys::Words<Choice>& words, const std::string& last = ", ")
{
    std::string all;
    for (std::size_t i = 0; i < words.size(); ++i)
        all += (i == 0 ? "" : i + 1 < words.size() ? ", " : last) + as_option(words[i].first);
    return all;
}

template <class Choice>
Choice chosen_from(const keys::Words<Choice>& words, const RenamedWord& renamed, const std::string& option,
                   const std::string& name)
{
    for (const auto& [word, choice] : words)
        if (as_option(word) == name)
            return choice;
    if (!name.empty() && name == renamed.before)
        throw input_error("--" + option + " " + name + " is now called --" + option + " " +
                          std::string(renamed.now));
    throw input_error("--" + option + ": \"" + name + "\" is none of " + listed(words));
}

[[noreturn]] void refuse_together(const std::string& option, const std::string& other)
{
    throw input_error("--" + option + " and --" + other + " do not go together");
}

// A setting of the scene that an option replaces. replace() puts the value that is given there, and returns it
// as the result file records it.
struct Setting {
    Option option;
    std::function<std::string(const Arguments&, const std::string& option, Scene&)> replace;
    bool is_of_creep = false;
    std::string not_with{}; // another option, or ""
};

// A number in a range.
auto number(const Range& range, std::string_view unit, const std::function<void(Scene&, double)>& set)
{
    return [=](const Arguments& arguments, const std::string& option, Scene& scene) {
        const double value = arguments.number(option, range, unit).value();
        set(scene, value);
        return shown(value);
    };
}

// One of some words.
template <class Choice>
auto word(const keys::Words<Choice>& words, const RenamedWord& renamed,
          const std::function<void(Scene&, Choice)>& set)
{
    return [=](const Arguments& arguments, const std::string& option, Scene& scene) {
        std::string value = arguments.text(option).value();
        set(scene, chosen_from(words, renamed, option, value));
        return value;
    };
}

void set_creep_step(Scene& scene, double days)
{
    scene.creep->step = days * unit::day;
    scene.creep->tolerance.reset();
}

void set_creep_tolerance(Scene& scene, double tolerance)
{
    scene.creep->step.reset();
    scene.creep->tolerance = tolerance;
}

std::vector<Setting> settings()
{
    return {
        {{"zone-size", "M",
          "longest side of zones [m]; size_at_faces_m changes in proportion (default: the scene's)"},
         number(scene::zone_sizes, "m", set_zone_size)},
        {{"tolerance", "T", "unbalanced force ratio of an equilibrium (default: the scene's)"},
         number(scene::equilibrium_tolerances, "(ratio)",
                [](Scene& scene, double tolerance) { scene.equilibrium.tolerance = tolerance; })},
        {{"engine", "NAME", listed(scene::engine_words(), " or ") + " (default: the scene's)"},
         word<EngineChoice>(scene::engine_words(), {scene::former_engine_word, scene::engine_word_for_it},
                            [](Scene& scene, EngineChoice engine) { scene.equilibrium.engine = engine; })},
        {{"creep-scheme", "NAME", listed(scene::creep_scheme_words(), " or ") + " (default: the scene's)"},
         word<CreepScheme>(scene::creep_scheme_words(), {},
                           [](Scene& scene, CreepScheme scheme) { scene.creep->scheme = scheme; }),
         true},
        {{"creep-step", "DAYS", "creep step of a fixed length [day] (default: the scene's)"},
         number(scene::creep_steps, "day", set_creep_step),
         true,
         "creep-tolerance"},
        {{"creep-tolerance", "M",
          "error of a creep step, by which its length is chosen [m] (default: the scene's)"},
         number(scene::creep_tolerances, "m", set_creep_tolerance),
         true},
    };
}

// Settings of creep go with creep.
void check_creep(const Arguments& arguments, const std::string& option, const Scene& scene)
{
    if (arguments.has("no-creep"))
        refuse_together(option, "no-creep");
    if (!scene.creep)
        throw input_error("--" + option + ": the scene has no [creep]");
}

// Options of the result file, as they are on the command line.
class Noted
{
public:
    void add(const std::string& option, const std::string& value = "")
    {
        text_ += (text_.empty() ? "--" : " --") + option + (value.empty() ? "" : " " + value);
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

} // namespace

void set_zone_size(Scene& scene, double size)
{
    if (scene.zone_size_at_faces)
        *scene.zone_size_at_faces *= size / scene.zone_size;
    scene.zone_size = size;
}

std::vector<Option> options()
{
    std::vector<Option> all{
        {"threads", "N", "threads of the solver; they do not change the result (default 1)"}};
    for (const Setting& setting : settings())
        all.push_back(setting.option);
    const std::vector<Option> others{
        {"increments", "N", "increments of excavation and of loads that change (default: the scene's)"},
        {"increments-tolerance", "T",
         "double the increments until displacements and tractions change by less than T; result.h5 is that of "
         "--increments N, with the last N (default: the scene's)"},
        {"no-creep", "", "excavate only"},
        {"strength-factor", "F",
         "divide all strengths of joints and of rock that yields by F: cohesion, tensile strength, "
         "tan(friction angle) and tan(dilation angle), or the strength of Barton and Bandis's law "
         "(default 1)"},
        {"factor-of-safety", "",
         "bracket the largest F with which every equilibrium is found, by runs with different F; "
         "result.h5 is the run with the largest F that has every equilibrium, result.failed.h5 the run with the "
         "smallest F that has not"},
        {"safety-width", "W", "width of the bracket of --factor-of-safety, over F (default 0.01)"},
        {"safety-displacement", "R",
         "a run fails if its largest displacement is more than R times that with strengths 64 times as large "
         "(default 10)"},
        {"runs-at-once", "N",
         "make N runs of that search side by side; they do not change the result (default 1)"},
        {"no-mesh-estimate", "",
         "where rock yields: no second search with zones twice as large, which estimates the error of the mesh"},
        {"until", "DAY", "end on this day, before or after the scene's end [day]"},
        {"checkpoint", "FILE",
         "write the state to FILE, before every stage and at intervals; if FILE exists, continue from it"},
        {"checkpoint-every", "MIN",
         "write the checkpoint again when MIN minutes have passed, at the next possible moment (default 10; "
         "0: before stages only)"},
        {"states", "N", "record the whole section every N creep steps too (default: at dates only)"},
        {"step-history", "N", "record points and gauges every N solver steps"}};
    all.insert(all.end(), others.begin(), others.end());
    return all;
}

std::string name_of(EngineChoice engine)
{
    for (const auto& [word, choice] : scene::engine_words())
        if (choice == engine)
            return std::string(word);
    return "";
}

std::string replace_settings(const Arguments& arguments, Scene& scene)
{
    Noted noted;
    for (const Setting& setting : settings()) {
        const std::string& option = setting.option.name;
        if (!arguments.has(option))
            continue;
        if (setting.is_of_creep)
            check_creep(arguments, option, scene);
        noted.add(option, setting.replace(arguments, option, scene));
        if (arguments.has(setting.not_with))
            refuse_together(option, setting.not_with);
    }
    if (const auto number = arguments.whole_number(
            "increments", 1, static_cast<std::uint64_t>(scene::numbers_of_increments.most))) {
        scene.equilibrium.unloading_increments = static_cast<std::int32_t>(*number);
        scene.equilibrium.increments_tolerance.reset();
    }
    if (const auto tolerance =
            arguments.number("increments-tolerance", scene::increments_tolerances, "(ratio)")) {
        if (arguments.has("increments"))
            refuse_together("increments", "increments-tolerance");
        scene.equilibrium.increments_tolerance = tolerance;
    }
    if (scene.large_displacements)
        for (const char* option : {"increments", "increments-tolerance"})
            if (arguments.has(option))
                throw input_error("--" + std::string(option) +
                                  ": the scene has [large_displacements], where forces go to 0 in release_s");
    if (scene.equilibrium.increments_tolerance)
        for (const char* option : {"factor-of-safety", "checkpoint"})
            if (arguments.has(option))
                throw input_error("--" + std::string(option) +
                                  " does not go with increments chosen by error; expected --increments N");
    if (arguments.has("no-creep")) {
        scene.creep.reset();
        noted.add("no-creep");
    }
    for (const char* option : {"states", "step-history"})
        if (const auto every = arguments.whole_number(option, 1, most_steps)) {
            if (scene.large_displacements)
                throw input_error(
                    "--" + std::string(option) +
                    ": the scene has [large_displacements], which records the section every record_every_s");
            noted.add(option, std::to_string(*every));
        }
    if (arguments.has("increments")) // the last one, as where they are chosen (demsolve_files.cpp)
        noted.add("increments", std::to_string(scene.equilibrium.unloading_increments));
    return noted.text();
}

std::string end_scene(const Arguments& arguments, Scene& scene)
{
    const auto day = arguments.number("until", above(0).to(keys::farthest_day), "day");
    if (!day)
        return "";
    scene.end = *day * unit::day;
    std::erase_if(scene.stages, [&](const Stage& stage) { return stage.time > scene.end; });
    for (MonitoringPoint& point : scene.points)
        point.first_reading = std::min(point.first_reading, scene.end);
    return "--until " + shown(*day);
}

std::string StrengthReduction::text() const
{
    if (search)
        return "--factor-of-safety --safety-width " + shown(search->width) + " --safety-displacement " +
               shown(search->runs_away) + (search->estimates_mesh ? "" : " --no-mesh-estimate");
    return factor == 1 ? "" : "--strength-factor " + shown(factor);
}

StrengthReduction strength_reduction(const Arguments& arguments, const Scene& scene)
{
    const double factor = arguments.number("strength-factor", from(1e-3).to(1e3), "(ratio)").value_or(1);
    const bool has_bracket = arguments.has("factor-of-safety");
    if (arguments.has("strength-factor") && has_bracket)
        refuse_together("strength-factor", "factor-of-safety");
    const double width = arguments.number("safety-width", from(1e-4).to(1), "(ratio)").value_or(0.01);
    const double runs_away = arguments.number("safety-displacement", from(2).to(1e6), "(ratio)").value_or(10);
    if (!has_bracket) {
        for (const std::string option :
             {"safety-width", "safety-displacement", "runs-at-once", "no-mesh-estimate"})
            if (arguments.has(option))
                throw input_error("--" + option + " goes with --factor-of-safety only");
        return {factor, {}};
    }
    require(width >= 100 * scene.equilibrium.tolerance, "--safety-width", width, "(ratio)",
            "must be at least 100 times the tolerance of equilibria, " + shown(scene.equilibrium.tolerance) +
                ", which separates equilibrium from movement");
    if (scene.equilibrium.engine == EngineChoice::implicit)
        throw input_error("--factor-of-safety: the implicit engine cannot show that blocks are moving; "
                          "expected --engine auto or relaxation");
    if (scene.large_displacements)
        throw input_error(
            "--factor-of-safety: the scene has [large_displacements], where rock that fails reaches a new equilibrium; "
            "expected a scene without");
    return {factor, demsolve::SafetySearch{width, runs_away, !arguments.has("no-mesh-estimate"),
                                           arguments.threads("runs-at-once")}};
}

analysis::Recording recording(const Arguments& arguments)
{
    analysis::Recording recording{arguments.whole_number("states", 1, most_steps).value_or(0),
                                  arguments.whole_number("step-history", 1, most_steps).value_or(0)};
    const double minutes = arguments.number("checkpoint-every", from(0).to(1e6), "min").value_or(10);
    if (!arguments.has("checkpoint") && arguments.has("checkpoint-every"))
        throw input_error("--checkpoint-every goes with --checkpoint only");
    stop_when_asked(arguments.program(), arguments.has("checkpoint")
                                             ? "when its state is kept in the checkpoint"
                                             : "at the next possible moment");
    if (arguments.has("checkpoint"))
        recording.keep_now = is_asked_to_stop;
    if (arguments.has("checkpoint") && minutes > 0)
        recording.keep_every = std::chrono::duration<double>(60 * minutes);
    return recording;
}

} // namespace jointcreep::demsolve
