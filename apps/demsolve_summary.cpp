#include "demsolve_summary.hpp"

#include "demsolve_settings.hpp"

#include "model/quantity.hpp"
#include "model/units.hpp"
#include "zoning/zone.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>

namespace jointcreep::demsolve
{

using analysis::Analysis;
using analysis::Findings;

namespace
{

// Above these a run is warned of.
constexpr double much_plastic_strain = 0.05; // [-]
constexpr double large_displacement = 0.02;  // over the diagonal of the section [-]
constexpr double much_merged = 2e-4;         // area of blocks merged into others, over the jointed rock [-]

// Area of the rock where joint sets are [m2]: at most the sum of their regions, of equal ones once.
double jointed_area(const Scene& scene)
{
    const double whole = area_of(scene.outline);
    std::vector<Polygon> regions;
    double sum = 0;
    for (const JointSet& set : scene.joint_sets) {
        if (!set.region)
            return whole;
        if (std::ranges::find(regions, *set.region) != regions.end())
            continue;
        regions.push_back(*set.region);
        sum += area_of(regions.back());
    }
    return sum > 0 ? std::min(sum, whole) : whole;
}

std::int64_t sum_of(const std::vector<Index>& numbers)
{
    return std::accumulate(numbers.begin(), numbers.end(), std::int64_t{0});
}

double largest_of(const std::vector<double>& numbers)
{
    return *std::max_element(numbers.begin(), numbers.end());
}

std::string off_by(Index percent, const std::string& stage)
{
    return "off by " + std::to_string(percent) + " percent in the dynamic analysis " +
           (stage.empty() ? "in situ" : "of stage \"" + stage + "\"");
}

void add_mesh(Summary& summary, const Network& network, const Mesh& mesh)
{
    const zoning::MeshQuality quality = zoning::quality_of(mesh);
    summary.add("blocks", network.blocks.block_area.size());
    summary.add("zones", mesh.zone_gridpoint.size());
    summary.add("gridpoints", mesh.gridpoint.size());
    summary.add("contacts at the start", mesh.contact_edge.size());
    summary.add("shortest block edge", network.blocks.report.shortest_edge, "m");
    summary.add("shortest zone side", quality.shortest_side, "m");
    summary.add("smallest zone altitude", quality.smallest_altitude, "m");
    summary.add("smallest zone angle", quality.smallest_angle / unit::deg, "deg");
}

std::string engine_in_words(const Scene& scene, const Analysis& run)
{
    if (run.engine() == EngineChoice::automatic)
        return "implicit, and dynamic relaxation where it does not converge (auto)";
    const bool chose = scene.equilibrium.engine == EngineChoice::automatic;
    return name_of(run.engine()) + (chose ? " (auto: real masses or a step history)" : "");
}

void add_equilibria(Summary& summary, const Scene& scene, const Analysis& run)
{
    const auto& equilibria = run.result().equilibria;
    const auto all = static_cast<std::int64_t>(equilibria.is_implicit.size());
    const std::int64_t implicit = sum_of(equilibria.is_implicit);
    summary.add("engine", engine_in_words(scene, run));
    summary.add("equilibria by the implicit engine", implicit);
    summary.add("equilibria by dynamic relaxation", all - implicit);
    for (const auto& [reason, n] : run.findings().given_up)
        summary.add("implicit engine did not converge", std::to_string(n) + " times: " + reason);
    summary.add("searches rejected or not converged", sum_of(equilibria.searches) - all);
    summary.add("solver steps", sum_of(equilibria.steps));
    summary.add("factorisations", sum_of(equilibria.factorisations));
    summary.add("back-substitutions", sum_of(equilibria.solves));
    summary.add("largest unbalanced force ratio", largest_of(equilibria.unbalanced_force_ratio));
    summary.add("largest remaining displacement, by estimate", largest_of(equilibria.remaining_displacement),
                "m");
}

void add_dynamics(Summary& summary, const DynamicsHistory& dynamics)
{
    if (dynamics.dynamic_time.empty())
        return;
    summary.add("last dynamic analysis ends after", dynamics.dynamic_time.back(), "s");
    summary.add("  fastest gridpoint then", dynamics.fastest.back(), "m/s");
}

void add_creep(Summary& summary, const Analysis& run)
{
    if (const auto& limit = run.stable_limit())
        summary.add("creep steps below", shown(limit->step / unit::day) + " day: " + limit->of);
    if (run.end_of_creep())
        summary.add("creep ended early", *run.end_of_creep() / unit::day, "day");
}

void add_contacts(Summary& summary, const std::vector<ContactStatus>& status)
{
    const auto number = [&](ContactStatus wanted) {
        return static_cast<Index>(std::count(status.begin(), status.end(), wanted));
    };
    summary.add("contacts sticking", number(ContactStatus::stuck));
    summary.add("contacts slipping", number(ContactStatus::slipping));
    summary.add("contacts open", number(ContactStatus::open));
}

void add_yield(Summary& summary, const Analysis& run)
{
    for (const auto& [rock, n] : run.yielded())
        summary.add("zones yielded since", std::to_string(n) + " of rock \"" + rock + "\"");
    if (const double strain = rock::largest_plastic_strain(run.assembly().zones); strain > 0)
        summary.add("largest plastic shear strain", strain);
}

// The lines of a message, one below the other.
void add_lines(Summary& summary, const std::string& label, const std::string& text)
{
    std::size_t from = 0;
    for (std::size_t end = 0; end != std::string::npos; from = end + 1) {
        end = text.find('\n', from);
        summary.add(label, text.substr(from, end == std::string::npos ? end : end - from));
    }
}

// Of the factor [-]; none where there is no estimate.
std::optional<double> mesh_share(const analysis::Bracket& bracket, const MeshEstimate& estimate)
{
    constexpr double hardly_fewer = 0.6; // zones follow the edges of blocks, and hardly grow
    const auto middle = [](const analysis::Bracket& of) { return (*of.stands + *of.not_above) / 2; };
    if (!estimate.coarse.stands || !estimate.coarse.not_above || estimate.share_of_zones > hardly_fewer)
        return std::nullopt;
    return middle(estimate.coarse) / middle(bracket) - 1;
}

std::string in_percent(double share)
{
    return shown(std::round(1000 * share) / 10) + " percent";
}

// The smallest factor with which rock was seen to move; infinite if there is none.
double smallest_that_fails(const Safety& trials)
{
    double fails = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < trials.factor.size(); ++i)
        if (trials.stands[i] == 0)
            fails = std::min(fails, trials.factor[i]);
    return fails;
}

// Of stages to a hundredth.
std::string day_of(double time, bool is_creep)
{
    const double parts = is_creep ? 1 : 100;
    return "day " + shown(std::round(parts * time / unit::day) / parts);
}

std::string in_digits(const char* format, double value)
{
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

// "3e-4", "1"
std::string power_of_ten(double value)
{
    std::string text = in_digits("%.0e", value);
    if (text.ends_with("e+00"))
        return text.substr(0, text.size() - 4);
    if (const std::size_t zero = text.find('e') + 2; zero < text.size() - 1 && text[zero] == '0')
        text.erase(zero, 1);
    return text;
}

} // namespace

void add_run(Summary& summary, const Network& network, const analysis::Trial& trial)
{
    const Analysis& run = trial.analysis();
    add_mesh(summary, network, run.result().mesh);
    summary.add("stages", trial.scene().stages.size());
    add_equilibria(summary, trial.scene(), run);
    add_dynamics(summary, run.result().dynamics);
    add_creep(summary, run);
    add_contacts(summary, run.assembly().contacts.status);
    add_yield(summary, run);
    for (const std::string& warning : warnings_of(trial))
        summary.warn(warning);
}

void add_safety(Summary& summary, const analysis::Bracket& bracket, const std::string& what_moves)
{
    summary.add("factor of safety, at least", shown(*bracket.stands));
    const Safety& trials = bracket.trials;
    summary.add("runs", trials.factor.size());
    if (!bracket.not_above) {
        summary.add("factor of safety, below", "none found: equilibrium at every factor tried");
        return;
    }
    const bool fails = bracket.fails();
    summary.add(fails ? "factor of safety, below" : "undecided at", shown(*bracket.not_above));
    add_lines(summary, "  at this factor", what_moves);
    if (fails)
        return;
    if (const double factor = smallest_that_fails(trials); std::isfinite(factor)) // known all the same
        summary.add("factor of safety, below", shown(factor));
}

void add_mesh_estimate(Summary& summary, const analysis::Bracket& bracket, const MeshEstimate& estimate)
{
    const std::string what = "mesh's share of the factor, by estimate";
    if (!estimate.coarse.stands || !estimate.coarse.not_above)
        return summary.add(what, "none: no bracket with zones twice as large");
    summary.add("with zones twice as large",
                shown(*estimate.coarse.stands) + " to " + shown(*estimate.coarse.not_above));
    const auto share = mesh_share(bracket, estimate);
    const double width = (*bracket.not_above - *bracket.stands) / *bracket.stands;
    summary.add(what, !share           ? "none: block edges set the size of zones"
                      : *share > width ? in_percent(*share)
                                       : "below " + in_percent(std::max(width, -*share)));
}

std::string merging_warning(const Scene& scene, const Blocks& blocks)
{
    const double merged = blocks.report.merged_block_area, share = merged / jointed_area(scene);
    return share > much_merged
               ? "blocks of " + rounded(merged) + " m2, " + rounded(1000 * share, 2) +
                     " thousandths of the jointed rock, are merged into others, which can change the factor of "
                     "safety. Compare with a third of [cutting] shortest_edge_m, " +
                     shown(scene.cutting.shortest_edge) + " m"
               : "";
}

std::string mesh_warning(const analysis::Bracket& bracket, const MeshEstimate& estimate)
{
    constexpr double much = 0.05;
    const double share = mesh_share(bracket, estimate).value_or(0);
    return share > much ? "the factor of safety is too high by about " + in_percent(share) +
                              ", by estimate from zones twice as large; use smaller zones"
                        : "";
}

std::vector<std::string> warnings_of(const analysis::Trial& trial)
{
    const Analysis& run = trial.analysis();
    const Findings& findings = run.findings();
    std::vector<std::string> warnings;
    if (trial.scene().creep && !run.creeps())
        warnings.emplace_back("no creep: neither joints nor rocks of the section creep");
    for (const auto& [joint, n] : findings.at_yield_in_situ)
        warnings.push_back("at yield in the initial stress state: " + std::to_string(n) +
                           " contacts of joint \"" + joint + '"');
    for (const auto& [rock, n] : findings.yielded_in_situ)
        warnings.push_back("at yield in the initial stress state: " + std::to_string(n) +
                           " zones of rock \"" + rock + '"');
    for (const auto& [slide, n] : findings.slid)
        warnings.push_back("rock slid in creep, " + slide);
    for (const auto& [stage, percent] : findings.energy_off)
        warnings.push_back("energy balance " + off_by(percent, stage));
    if (const double strain = rock::largest_plastic_strain(run.assembly().zones);
        strain > much_plastic_strain)
        warnings.push_back("plastic shear strain of " + rounded(strain) +
                           " in a zone: the rock may have failed");
    if (const double share = run.largest_displacement() / size_of(run.assembly());
        !trial.scene().large_displacements && share > large_displacement)
        warnings.push_back(
            "displacement of " + rounded(run.largest_displacement()) + " m, " + rounded(100 * share) +
            " percent of the section's size: too much for the formulas of small displacements");
    return warnings;
}

std::string warning_lines(const analysis::Trial& run)
{
    std::string lines;
    for (const std::string& warning : warnings_of(run))
        lines += "\nwarning: " + warning;
    return lines;
}

std::string what_is_done(const Which& which, const analysis::Progress& progress, bool has_days,
                         std::size_t most)
{
    const bool is_brief = most != Progress::unlimited;
    const std::string day = has_days && progress.time ? day_of(*progress.time, progress.what.empty()) : "";
    std::string rest = progress.what.empty() || day.empty() ? day : ", " + day;
    if (!progress.more.empty())
        rest += ", " + progress.more;
    if (progress.search != nullptr) {
        const double ratio = progress.search->unbalanced_force_ratio;
        rest += is_brief ? ", ratio " + power_of_ten(ratio) + " of " + power_of_ten(progress.tolerance)
                         : ": " + std::to_string(progress.search->steps) + " steps, unbalanced force ratio " +
                               in_digits("%.1e", ratio) + " (expected " +
                               in_digits("%.0e", progress.tolerance) + ')';
    }
    if (!is_brief)
        return which.whole + progress.what + rest;
    constexpr std::size_t shortest = 8; // name of a stage
    const std::size_t taken = columns(which.brief) + columns(rest);
    const std::size_t room = std::max(shortest, most - std::min(most, taken));
    const bool is_long = columns(progress.what) > room;
    return which.brief +
           (is_long ? std::string(shortened(progress.what, room - 1)) + "\u2026" : progress.what) + rest;
}

std::string place_of(const Checkpoint& kept, const Scene& scene)
{
    const std::string within = kept.search.empty() ? "" : ", in the middle of a search for equilibrium";
    if (kept.is_in_situ != 0)
        return "the in-situ state" + within;
    const auto stage = static_cast<std::size_t>(kept.stage);
    const bool is_stage = stage < scene.stages.size() && scene.stages[stage].time == kept.time;
    return (is_stage ? "stage \"" + scene.stages[stage].name + "\", " : "") + "day " +
           shown(kept.time / unit::day) + within;
}

} // namespace jointcreep::demsolve
