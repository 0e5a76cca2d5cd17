// The continuously yielding joint along paths worked out by hand, beside its equations, and along any path.

#include "joint/law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace continuously_yielding_test
{

using namespace jointcreep;
using namespace jointcreep::joint;

namespace
{

ContinuouslyYielding rough(double roughness_length)
{
    return {.k_n = 4e9,
            .k_s = 1e9,
            .plastic_k_s = 1e9,
            .friction_angle = 0.5,
            .initial_angle = 0.8,
            .roughness_length = roughness_length};
}

// The equations by small explicit steps, from no shear on.
struct Stepped {
    ContinuouslyYielding law;
    double tau = 0, u_p = 0, r = 0, sense = 0;

    void go(double by, double p, int steps)
    {
        const double way = by > 0 ? 1 : -1;
        if (sense != way) {
            r = sense == 0 ? 0 : std::min(0.75, way * tau / (p * law.tan_phi_m(u_p)));
            sense = way;
        }
        for (int i = 0; i < steps; ++i) {
            const double left = 1 - sense * tau / (p * law.tan_phi_m(u_p)), f = std::min(1.0, left / (1 - r)),
                         u = std::abs(by) / steps;
            tau += sense * f * law.k_s * u;
            u_p += (1 - f) * u;
            const double limit = p * law.tan_phi_m(u_p);
            if (sense * tau > limit) {
                u_p += (sense * tau - limit) / law.k_s;
                tau = sense * limit;
            }
        }
    }
};

} // namespace

// Where the roughness does not wear, tau_m stays: tau = tau_m - (tau_m - tau_0) exp(-k_s u / ((1 - r) tau_m)).
TEST(continuously_yielding, follows_exponentials_where_roughness_stays)
{
    const ContinuouslyYielding law = rough(1e9);
    const double p = 2e6, most = p * std::tan(0.8);
    State state;
    // From 0 on, r = 0.
    const double first = most * (1 - std::exp(-law.k_s * 3e-3 / most));
    EXPECT_NEAR(respond(law, state, -p, 0, 0, 3e-3).tau, first, 1e-3);
    EXPECT_NEAR(state.slip, 3e-3 - first / law.k_s, 1e-12);
    // It turns: in the other sense tau is -first, and r = -first / most.
    const double back = most - (most + first) * std::exp(-law.k_s * 1e-3 / (most + first));
    EXPECT_NEAR(respond(law, state, -p, 0, 0, 2e-3).tau, -back, 1e-3);
    // And turns again while tau is still positive: r = tau / most, below 0.75.
    ASSERT_GT(-back, 0);
    const double r = -back / most, on = most - (most + back) * std::exp(-law.k_s * 2e-3 / ((1 - r) * most));
    EXPECT_NEAR(respond(law, state, -p, 0, 0, 4e-3).tau, on, 1e-3);
}

TEST(continuously_yielding, is_as_stiff_as_its_spring_where_shear_turns)
{
    const ContinuouslyYielding law = rough(2e-3);
    State state;
    const double u = 1e-8;
    EXPECT_NEAR(respond(law, state, -1e6, 0, 0, u).tau / (law.k_s * u), 1, 1e-4);
    const double far = respond(law, state, -1e6, 0, 0, 4e-3).tau;
    EXPECT_NEAR((far - respond(law, state, -1e6, 0, 0, 4e-3 - u).tau) / (law.k_s * u), 1, 1e-4);
}

// The roughness wears off as it yields: beside the equations in small steps, there, back and on.
TEST(continuously_yielding, follows_its_equations)
{
    for (const double roughness_length : {5e-4, 2e-3, 1e-2}) {
        const ContinuouslyYielding law = rough(roughness_length);
        State state;
        Stepped by_steps{law};
        double u = 0;
        for (const double by : {3e-3, -1e-3, 4e-3, -9e-3, 2e-3}) {
            u += by;
            by_steps.go(by, 1.5e6, 200000);
            const Response now = respond(law, state, -1.5e6, 0, 0, u);
            EXPECT_NEAR(now.tau, by_steps.tau, 1e-3 * 1.5e6) << roughness_length << " " << u;
            EXPECT_NEAR(state.memory[0], by_steps.u_p, 1e-3 * by_steps.u_p) << roughness_length << " " << u;
        }
    }
}

// The strength passes a peak, and ends at p tan(phi).
TEST(continuously_yielding, ends_at_the_friction_of_the_smooth_joint)
{
    const ContinuouslyYielding law = rough(1e-3);
    State state;
    double peak = 0;
    for (int i = 1; i <= 400; ++i)
        peak = std::max(peak, respond(law, state, -1e6, 0, 0, i * 5e-5).tau);
    const double smooth = 1e6 * std::tan(0.5);
    EXPECT_GT(peak, 1.05 * smooth);
    EXPECT_LT(peak, 1e6 * std::tan(0.8));
    const Response end = respond(law, state, -1e6, 0, 0, 0.03);
    EXPECT_NEAR(end.tau / smooth, 1, 1e-6);
    EXPECT_EQ(end.status, ContactStatus::slipping);
}

TEST(continuously_yielding, opens_and_closes_without_shear)
{
    const ContinuouslyYielding law = rough(2e-3);
    State state;
    respond(law, state, -1e6, 0, 0, 3e-3);
    const double worn = state.memory[0];
    EXPECT_EQ(respond(law, state, -1e6, 0, 3e-4, 3e-3).status, ContactStatus::open);
    EXPECT_EQ(respond(law, state, -1e6, 0, 3e-4, -5e-3).tau, 0);
    const Response closed = respond(law, state, -1e6, 0, 0, -5e-3);
    EXPECT_EQ(closed.tau, 0);
    EXPECT_EQ(state.memory[0], worn);
    EXPECT_GT(respond(law, state, -1e6, 0, 0, -4.9e-3).tau, 0.9 * law.k_s * 1e-4);
}

// A spring that creep has softened adds its own displacement, and changes nothing of the plastic one.
TEST(continuously_yielding, a_softer_spring_is_in_series)
{
    const ContinuouslyYielding law = rough(1e6), soft = law.with_springs(law.k_n, 0.25 * law.k_s);
    const double p = 1e6, most = p * std::tan(0.8);
    for (const double tau : {0.2 * most, 0.6 * most, 0.95 * most}) {
        const double u = -most / law.k_s * std::log(1 - tau / most); // of the firm joint
        State state;
        EXPECT_NEAR(respond(law, state, -p, 0, 0, u).tau, tau, 1e-3);
        State softened;
        EXPECT_NEAR(respond(soft, softened, -p, 0, 0, u + tau * (1 / soft.k_s - 1 / law.k_s)).tau, tau, 1e-3);
        EXPECT_NEAR(softened.slip, state.slip, 1e-12);
        EXPECT_NEAR(softened.memory[0], state.memory[0], 1e-12);
    }
}

// For any path: never beyond its strength, never stiffer than its spring, plastic displacement that only grows, and
// the same when asked twice.
RC_GTEST_PROP(continuously_yielding, any_path_is_within_its_strength, ())
{
    // With any initial shear, and a spring that creep has softened.
    const auto one_in = [](int from, int to) { return *rc::gen::inRange(from, to); };
    const ContinuouslyYielding firm = rough(1e-5 * one_in(1, 1001)),
                               law = firm.with_springs(firm.k_n, firm.k_s / std::pow(10, one_in(0, 5)));
    const double tau_0 = 2e3 * one_in(-1000, 1001);
    State state;
    double last = tau_0, last_u = 0, last_most = 1e300;
    for (int i = 0; i < 20; ++i) {
        const State before = state;
        const double u_n = 4e-4 * one_in(-1000, 1001) / 1000.0, u_s = 1e-2 * one_in(-1000, 1001) / 1000.0;
        const Response now = respond(law, state, -1e6, tau_0, u_n, u_s);
        const double most = std::max(0.0, -now.sigma_n) * law.tan_phi_m(state.memory[0]);
        RC_ASSERT(std::abs(now.tau) <= most * (1 + 1e-8));
        if (now.status != ContactStatus::open && last_most <= most) // else its strength cuts it off
            RC_ASSERT(std::abs(now.tau - last) <= law.k_s * std::abs(u_s - last_u) * (1 + 1e-9) + 1e-3);
        // Plastic displacement only grows, and by no more than the joint moves and its spring gives.
        const double grown = state.memory[0] - before.memory[0];
        RC_ASSERT(grown >= 0);
        RC_ASSERT(grown <= std::abs(u_s - last_u) + (std::abs(last) + std::abs(now.tau)) / law.k_s + 1e-12);
        const State kept = state;
        const Response again = respond(law, state, -1e6, tau_0, u_n, u_s);
        RC_ASSERT(std::abs(again.tau - now.tau) <= 1e-8 * most);
        RC_ASSERT(std::abs(state.memory[0] - kept.memory[0]) <= 1e-12);
        RC_ASSERT(state.memory[2] == kept.memory[2]);
        last = now.tau;
        last_u = u_s;
        last_most = most;
    }
}

// At large displacements every time step is far too little for a turn; many together follow the path, from initial
// shear on, and back.
TEST(continuously_yielding, yields_in_small_steps_at_large_displacements)
{
    const ContinuouslyYielding law = rough(2e-3);
    const double p = 1e6, tau_0 = 1e5, step = 2e-8;
    State at_point, along;
    double u = 0, tau = tau_0;
    for (const double by : {2e-3, -1.5e-3, 3e-3}) {
        u += by;
        for (int i = 0; i < std::lround(std::abs(by) / step); ++i)
            tau = shear(law, along, tau, by > 0 ? step : -step, p * law.tan_phi_m(along.memory[0]));
        EXPECT_NEAR(tau, respond(law, at_point, -p, tau_0, 0, u).tau, 1e-3 * p) << u;
        EXPECT_NEAR(along.memory[0], at_point.memory[0], 2e-3 * at_point.memory[0]) << u;
    }
}

// What an equilibrium leaves of a displacement back is no turn: the path goes on as if it had not been.
TEST(continuously_yielding, a_displacement_of_rounding_is_no_turn)
{
    const ContinuouslyYielding law = rough(2e-3);
    State once, twice;
    respond(law, once, -1e6, 0, 0, 1e-3);
    respond(law, twice, -1e6, 0, 0, 1e-3);
    respond(law, twice, -1e6, 0, 0, 1e-3 - 1e-11);
    EXPECT_NEAR(respond(law, twice, -1e6, 0, 0, 1.5e-3).tau, respond(law, once, -1e6, 0, 0, 1.5e-3).tau, 1);
}

} // namespace continuously_yielding_test
