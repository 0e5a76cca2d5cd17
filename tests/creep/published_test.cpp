// The published creep step against closed forms, on single joints that need no zones.

#include "creep/published.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace jointcreep;
using Eigen::Vector2d;

namespace
{

const double K = 6.9e8, E = 4.8e8, eta = 57600e6 * 86400, lam = E / eta;

Mesh one_contact()
{
    Mesh mesh;
    mesh.contact_edge = {0};
    return mesh;
}

EquivalentJoints one_joint(double k, double kelvin)
{
    EquivalentJoints joints;
    joints.normal_stiffness = {k};
    joints.shear_stiffness = {k / 2};
    joints.normal_kelvin_stiffness = {kelvin};
    joints.shear_kelvin_stiffness = {0};
    joints.normal_kelvin_viscosity = {kelvin / lam};
    joints.shear_kelvin_viscosity = {0};
    joints.normal_maxwell_viscosity = joints.shear_maxwell_viscosity = {0};
    return joints;
}

} // namespace

TEST(published, constant_traction_gives_the_kelvin_curve_whatever_the_steps)
{
    // The paper's Eq. 3 for the change of traction since the contact has crept: d = dF / E (1 - exp(-lam T)).
    const std::vector<Vector2d> before{{-2e6, 1e5}}, after{{-0.5e6, 3e5}};
    for (const int n : {1, 7, 365}) {
        creep::Published creep(one_contact(), one_joint(K, E), before);
        std::vector<Vector2d> offset{{0, 0}};
        const double T = 365 * 86400.0;
        for (int i = 0; i < n; ++i)
            creep.advance(T / n, after, offset);
        EXPECT_NEAR(offset[0].x(), 1.5e6 / E * -std::expm1(-lam * T), 1e-12 * 1.5e6 / E) << n;
        EXPECT_EQ(offset[0].y(), 0); // no Kelvin element along the joint
    }
}

TEST(published, unchanged_traction_does_not_creep)
{
    creep::Published creep(one_contact(), one_joint(K, E), {{-2e6, 1e5}});
    std::vector<Vector2d> offset{{0, 0}};
    creep.advance(1e9, {{-2e6, 1e5}}, offset);
    EXPECT_EQ(offset[0], Vector2d(0, 0));
}

TEST(published, an_open_joint_relaxes_towards_the_displacement_without_traction)
{
    creep::Published creep(one_contact(), one_joint(K, E), {{-2e6, 0}});
    std::vector<Vector2d> offset{{0, 0}};
    creep.advance(1e12, {{0, 0}}, offset);
    EXPECT_NEAR(offset[0].x(), 2e6 / E, 1e-12);
}

TEST(published, joint_between_fixed_platens)
{
    // Squeezed by u0 at T = 0, F(T) = u0 (Kinf + (K - Kinf) exp(-T (K + E) / eta)), Kinf = K E / (K + E). The
    // step is first order: halving it halves the error.
    const double u0 = -1e-3, T = 120 * 86400.0;
    const double k_inf = K * E / (K + E);
    const double exact = u0 * (k_inf + (K - k_inf) * std::exp(-T * (K + E) / eta));
    double last = 0;
    for (const int n : {64, 128, 256}) {
        creep::Published creep(one_contact(), one_joint(K, E), {{0, 0}});
        std::vector<Vector2d> offset{{0, 0}};
        for (int i = 0; i < n; ++i)
            creep.advance(T / n, {{K * (u0 - offset[0].x()), 0}}, offset);
        const double error = std::abs(K * (u0 - offset[0].x()) - exact);
        if (last > 0) {
            EXPECT_NEAR(error / last, 0.5, 0.05);
        }
        last = error;
    }
    EXPECT_LT(last, 3e-3 * std::abs(exact));
}

TEST(published, the_step_limit_is_where_a_fixed_joint_starts_to_blow_up)
{
    for (const double ratio : {1.44, 5.0, 20.0, 100.0}) {
        const EquivalentJoints joints = one_joint(K, K / ratio);
        const creep::StepLimit limit = creep::longest_step(joints);
        EXPECT_EQ(limit.edge, 0);
        const auto force_after = [&](double step) {
            creep::Published creep(one_contact(), joints, {{0, 0}});
            std::vector<Vector2d> offset{{0, 0}};
            for (int i = 0; i < 400; ++i)
                creep.advance(step, {{K * (-1e-3 - offset[0].x()), 0}}, offset);
            return std::abs(K * (-1e-3 - offset[0].x()));
        };
        EXPECT_LE(force_after(0.97 * limit.step), K * 1e-3) << ratio;
        EXPECT_GT(force_after(1.03 * limit.step), 10 * K * 1e-3) << ratio;
    }
    // K <= E: no limit. The paper's Table 2 beside its K_n: about 206 days.
    EXPECT_EQ(creep::longest_step(one_joint(K, K)).edge, -1);
    EXPECT_NEAR(creep::longest_step(one_joint(K, E)).step / 86400, 206, 1);
}
