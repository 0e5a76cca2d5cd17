#include "creep/published.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::creep
{

Published::Published(const Mesh& mesh, const EquivalentJoints& joints,
                     const std::vector<Eigen::Vector2d>& traction)
    : first_traction_(traction)
{
    const auto units = static_cast<Index>(joints.kelvin_units());
    for (const Index edge : mesh.contact_edge) {
        if (units == 0) {
            contact_.push_back({});
            continue;
        }
        const Index e = edge * units; // of a chain the first unit alone
        contact_.push_back({Direction{joints.normal_kelvin_stiffness[e], joints.normal_kelvin_viscosity[e]},
                            Direction{joints.shear_kelvin_stiffness[e], joints.shear_kelvin_viscosity[e]}});
    }
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

bool creeps(const EquivalentJoints& joints)
{
    const auto is_there = [](double stiffness) { return stiffness > 0; };
    return std::any_of(joints.normal_kelvin_stiffness.begin(), joints.normal_kelvin_stiffness.end(),
                       is_there) ||
           std::any_of(joints.shear_kelvin_stiffness.begin(), joints.shear_kelvin_stiffness.end(), is_there);
}

} // namespace jointcreep::creep
