#include "analysis/guards.hpp"

#include "joint/continuously_yielding.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::analysis
{

namespace
{

constexpr double rounding = 1e-9;          // over what it is of
constexpr double most_energy_error = 1e-6; // of the energy balance, over its terms

// Of the blocks with present zones, the largest.
double area_error(const Section& section)
{
    const std::vector<double>& area = section.network.blocks.block_area;
    const rock::Zones& zones = section.assembly.zones;
    std::vector<double> sum(area.size(), 0.0);
    for (std::size_t z = 0; z < zones.size(); ++z)
        if (zones.is_present[z])
            sum[section.mesh().zone_block[zones.zone_of(z)]] += zones.area[z];
    double error = 0;
    for (std::size_t b = 0; b < area.size(); ++b)
        if (sum[b] > 0)
            error = std::max(error, std::abs(sum[b] - area[b]) / area[b]);
    return error;
}

double weight_error(const Section& section)
{
    const rock::Zones& zones = section.assembly.zones;
    double present = 0, all = 0, loads = 0;
    for (std::size_t z = 0; z < zones.size(); ++z) {
        all += zones.weight[z];
        present += zones.is_present[z] ? zones.weight[z] : 0.0;
    }
    for (const Vector2d& load : section.assembly.load)
        loads += load.y();
    return all == 0 ? std::abs(loads) : std::abs(loads + present) / std::abs(all);
}

// Where a continuously yielding joint shears back, its plastic displacement is against its traction at first.
bool slip_gives_back(const Scene& scene)
{
    return std::ranges::any_of(scene.joint_materials, [](const JointMaterial& material) {
        return material.own.contains(joint::parameters::roughness_length.name);
    });
}

} // namespace

GuardedState guarded_state(const Section& section)
{
    const mechanics::Assembly& assembly = section.assembly;
    GuardedState state;
    state.is_finite = std::ranges::all_of(
        assembly.displacement, [](const Vector2d& displacement) { return displacement.allFinite(); });
    for_each_force([&](const auto& one) { state.is_finite = state.is_finite && is_finite(one); }, assembly);
    state.area_error = area_error(section);
    state.weight_error = weight_error(section);
    // At large displacements contacts are between faces, which check their depth at every step.
    state.penetration =
        assembly.contacts.state_by_faces.empty() ? joint::penetration(assembly.contacts) : 0.0;
    return state;
}

double energy_error(const mechanics::Convergence& convergence, double stored)
{
    const double parts[]{convergence.work_of_loads, -convergence.stored, -convergence.dissipated,
                         -convergence.damped};
    double sum = 0, size = 0;
    for (const double part : parts) {
        sum += part;
        size += std::abs(part);
    }
    const double error =
        std::abs(sum) + convergence.created - 1e-12 * (std::abs(stored) + std::abs(convergence.stored));
    return error > 0 ? error / size : std::isnan(error) ? 1.0 : 0.0;
}

std::string broken_guard(const GuardedState& state, double size_of_section)
{
    if (!state.is_finite)
        return "displacements, stresses or tractions are not finite numbers";
    if (!(state.area_error <= rounding))
        return "areas of zones are off by " + rounded(state.area_error) + " of their block's";
    if (!(state.weight_error <= rounding))
        return "loads are off by " + rounded(state.weight_error) + " of the weight";
    if (!(state.penetration <= rounding * size_of_section))
        return "a contact is closed by " + rounded(state.penetration) +
               " m more than its normal stress over its stiffness";
    return "";
}

std::string broken_guard(double unbalanced_force_ratio, double energy_error, double tolerance)
{
    if (!(unbalanced_force_ratio <= tolerance))
        return "the unbalanced force ratio of an equilibrium is " + rounded(unbalanced_force_ratio) +
               ", expected " + shown(tolerance);
    if (!(energy_error <= most_energy_error))
        return "the energy balance of an equilibrium is off by " + rounded(energy_error) + " of its terms";
    return "";
}

// The sum of the energies holds by definition with the implicit engine: that none is created is checked in its place. The sum
// of a dynamic analysis is checked over its whole length, by DynamicStage.
void Guards::check_equilibrium()
{
    mechanics::Convergence found = section_.settled.convergence;
    const bool is_dynamic =
        !section_.result.dynamics.time.empty() || !section_.assembly.contacts.state_by_faces.empty();
    if (found.is_implicit && !slip_gives_back(section_.scene))
        found.created = std::max(found.created, -found.dissipated);
    const double error = is_dynamic ? 0.0 : energy_error(found, stored_energy(section_.assembly));
    end_if(broken_guard(found.unbalanced_force_ratio, error, section_.scene.equilibrium.tolerance));
}

void Guards::state_is_due(const std::string& /*event*/)
{
    const GuardedState state = guarded_state(section_);
    end_if(broken_guard(state, mechanics::size_of(section_.assembly)));
    GuardHistory& history = section_.result.guards;
    history.area_error.push_back(state.area_error);
    history.weight_error.push_back(state.weight_error);
    history.penetration.push_back(state.penetration);
}

void Guards::end_if(const std::string& broken)
{
    if (!broken.empty())
        fail(section_, {.reason = "the result is wrong: " + broken + ". Please report this with the scene"},
             section_.now);
}

} // namespace jointcreep::analysis
