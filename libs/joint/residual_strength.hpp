// Coulomb's joint with a residual strength: the first slip or opening breaks its bonds. Residual cohesion and friction
// remain. In other Coulomb joints only opening removes the cohesion.
//
//     |tau| <= c - sigma_n tan(phi)        until then
//     |tau| <= c_r - sigma_n tan(phi_r)    afterwards        c_r <= c,  tan(psi) <= tan(phi_r) <= tan(phi)
//
// The response is that of joint/coulomb.hpp.

#pragma once

#include "joint/coulomb.hpp"

namespace jointcreep::joint
{

namespace parameters
{

inline const Parameter residual_cohesion{
    "residual_cohesion",
    "residual_cohesion_MPa",
    MPa,
    strengths,
    WithBridges::share,
    WithStrengthDivided::value,
    "Residual cohesion, after the first slip or opening: at most the cohesion. A joint without residual "
    "strength loses its cohesion by opening only."};
inline const Parameter residual_friction_angle{
    "residual_friction_angle",
    "residual_friction_angle_deg",
    degrees,
    frictions,
    WithBridges::weaker,
    WithStrengthDivided::tangent,
    "Residual friction angle, after the first slip or opening: at most the friction angle, at least the "
    "dilation angle."};

} // namespace parameters

struct ResidualStrength : Coulomb {
    static ResidualStrength from(const ValueOf& value, double divisor)
    {
        ResidualStrength law{Coulomb::from(value, divisor)};
        law.weakens = true;
        law.residual_cohesion = value(parameters::residual_cohesion);
        law.residual_tan_phi = std::tan(value(parameters::residual_friction_angle));
        return law;
    }
    static const LawInfo& info()
    {
        using namespace parameters;
        static const LawInfo info{
            .name = "residual strength",
            .about = "Coulomb with residual strength: bonds break by slip, too",
            .parameters = of_all_joints_and({parameters::residual_cohesion, residual_friction_angle}),
            .own = {"residual_cohesion", "residual_friction_angle"},
            .check = [](const ValueOf& value) -> std::optional<Complaint> {
                if (auto complaint = Coulomb::check(value))
                    return complaint;
                if (value(parameters::residual_cohesion) > value(parameters::cohesion))
                    return Complaint{parameters::residual_cohesion, "expected at most cohesion_MPa"};
                if (value(residual_friction_angle) > value(friction_angle))
                    return Complaint{residual_friction_angle, "expected at most friction_angle_deg"};
                if (value(residual_friction_angle) < value(dilation_angle))
                    return Complaint{residual_friction_angle, "expected at least dilation_angle_deg"};
                if (value(shear_stiffness) == 0)
                    return Complaint{residual_friction_angle,
                                     "expected none of a smooth joint, which has no shear strength"};
                return {};
            }};
        return info;
    }
};

} // namespace jointcreep::joint
