// Rock that yields: Mohr-Coulomb strength with a tension cut-off, elastic and perfectly plastic, in plane strain. The
// stress across the section is one of the three principal stresses.
//
//     N s1 - s3 <= 2 c sqrt(N)    N = (1 + sin(phi)) / (1 - sin(phi))      s1 >= s2 >= s3, tension positive
//     s1 <= T                     T at most c cot(phi), where the shear strength ends
//
// Plastic flow is along N_psi s1 - s3 in shear, with the dilation angle psi in place of phi, and along s1 in tension.
// At edges and corners of the yield surface it is the sum over the active planes (Koiter). The new stress is the return
// of the trial stress, which is elastic from the last plastic strain (backward Euler). In principal stresses each yield
// surface is a plane. The solution is the one set of active planes with positive multipliers and no plane exceeded. It
// is exact on faces, edges and corners. (De Souza Neto, Peric, Owen: Computational Methods for Plasticity, 2008, ch. 8,
// treat the cases one by one.)

#pragma once

#include "rock/elasticity.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace jointcreep::rock
{

struct MohrCoulomb {
    double n_phi, n_psi; // N, with the friction and with the dilation angle [-]
    double shear;        // 2 c sqrt(N) [Pa]
    double tension;      // T [Pa]

    // From cohesion [Pa], friction angle [rad], tensile strength [Pa] and dilation angle [rad].
    static MohrCoulomb of(double cohesion, double friction_angle, double tensile_strength,
                          double dilation_angle)
    {
        const auto n = [](double angle) { return (1 + std::sin(angle)) / (1 - std::sin(angle)); };
        const double n_phi = n(friction_angle), shear = 2 * cohesion * std::sqrt(n_phi);
        const double apex = n_phi > 1 ? shear / (n_phi - 1) : tensile_strength;
        return {n_phi, n(dilation_angle), shear, std::min(tensile_strength, apex)};
    }

    // How far the largest and smallest principal stress are beyond the strength [Pa]. Rounding counts as 0.
    double excess(double s1, double s3) const
    {
        const double most = std::max(n_phi * s1 - s3 - shear, s1 - tension);
        return most > 1e-10 * (std::abs(s1) + std::abs(s3) + shear) ? most : 0.0;
    }
};

struct Returned {
    Eigen::Vector3d stress;  // principal [Pa]
    Eigen::Vector3d plastic; // plastic strain in this step, in the same directions [-]
    Eigen::Matrix3d tangent; // change of the stress over that of the trial stress [-]
};

// Returns trial stresses s1 >= s2 >= s3 that exceed the strength.
Returned returned(const MohrCoulomb& law, const Elasticity& c, const Eigen::Vector3d& trial);

// A zone of rock that yields.
struct YieldingZone {
    MohrCoulomb law;
    double initial_zz;                   // across the section, at zero displacement [Pa]
    Eigen::Vector4d plastic{0, 0, 0, 0}; // strain {xx, yy, zz, gamma_xy} since then [-]
    double stress_zz = initial_zz;       // now [Pa]
    double dissipated = 0;               // plastic work per area [J/m2]
};

// Elastic stress {xx, yy, xy, zz} of a zone at a strain {xx, yy, gamma_xy}, with its present plastic strain.
inline Eigen::Vector4d elastic_stress(const YieldingZone& zone, const Elasticity& c,
                                      const Eigen::Vector3d& initial, const Eigen::Vector3d& strain)
{
    const double xx = strain[0] - zone.plastic[0], yy = strain[1] - zone.plastic[1], zz = -zone.plastic[2];
    return {initial[0] + c[0] * xx + c[1] * (yy + zz), initial[1] + c[0] * yy + c[1] * (xx + zz),
            initial[2] + c[2] * (strain[2] - zone.plastic[3]),
            zone.initial_zz + c[0] * zz + c[1] * (xx + yy)};
}

// Principal stresses of {xx, yy, xy, zz}: the larger and the smaller one in the section, and the one across it.
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

// The stress {xx, yy, xy} at a strain; updates plastic strain, the stress across and the dissipation in `zone`.
// `last` is the stress before. A second call with the same strain changes nothing.
Eigen::Vector3d yielded(YieldingZone& zone, const Elasticity& c, const Eigen::Vector3d& initial,
                        const Eigen::Vector3d& last, const Eigen::Vector3d& strain);

// Change of the stress {xx, yy, xy} of yielded() over change of the strain {xx, yy, gamma_xy} (consistent tangent: Simo
// and Taylor 1985) [Pa]. Where the stress is elastic, it is the elastic stiffness. It is unsymmetric unless the
// dilation angle equals the friction angle.
Eigen::Matrix3d tangent_of_yield(const YieldingZone& zone, const Elasticity& c,
                                 const Eigen::Vector3d& initial, const Eigen::Vector3d& strain);

// Elastic energy per area [J/m2]; only differences have a meaning.
inline double stored(const Elasticity& c, const Eigen::Vector3d& s, double zz)
{
    const double mean = (s[0] + s[1] + zz) / 3, bulk = (c[0] + 2 * c[1]) / 3;
    const double xx = s[0] - mean, yy = s[1] - mean, across = zz - mean;
    return mean * mean / (2 * bulk) + (xx * xx + yy * yy + across * across + 2 * s[2] * s[2]) / (4 * c[2]);
}

} // namespace jointcreep::rock
