#include "creep/published.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::creep
{

Published::Published(const Mesh& mesh, const EquivalentJoints& joints,
                     const std::vector<Eigen::Vector2d>& traction)
    : first_traction_(traction)
{
    for (const Index e : mesh.contact_edge)
        contact_.push_back({Direction{joints.normal_kelvin_stiffness[e], joints.normal_kelvin_viscosity[e]},
                            Direction{joints.shear_kelvin_stiffness[e], joints.shear_kelvin_viscosity[e]}});
}

void Published::advance(double duration, const std::vector<Eigen::Vector2d>& traction,
                        std::vector<Eigen::Vector2d>& offset)
{
    for (std::size_t c = 0; c < contact_.size(); ++c)
        for (int i = 0; i < 2; ++i) {
            const Direction& d = contact_[c][i];
            if (d.stiffness <= 0)
                continue;
            const double crept = -std::expm1(-d.stiffness / d.viscosity * duration);
            const double final_offset = (traction[c][i] - first_traction_[c][i]) / d.stiffness;
            offset[c][i] += crept * (final_offset - offset[c][i]);
        }
}

StepLimit longest_step(const EquivalentJoints& joints)
{
    StepLimit limit{std::numeric_limits<double>::infinity(), -1};
    const auto consider = [&](double spring, double stiffness, double viscosity, std::size_t edge) {
        if (stiffness <= 0)
            return;
        const double most_crept = 2 / (1 + spring / stiffness);
        if (most_crept >= 1)
            return;
        const double step = -std::log1p(-most_crept) * viscosity / stiffness;
        if (step < limit.step)
            limit = {step, static_cast<Index>(edge)};
    };
    for (std::size_t e = 0; e < joints.normal_stiffness.size(); ++e) {
        consider(joints.normal_stiffness[e], joints.normal_kelvin_stiffness[e],
                 joints.normal_kelvin_viscosity[e], e);
        consider(joints.shear_stiffness[e], joints.shear_kelvin_stiffness[e],
                 joints.shear_kelvin_viscosity[e], e);
    }
    return limit;
}

bool creeps(const EquivalentJoints& joints)
{
    const auto is_there = [](double stiffness) { return stiffness > 0; };
    return std::any_of(joints.normal_kelvin_stiffness.begin(), joints.normal_kelvin_stiffness.end(),
                       is_there) ||
           std::any_of(joints.shear_kelvin_stiffness.begin(), joints.shear_kelvin_stiffness.end(), is_there);
}

} // namespace jointcreep::creep
