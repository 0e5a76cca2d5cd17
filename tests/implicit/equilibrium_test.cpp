// Equilibria with a closed form, equilibria by dynamic relaxation to compare with, and what happens where
// there is none.

#include "../mechanics/sections.hpp"

#include "implicit/equilibrium.hpp"
#include "mechanics/excavation.hpp"
#include "relaxation/relax.hpp"

#include <gtest/gtest.h>

#include <random>

namespace equilibrium_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;
using mechanics::Assembly;
using mechanics::Convergence;

namespace
{

const double deg = std::numbers::pi / 180;

Equilibrium settings(double tolerance = 1e-7)
{
    return {.tolerance = tolerance, .unloading_increments = 1, .most_steps = 400000};
}

Convergence found(implicit::Solver& solver, Assembly& assembly, const Equilibrium& how = settings())
{
    const auto convergence = solver.equilibrate(assembly, how);
    EXPECT_TRUE(convergence) << solver.reason();
    return convergence.value_or(Convergence{});
}

Convergence found(Assembly& assembly, const Equilibrium& how = settings())
{
    implicit::Solver solver;
    return found(solver, assembly, how);
}

std::map<ContactStatus, int> statuses(const Assembly& assembly)
{
    std::map<ContactStatus, int> numbers;
    for (const ContactStatus status : assembly.contacts.status)
        ++numbers[status];
    return numbers;
}

double largest_difference(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b)
{
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, (a[i] - b[i]).norm());
    return largest;
}

double largest(const std::vector<Vector2d>& a)
{
    return largest_difference(a, std::vector<Vector2d>(a.size(), Vector2d::Zero()));
}

// All that equilibria change.
void expect_unchanged(const Assembly& a, const Assembly& b)
{
    EXPECT_EQ(a.displacement, b.displacement);
    EXPECT_EQ(a.load, b.load);
    EXPECT_EQ(a.applied, b.applied);
    EXPECT_EQ(a.contacts.traction, b.contacts.traction);
    EXPECT_EQ(a.contacts.relative_displacement, b.contacts.relative_displacement);
    EXPECT_EQ(a.contacts.offset, b.contacts.offset);
    EXPECT_EQ(a.contacts.initial_traction, b.contacts.initial_traction);
    EXPECT_EQ(a.contacts.status, b.contacts.status);
    EXPECT_EQ(a.zones.stress, b.zones.stress);
    for (std::size_t c = 0; c < a.contacts.state.size(); ++c) {
        EXPECT_EQ(a.contacts.state[c].slip, b.contacts.state[c].slip) << c;
        EXPECT_EQ(a.contacts.state[c].is_broken, b.contacts.state[c].is_broken) << c;
        EXPECT_EQ(std::get<joint::Coulomb>(a.contacts.law[c]).k_n,
                  std::get<joint::Coulomb>(b.contacts.law[c]).k_n)
            << c;
    }
}

// 20 m x 10 m with three joints, held below, pushed at the left side above 5 m and at the top by `traction`.
Section plate(const Vector2d& side, const Vector2d& top, std::optional<double> friction_angle,
              double cohesion, double tensile_strength, double tan_psi = 0)
{
    Scene scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
    scene.zone_size = 1.5;
    scene.gravity = 9.81;
    scene.boundaries = {{.from = {0, 0}, .to = {20, 0}, .fix_x = true, .fix_y = true},
                        {.from = {0, 5}, .to = {0, 10}, .traction = side},
                        {.from = {0, 10}, .to = {20, 10}, .traction = top}};
    Joints joints;
    add_joint(joints, {-1, 3}, {21, 5});
    add_joint(joints, {6, -1}, {9, 11});
    add_joint(joints, {15, -1}, {13, 11});
    Section s = assembled(std::move(scene), joints, 5e9, 2e9, friction_angle);
    if (friction_angle)
        for (joint::Coulomb& law : coulomb(s.assembly.contacts.law)) {
            law.cohesion = cohesion;
            law.tensile_strength = tensile_strength;
            law.tan_psi = tan_psi;
        }
    mechanics::Loading(s.scene, s.mesh).apply(s.assembly, 0);
    return s;
}

// Two blocks of 10 m x 5 m, one on the other; the upper hangs or stands.
struct TwoBlocks {
    Section section;

    TwoBlocks(bool held_below, const LoadHistory& load_history = {}, const Vector2d& moved = {0, 0},
              double friction = 0.6)
    {
        Scene scene = test::section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.05);
        scene.zone_size = 2;
        scene.gravity = 9.81;
        const bool moves = !moved.isZero();
        if (held_below)
            scene.boundaries.push_back({.from = {0, 0}, .to = {10, 0}, .fix_x = true, .fix_y = true});
        if (moves || !held_below)
            scene.boundaries.push_back({.from = {0, 10}, .to = {10, 10}, .fix_x = true, .fix_y = true});
        if (moves) {
            scene.boundaries.back().displacement = moved;
            scene.boundaries.back().load_history = load_history;
        }
        Joints joints;
        add_joint(joints, {-1, 5}, {11, 5});
        section = assembled(std::move(scene), joints, 1e9, 1e9, friction);
    }
    Assembly& assembly() { return section.assembly; }
    void set_strength(double cohesion, double tensile_strength)
    {
        for (joint::Coulomb& law : coulomb(section.assembly.contacts.law)) {
            law.cohesion = cohesion;
            law.tensile_strength = tensile_strength;
        }
    }
    // Forces over the whole joint {normal, shear} [N/m].
    Vector2d force()
    {
        Vector2d sum(0, 0);
        for (std::size_t c = 0; c < assembly().contacts.length.size(); ++c)
            sum += assembly().contacts.length[c] * assembly().contacts.traction[c];
        return sum;
    }
    int broken()
    {
        int n = 0;
        for (const joint::State& state : assembly().contacts.state)
            n += state.is_broken ? 1 : 0;
        return n;
    }
};

constexpr double block_weight = 2700 * 9.81 * 50; // [N/m]

} // namespace

// The same plate at rest by both engines. Where joints slip what remains depends on the way: each engine goes
// its own to the next part of the load, and the smaller the parts the less that matters.
class both_engines : public testing::TestWithParam<std::tuple<Section, ContactStatus, double>>
{
};

TEST_P(both_engines, agree)
{
    const auto& [section, status, allowed] = GetParam();
    // Largest difference of displacements, and of tractions, over the largest of them.
    const auto difference = [&section = section, &status = status](int parts) {
        Assembly by_factor = section.assembly, by_relaxation = section.assembly;
        implicit::Solver solver;
        for (int part = 1; part <= parts; ++part) { // first the weight, then the tractions
            for (Assembly* assembly : {&by_factor, &by_relaxation})
                for (std::size_t g = 0; g < section.assembly.load.size(); ++g) {
                    assembly->load[g] = section.assembly.load[g] * std::min(1.0, 2.0 * part / parts);
                    assembly->applied[g] =
                        section.assembly.applied[g] * std::max(0.0, 2.0 * part / parts - 1);
                }
            found(solver, by_factor);
            relaxation::relax(by_relaxation, settings());
        }
        EXPECT_GT(statuses(by_factor)[status], 3);
        return std::pair(largest_difference(by_factor.displacement, by_relaxation.displacement) /
                             largest(by_relaxation.displacement),
                         largest_difference(by_factor.contacts.traction, by_relaxation.contacts.traction) /
                             largest(by_relaxation.contacts.traction));
    };
    const auto [moves, tractions] = difference(10);
    EXPECT_LT(moves, allowed);
    EXPECT_LT(tractions, allowed);
    const auto [moves_of_40, tractions_of_40] = difference(40);
    EXPECT_LT(moves_of_40, std::max(1e-6, moves / 3));
    EXPECT_LT(tractions_of_40, std::max(1e-6, tractions / 3));
}

INSTANTIATE_TEST_SUITE_P(
    plates, both_engines,
    testing::Values(std::tuple(plate({-1e5, 0}, {0, 0}, {}, 0, 0), ContactStatus::stuck, 1e-6),
                    std::tuple(plate({1e5, 0}, {0, -1e5}, 20 * deg, 0, 0), ContactStatus::slipping, 1e-2),
                    std::tuple(plate({1e5, 0}, {0, -1e5}, 20 * deg, 0, 0, 0.15), ContactStatus::slipping,
                               1e-2),
                    std::tuple(plate({-4e4, 0}, {0, 0}, 30 * deg, 0, 0), ContactStatus::open, 1e-2),
                    std::tuple(plate({3e5, 0}, {0, 0}, 20 * deg, 4e4, 1e12), ContactStatus::slipping, 1e-6)));

// W sin(b) along the joint, W cos(b) into it; its middle slides by tau / K_s.
TEST(implicit_equilibrium, a_block_on_an_incline_rests_below_the_friction_angle)
{
    for (const double dip : {25 * deg, 29.9 * deg}) {
        Section s = incline(dip, 30 * deg);
        const Convergence convergence = found(s.assembly);
        EXPECT_TRUE(convergence.is_implicit);
        EXPECT_GT(convergence.steps, 0);
        EXPECT_LE(convergence.unbalanced_force_ratio, 1e-7);
        EXPECT_LE(convergence.contact_force_change, 1e-7);
        Vector2d force(0, 0);
        for (std::size_t c = 0; c < s.mesh.contact_edge.size(); ++c)
            force += s.assembly.contacts.length[c] * s.assembly.contacts.traction[c];
        const double weight = 2700 * 9.81 * 10;
        EXPECT_NEAR(std::abs(force.y()), weight * std::sin(dip), 1e-6 * weight);
        EXPECT_NEAR(force.x(), -weight * std::cos(dip), 1e-6 * weight);
    }
}

// With a loose tolerance some displacement remains, and the convergence report says how much.
TEST(implicit_equilibrium, remaining_displacement)
{
    const Section loaded = plate({1e5, 0}, {0, -1e5}, 20 * deg, 0, 0);
    Section s = loaded, tight = loaded;
    Equilibrium loose = settings();
    loose.tolerance = 1e-2;
    implicit::Solver solver;
    const auto convergence = solver.equilibrate(s.assembly, loose);
    ASSERT_TRUE(convergence);
    found(tight.assembly);
    const double left = mechanics::largest_move(s.assembly.displacement, tight.assembly.displacement).first;
    EXPECT_GT(left, 1e-9);
    EXPECT_GT(convergence->remaining_displacement, left / 2);
    EXPECT_LT(convergence->remaining_displacement, 2 * left);
}

TEST(implicit_equilibrium, a_block_on_an_incline_above_the_friction_angle_has_none)
{
    for (const double dip : {30.1 * deg, 35 * deg, 60 * deg}) {
        Section s = incline(dip, 30 * deg);
        find_forces(s.assembly);
        const Assembly before = s.assembly;
        implicit::Solver solver;
        EXPECT_FALSE(solver.equilibrate(s.assembly, settings()));
        EXPECT_NE(solver.reason(), "");
        expect_unchanged(before, s.assembly);
        // The search has left nothing behind in the engine either: with friction it rests.
        for (joint::Coulomb& law : coulomb(s.assembly.contacts.law))
            law.tan_phi = 2;
        found(solver, s.assembly);
    }
}

TEST(implicit_equilibrium, a_block_held_by_nothing_has_none)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 3;
    scene.gravity = 9.81;
    Section s = assembled(std::move(scene), {}, 1e9, 1e9);
    find_forces(s.assembly);
    const Assembly before = s.assembly;
    implicit::Solver solver;
    testing::internal::CaptureStdout();
    EXPECT_FALSE(solver.equilibrate(s.assembly, settings()));
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_NE(solver.reason(), "");
    expect_unchanged(before, s.assembly);
}

TEST(implicit_equilibrium, forces_that_are_no_numbers_are_no_equilibrium)
{
    TwoBlocks blocks(true);
    blocks.assembly().load[3].x() = std::numeric_limits<double>::quiet_NaN();
    implicit::Solver solver;
    EXPECT_FALSE(solver.equilibrate(blocks.assembly(), settings()));
    for (Vector2d& load : blocks.assembly().load)
        load.setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(solver.equilibrate(blocks.assembly(), settings()));
    EXPECT_NE(solver.reason().find("numbers"), std::string::npos);
}

// The gap g of the joint, then the weight over the stiffness.
TEST(implicit_equilibrium, a_block_above_its_joint_falls_onto_it)
{
    for (const double gap : {1e-6, 1e-3, 0.1}) {
        TwoBlocks blocks(true);
        for (Vector2d& traction : blocks.assembly().contacts.initial_traction)
            traction = {1e9 * gap, 0};
        found(blocks.assembly());
        EXPECT_NEAR(blocks.force().x(), -block_weight, 1e-6 * block_weight) << gap;
        EXPECT_NEAR(blocks.force().y(), 0, 1e-6 * block_weight) << gap;
        for (const Vector2d& relative_displacement : blocks.assembly().contacts.relative_displacement) {
            EXPECT_LT(relative_displacement.x(), -gap);
            EXPECT_GT(relative_displacement.x(), -gap - 2 * block_weight / 10 / 1e9);
        }
        EXPECT_EQ(statuses(blocks.assembly())[ContactStatus::open], 0);
    }
}

TEST(implicit_equilibrium, a_block_that_falls_farther_than_a_tenth_of_the_section_is_let_go)
{
    TwoBlocks blocks(true);
    for (Vector2d& traction : blocks.assembly().contacts.initial_traction)
        traction = {1e9 * 2, 0};
    implicit::Solver solver;
    EXPECT_FALSE(solver.equilibrate(blocks.assembly(), settings()));
    EXPECT_NE(solver.reason().find("tenth"), std::string::npos) << solver.reason();
}

// Hung up at its joint, of 133 kPa.
TEST(implicit_equilibrium, a_bond_holds_what_hangs_up_to_its_tensile_strength)
{
    TwoBlocks blocks(false);
    blocks.set_strength(1e6, 1.6e5);
    found(blocks.assembly());
    EXPECT_NEAR(blocks.force().x(), block_weight, 1e-6 * block_weight);
    EXPECT_EQ(blocks.broken(), 0);

    TwoBlocks heavy(false);
    heavy.set_strength(1e6, 1.2e5);
    find_forces(heavy.assembly());
    const Assembly before = heavy.assembly();
    implicit::Solver solver;
    EXPECT_FALSE(solver.equilibrate(heavy.assembly(), settings()));
    EXPECT_EQ(heavy.broken(), 0) << "bonds that broke in vain";
    expect_unchanged(before, heavy.assembly());
}

// Lifted off by 1 mm and put down again, displaced: what is lifted breaks, and then neither hangs nor
// coheres.
TEST(implicit_equilibrium, bonds_that_broke_stay_broken)
{
    const LoadHistory load_history{{{0, 0}, {10, 1}, {20, -0.5}, {30, 0.02}}};
    TwoBlocks blocks(true, load_history, {0, 1e-3});
    blocks.set_strength(1e6, 2e5);
    mechanics::Loading loading(blocks.section.scene, blocks.section.mesh);
    implicit::Solver solver;
    const auto at = [&](double time) {
        loading.apply(blocks.assembly(), time);
        found(solver, blocks.assembly());
    };
    at(0);
    EXPECT_EQ(blocks.broken(), 0);
    at(1); // 0.1 mm: in tension within its strength
    EXPECT_EQ(blocks.broken(), 0);
    EXPECT_GT(blocks.force().x(), 0);
    at(10);
    EXPECT_EQ(blocks.broken(), static_cast<int>(blocks.assembly().contacts.law.size()));
    EXPECT_EQ(blocks.force(), Vector2d(0, 0));
    at(20);
    EXPECT_LT(blocks.force().x(), -1e5 * 10);
    EXPECT_EQ(blocks.broken(), static_cast<int>(blocks.assembly().contacts.law.size()));
    at(30); // in tension within its former strength
    EXPECT_EQ(blocks.force(), Vector2d(0, 0));
}

// Pushed sideways, an unbroken joint coheres; one that has broken before slides at its friction.
TEST(implicit_equilibrium, cohesion_is_lost_with_the_bond)
{
    for (const bool broken : {false, true}) {
        TwoBlocks blocks(true, {{{0, 0}, {1, 1}}}, {5e-3, -2e-4}, 0.3);
        blocks.set_strength(1e7, 1e7);
        for (joint::State& state : blocks.assembly().contacts.state)
            state.is_broken = broken;
        mechanics::Loading loading(blocks.section.scene, blocks.section.mesh);
        loading.apply(blocks.assembly(), 1);
        found(blocks.assembly());
        auto n = statuses(blocks.assembly());
        EXPECT_EQ(n[ContactStatus::slipping] > 0, broken);
        const double cohesion = broken ? 0 : 1e7;
        for (const Vector2d& traction : blocks.assembly().contacts.traction)
            EXPECT_LE(std::abs(traction.y()),
                      cohesion + std::max(0.0, -traction.x()) * std::tan(0.3) * (1 + 1e-6));
    }
}

// Bonds may open and close on the way. What is stuck in the end would be so with its bond, and so it has one.
TEST(implicit_equilibrium, a_bond_that_need_not_break_is_whole_afterwards)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> from_0_to_1(0, 1);
    const auto between = [&](double least, double most) {
        return least + (most - least) * from_0_to_1(random);
    };
    int n_broken = 0, n_found = 0;
    for (int i = 0; i < 100; ++i) { // pushed up: few of them open in vain
        const Vector2d side(between(5e4, 2e5), between(2e4, 1e5)), top(between(5e4, 1e5), between(5e4, 1e5));
        const double cohesion = i % 2 == 0 ? 5e5 : 3e4, tensile_strength = between(1e4, 5e4);
        Section s = plate(side, top, 30 * deg, cohesion, tensile_strength);
        implicit::Solver solver;
        if (!solver.equilibrate(s.assembly, settings()))
            continue;
        ++n_found;
        const joint::Contacts& contacts = s.assembly.contacts;
        for (std::size_t c = 0; c < contacts.state.size(); ++c) {
            n_broken += contacts.state[c].is_broken ? 1 : 0;
            EXPECT_FALSE(contacts.state[c].is_broken && contacts.status[c] == ContactStatus::stuck) << i;
        }
    }
    EXPECT_GT(n_found, 20);
    EXPECT_GT(n_broken, 50);
}

// Joints that weaken at their first slip: in most cases there is an equilibrium, and it keeps to the law.
// Straight from the start of it, every contact that is broken has to be.
TEST(implicit_equilibrium, joints_that_weaken)
{
    std::mt19937 random(12);
    std::uniform_real_distribution<double> from_0_to_1(0, 1);
    const auto between = [&](double least, double most) {
        return least + (most - least) * from_0_to_1(random);
    };
    int n_broken = 0, n_whole = 0, n_found = 0;
    for (int i = 0; i < 60; ++i) {
        const Vector2d side(between(1e5, 8e5), between(-1e5, 1e5)), top(0, between(-3e5, 0));
        Section s = plate(side, top, 30 * deg, 5e4, between(1e4, 5e4), i % 3 == 0 ? 0.1 : 0.0);
        for (joint::Coulomb& law : coulomb(s.assembly.contacts.law)) {
            law.weakens = true;
            law.residual_cohesion = 5e3;
            law.residual_tan_phi = 0.4;
        }
        implicit::Solver solver;
        if (!solver.equilibrate(s.assembly, settings()))
            continue;
        ++n_found;
        const joint::Contacts& contacts = s.assembly.contacts;
        for (std::size_t c = 0; c < contacts.state.size(); ++c) {
            const auto& law = std::get<joint::Coulomb>(contacts.law[c]);
            joint::State state;
            const Vector2d sprung = contacts.relative_displacement[c] - contacts.offset[c];
            const joint::Response r = respond(law, state, contacts.initial_traction[c].x(),
                                              contacts.initial_traction[c].y(), sprung.x(), sprung.y());
            EXPECT_EQ(state.is_broken, contacts.state[c].is_broken) << i << ' ' << c;
            EXPECT_NEAR(r.tau, contacts.traction[c].y(), 1) << i << ' ' << c;
            (state.is_broken ? n_broken : n_whole) += 1;
        }
    }
    EXPECT_GT(n_found, 30);
    EXPECT_GT(n_broken, 100);
    EXPECT_GT(n_whole, 200);
}

TEST(implicit_equilibrium, energy_is_accounted_for)
{
    // A bar pulled at once: half of the work is stored, half would have to be damped.
    {
        Scene scene = section({{0, 0}, {10, 0}, {10, 1}, {0, 1}}, 0.01);
        scene.zone_size = 0.5;
        scene.boundaries = {{.from = {0, 0}, .to = {0, 1}, .fix_x = true},
                            {.from = {10, 0}, .to = {10, 1}, .traction = Vector2d(2e6, 0)},
                            {.from = {0, 0}, .to = {10, 0}, .fix_y = true}};
        Section s = assembled(std::move(scene), {}, 1e9, 1e9);
        mechanics::Loading(s.scene, s.mesh).apply(s.assembly, 0);
        const Convergence convergence = found(s.assembly);
        const double work = 2e6 * 2e6 * 10 * (1 - 0.25 * 0.25) / 3e10;
        EXPECT_NEAR(convergence.work_of_loads, work, 1e-6 * work);
        EXPECT_NEAR(convergence.stored, work / 2, 1e-6 * work);
        EXPECT_EQ(convergence.dissipated, 0);
        EXPECT_NEAR(convergence.damped, work / 2, 1e-6 * work);
    }
    const std::vector<Section> plates{
        plate({-1e5, 0}, {0, 0}, {}, 0, 0), plate({1e5, 0}, {0, -1e5}, 20 * deg, 0, 0),
        plate({-4e4, 0}, {0, 0}, 30 * deg, 0, 0), plate({3e5, 0}, {0, 0}, 20 * deg, 4e4, 1e5)};
    for (Section s : plates) {
        const mechanics::State start = state_of(s.assembly);
        const Convergence convergence = found(s.assembly);
        EXPECT_LE(convergence.created, 1e-12 * std::abs(convergence.work_of_loads));
        EXPECT_GT(implicit::created_energy(s.assembly, start, -2 * convergence.damped), convergence.damped);
        const double size = std::abs(convergence.work_of_loads);
        EXPECT_NEAR(convergence.work_of_loads,
                    convergence.stored + convergence.dissipated + convergence.damped, 1e-12 * size);
        EXPECT_GE(convergence.dissipated, 0);
        EXPECT_GE(convergence.damped, 0);
    }
}

// Dragged over the joint at its friction limit, p tan(phi) each metre it slides.
TEST(implicit_equilibrium, what_slides_dissipates_and_what_opens_does_not)
{
    TwoBlocks blocks(true, {{{0, 0}, {1, 1}}}, {5e-3, -1e-4}, 0.3);
    mechanics::Loading loading(blocks.section.scene, blocks.section.mesh);
    implicit::Solver solver;
    loading.apply(blocks.assembly(), 1);
    found(solver, blocks.assembly());
    for (std::size_t g = 0; g < blocks.assembly().position.size(); ++g)
        if (blocks.assembly().position[g].y() == 10)
            blocks.assembly().displacement[g].x() += 5e-3;
    const double before = blocks.force().y();
    const Convergence convergence = found(solver, blocks.assembly());
    EXPECT_EQ(statuses(blocks.assembly())[ContactStatus::stuck], 0);
    const double exact = std::abs(blocks.force().y()) * 5e-3;
    EXPECT_GT(exact, 100);
    EXPECT_NEAR(blocks.force().y(), before, 0.01 * std::abs(before));
    EXPECT_NEAR(convergence.dissipated, exact, 0.01 * exact);

    TwoBlocks lifted(true, {{{0, 0}, {1, 1}}}, {0, 1e-2});
    mechanics::Loading lifting(lifted.section.scene, lifted.section.mesh);
    lifting.apply(lifted.assembly(), 0);
    found(solver, lifted.assembly());
    lifting.apply(lifted.assembly(), 1);
    const Convergence opening = found(solver, lifted.assembly());
    EXPECT_EQ(statuses(lifted.assembly())[ContactStatus::stuck], 0);
    EXPECT_NEAR(opening.dissipated, 0, 1e-6 * block_weight * 1e-2);
}

TEST(implicit_equilibrium, a_state_in_balance_stays_as_it_is)
{
    Section s = plate({1e5, 0}, {0, -1e5}, 20 * deg, 0, 0);
    implicit::Solver solver;
    found(solver, s.assembly);
    const Assembly before = s.assembly;
    const Convergence convergence = found(solver, s.assembly);
    EXPECT_EQ(convergence.steps, 0);
    EXPECT_EQ(solver.corrections(), 0);
    EXPECT_EQ(convergence.work_of_loads, 0);
    EXPECT_EQ(s.assembly.displacement, before.displacement);
    EXPECT_EQ(s.assembly.contacts.status, before.contacts.status);
    EXPECT_LT(largest_difference(s.assembly.contacts.traction, before.contacts.traction), 1e-6); // of 1e5
}

TEST(implicit_equilibrium, a_guess_costs_or_saves_time_only)
{
    for (const double friction : {20., 60.}) {
        const Section s = plate({1e5, 0}, {0, -1e5}, friction * deg, 0, 0);
        Assembly without = s.assembly;
        found(without);
        std::vector<Vector2d> good = without.displacement, none(good.size(), Vector2d::Zero()),
                              bad(good.size(), {1, -2});
        for (std::size_t g = 0; g < good.size(); ++g)
            good[g] = 0.95 * good[g] - s.assembly.displacement[g];
        for (const auto& guess : {good, none, bad}) {
            Assembly with = s.assembly;
            implicit::Solver solver;
            ASSERT_TRUE(solver.equilibrate(with, settings(), guess)) << solver.reason();
            EXPECT_LT(largest_difference(with.displacement, without.displacement),
                      1e-4 * largest(without.displacement));
        }
    }
}

TEST(implicit_equilibrium, one_factor_serves_until_something_changes)
{
    Section s = plate({1e5, 0}, {0, 0}, {}, 0, 0);
    implicit::Solver solver;
    found(solver, s.assembly);
    EXPECT_EQ(solver.factorisations(), 1);
    EXPECT_GT(solver.solves(), 0);
    for (Vector2d& applied : s.assembly.applied)
        applied *= -0.5;
    const Convergence again = found(solver, s.assembly);
    EXPECT_GT(again.steps, 0);
    EXPECT_EQ(solver.factorisations(), 0);
    for (joint::Coulomb& law : coulomb(s.assembly.contacts.law)) // as in a creep step
        law.k_s *= 0.98;
    EXPECT_GT(found(solver, s.assembly).steps, 0);
    EXPECT_EQ(solver.factorisations(), 0);
}

// After a stage, and with ties that end, the same engine finds what a new one finds.
TEST(implicit_equilibrium, follows_excavation_and_ties)
{
    Section s = plate({0, 0}, {0, 0}, 35 * deg, 0, 0);
    Scene scene = s.scene;
    scene.stages = {{"one", 1, {{{15, 6}, {21, 6}, {21, 11}, {15, 11}}}},
                    {"two", 2, {{{-1, 7}, {5, 7}, {5, 11}, {-1, 11}}}}};
    s = assembled(std::move(scene), s.network.joints, 5e9, 2e9, 35 * deg);
    s.assembly.ties.push_back({s.mesh.contact_gridpoint[s.mesh.contact_gridpoint.size() / 2], 1});
    mechanics::part_ties(s.assembly, -1);
    const mechanics::Loading loading(s.scene, s.mesh);
    implicit::Solver solver;
    found(solver, s.assembly);
    for (const Index stage : {0, 1}) {
        mechanics::excavate(s.assembly, s.network.blocks, s.mesh, loading, stage);
        EXPECT_EQ(s.assembly.tied.empty(), stage == 1);
        Assembly with_new = s.assembly;
        const Convergence convergence = found(solver, s.assembly);
        EXPECT_GT(convergence.steps, 0);
        EXPECT_GT(solver.factorisations(), 0);
        found(with_new);
        EXPECT_LT(largest_difference(s.assembly.displacement, with_new.displacement),
                  1e-5 * largest(with_new.displacement));
        EXPECT_LT(balance_of(s.assembly).ratio(), 1.01e-7);
    }
}

} // namespace equilibrium_test
