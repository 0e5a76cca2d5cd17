// Joints held together by rock bridges: bounds, staggered lines, and what becomes of creep.

#include "joint/bridged.hpp"

#include "model/units.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace bridged_test
{

using namespace jointcreep;
using namespace jointcreep::joint;
using namespace jointcreep::unit;

namespace
{

constexpr double pi = std::numbers::pi;
constexpr Direction both[] = {Direction::normal, Direction::shear};

BridgedLine line_of(double persistence)
{
    return {.persistence = persistence, .trace_length = 5, .spacing = 8, .plane_modulus = 30e9 / (1 - .04)};
}

double stiffness(StiffnessRule rule, const BridgedLine& line, double joint, Direction direction)
{
    const Bridging found = bridging(rule, line, joint, direction);
    return found.bridges + found.share * joint;
}

// A number from least to most.
rc::Gen<double> between(double least, double most)
{
    return rc::gen::map(rc::gen::inRange(0, 1000001),
                        [=](int i) { return least + (most - least) * i / 1e6; });
}

// 1 / (impedance) of a chain under exp(s t).
std::complex<double> compliance(const JointChain& chain, std::complex<double> s)
{
    std::complex<double> sum = 1 / chain.spring;
    for (const KelvinUnit& unit : chain.units)
        sum += 1.0 / (unit.stiffness + s * unit.viscosity);
    if (chain.maxwell_viscosity > 0)
        sum += 1.0 / (s * chain.maxwell_viscosity);
    return sum;
}

} // namespace

TEST(Bridging, IsWhatAHandFinds)
{
    // L = 5 m, k = .25: 2 b = 20 m, ln sec(pi / 8) = .0791736, K_0 = pi 31.25e9 / (4 20 .0791736) = 15.4999
    // GPa/m, and 690 / .25 = 2760 MPa/m of the joint: together 26.5 times its own.
    const Bridging found = bridging(StiffnessRule::lower_bound, line_of(.25), 690e6, Direction::normal);
    EXPECT_NEAR(found.bridges, 15.4999e9, 1e5);
    EXPECT_EQ(found.share, 4);
    EXPECT_NEAR(stiffness(StiffnessRule::lower_bound, line_of(.25), 690e6, Direction::normal) / 690e6, 26.46,
                .01);
    const Bridging upper = bridging(StiffnessRule::upper_bound, line_of(.25), 690e6, Direction::shear);
    EXPECT_EQ(upper.bridges, found.bridges);
    EXPECT_NEAR(upper.share, 4 * 1.0808, 1e-3);
}

TEST(Bridging, IsThatOfOneTraceWhereItHardlyMeetsAnother)
{
    // A single empty trace opens by pi L^2 / (2 E') times the stress: over 2 b, K_0 = 2 E' 2 b / (pi L^2).
    const double k = .02, b = 5 / (2 * k), one = 2 * line_of(k).plane_modulus * 2 * b / (pi * 25);
    for (const StiffnessRule rule : {StiffnessRule::lower_bound, StiffnessRule::staggered})
        EXPECT_NEAR(bridging(rule, {k, 5, 1e3, line_of(k).plane_modulus}, 0, Direction::normal).bridges / one,
                    1, 1e-3);
}

TEST(Bridging, OfJointsWithoutBridgesIsTheJoint)
{
    const Bridging found = bridging(StiffnessRule::lower_bound, line_of(1 - 1e-12), 690e6, Direction::normal);
    EXPECT_NEAR(found.share, 1, 1e-11);
    EXPECT_LT(found.bridges, .2e9); // goes with 1 / log: slowly
    EXPECT_EQ(bridging(StiffnessRule::joint, line_of(.3), 690e6, Direction::normal).bridges, 0);
    EXPECT_EQ(bridging(StiffnessRule::joint, line_of(.3), 690e6, Direction::normal).share, 1);
}

RC_GTEST_PROP(Bridging, FallsWithPersistenceAndRisesWithTheJoint, ())
{
    const double k = *between(.05, .9), more = k + *between(.01, .09), joint = *between(1e6, 1e11);
    for (const StiffnessRule rule : {StiffnessRule::lower_bound, StiffnessRule::upper_bound}) {
        RC_ASSERT(stiffness(rule, line_of(k), joint, Direction::normal) >
                  stiffness(rule, line_of(more), joint, Direction::normal));
        RC_ASSERT(stiffness(rule, line_of(k), joint, Direction::normal) <
                  stiffness(rule, line_of(k), 1.1 * joint, Direction::normal));
        RC_ASSERT(stiffness(rule, line_of(k), joint, Direction::normal) > joint);
    }
}

RC_GTEST_PROP(Staggered, IsBetweenTheBoundsWhereLinesAreFarApart, ())
{
    BridgedLine line = line_of(*between(.1, .95));
    line.spacing = 3 * line.trace_length / line.persistence;
    const double joint = *between(1e5, 1e11);
    for (const Direction direction : both) {
        const double found = stiffness(StiffnessRule::staggered, line, joint, direction);
        RC_ASSERT(found > (1 - 1e-3) * stiffness(StiffnessRule::lower_bound, line, joint, direction));
        RC_ASSERT(found < (1 + 1e-3) * stiffness(StiffnessRule::upper_bound, line, joint, direction));
    }
}

// Second method: the singular integral equation of the same problem, by dislocations along the traces of two
// lines a cell, summed over their periods, extrapolated from 40, 80 and 160 elements a trace. The period and
// E' are 1.
TEST(Staggered, IsWhatDislocationsFind)
{
    struct Case {
        double persistence, spacing, joint, normal, shear;
    };
    for (const Case& one : std::vector<Case>{
             {0.25, 0.25, 0, 8.87743, 9.63825},
             {0.25, 0.25, 0.5, 11.02970, 11.79703},
             {0.25, 0.25, 5, 30.05428, 30.85982},
             {0.5, 0.5, 0, 1.72410, 2.53379},
             {0.5, 0.5, 0.5, 2.80816, 3.60417},
             {0.5, 0.5, 5, 12.26378, 12.99860},
             {0.5, 0.125, 0, 0.86266, 1.64083},
             {0.5, 0.125, 0.5, 1.91141, 2.75999},
             {0.5, 0.125, 5, 11.23086, 12.34426},
             {0.75, 0.25, 0, 0.22348, 0.85187},
             {0.75, 0.25, 0.5, 1.00265, 1.55476},
             {0.75, 0.25, 5, 7.44940, 7.74709},
             {0.75, 1, 0, 0.80075, 0.82978},
             {0.75, 1, 0.5, 1.51459, 1.54145},
             {0.75, 1, 5, 7.74145, 7.76126},
             {0.9, 0.5, 0, 0.33880, 0.45473},
             {0.9, 0.5, 0.5, 0.94343, 1.03782},
             {0.9, 0.5, 5, 6.13194, 6.17555},
         }) {
        EXPECT_NEAR(staggered_stiffness(one.persistence, one.spacing, one.joint, Direction::normal) /
                        one.normal,
                    1, 2e-4)
            << one.persistence << ' ' << one.spacing << ' ' << one.joint;
        EXPECT_NEAR(staggered_stiffness(one.persistence, one.spacing, one.joint, Direction::shear) /
                        one.shear,
                    1, 2e-4)
            << one.persistence << ' ' << one.spacing << ' ' << one.joint;
    }
}

TEST(Staggered, IsTheClosedFormOfALineAlone)
{
    for (const double k : {.05, .2, .5, .8, .9})
        for (const Direction direction : both)
            EXPECT_NEAR(staggered_stiffness(k, 5, 0, direction) * 4 * -std::log(std::cos(pi * k / 2)) / pi, 1,
                        1e-3)
                << k;
}

TEST(Bridged, CreepsAsAHandFinds)
{
    // Beside the bridges B, a joint of spring K and Kelvin unit E, eta: B + K at first, B + K E / (K + E) in
    // the end, and between them as exp(-t (B (K + E) + K E) / (eta (B + K))).
    const double B = 3, K = 2, E = 1, eta = 5;
    const JointChain chain = bridged({K, {{E, eta}}, 0}, {B, 1});
    EXPECT_EQ(chain.spring, 5);
    ASSERT_EQ(chain.units.size(), 1u);
    EXPECT_NEAR(1 / chain.spring + 1 / chain.units[0].stiffness, 1 / (B + K * E / (K + E)), 1e-14);
    EXPECT_NEAR(chain.units[0].stiffness / chain.units[0].viscosity, (B * (K + E) + K * E) / (eta * (B + K)),
                1e-14);
}

TEST(Bridged, BringsAMaxwellDashpotToAnEnd)
{
    // Bridges B beside a spring K with a dashpot eta: B + K at first, B in the end; (B + K)^2 eta / K^2 in
    // between.
    const double B = 3, K = 2, eta = 5;
    const JointChain chain = bridged({K, {}, eta}, {B, 1});
    EXPECT_EQ(chain.maxwell_viscosity, 0);
    ASSERT_EQ(chain.units.size(), 1u);
    EXPECT_NEAR(1 / chain.spring + 1 / chain.units[0].stiffness, 1 / B, 1e-14);
    EXPECT_NEAR(chain.units[0].viscosity, (B + K) * (B + K) * eta / (K * K), 1e-12);
}

TEST(Bridged, WithoutBridgesIsTheJoint)
{
    const JointChain chain = bridged({2, {{3, 4}}, 5}, {0, 1});
    EXPECT_EQ(chain.spring, 2);
    EXPECT_EQ(chain.units[0].stiffness, 3);
    EXPECT_EQ(chain.units[0].viscosity, 4);
    EXPECT_EQ(chain.maxwell_viscosity, 5);
    EXPECT_TRUE(bridged({0, {{3, 4}}, 5}, {7, 2}).units.empty()); // a smooth joint bears nothing
    EXPECT_EQ(bridged({0, {{3, 4}}, 5}, {7, 2}).spring, 7);
}

// Under any course of time: the same impedance at any frequency. Units of one rate, or nearly, are among
// them.
RC_GTEST_PROP(Bridged, IsTheBridgesBesideTheJointAtEveryRate, ())
{
    const auto decades = [](int most) { return std::pow(10.0, *between(-most, most)); };
    JointChain joint{decades(2), {}, *rc::gen::arbitrary<bool>() ? decades(3) : 0.0};
    for (int unit = *rc::gen::inRange(0, 5); unit > 0; --unit)
        joint.units.push_back({decades(2), decades(4)});
    if (joint.units.size() > 1 && *rc::gen::arbitrary<bool>()) {
        const double near = *rc::gen::element(0.0, 1e-12, 1e-7);
        joint.units[1] = {joint.units[0].stiffness * 3, joint.units[0].viscosity * 3 * (1 + near)};
    }
    const Bridging beside{decades(3), decades(1)};
    const JointChain chain = bridged(joint, beside);
    RC_ASSERT(chain.maxwell_viscosity == 0);
    for (const KelvinUnit& unit : chain.units)
        RC_ASSERT(unit.stiffness > 0 && unit.viscosity > 0 && std::isfinite(unit.viscosity));
    const std::complex<double> s = std::polar(decades(5), *between(0, pi / 2));
    const std::complex<double> found = compliance(chain, s),
                               wanted = 1.0 / (beside.bridges + beside.share / compliance(joint, s));
    RC_ASSERT(std::abs(found - wanted) < 1e-6 * std::abs(wanted));
}

} // namespace bridged_test
