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
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

namespace jointcreep::mechanics
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
};

// From trial stresses s1 >= s2 >= s3 beyond the strength.
inline Returned returned(const MohrCoulomb& law, const Elasticity& c, const Eigen::Vector3d& trial)
{
    using Eigen::Vector3d;
    const double N = law.n_phi, M = law.n_psi;
    struct Plane {
        Vector3d normal, flow;
        double limit;
    };
    const std::array<Plane, 6> planes{{{{N, 0, -1}, {M, 0, -1}, law.shear},
                                       {{1, 0, 0}, {1, 0, 0}, law.tension},
                                       {{N, -1, 0}, {M, -1, 0}, law.shear},
                                       {{0, N, -1}, {0, M, -1}, law.shear},
                                       {{0, 1, 0}, {0, 1, 0}, law.tension},
                                       {{0, 0, 1}, {0, 0, 1}, law.tension}}};
    const auto elastic = [&](const Vector3d& strain) {
        return Vector3d((c[0] - c[1]) * strain + Vector3d::Constant(c[1] * strain.sum()));
    };
    const double rounding = 1e-11 * (trial.cwiseAbs().maxCoeff() + law.shear);
    Returned best{Vector3d::Constant(law.tension), Vector3d::Zero()};
    double least = std::numeric_limits<double>::infinity(); // excess
    for (int together = 1; together <= 3; ++together)
        for (unsigned set = 1; set < 64; ++set) {
            if (std::popcount(set) != together || (set & 3) == 0) // the first two are the outermost
                continue;
            std::array<int, 3> active{};
            for (int plane = 0, n = 0; plane < 6; ++plane)
                if ((set >> plane & 1) != 0)
                    active[n++] = plane;
            using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
            using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;
            Matrix matrix(together, together);
            Vector excess(together);
            for (int i = 0; i < together; ++i) {
                const Plane& plane = planes[active[i]];
                excess[i] = plane.normal.dot(trial) - plane.limit;
                for (int j = 0; j < together; ++j)
                    matrix(i, j) = plane.normal.dot(elastic(planes[active[j]].flow));
            }
            const Eigen::FullPivLU<Matrix> factor(matrix);
            if (!factor.isInvertible())
                continue;
            const Vector multiplier = factor.solve(excess);
            if (!(multiplier.minCoeff() >= 0))
                continue;
            Vector3d plastic = Vector3d::Zero();
            for (int i = 0; i < together; ++i)
                plastic += multiplier[i] * planes[active[i]].flow;
            const Vector3d stress = trial - elastic(plastic);
            double most = 0;
            for (const Plane& plane : planes)
                most = std::max(most, plane.normal.dot(stress) - plane.limit);
            if (most <= rounding)
                return {stress, plastic};
            if (most < least) {
                least = most;
                best = {stress, plastic};
            }
        }
    return best; // of rounding at a corner
}

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
inline Eigen::Vector3d yielded(YieldingZone& zone, const Elasticity& c, const Eigen::Vector3d& initial,
                               const Eigen::Vector3d& last, const Eigen::Vector3d& strain)
{
    using Eigen::Vector3d, Eigen::Vector4d;
    Vector4d s = elastic_stress(zone, c, initial, strain);
    if (excess(zone.law, s) > 0) {
        const Vector3d trial = principal(s);
        std::array<int, 3> order{0, 1, 2};
        std::sort(order.begin(), order.end(), [&](int a, int b) { return trial[a] > trial[b]; });
        const Returned found = returned(zone.law, c, {trial[order[0]], trial[order[1]], trial[order[2]]});
        Vector3d stress, plastic; // as `trial`
        for (int i = 0; i < 3; ++i) {
            stress[order[i]] = found.stress[i];
            plastic[order[i]] = found.plastic[i];
        }
        const double radius = (trial[0] - trial[1]) / 2;
        const double cos2 = radius > 0 ? (s[0] - s[1]) / 2 / radius : 1.0,
                     sin2 = radius > 0 ? s[2] / radius : 0.0;
        const auto turned = [&](const Vector3d& p) { // {xx, yy, xy}
            const double mean = (p[0] + p[1]) / 2, half = (p[0] - p[1]) / 2;
            return Vector3d(mean + half * cos2, mean - half * cos2, half * sin2);
        };
        const Vector3d in_section = turned(plastic), now = turned(stress);
        const double last_zz = zone.stress_zz;
        s = {now[0], now[1], now[2], stress[2]};
        const Vector4d more(in_section[0], in_section[1], plastic[2], 2 * in_section[2]);
        zone.plastic += more;
        zone.dissipated +=
            ((last + now).dot(Vector3d(more[0], more[1], more[3])) + (last_zz + s[3]) * more[2]) / 2;
    }
    zone.stress_zz = s[3];
    return {s[0], s[1], s[2]};
}

// What its springs hold, per area [J/m2]: only differences mean anything.
inline double stored(const Elasticity& c, const Eigen::Vector3d& s, double zz)
{
    const double mean = (s[0] + s[1] + zz) / 3, bulk = (c[0] + 2 * c[1]) / 3;
    const double xx = s[0] - mean, yy = s[1] - mean, across = zz - mean;
    return mean * mean / (2 * bulk) + (xx * xx + yy * yy + across * across + 2 * s[2] * s[2]) / (4 * c[2]);
}

} // namespace jointcreep::mechanics
