// The weights of one step against the integrals that they stand for.

#include "joints.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace scheme_test
{

using namespace jointcreep;
using namespace jointcreep::test;

namespace
{

// A number that is as likely in any decade.
double any_of_decades(double least, double most)
{
    const double fraction = *rc::gen::inRange(0, 1 << 30) / static_cast<double>(1 << 30);
    return least * std::pow(most / least, fraction);
}

// d(1) of d' = -x d + phi(s), phi' = r / (1 - exp(-r)) - r phi, from zero: the integral of the last weight.
double integral(double x, double r)
{
    MatrixXd M = MatrixXd::Zero(3, 3);
    M << -x, 1, 0, 0, -r, r == 0 ? 1 : -r / std::expm1(-r), 0, 0, 0;
    const MatrixXd flow = M.exp(); // a coefficient of M.exp() itself would dangle
    return flow(0, 2);
}

} // namespace

RC_GTEST_PROP(scheme, fitted_weights_are_the_integrals_of_their_force, ())
{
    const double lam = any_of_decades(1e-9, 300), ratio = any_of_decades(1e-6, 300);
    const Chain chain = kelvin(1, ratio, lam);
    const double eta = chain.units[0].viscosity;
    const double r = creep::relaxation_rate(chain);
    RC_ASSERT(std::abs(r - lam * (1 + ratio)) < 1e-14 * r);
    const creep::StepWeights step = creep::step_of(chain, CreepScheme::fitted, 1);
    const double last = integral(lam, r) / eta;
    const double all = -std::expm1(-lam) / lam / eta;
    RC_ASSERT(std::abs(step.units[0].last - last) < 1e-10 * last);
    RC_ASSERT(std::abs(step.units[0].first - (all - last)) < 1e-10 * all);
    RC_ASSERT(std::abs(step.units[0].decay - std::exp(-lam)) < 1e-14);
    RC_ASSERT(std::abs(1 / step.acting_stiffness - (1 + last)) < 1e-10 * (1 + last));
}

RC_GTEST_PROP(scheme, linear_weights_are_the_integrals_of_their_force, ())
{
    const double lam = any_of_decades(1e-9, 300);
    const creep::StepWeights step = creep::step_of(kelvin(1, 1, lam), CreepScheme::linear_force, 1);
    RC_ASSERT(std::abs(step.units[0].last - integral(lam, 0) * lam) < 1e-11 * lam);
}

// Between linear force and backward: what keeps it from ringing and from growing.
RC_GTEST_PROP(scheme, fitted_lies_between_linear_force_and_backward, ())
{
    Chain chain{1, {}};
    for (int n = *rc::gen::inRange(1, 5); n > 0; --n)
        chain.units.push_back(
            {*rc::gen::inRange(0, 4) == 0 ? 0 : any_of_decades(1e-3, 1e3), any_of_decades(1e-6, 1e6)});
    const double duration = any_of_decades(1e-9, 1e9);
    const auto linear = creep::step_of(chain, CreepScheme::linear_force, duration);
    const auto fitted = creep::step_of(chain, CreepScheme::fitted, duration);
    const auto backward = creep::step_of(chain, CreepScheme::backward, duration);
    for (std::size_t u = 0; u < chain.units.size(); ++u) {
        const double rounding = 1e-10 * backward.units[u].last;
        RC_ASSERT(fitted.units[u].last >= linear.units[u].last - rounding);
        RC_ASSERT(fitted.units[u].last <= backward.units[u].last + rounding);
        RC_ASSERT(fitted.units[u].first >= -rounding);
        RC_ASSERT(linear.units[u].last >= linear.units[u].first - rounding);
    }
    RC_ASSERT(std::isfinite(fitted.compliance) && fitted.acting_stiffness > 0);
}

TEST(scheme, a_maxwell_dashpot_is_a_kelvin_unit_without_spring)
{
    for (const CreepScheme scheme : all_schemes) {
        const creep::StepWeights maxwell = creep::step_of({2, {{0, 5}}}, scheme, 3);
        const creep::StepWeights soft = creep::step_of({2, {{1e-9, 5}}}, scheme, 3);
        EXPECT_EQ(maxwell.units[0].decay, 1);
        EXPECT_NEAR(maxwell.units[0].first + maxwell.units[0].last, 3. / 5, 1e-14);
        EXPECT_NEAR(maxwell.units[0].last, soft.units[0].last, 1e-9);
    }
}

// Fixed walls: d <- (A - K b 1^T) d with A = diag(a), b the first weights. At the limit an eigenvalue is -1.
RC_GTEST_PROP(scheme, published_is_stable_up_to_its_limit_and_no_further, ())
{
    Chain chain{1, {}};
    const int units = *rc::gen::inRange(1, 4);
    for (int n = units; n > 0; --n) {
        chain.units.push_back({any_of_decades(.01, 10), any_of_decades(.01, 100)});
        if (*rc::gen::inRange(0, 5) == 0)
            chain.units.back().stiffness = 0;
    }
    const auto radius = [&](double duration) {
        const creep::StepWeights step = creep::step_of(chain, CreepScheme::published, duration);
        MatrixXd M(units, units);
        for (int u = 0; u < units; ++u) {
            M.row(u).setConstant(-step.units[u].first);
            M(u, u) += step.units[u].decay;
        }
        return M.eigenvalues().cwiseAbs().maxCoeff();
    };
    const double limit = creep::longest_stable_step(chain);
    if (std::isinf(limit)) {
        RC_ASSERT(radius(1e6) <= 1 + 1e-12);
        return;
    }
    RC_ASSERT(std::abs(radius(limit) - 1) < 1e-9);
    RC_ASSERT(radius(1.01 * limit) > 1);
    RC_ASSERT(creep::is_stable(chain, .99 * limit) && !creep::is_stable(chain, 1.01 * limit));
}

TEST(scheme, the_papers_joint_has_a_limit_of_206_days)
{
    const Chain chain{6.9e8, {{4.8e8, 57600e6 * 86400}}};
    EXPECT_NEAR(creep::longest_stable_step(chain) / 86400, 206, 1);
    const double lam = 1 / 120.0, ratio = 6.9 / 4.8;
    EXPECT_NEAR(creep::longest_stable_step(chain) / 86400, -std::log1p(-2 / (1 + ratio)) / lam, 1e-9);
    EXPECT_TRUE(std::isinf(creep::longest_stable_step(kelvin(1, 1, 1))));
}

TEST(scheme, the_longest_step_of_a_section_names_what_sets_it)
{
    const EquivalentJoints joints = joints_of({kelvin(1e9, 2, .1), kelvin(1e9, 20, .1), kelvin(0, 20, 1)});
    Scene scene;
    Network network;
    network.blocks.edge_joint = {0, 1, 2};
    network.joints.set = {0, 1, 2};
    network.names.joint_set = {"stiff", "soft", "smooth"};
    const auto limit = [&](const EquivalentJoints& of) {
        return mechanics::longest_stable_step(scene, network, of);
    };
    EXPECT_EQ(limit(joints).set_by, "joint \"soft\"");
    EXPECT_NEAR(limit(joints).step, -std::log1p(-2 / 21.) / .1, 1e-9);

    Rock hard{"hard", 2700, 3e10, .25, {}}, soft = hard;
    soft.name = "weak";
    soft.kelvin = ShearKelvin{1e9, 1e10}; // G / E = 12: 1 - exp(-x) = 2 / 13 at the limit
    scene.rocks = {hard, soft};
    EXPECT_EQ(limit(joints).set_by, "joint \"soft\"");
    scene.rocks[1].kelvin = ShearKelvin{1e9, 1e9};
    EXPECT_EQ(limit(joints).set_by, "rock \"weak\"");
    EXPECT_NEAR(limit(joints).step, -std::log1p(-2 / 13.), 1e-9);
    scene.rocks = {hard};
    EXPECT_EQ(limit(joints_of({kelvin(1e9, .5, .1)})).set_by, "");
}

} // namespace scheme_test
