// What holds of every law in the list: its derivatives, its slopes, its integral along an overlap, its table.

#include "any_law.hpp"

#include "joint/along_overlap.hpp"
#include "joint/law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>

namespace law_test
{

using namespace jointcreep;
using namespace jointcreep::joint;
using namespace jointcreep::test;

// Forward differentiation beside central differences, on the branch that all three are on: by the displacement, and
// by what the joint remembers of a first displacement, if there is one.
RC_GTEST_PROP(law, its_derivatives_are_those_of_its_response, ())
{
    const Law law = some_law(any_in(0, places()));
    const auto number = [](double scale) { return scale * any_in(-1000, 1001) / 1000.0; };
    const double sigma_0 = -1e6, tau_0 = 1e5, u_n = number(8e-4), u_s = number(3e-3), step = 1e-9;
    const double by_n = number(1), by_s = number(1);
    State start;
    if (*rc::gen::arbitrary<bool>())
        respond(law, start, sigma_0, tau_0, 0, 1.2345e-3);
    std::array<double, 3> by_memory{};
    for (int i = 0; i < 3; ++i)
        by_memory[i] = number(1e3) * start.memory[i];
    const auto at = [&](double way, State& state) {
        state = start;
        for (int i = 0; i < 3; ++i)
            state.memory[i] += way * by_memory[i];
        return respond(law, state, sigma_0, tau_0, u_n + way * by_n, u_s + way * by_s);
    };
    State before, here, after;
    const Response low = at(-step, before), now = at(0, here), high = at(step, after);
    RC_PRE(low.status == now.status && high.status == now.status && before.is_broken == after.is_broken);
    StateOf<Dual> state{start.slip, start.dilation, start.is_broken, {}};
    for (int i = 0; i < 3; ++i)
        state.memory[i] = Dual(start.memory[i], by_memory[i]);
    const auto found = with_derivatives(law, Dual(k_n(law)), Dual(k_s(law)), [&](const auto& one) {
        return joint::respond(one, state, Dual(sigma_0), Dual(tau_0), Dual(u_n, by_n), Dual(u_s, by_s));
    });
    RC_ASSERT(found.sigma_n.value == now.sigma_n);
    RC_ASSERT(found.tau.value == now.tau);
    RC_ASSERT(std::abs(found.sigma_n.slope - (high.sigma_n - low.sigma_n) / (2 * step)) < 1e5);
    RC_ASSERT(std::abs(found.tau.slope - (high.tau - low.tau) / (2 * step)) < 1e5);
    RC_ASSERT(std::abs(state.slip.slope - (after.slip - before.slip) / (2 * step)) < 1e-4);
    RC_ASSERT(std::abs(state.dilation.slope - (after.dilation - before.dilation) / (2 * step)) < 1e-6);
    for (int i = 0; i < 3; ++i) {
        const double slope = (after.memory[i] - before.memory[i]) / (2 * step);
        RC_ASSERT(state.memory[i].value == here.memory[i]);
        RC_ASSERT(std::abs(state.memory[i].slope - slope) <
                  0.1 * std::abs(here.memory[i]) + 1e-6 * std::abs(slope) + 1e-6);
    }
}

// A joint after a few displacements, some of which open it, and a last shear.
struct Sheared {
    Law law;
    double p;        // initial pressure [Pa]
    State state;     // after the last shear
    double u_n, u_s; // of the last shear [m]
    Response now;

    // The response to another displacement from here [m]; updates `from`.
    Response moved(State& from, double opened, double slid) const
    {
        return respond(law, from, -p, 0, u_n + opened, u_s + slid);
    }
    double sense() const { return now.tau < 0 ? -1 : 1; }
};

Sheared any_sheared()
{
    Law law = some_law(any_in(0, places()));
    for (Coulomb* const one :
         {std::get_if<Coulomb>(&law), static_cast<Coulomb*>(std::get_if<ResidualStrength>(&law))})
        if (one && *rc::gen::arbitrary<bool>())
            one->dilation_until = 7.77e-3;
    Sheared joint{law, std::pow(10, any_in(3000, 8700) / 1000.0), {}, 0, 0, {}};
    const auto share = [] { return any_in(-1000, 1001) / 1000.0; };
    const double closed = joint.p / slopes(law, {}, -joint.p).k_n, sheared = joint.p / k_s(law);
    for (Index left = any_in(0, 4); left >= 0; --left) {
        joint.u_n = closed * (left > 0 && any_in(0, 4) == 0 ? 2 : 0.3 * share());
        joint.u_s += (left > 0 ? 3 : 10) * sheared * share();
        joint.now = respond(law, joint.state, -joint.p, 0, joint.u_n, joint.u_s);
    }
    return joint;
}

// The slopes of a law are those of its response. Its springs: closing, and shear back, of a joint at its strength.
RC_GTEST_PROP(law, its_springs_are_those_of_its_response, ())
{
    const Sheared joint = any_sheared();
    RC_PRE(joint.now.status == ContactStatus::slipping);
    const Slopes slopes = joint::slopes(joint.law, joint.state, joint.now.sigma_n);
    const double closing = 1e-6 * -joint.now.sigma_n / slopes.k_n,
                 back = (*rc::gen::arbitrary<bool>() ? 3e-5 : 3e-4) * std::abs(joint.now.tau) / slopes.k_s;
    State closed = joint.state, unloaded = joint.state;
    const double pressed = joint.now.sigma_n - joint.moved(closed, -closing, 0).sigma_n;
    RC_ASSERT(std::abs(pressed / closing - slopes.k_n) < 1e-4 * slopes.k_n);
    const Response after = joint.moved(unloaded, 0, -joint.sense() * back);
    RC_ASSERT(std::abs(joint.sense() * (joint.now.tau - after.tau) / back - slopes.k_s) < 1e-3 * slopes.k_s);
    RC_ASSERT(std::abs(after.sigma_n - joint.now.sigma_n) < 1e-9 * joint.p);
    RC_ASSERT(unloaded.dilation == joint.state.dilation);
}

// The strength: where a joint at its strength opens a little, its shear traction falls with the pressure by tan(phi),
// and is on the straight line that the slopes say.
RC_GTEST_PROP(law, its_friction_is_that_of_its_response, ())
{
    const Sheared joint = any_sheared();
    RC_PRE(joint.now.status == ContactStatus::slipping);
    const double opens =
        2e-3 * -joint.now.sigma_n / joint::slopes(joint.law, joint.state, joint.now.sigma_n).k_n;
    std::array<State, 3> state;
    std::array<Response, 3> at{};
    std::array<Slopes, 3> slopes{};
    for (int i = 0; i < 3; ++i) {
        state[i] = joint.state;
        at[i] = joint.moved(state[i], opens * (1 + 0.5 * i), 0);
        slopes[i] = joint::slopes(joint.law, state[i], at[i].sigma_n);
    }
    RC_PRE(std::abs(slopes[0].tan_phi - slopes[2].tan_phi) < 0.01 * slopes[1].tan_phi); // no kink between
    const double line = slopes[1].cohesion - at[1].sigma_n * slopes[1].tan_phi;
    RC_ASSERT(std::abs(std::abs(at[1].tau) - line) < 1e-6 * line);
    // The slip in it may lessen the friction.
    RC_PRE(joint::slopes(joint.law, state[0], at[1].sigma_n).tan_phi ==
           joint::slopes(joint.law, state[2], at[1].sigma_n).tan_phi);
    const double falls = std::abs(at[0].tau) - std::abs(at[2].tau), by = at[2].sigma_n - at[0].sigma_n;
    RC_ASSERT(by > 0);
    RC_ASSERT(std::abs(falls / by - slopes[1].tan_phi) < 1e-4 * slopes[1].tan_phi);
}

// Before it has slipped, too: it is elastic below that strength, and slips above. (A continuously yielding joint slips
// from the first shear on, and never reaches it.)
RC_GTEST_PROP(law, its_first_slip_is_at_the_strength_of_its_slopes, ())
{
    const Law law = some_law(any_in(0, places()));
    const double p = std::pow(10, any_in(3000, 8700) / 1000.0);
    const Slopes slopes = joint::slopes(law, {}, -p);
    const double strength = slopes.cohesion + p * slopes.tan_phi;
    State below, above;
    const Response sticks = respond(law, below, -p, 0, 0, 0.999 * strength / slopes.k_s),
                   slips = respond(law, above, -p, 0, 0, 1.001 * strength / slopes.k_s);
    RC_ASSERT(sticks.status == ContactStatus::stuck);
    if (yields_from_the_first_shear(law)) { // it slips below its strength
        RC_ASSERT(slips.tau < strength);
        return;
    }
    RC_ASSERT(std::abs(sticks.tau - 0.999 * strength) < 1e-9 * strength);
    RC_ASSERT(slips.status == ContactStatus::slipping);
}

// Dilation: a joint at its strength opens by tan(psi) times the slip, and without slip not at all.
RC_GTEST_PROP(law, its_dilation_is_that_of_its_response, ())
{
    const Sheared joint = any_sheared();
    RC_PRE(joint.now.status == ContactStatus::slipping);
    constexpr double by = 1e-8;
    State middle = joint.state, end = joint.state;
    const Response half = joint.moved(middle, 0, joint.sense() * by);
    joint.moved(end, 0, joint.sense() * 2 * by);
    const double tan_psi = joint::slopes(joint.law, middle, half.sigma_n).tan_psi;
    const double before = joint::slopes(joint.law, joint.state, joint.now.sigma_n).tan_psi;
    RC_PRE(before <= 1.01 * tan_psi); // no kink between
    const double slip = std::abs(end.slip - joint.state.slip);
    RC_ASSERT(slip > 0);
    RC_ASSERT(std::abs((end.dilation - joint.state.dilation) / slip - tan_psi) < 1e-4 * tan_psi + 1e-9);
}

// The tangents that the implicit engine makes of the slopes are those of the response, where it sticks and where it
// slips. Of a law that remembers it takes the derivatives of the response instead.
RC_GTEST_PROP(law, tangents_of_its_slopes_are_those_of_its_response, ())
{
    const Law law = some_law(*rc::gen::inRange<Index>(0, places()));
    const double u_s = 3e-3 * (*rc::gen::inRange(-1000, 1001)) / 1000.0;
    State state;
    const Response now = respond(law, state, -1e6, 0, 0, u_s);
    RC_PRE(now.status != ContactStatus::open);
    RC_PRE(!remembers(law));
    const Slopes slopes = joint::slopes(law, state, now.sigma_n);
    const auto slope = [&](double by_n, double by_s) {
        StateOf<Dual> start;
        return with_derivatives(law, Dual(k_n(law)), Dual(k_s(law)), [&](const auto& one) {
            return joint::respond(one, start, Dual(-1e6), Dual(0), Dual(0, by_n), Dual(u_s, by_s));
        });
    };
    const double sense = u_s < 0 ? -1 : 1;
    if (now.status == ContactStatus::stuck) {
        RC_ASSERT(std::abs(slope(1, 0).sigma_n.slope - slopes.k_n) < 1e-6 * slopes.k_n);
        RC_ASSERT(std::abs(slope(0, 1).tau.slope - slopes.k_s) < 1e-6 * slopes.k_s);
    } else {
        const double k =
            slopes.k_n * slopes.k_s / (slopes.k_s + slopes.k_n * slopes.tan_phi * slopes.tan_psi);
        RC_ASSERT(std::abs(slope(1, 0).sigma_n.slope - k) < 1e-6 * k);
        RC_ASSERT(std::abs(slope(1, 0).tau.slope + sense * k * slopes.tan_phi) < 1e-6 * k);
        RC_ASSERT(std::abs(slope(0, 1).sigma_n.slope + sense * k * slopes.tan_psi) < 1e-6 * k);
    }
}

// Along an overlap: the integral of the response at points, of which the exact integrals of Coulomb's law are one
// case. Five points are exact for it; Barton and Bandis's curve is near enough a polynomial where it does not start.
RC_GTEST_PROP(law, along_an_overlap_it_is_the_sum_over_points, ())
{
    const Law law = some_law(*rc::gen::inRange<Index>(0, places()));
    const std::array<double, 2> closing{1e-3 * (*rc::gen::inRange(100, 1001)) / 1000,
                                        1e-3 * (*rc::gen::inRange(100, 1001)) / 1000};
    const double length = 2.5;
    const bool is_broken = *rc::gen::arbitrary<bool>();
    State start;
    start.is_broken = is_broken;
    const AlongOverlap exact = along_overlap(law, start, closing, length);
    constexpr int parts = 2000;
    double force = 0, on_second = 0, strength = 0, energy = 0;
    for (int i = 0; i < parts; ++i) {
        const double at = (i + 0.5) / parts, v = closing[0] + at * (closing[1] - closing[0]);
        State state = start;
        // Far sheared, so that it slips, after its bonds are gone if it weakens.
        if (weakens_by_slip(law))
            state.is_broken = true;
        const Response r = respond(law, state, 0, 0, -v, 0);
        State sheared = start;
        sheared.is_broken = is_broken || weakens_by_slip(law);
        const double limit = dilates(law) || remembers(law)
                                 ? joint::slopes(law, sheared, r.sigma_n).cohesion -
                                       r.sigma_n * joint::slopes(law, sheared, r.sigma_n).tan_phi
                                 : std::abs(respond(law, sheared, 0, 0, -v, 1).tau);
        force -= r.sigma_n * length / parts;
        on_second -= at * r.sigma_n * length / parts;
        energy += stored(law, r.sigma_n, 0) * length / parts;
        strength += limit * length / parts;
    }
    RC_ASSERT(std::abs(exact.force - force) < 1e-5 * force);
    // Stiffness in the middle, and where the overlap is most closed.
    const auto slope_at = [&](double v) {
        State below = start, above = start;
        const double h = 1e-4 * v;
        return (respond(law, below, 0, 0, h - v, 0).sigma_n - respond(law, above, 0, 0, -h - v, 0).sigma_n) /
               (2 * h);
    };
    for (const auto& [stiffness, v] : {std::pair(exact.stiffness, (closing[0] + closing[1]) / 2),
                                       {exact.stiffest, std::max(closing[0], closing[1])}})
        RC_ASSERT(std::abs(stiffness - slope_at(v)) < 1e-4 * stiffness);
    RC_ASSERT(std::abs(exact.force_on_ends[1] - on_second) < 1e-5 * force);
    RC_ASSERT(std::abs(exact.force_on_ends[0] + exact.force_on_ends[1] - exact.force) < 1e-12 * force);
    RC_ASSERT(std::abs(exact.stored - energy) < 1e-5 * energy);
    RC_ASSERT(std::abs(exact.strength[is_broken || weakens_by_slip(law) ? 1 : 0] - strength) <
              1e-3 * strength);
}

// At large displacements the shear traction goes step by step with the strength of the overlap: under a constant
// pressure as the response at a point, which may open by what it dilates, and so does what the joint remembers.
RC_GTEST_PROP(law, its_shear_along_an_overlap_is_that_of_its_response, ())
{
    const Law law = some_law(any_in(0, places()));
    const double p = 1e6, length = 2.5, closing = -opening(law, -p);
    State at_point, along;
    double u = 0, tau = 0;
    for (int i = 0; i < 6; ++i) {
        const double by = 3e-3 * any_in(-1000, 1001) / 1000.0;
        u += by;
        State opened;
        Response now{};
        for (int k = 0; k < 30; ++k) {
            const double rises = opened.dilation;
            opened = at_point;
            now = respond(law, opened, -p, 0, rises, u);
        }
        at_point = opened;
        RC_ASSERT(std::abs(now.sigma_n + p) < 1e-6 * p);
        const AlongOverlap overlap = along_overlap(law, along, {closing, closing}, length);
        RC_ASSERT(std::abs(overlap.force - p * length) < 1e-6 * p * length);
        tau = shear(law, along, tau, by, overlap.strength[at_point.is_broken ? 1 : 0] / length);
        RC_ASSERT(std::abs(tau - now.tau) < 1e-6 * p);
        for (int m = 0; m < 3; ++m)
            RC_ASSERT(std::abs(along.memory[m] - at_point.memory[m]) <= 1e-6 * std::abs(at_point.memory[m]));
    }
}

// A row of a table for each parameter; what is a law's own is in its table, and in no other's.
TEST(laws, have_tables_that_agree)
{
    std::set<std::string_view> own, law_names;
    for (const LawInfo& law : laws()) {
        EXPECT_TRUE(law_names.insert(law.name).second) << law.name << ": has the law an info() of its own?";
        EXPECT_TRUE(law.check) << law.name;
        std::set<std::string_view> names, keys;
        for (const Parameter& parameter : law.parameters) {
            EXPECT_TRUE(names.insert(parameter.name).second) << law.name << " " << parameter.name;
            EXPECT_TRUE(keys.insert(parameter.key).second) << law.name << " " << parameter.key;
            EXPECT_FALSE(parameter.meaning.empty());
            EXPECT_LT(parameter.range.least, parameter.range.most);
        }
        for (const std::string_view name : law.own) {
            EXPECT_TRUE(names.contains(name)) << law.name << " " << name;
            EXPECT_TRUE(own.insert(name).second) << law.name << " " << name;
            const auto found = std::ranges::find(law.parameters, name, &Parameter::name);
            ASSERT_NE(found, law.parameters.end());
            const WithBridges rule = found->with_bridges;
            EXPECT_TRUE(rule != WithBridges::mean && rule != WithBridges::spring)
                << law.name << " " << name << ": joint/equivalent.cpp has no mean of a law's own parameter";
            EXPECT_TRUE(rule != WithBridges::weaker || found->is_angle()) << law.name << " " << name;
        }
    }
    EXPECT_TRUE(laws()[0].own.empty()); // a material without any has the first law
}

} // namespace law_test
