// Rock that yields: Mohr and Coulomb's strength with a tension cut-off, elastic and perfectly plastic, in the
// plane strain of zones with the stress across the section beside those in it.
//
//     N s1 - s3 <= 2 c sqrt(N)    N = (1 + sin(phi)) / (1 - sin(phi))      s1 >= s2 >= s3, tension positive
//     s1 <= T                     T at most c cot(phi), where the shear strength ends
//
// Plastic strain goes along N_psi s1 - s3 in shear, psi the dilation angle in place of phi, and along s1 in
// tension. Where edges or corners of the strength meet, it is a sum over those that do (Koiter). From a trial
// stress, elastic from the last plastic strain, the new stress is found at once (backward Euler): in
// principal stresses every surface is a plane, and the answer is the one set of active planes whose
// multipliers are positive while no plane is exceeded. It is exact on faces, edges and corners alike. (De
// Souza Neto, Peric, Owen: Computational Methods for Plasticity, 2008, ch. 8, look for it case by case.)

#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace jointcreep::rock
{

struct MohrCoulomb {
    double n_phi, n_psi; // N, with the friction and with the dilation angle [-]
    double shear;        // 2 c sqrt(N) [Pa]
    double tension;      // T [Pa]

    // Of cohesion [Pa], friction angle [rad], tensile strength [Pa] and dilation angle [rad].
    static MohrCoulomb of(double cohesion, double friction_angle, double tensile_strength,
                          double dilation_angle)
    {
        const auto n = [](double angle) { return (1 + std::sin(angle)) / (1 - std::sin(angle)); };
        const double n_phi = n(friction_angle), shear = 2 * cohesion * std::sqrt(n_phi);
        const double apex = n_phi > 1 ? shear / (n_phi - 1) : tensile_strength;
        return {n_phi, n(dilation_angle), shear, std::min(tensile_strength, apex)};
    }

    // By how much a largest and a smallest principal stress exceed the strength [Pa]; what is rounding does
    // not count.
    double excess(double s1, double s3) const
    {
        const double most = std::max(n_phi * s1 - s3 - shear, s1 - tension);
        return most > 1e-10 * (std::abs(s1) + std::abs(s3) + shear) ? most : 0.0;
    }
};

// Elastic stress over strain of a volume change and of shear, as in Zones::stiffness: {C11, C12, C33} [Pa].
using Elasticity = Eigen::Vector3d;

struct Returned {
    Eigen::Vector3d stress;  // principal [Pa]
    Eigen::Vector3d plastic; // strain on the way there, in the same directions [-]
    Eigen::Matrix3d tangent; // change of the stress over that of the trial stress [-]
};

// From trial stresses s1 >= s2 >= s3 beyond the strength.
Returned returned(const MohrCoulomb& law, const Elasticity& c, const Eigen::Vector3d& trial);

// A zone of rock that yields.
struct YieldingZone {
    MohrCoulomb law;
    double initial_zz;                   // across the section, at zero displacement [Pa]
    Eigen::Vector4d plastic{0, 0, 0, 0}; // strain {xx, yy, zz, gamma_xy} since then [-]
    double stress_zz = initial_zz;       // now [Pa]
    double dissipated = 0;               // work per area that it has not stored [J/m2]
};

// Stress {xx, yy, xy, zz} of its zone by elasticity from the present plastic strain, at a strain {xx, yy,
// gamma_xy}.
inline Eigen::Vector4d elastic_stress(const YieldingZone& zone, const Elasticity& c,
                                      const Eigen::Vector3d& initial, const Eigen::Vector3d& strain)
{
    const double xx = strain[0] - zone.plastic[0], yy = strain[1] - zone.plastic[1], zz = -zone.plastic[2];
    return {initial[0] + c[0] * xx + c[1] * (yy + zz), initial[1] + c[0] * yy + c[1] * (xx + zz),
            initial[2] + c[2] * (strain[2] - zone.plastic[3]),
            zone.initial_zz + c[0] * zz + c[1] * (xx + yy)};
}

// Principal stresses of {xx, yy, xy, zz}: the larger and the smaller one in the section, and that across.
inline Eigen::Vector3d principal(const Eigen::Vector4d& s)
{
    const double mean = (s[0] + s[1]) / 2, radius = std::hypot((s[0] - s[1]) / 2, s[2]);
    return {mean + radius, mean - radius, s[3]};
}

inline double excess(const MohrCoulomb& law, const Eigen::Vector4d& s)
{
    const Eigen::Vector3d p = principal(s);
    return law.excess(std::max(p[0], p[2]), std::min(p[1], p[2]));
}

// The stress {xx, yy, xy} at a strain; takes plastic strain, the stress across and dissipation into `zone`.
// `last` is the stress before. Asked twice for the same strain, it changes nothing more.
Eigen::Vector3d yielded(YieldingZone& zone, const Elasticity& c, const Eigen::Vector3d& initial,
                        const Eigen::Vector3d& last, const Eigen::Vector3d& strain);

// Change of the stress {xx, yy, xy} that yielded() finds over that of the strain {xx, yy, gamma_xy} (consistent tangent:
// Simo and Taylor 1985) [Pa]. Where the stress is elastic, its elasticity. Not symmetric where the dilation angle is not
// the friction angle.
Eigen::Matrix3d tangent_of_yield(const YieldingZone& zone, const Elasticity& c,
                                 const Eigen::Vector3d& initial, const Eigen::Vector3d& strain);

// What its springs hold, per area [J/m2]: only differences mean anything.
inline double stored(const Elasticity& c, const Eigen::Vector3d& s, double zz)
{
    const double mean = (s[0] + s[1] + zz) / 3, bulk = (c[0] + 2 * c[1]) / 3;
    const double xx = s[0] - mean, yy = s[1] - mean, across = zz - mean;
    return mean * mean / (2 * bulk) + (xx * xx + yy * yy + across * across + 2 * s[2] * s[2]) / (4 * c[2]);
}

} // namespace jointcreep::rock
