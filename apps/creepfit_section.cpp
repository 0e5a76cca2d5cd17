#include "creepfit_section.hpp"

#include "creepfit_errors.hpp"
#include "creepfit_factors.hpp"
#include "creepfit_files.hpp"
#include "creepfit_found.hpp"
#include "creepfit_words.hpp"

#include "back_analysis/back_analysis.hpp"
#include "model/error.hpp"
#include "scene/measurements.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"
#include "zoning/cost.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace jointcreep::creepfit
{

using back_analysis::Found;
using Measurements = std::vector<scene::Measurement>;

namespace
{

back_analysis::Settings settings_of(const Arguments& arguments)
{
    if (!arguments.has("fit"))
        throw input_error("--fit is not given; expected the factors to find");
    const estimation::Errors errors = errors_in(arguments);
    if (arguments.has("since-first-reading") && (errors.offset || errors.robust || errors.correlated))
        throw input_error(std::string("--since-first-reading does not go with --") +
                          (errors.offset   ? "offset, which contains it"
                           : errors.robust ? "robust; expected --offset in its place"
                                           : "correlated-noise; expected --offset in its place"));
    Factors factors = factors_in(*arguments.text("fit"));
    std::optional<estimation::EnsembleSearch> ensemble;
    if (const auto members = arguments.whole_number("ensemble", 4, 100000)) {
        for (const char* option : {"robust", "correlated-noise", "profile-intervals", "runs"})
            if (arguments.has(option))
                throw input_error("--ensemble does not go with --" + std::string(option));
        const Eigen::Index least = estimation::least_members(static_cast<Eigen::Index>(factors.size()));
        if (static_cast<Eigen::Index>(*members) < least)
            throw input_error("--ensemble is " + std::to_string(*members) + "; expected at least " +
                              std::to_string(least) + ": twice the number of factors and 2 more");
        for (const back_analysis::Factor& factor : factors)
            if (factor.start != usual_start(factor.low, factor.high))
                throw input_error(
                    "--fit: " + option_of(factor) +
                    " has a start, and --ensemble starts from the middle of the bounds; expected "
                    "LOW:HIGH");
        ensemble = {.members = static_cast<int>(*members)};
    }
    return {.factors = std::move(factors),
            .since_first_reading = arguments.has("since-first-reading"),
            .errors = errors,
            .threads = arguments.threads(),
            .most_runs = static_cast<int>(arguments.whole_number("runs", 1, 100000).value_or(60)),
            .profile_intervals = arguments.has("profile-intervals"),
            .ensemble = ensemble};
}

Measurements read_measurements(const std::string& path, const Scene& scene,
                               const back_analysis::Settings& settings)
{
    const std::string text = text_of(path);
    if (text.starts_with("\x89HDF"))
        throw input_error(path + ": this is an HDF5 file; expected a table of measurements (.csv)");
    Measurements measurements = of_file(path, [&] { return scene::measurements_in_csv(text, scene); });
    if (measurements.size() <= settings.factors.size())
        throw input_error(path + ": " + std::to_string(measurements.size()) + " readings for " +
                          std::to_string(settings.factors.size()) + " factors; expected more readings");
    if (settings.ensemble && !measurements.front().deviation)
        throw input_error(path +
                          ": no sigma_mm; expected the standard deviation of each reading with --ensemble");
    return measurements;
}

// The search, with its runs shown. Messages of lines are those of the file.
Found search(const Arguments& arguments, const store::JointsFile& file, const Scene& scene,
             const Measurements& measurements, const back_analysis::Settings& settings)
{
    Progress progress("creepfit", arguments.quiet());
    return of_lines_of_file(*arguments.text("measurements"), [&] {
        return back_analysis::fit(scene, file.network, file.equivalent, measurements, settings,
                                  [&](int run, const std::vector<double>& factors) {
                                      progress.show(
                                          0, [&](std::size_t) { // nobody knows how many runs there will be
                                              std::string words = "run " + std::to_string(run + 1) + ":";
                                              for (const double factor : factors)
                                                  words += ' ' + rounded(factor, 3);
                                              return words;
                                          });
                                  });
    });
}

struct Section {
    store::JointsFile file;
    Scene scene;
};

Section read_section(const Arguments& arguments, const std::string& input, const Factors& factors)
{
    Section section{store::read_joints(input), {}};
    section.scene = scene::parse_scene_of_file(section.file.provenance.scene, input, section.file.network);
    if (const std::string cost =
            zoning::check_cost(section.scene, section.file.network.blocks, input + ": /scene");
        !cost.empty())
        print_warning(arguments.program(), cost);
    for (const back_analysis::Factor& factor : factors)
        if (!factor.material.empty() &&
            std::ranges::find(section.scene.joint_materials, factor.material, &JointMaterial::name) ==
                section.scene.joint_materials.end())
            throw input_error("--fit: " + option_of(factor) + ": the scene has no joint material \"" +
                              factor.material + '"');
    return section;
}

bool are_same(const Joints& a, const Joints& b)
{
    return a.from == b.from && a.to == b.to && a.trace_from == b.trace_from && a.trace_to == b.trace_to;
}

// The same measurements fitted with each network of a scene, none of which is that of the site.
void fit_networks(const Arguments& arguments, const std::string& measured,
                  const back_analysis::Settings& settings)
{
    for (const char* option : {"readings", "profile-intervals", "ensemble"})
        if (arguments.has(option))
            throw input_error("--" + std::string(option) + " is of one network, and several are given");
    std::string text; // of the scene
    bool knows_deviations = false;
    std::vector<Found> found;
    std::vector<Joints> joints_before;
    for (const std::string& input : arguments.inputs()) {
        const Section section = read_section(arguments, input, settings.factors);
        const std::string& its = section.file.provenance.scene;
        if (!found.empty() && its != text)
            throw input_error(input + ": its scene is not that of " + arguments.inputs().front() +
                              "; expected networks of one scene, as jointgen --realization makes them");
        text = its;
        const Joints& joints = section.file.network.joints;
        if (const auto same = std::ranges::find_if(
                joints_before, [&](const Joints& before) { return are_same(before, joints); });
            same != joints_before.end())
            throw input_error(input + ": the same network as " +
                              arguments.inputs()[static_cast<std::size_t>(same - joints_before.begin())] +
                              "; expected each network once");
        joints_before.push_back(joints);
        const Measurements measurements = read_measurements(measured, section.scene, settings);
        knows_deviations = measurements.front().deviation.has_value() && !settings.errors.robust &&
                           !settings.errors.correlated;
        found.push_back(search(arguments, section.file, section.scene, measurements, settings));
        if (!found.back().minimum.is_converged)
            throw fit_error(input + ": " + why_not_converged(found.back(), settings.factors));
    }
    const Networks networks =
        networks_of(std::move(found), arguments.inputs(), settings.factors, knows_deviations);
    write_texts({{arguments.output(), networks_table(networks, settings.factors)}});
    report_networks(arguments, networks, settings.factors);
}

} // namespace

std::vector<Option> section_options()
{
    return {
        {"measurements", "FILE.csv", "through the solver: displacements of the scene's points"},
        {"fit", "NAMES",
         "through the solver: factors to find, of " + all_options(" and ") +
             ", separated by commas. normal- or shear- before the name: for one direction of joints. "
             "@MATERIAL behind it: for one joint material. Bounds may follow: joint-stiffness=0.5:2 (default "
             "bounds: 0.05:20). kelvin-viscosity is that of Maxwell dashpots, too. The search starts from 1, "
             "or from the geometric mean of the bounds if 1 is outside them, or from START: "
             "joint-stiffness=0.5:1.3:2"},
        {"since-first-reading", "",
         "through the solver: measurements count from each point's first reading, and share its error"},
        {"profile-intervals", "",
         "through the solver: 95 percent intervals by profiles of the sum of squares, in place of standard errors, which are wrong "
         "where displacements are far from linear in the factors' logarithms. Each factor takes 10 to 90 more runs, and 60 at most for each of four ends"},
        {"ensemble", "N",
         "through the solver: search by an ensemble of N runs a round, without sensitivities: for many factors, and where joints or rock have "
         "no sensitivities (Barton-Bandis joints, rock that yields). Bounds of a factor are then its 95 percent interval beforehand (default "
         "0.05:20). Readings need sigma_mm"},
        {"runs", "N",
         "through the solver: largest number of runs of the search (default 60); if they are too few the exit code is 3, "
         "and the best factors are in FOUND.failed.csv"},
        {"threads", "N", "through the solver: threads (default 1)"}};
}

void fit_section(const Arguments& arguments)
{
    const bool keeps_best = !arguments.to_standard_output();
    const std::string measured = *arguments.text("measurements");
    const back_analysis::Settings settings = settings_of(arguments);
    const std::optional<std::string> readings_path = readings_file(arguments, true);
    if (arguments.inputs().size() > 1) {
        fit_networks(arguments, measured, settings);
        return;
    }
    const std::string& output = arguments.output();

    // 1. The section, and its measurements.
    const auto [file, scene] = read_section(arguments, arguments.input(), settings.factors);
    const Measurements measurements = read_measurements(measured, scene, settings);

    // 2. The factors that fit the measurements.
    const Found found = search(arguments, file, scene, measurements, settings);

    // 3. The results, or the best factors so far.
    const auto name = [&](const std::string& path) {
        return found.minimum.is_converged ? path : failed_name(path);
    };
    std::vector<TextFile> files;
    if (readings_path)
        files.push_back({name(*readings_path), readings_table(found, measurements, scene)});
    if (found.minimum.is_converged || keeps_best)
        files.push_back(
            {name(output), found_table(found, settings.factors, measurements.front().deviation.has_value())});
    write_texts(files);
    if (!found.minimum.is_converged)
        throw fit_error(why_not_converged(found, settings.factors) + "\nthe best factors are " +
                        (keeps_best ? "in " + name(output) : "kept in a file only: -o FILE"));
    report(arguments, found, measurements, scene, settings);
}

} // namespace jointcreep::creepfit
