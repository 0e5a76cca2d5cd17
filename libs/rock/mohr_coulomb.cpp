#include "rock/mohr_coulomb.hpp"

#include <Eigen/LU>

#include <array>
#include <bit>
#include <limits>

namespace jointcreep::rock
{

Returned returned(const MohrCoulomb& law, const Elasticity& c, const Eigen::Vector3d& trial)
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

Eigen::Vector3d yielded(YieldingZone& zone, const Elasticity& c, const Eigen::Vector3d& initial,
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

} // namespace jointcreep::rock
