#include "demsolve_summary.hpp"

#include "demsolve_settings.hpp"

#include "model/quantity.hpp"
#include "model/units.hpp"
#include "zoning/zone.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace jointcreep::demsolve
{

using analysis::Analysis;
using analysis::Findings;

namespace
{

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
    summary.add("contacts", mesh.contact_edge.size());
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

void add_creep(Summary& summary, const Scene& scene, const Analysis& run)
{
    if (scene.creep && !run.creeps())
        summary.add("warning: no creep", "neither joints nor rocks of the section creep");
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
    summary.add("contacts stuck", number(ContactStatus::stuck));
    summary.add("contacts slipping", number(ContactStatus::slipping));
    summary.add("contacts open", number(ContactStatus::open));
}

void add_findings(Summary& summary, const Findings& findings, const Findings::Counts& yielded)
{
    for (const auto& [joint, n] : findings.at_yield_in_situ)
        summary.add("warning: at yield in situ", std::to_string(n) + " contacts of joint \"" + joint + "\"");
    for (const auto& [rock, n] : findings.yielded_in_situ)
        summary.add("warning: at yield in situ", std::to_string(n) + " zones of rock \"" + rock + "\"");
    for (const auto& [rock, n] : yielded)
        summary.add("zones yielded since", std::to_string(n) + " of rock \"" + rock + "\"");
    for (const auto& [stage, percent] : findings.energy_off)
        summary.add("warning: energy balance", off_by(percent, stage));
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

// The smallest factor with which rock was seen to move; infinite if there is none.
double smallest_that_fails(const Safety& trials)
{
    double fails = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < trials.factor.size(); ++i)
        if (trials.stands[i] == 0)
            fails = std::min(fails, trials.factor[i]);
    return fails;
}

} // namespace

void add_run(Summary& summary, const Network& network, const Scene& scene, const Analysis& run)
{
    add_mesh(summary, network, run.result().mesh);
    summary.add("stages", scene.stages.size());
    add_equilibria(summary, scene, run);
    add_creep(summary, scene, run);
    add_contacts(summary, run.rock().contacts.status);
    add_findings(summary, run.findings(), run.yielded());
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
    const auto upper =
        std::find(trials.factor.begin(), trials.factor.end(), *bracket.not_above) - trials.factor.begin();
    const bool fails = trials.stands[upper] == 0;
    summary.add(fails ? "factor of safety, below" : "warning: undecided at", shown(*bracket.not_above));
    add_lines(summary, "  there", what_moves);
    if (fails)
        return;
    if (const double factor = smallest_that_fails(trials); std::isfinite(factor)) // known all the same
        summary.add("factor of safety, below", shown(factor));
}

std::string warnings_of(const Findings& findings)
{
    std::string lines;
    for (const auto& [stage, percent] : findings.energy_off)
        lines += "\nwarning: energy balance " + off_by(percent, stage);
    return lines;
}

} // namespace jointcreep::demsolve
