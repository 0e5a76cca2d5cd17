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

namespace jointcreep::creepfit
{

using back_analysis::Found;
using Measurements = std::vector<scene::Measurement>;

namespace
{

back_analysis::Settings settings_of(const Arguments& arguments)
{
    if (!arguments.has("fit"))
        throw input_error("--fit is not given; wanted the factors to find");
    const estimation::Errors errors = errors_in(arguments);
    if (arguments.has("since-first-reading") && (errors.offset || errors.robust || errors.correlated))
        throw input_error(std::string("--since-first-reading does not go with --") +
                          (errors.offset   ? "offset, which contains it"
                           : errors.robust ? "robust; wanted --offset in its place"
                                           : "correlated-noise; wanted --offset in its place"));
    return {.factors = factors_in(*arguments.text("fit")),
            .since_first_reading = arguments.has("since-first-reading"),
            .errors = errors,
            .threads = arguments.threads(),
            .most_runs = static_cast<int>(arguments.whole_number("runs", 1, 100000).value_or(60))};
}

Measurements read_measurements(const std::string& path, const Scene& scene, std::size_t n_factors)
{
    const std::string text = text_of(path);
    Measurements measurements = of_file(path, [&] { return scene::measurements_in_csv(text, scene); });
    if (measurements.size() <= n_factors)
        throw input_error(path + ": " + std::to_string(measurements.size()) + " readings for " +
                          std::to_string(n_factors) + " factors; wanted more readings");
    return measurements;
}

// The search, with its runs shown. Messages of lines are those of the file.
Found search(const Arguments& arguments, const store::JointsFile& file, const Scene& scene,
             const Measurements& measurements, const back_analysis::Settings& settings)
{
    Progress progress(arguments.quiet());
    return of_lines_of_file(*arguments.text("measurements"), [&] {
        return back_analysis::fit(scene, file.network, file.equivalent, measurements, settings,
                                  [&](int run, const std::vector<double>& factors) {
                                      std::string words = "run " + std::to_string(run + 1) + ":";
                                      for (const double factor : factors)
                                          words += ' ' + rounded(factor, 3);
                                      progress.show(1 - std::pow(0.8, run), words);
                                  });
    });
}

} // namespace

std::vector<Option> section_options()
{
    return {
        {"measurements", "FILE.csv", "through the solver: displacements of the scene's points"},
        {"fit", "NAMES",
         "through the solver: factors to find, of " + all_options(" and ") +
             "; of joints with normal- or shear- before the name and @MATERIAL behind it for one direction and joint material "
             "alone, separated by commas, each with bounds if given: joint-stiffness=0.5:2 (default "
             "bounds: 0.05:20); kelvin-viscosity is that of Maxwell dashpots, too; the search starts from 1, or "
             "from the geometric mean of the bounds if 1 is outside them"},
        {"since-first-reading", "",
         "through the solver: measurements count from each point's first reading, and share its error"},
        {"runs", "N",
         "through the solver: largest number of runs (default 60); if they are too few the exit code is 3, "
         "and the best factors are in FOUND.failed.csv"},
        {"threads", "N", "through the solver: threads (default 1)"}};
}

void fit_section(const Arguments& arguments)
{
    const std::string &input = arguments.input(), &output = arguments.output();
    const std::string measured = *arguments.text("measurements");
    const back_analysis::Settings settings = settings_of(arguments);
    const std::optional<std::string> readings_path = readings_file(arguments, true);

    // 1. The section, and its measurements.
    const store::JointsFile file = store::read_joints(input);
    const Scene scene = scene::parse_scene_of_file(file.provenance.scene, input, file.network);
    if (const std::string cost = zoning::check_cost(scene, file.network.blocks, input + ": /scene");
        !cost.empty())
        print_warning(arguments.program(), cost);
    for (const back_analysis::Factor& factor : settings.factors)
        if (!factor.material.empty() &&
            std::ranges::find(scene.joint_materials, factor.material, &JointMaterial::name) ==
                scene.joint_materials.end())
            throw input_error("--fit: " + option_of(factor) + ": the scene has no joint material \"" +
                              factor.material + '"');
    const Measurements measurements = read_measurements(measured, scene, settings.factors.size());

    // 2. The factors that fit the measurements.
    const Found found = search(arguments, file, scene, measurements, settings);

    // 3. The results, or the best factors so far.
    const auto name = [&](const std::string& path) {
        return found.minimum.is_converged ? path : failed_name(path);
    };
    std::vector<TextFile> files;
    if (readings_path)
        files.push_back({name(*readings_path), readings_table(found, measurements, scene)});
    files.push_back(
        {name(output), found_table(found, settings.factors, measurements.front().deviation.has_value())});
    write_texts(files);
    if (!found.minimum.is_converged)
        throw fit_error(why_not_converged(found, settings.factors) + "\nthe best factors are in " +
                        name(output));
    report(arguments, found, measurements, scene, settings);
}

} // namespace jointcreep::creepfit
