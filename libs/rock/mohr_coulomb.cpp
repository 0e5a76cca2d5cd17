#include "rock/mohr_coulomb.hpp"

#include <Eigen/LU>

#include <algorithm>
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
    Returned best{Vector3d::Constant(law.tension), Vector3d::Zero(), Eigen::Matrix3d::Zero()};
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
            const auto with_tangent = [&] {
                Eigen::Matrix3d tangent = Eigen::Matrix3d::Identity();
                const Matrix inverse = factor.inverse();
                for (int i = 0; i < together; ++i)
                    for (int j = 0; j < together; ++j)
                        tangent -= inverse(i, j) * elastic(planes[active[i]].flow) *
                                   planes[active[j]].normal.transpose();
                return Returned{stress, plastic, tangent};
            };
            double most = 0;
            for (const Plane& plane : planes)
                most = std::max(most, plane.normal.dot(stress) - plane.limit);
            if (most <= rounding)
                return with_tangent();
            if (most < least) {
                least = most;
                best = with_tangent();
            }
        }
    return best; // of rounding at a corner
}

namespace
{

// Trial stresses that exceed the strength, in principal axes, and the stresses they return to.
struct Return {
    Eigen::Vector3d trial;      // the larger and the smaller one in the section, and the one across [Pa]
    std::array<int, 3> order{}; // of these, the largest first
    Returned found;             // in that order
    double cos2, sin2;          // of twice the angle of the first

    Return(const MohrCoulomb& law, const Elasticity& c, const Eigen::Vector4d& s)
        : trial(principal(s)), order{0, 1, 2}
    {
        std::sort(order.begin(), order.end(), [this](int a, int b) { return trial[a] > trial[b]; });
        found = returned(law, c, {trial[order[0]], trial[order[1]], trial[order[2]]});
        const double radius = (trial[0] - trial[1]) / 2;
        cos2 = radius > 0 ? (s[0] - s[1]) / 2 / radius : 1.0;
        sin2 = radius > 0 ? s[2] / radius : 0.0;
    }

    // As `trial`.
    Eigen::Vector3d in_order_of_trial(const Eigen::Vector3d& values) const
    {
        Eigen::Vector3d all;
        for (int i = 0; i < 3; ++i)
            all[order[i]] = values[i];
        return all;
    }
};

} // namespace

Eigen::Vector3d yielded(YieldingZone& zone, const Elasticity& c, const Eigen::Vector3d& initial,
                        const Eigen::Vector3d& last, const Eigen::Vector3d& strain)
{
    using Eigen::Vector3d, Eigen::Vector4d;
    Vector4d s = elastic_stress(zone, c, initial, strain);
    if (excess(zone.law, s) > 0) {
        const Return to(zone.law, c, s);
        const Vector3d stress = to.in_order_of_trial(to.found.stress),
                       plastic = to.in_order_of_trial(to.found.plastic);
        const auto turned = [&](const Vector3d& p) { // {xx, yy, xy}
            const double mean = (p[0] + p[1]) / 2, half = (p[0] - p[1]) / 2;
            return Vector3d(mean + half * to.cos2, mean - half * to.cos2, half * to.sin2);
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

Eigen::Matrix3d tangent_of_yield(const YieldingZone& zone, const Elasticity& c,
                                 const Eigen::Vector3d& initial, const Eigen::Vector3d& strain)
{
    using Eigen::Matrix3d, Eigen::Matrix4d;
    Eigen::Matrix<double, 4, 3> elastic; // trial stress {xx, yy, xy, zz}
    elastic << c[0], c[1], 0, c[1], c[0], 0, 0, 0, c[2], c[1], c[1], 0;
    const Eigen::Vector4d s = elastic_stress(zone, c, initial, strain);
    if (!(excess(zone.law, s) > 0))
        return elastic.topRows<3>();
    const Return to(zone.law, c, s);
    const double cos2 = to.cos2, sin2 = to.sin2;
    Matrix4d turn,
        back; // {xx, yy, xy, zz} to principal {first, second, shear, zz} of the trial stress, and back
    turn << (1 + cos2) / 2, (1 - cos2) / 2, sin2, 0, //
        (1 - cos2) / 2, (1 + cos2) / 2, -sin2, 0,    //
        -sin2 / 2, sin2 / 2, cos2, 0,                //
        0, 0, 0, 1;
    back << (1 + cos2) / 2, (1 - cos2) / 2, -sin2, 0, //
        (1 - cos2) / 2, (1 + cos2) / 2, sin2, 0,      //
        sin2 / 2, -sin2 / 2, cos2, 0,                 //
        0, 0, 0, 1;
    constexpr std::array<int, 3> place{0, 1, 3}; // of the principal stresses in these
    Matrix4d change = Matrix4d::Zero();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            change(place[to.order[i]], place[to.order[j]]) = to.found.tangent(i, j);
    // The axes rotate with the trial stress. Its shear is scaled as the difference of the principal stresses.
    const Eigen::Vector3d stress = to.in_order_of_trial(to.found.stress);
    const double apart = to.trial[0] - to.trial[1], size = to.trial.cwiseAbs().maxCoeff();
    change(2, 2) = apart > 1e-9 * size ? (stress[0] - stress[1]) / apart : change(0, 0) - change(0, 1);
    return (back * change * turn * elastic).topRows<3>();
}

} // namespace jointcreep::rock
