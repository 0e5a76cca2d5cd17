// Rock that moves, against closed forms. Steps of time are those of the central difference method, whose own
// closed forms are known: a parabola is exact, and a spring of frequency w swings by the angle theta in a step
// of dt, with 2 sin(theta / 2) = w dt.

#include "../mechanics/sections.hpp"

#include "large_displacements/dynamics.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace dynamics_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using large_displacements::Dynamics;
using large_displacements::Settings;

namespace
{

constexpr double density = 2700, k_n = 1e8, k_s = 4e7; // as in the sections
const joint::Law found = joint::Coulomb{k_n, k_s, 0, 0.5, 0};

enum Kind { rigid, deformable };

// A section that moves, free all round unless the scene holds it.
struct Moving {
    Section section;
    Dynamics dynamics;

    Moving(Section of, Kind kind, const Settings& settings = {})
        : section(std::move(of)),
          dynamics(section.assembly, section.mesh, std::vector<Index>(section.mesh.contact_edge.size(), 0),
                   std::vector<char>(section.mesh.zone_gridpoint.size(), kind == rigid), found, settings)
    {
    }
    mechanics::Assembly& rock() { return section.assembly; }
    // Where gridpoints are [m].
    std::vector<Vector2d> places()
    {
        dynamics.put_back();
        std::vector<Vector2d> place = rock().position;
        for (std::size_t g = 0; g < place.size(); ++g)
            place[g] += rock().displacement[g];
        return place;
    }
    std::vector<Vector2d> displacements()
    {
        dynamics.put_back();
        return rock().displacement;
    }
    // Deforms the section as it is given by F, about its middle, and begins there from rest.
    void deform(const Matrix2d& gradient)
    {
        DynamicsState state;
        dynamics.transfer(Transfer(Transfer::Way::keep), state);
        for (std::size_t g = 0; g < state.place.size(); ++g)
            state.place[g] = gradient * state.origin[g];
        dynamics.transfer(Transfer(Transfer::Way::restore), state);
        dynamics.start();
    }
};

// One block, 2 m x 1 m.
Section block(double gravity = 0)
{
    Scene scene = test::section({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0.05);
    scene.zone_size = 0.4;
    scene.gravity = gravity;
    return assembled(std::move(scene), {}, k_n, k_s);
}

// A block of 2 m x 1 m on a joint, on a block that is held or free.
Section stack(double gravity, std::optional<double> friction_angle = {}, double normal_stiffness = k_n,
              double shear_stiffness = k_s, bool is_held = true, bool yields = false)
{
    Scene scene = test::section({{0, -1}, {2, -1}, {2, 1}, {0, 1}}, 0.05);
    scene.zone_size = 0.5;
    scene.gravity = gravity;
    if (yields) {
        scene.rocks[0].law = RockLaw::mohr_coulomb;
        scene.rocks[0].strength = RockStrength{1e9, 0.5, 1e9};
    }
    if (is_held)
        scene.boundaries = {{.from = {0, -1}, .to = {2, -1}, .fix_x = true, .fix_y = true}};
    Joints joints;
    add_joint(joints, {0, 0}, {2, 0});
    return assembled(std::move(scene), joints, normal_stiffness, shear_stiffness, friction_angle);
}

// Ties the two gridpoints at a place on the joint between two blocks.
Section tied(Section section, const Vector2d& at)
{
    std::vector<Index> there;
    for (std::size_t g = 0; g < section.mesh.gridpoint.size(); ++g)
        if ((section.mesh.gridpoint[g] - at).norm() < 1e-9)
            there.push_back(static_cast<Index>(g));
    EXPECT_EQ(there.size(), 2u);
    section.assembly.ties.push_back({{there.at(0), there.at(1)}, 1});
    part_ties(section.assembly, 0);
    return section;
}

double cross(const Vector2d& a, const Vector2d& b)
{
    return a.x() * b.y() - a.y() * b.x();
}

// Angular momentum of lumped masses about the origin, by the way from one place to the next [kg m/s].
double angular_momentum(const mechanics::Assembly& rock, const std::vector<Vector2d>& from,
                        const std::vector<Vector2d>& to, double dt)
{
    const std::vector<double> mass = lumped_masses(rock);
    double sum = 0;
    for (std::size_t g = 0; g < mass.size(); ++g)
        sum += mass[g] * cross(from[g], to[g] - from[g]) / dt;
    return sum;
}

// A couple on the block [N]: tractions along its outline that all turn it the same way round.
void apply_couple(mechanics::Assembly& rock, double moment)
{
    std::vector<Vector2d> force;
    double sum = 0;
    for (const Vector2d& p : rock.position) {
        const Vector2d arm = p - Vector2d(1, 0.5);
        force.emplace_back(-arm.y(), arm.x());
        sum += arm.squaredNorm();
    }
    Vector2d mean(0, 0);
    for (const Vector2d& f : force)
        mean += f / static_cast<double>(force.size());
    double turning = 0;
    for (std::size_t g = 0; g < force.size(); ++g)
        turning += cross(rock.position[g], force[g] - mean);
    for (std::size_t g = 0; g < force.size(); ++g)
        rock.load[g] = moment / turning * (force[g] - mean);
}

// Kinetic energy is that of the product of two velocities, half a step before and after. From rest it lacks
// what the first half step gives [J/m].
double first_step(double mass, double acceleration, double dt)
{
    return mass * acceleration * acceleration * dt * dt / 8;
}

std::string bytes(const DynamicsState& state)
{
    std::string all;
    const auto add = [&](const auto& values) {
        all.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
    };
    add(state.origin), add(state.place), add(state.inverse), add(state.area), add(state.strain);
    add(state.face), add(state.pair), add(state.law), add(state.first_lead), add(state.second_lead);
    add(state.dilation), add(state.tau), add(state.is_known), add(state.is_new), add(state.is_closed);
    add(state.is_broken), add(state.normal), add(state.length), add(state.pressed_in), add(state.sheared_in);
    add(std::vector<double>{state.fastest, state.unbalanced_force_ratio, state.largest_mean_force});
    return all;
}

} // namespace

// y = -g t^2 / 2, with all of the work in the kinetic energy. One block, and two that are tied: each mass counts once.
TEST(dynamics, free_fall_is_a_parabola)
{
    const double gravity = 9.81;
    for (const auto& [kind, area] : {std::pair(rigid, 2.0), std::pair(deformable, 2.0), std::pair(rigid, 4.0),
                                     std::pair(deformable, 4.0)}) {
        Moving falling(area == 2 ? block(gravity) : tied(stack(gravity, {}, k_n, k_s, false), {0, 0}), kind);
        Dynamics& dynamics = falling.dynamics;
        for (int n = 1; n <= 400 && dynamics.time() < 0.5; ++n) {
            dynamics.step();
            EXPECT_NEAR(dynamics.time(), n * dynamics.dt(), 1e-12);
            const double fall = -gravity * dynamics.time() * dynamics.time() / 2;
            for (const Vector2d& u : falling.displacements()) {
                ASSERT_NEAR(u.y(), fall, 1e-12) << kind << " step " << n;
                ASSERT_NEAR(u.x(), 0, 1e-12) << kind << " step " << n;
            }
            const large_displacements::Energy energy = dynamics.energy();
            const double work = -density * area * gravity * fall;
            EXPECT_NEAR(energy.work, work, 1e-10 * work);
            EXPECT_NEAR(energy.kinetic, work - first_step(density * area, gravity, dynamics.dt()),
                        1e-10 * work);
            EXPECT_NEAR(energy.stored, 0, 1e-10 * work);
            EXPECT_FALSE(n % Dynamics::check_every == 0 && dynamics.is_at_rest());
        }
        EXPECT_GT(dynamics.time(), 0.01);
    }
}

// A couple M gives a block b x h the spin M t / I, I = m (b^2 + h^2) / 12. Once it is gone, the block turns by
// the same angle in every step about a centre that stays, and I spin^2 / 2 stays its energy.
TEST(dynamics, a_rigid_body_keeps_its_spin_and_energy)
{
    Moving turning(block(), rigid);
    Dynamics& dynamics = turning.dynamics;
    const double mass = density * 2, inertia = mass * (4 + 1) / 12.0, moment = 1e6;
    apply_couple(turning.rock(), moment);
    const int pushed = 20;
    for (int n = 0; n < pushed; ++n)
        dynamics.step();
    // Forces are those at the beginning of a step: the couple counts in the next one, but not in the first.
    const double spin = moment / inertia * pushed * dynamics.dt();
    turning.rock().load.assign(turning.rock().load.size(), Vector2d::Zero());
    std::vector<Vector2d> before = turning.places();
    dynamics.step();
    std::vector<Vector2d> now = turning.places();
    const auto angle_of = [](const std::vector<Vector2d>& from, const std::vector<Vector2d>& to) {
        const Vector2d one = from[1] - from[0], other = to[1] - to[0];
        return std::atan2(cross(one, other), one.dot(other));
    };
    const double in_step = angle_of(before, now);
    EXPECT_NEAR(in_step / dynamics.dt(), spin, 1e-3 * spin); // it has turned a little, its forces have not
    const auto centre_of = [&](const std::vector<Vector2d>& places) {
        const std::vector<double> weights = lumped_masses(turning.rock());
        Vector2d sum(0, 0);
        for (std::size_t g = 0; g < places.size(); ++g)
            sum += weights[g] / mass * places[g];
        return sum;
    };
    double all = 0;
    for (int n = 0; n < 2000; ++n) {
        before = now;
        dynamics.step();
        now = turning.places();
        const double angle = angle_of(before, now);
        all += angle;
        ASSERT_NEAR(angle, in_step, 1e-10 * in_step + 1e-14) << n;
        ASSERT_LT((centre_of(now) - Vector2d(1, 0.5)).norm(), 1e-11) << n;
        const double rate = in_step / dynamics.dt();
        ASSERT_NEAR(dynamics.energy().kinetic, inertia * rate * rate / 2, 1e-9 * inertia * rate * rate) << n;
    }
    EXPECT_GT(all, 1.0); // it has turned far
}

// Inner forces have no moment, however far rock has turned.
TEST(dynamics, a_deformable_block_keeps_its_angular_momentum)
{
    Moving turning(block(), deformable);
    Dynamics& dynamics = turning.dynamics;
    apply_couple(turning.rock(), 2e6);
    for (int n = 0; n < 200; ++n)
        dynamics.step();
    turning.rock().load.assign(turning.rock().load.size(), Vector2d::Zero());
    dynamics.step();
    std::vector<Vector2d> before = turning.places();
    double first = 0;
    for (int n = 0; n < 2000; ++n) {
        dynamics.step();
        const std::vector<Vector2d> now = turning.places();
        const double momentum = angular_momentum(turning.rock(), before, now, dynamics.dt());
        if (n == 0)
            first = momentum;
        ASSERT_NEAR(momentum, first, 1e-8 * first) << n;
        before = now;
    }
    EXPECT_GT(first, 1e2);
}

// A couple turns a block of a few zones as it turns the rigid block: the moment of inertia is the rock's, not that of masses
// at corners, which is three times as large with two zones. Energy closes.
TEST(dynamics, a_block_of_few_zones_has_its_own_moment_of_inertia)
{
    for (const double size : {3.0, 1.2, 0.8}) {
        Scene scene = test::section({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0.05);
        scene.zone_size = size;
        scene.gravity = 0;
        Moving turning(assembled(std::move(scene), {}, k_n, k_s), deformable);
        Dynamics& dynamics = turning.dynamics;
        const double mass = density * 2, inertia = mass * (4 + 1) / 12.0, moment = 1e5;
        apply_couple(turning.rock(), moment);
        constexpr int steps = 400;
        for (int n = 0; n < steps; ++n)
            dynamics.step();
        // Its forces at the beginning of the first step count from the second, as of the rigid body.
        const double time = steps * dynamics.dt(), angle = moment / inertia * time * time / 2;
        double turned = 0; // mean over gridpoints, by their arms: the block deforms a little, too
        const std::vector<Vector2d> places = turning.places();
        double all = 0;
        for (std::size_t g = 0; g < places.size(); ++g) {
            const Vector2d arm = turning.rock().position[g] - Vector2d(1, 0.5);
            turned += cross(arm, places[g] - turning.rock().position[g]);
            all += arm.squaredNorm();
        }
        std::printf("size %g: %zu zones, angle %.4e of %.4e rad\n", size,
                    turning.section.mesh.zone_gridpoint.size(), turned / all, angle);
        EXPECT_NEAR(turned / all, angle, 0.01 * angle) << size;
        const large_displacements::Energy energy = dynamics.energy();
        EXPECT_NEAR(energy.work, moment * angle, 0.05 * energy.work);
        EXPECT_NEAR(energy.error(), 0, 1e-3 * energy.work);
    }
}

// m u'' = -k L u - m g from rest: u = -(g / w^2) (1 - cos(n theta)), w^2 = k L / m, and energy closes to the
// last digits at every step, but for the first one.
TEST(dynamics, a_block_on_a_joint_swings_at_its_frequency)
{
    const double gravity = 2000; // fast enough that motion is not taken for nearly at rest
    Moving swinging(stack(gravity), rigid);
    Dynamics& dynamics = swinging.dynamics;
    const double frequency = std::sqrt(k_n / (density * 1)), sag = gravity / (frequency * frequency);
    const double theta = 2 * std::asin(frequency * dynamics.dt() / 2);
    double most = 0;
    for (int n = 1; n <= 500; ++n) {
        dynamics.step();
        const double expected = -sag * (1 - std::cos(n * theta));
        const std::vector<Vector2d> displacement = swinging.displacements();
        for (std::size_t g = 0; g < displacement.size(); ++g) {
            const bool is_upper = swinging.section.mesh.gridpoint[g].y() > 0.01;
            const bool is_lower = swinging.section.mesh.gridpoint[g].y() < -0.01;
            if (is_upper) {
                ASSERT_NEAR(displacement[g].y(), expected, 1e-9 * sag) << n;
            }
            if (is_lower) {
                ASSERT_EQ(displacement[g], Vector2d(0, 0)) << n;
            }
        }
        const large_displacements::Energy energy = dynamics.energy();
        most = std::max(most, energy.work);
        ASSERT_NEAR(energy.error(), first_step(density * 2, gravity, dynamics.dt()), 1e-9 * most) << n;
        ASSERT_NEAR(energy.stored, k_n * 2 * expected * expected / 2, 1e-8 * most) << n;
        ASSERT_NEAR(energy.friction, 0, 1e-12 * most);
        ASSERT_EQ(energy.damped, 0);
    }
    EXPECT_GT(500 * theta, 4 * 2 * std::numbers::pi);
}

// The force that carries a block fades in a time of many steps. It does work until then, and energy closes to the last
// digits.
TEST(dynamics, energy_closes_while_a_force_is_released)
{
    const double gravity = 2000, frequency = std::sqrt(k_n / (density * 1));
    const double sag = gravity / (frequency * frequency), period = 2 * std::numbers::pi / frequency;
    Moving released(stack(gravity), rigid, {.release = period / 3});
    double most = 0.01 * density * 2 * gravity * sag; // the weight times a hundredth of the sag at least
    while (released.dynamics.time() < period) {
        released.dynamics.step();
        const large_displacements::Energy energy = released.dynamics.energy();
        most = std::max({most, std::abs(energy.work), energy.stored});
        ASSERT_NEAR(energy.error(), 0, 1e-9 * most) << released.dynamics.time() / period;
    }
    EXPECT_GT(released.dynamics.energy().work, 0);
}

// Blocks that slide, rock and lie on each other, with dashpots and without: what loads do is kinetic, stored,
// lost to friction, or damped.
TEST(dynamics, energy_closes_at_every_step)
{
    const double dip = 30 * std::numbers::pi / 180;
    for (const Kind kind : {rigid, deformable})
        for (const double damping : {0.0, 2e-5}) {
            Moving sliding(incline(dip, 20 * std::numbers::pi / 180), kind,
                           {.stiffness_damping = damping, .mass_damping = damping > 0 ? 0.5 : 0.0});
            double most = 0.01 * 9.81 * density * 10, friction = 0; // the weight times 1 cm at least
            double worst = 0;
            for (int n = 1; n <= 1500; ++n) {
                sliding.dynamics.step();
                const large_displacements::Energy energy = sliding.dynamics.energy();
                most = std::max({most, std::abs(energy.work), energy.kinetic});
                worst = std::max(worst, std::abs(energy.error()) / most);
                ASSERT_GE(energy.friction, friction - 1e-3 * most);
                friction = energy.friction;
            }
            EXPECT_LT(worst, kind == rigid ? 1e-3 : 2e-5) << kind << " " << damping;
            EXPECT_GT(friction, 0.02 * most) << kind << " " << damping;
        }
}

// A block on a joint comes to rest where the joint carries its weight, damped or only stopped at peaks of its energy.
TEST(dynamics, rest_is_recognised_where_forces_balance)
{
    const double gravity = 9.81;
    for (const auto& [kind, damping] : {std::pair(rigid, 100.0), std::pair(deformable, 100.0),
                                        std::pair(rigid, 0.0), std::pair(deformable, 0.0)}) {
        Moving settling(stack(gravity, 0.6), kind, {.mass_damping = damping, .tolerance = 1e-6});
        Dynamics& dynamics = settling.dynamics;
        bool is_at_rest = false;
        int n = 0;
        while (!is_at_rest && n < 200000) {
            dynamics.step();
            is_at_rest = ++n % Dynamics::check_every == 0 && dynamics.is_at_rest();
        }
        ASSERT_TRUE(is_at_rest);
        EXPECT_GT(n, 2 * Dynamics::check_every);
        EXPECT_LE(dynamics.unbalanced_force_ratio(), 1e-6);
        const double sag = density * 1 * gravity / k_n;
        double carried = 0;
        for (const large_displacements::Touching& touching : dynamics.touching()) {
            carried -= touching.traction.x() * (touching.between[1] - touching.between[0]).norm();
            EXPECT_FALSE(touching.is_slipping);
        }
        EXPECT_NEAR(carried, density * 2 * gravity, 1e-5 * density * 2 * gravity) << kind;
        if (kind != rigid)
            continue;
        for (const large_displacements::Touching& touching : dynamics.touching()) {
            EXPECT_NEAR(touching.closing, sag, 1e-5 * sag);
        }
    }
}

// Dashpots that are far too strong: K u + beta K u' = weight. The weight that springs do not carry yet decays nearly as
// exp(-t / beta), by the slow root of the oscillator. This weight is the unbalanced force, though forces are nearly in balance
// with those of dashpots. Rigid and deformable rock, tied to what it lies on, and with a yield law, below its strength.
TEST(dynamics, forces_have_to_balance_without_dashpots_too)
{
    const double gravity = 2000, stiffness = 1e10, beta = 0.01;
    const double w2 = stiffness / (density * 1), // of the block, which is 1 m high [1/s2]
        rate = (beta * w2 - std::sqrt(beta * w2 * beta * w2 - 4 * w2)) / 2; // of the slow root
    const auto loaded = [&](bool is_tied, bool yields) {
        Section section = stack(gravity, {}, stiffness, stiffness, true, yields);
        return is_tied ? tied(std::move(section), {2, 0}) : section;
    };
    for (const auto& [kind, is_tied, yields] :
         {std::tuple(rigid, false, false), std::tuple(deformable, false, false),
          std::tuple(deformable, true, false), std::tuple(deformable, false, true)}) {
        Moving damped(loaded(is_tied, yields), kind, {.stiffness_damping = beta, .tolerance = 0.01});
        Dynamics& dynamics = damped.dynamics;
        const mechanics::Assembly& rock = damped.rock();
        EXPECT_EQ(!rock.tied.empty(), is_tied);
        EXPECT_EQ(!rock.zones.yielding.empty(), yields);
        std::vector<Vector2d> weight = rock.load;
        give_forces_to_leaders(rock, weight);
        double largest = density * 2 * gravity; // of the rigid block
        if (kind == deformable) {
            largest = 0;
            for (std::size_t g = 0; g < weight.size(); ++g)
                largest = std::max(largest, weight[g].cwiseProduct(rock.is_free[g]).norm());
        }
        while (dynamics.time() < beta / 5)
            for (int n = 0; n < Dynamics::check_every; ++n)
                dynamics.step();
        dynamics.is_at_rest(); // computes the ratio
        DynamicsState state;
        dynamics.transfer(Transfer(Transfer::Way::keep), state);
        const double expected = largest * std::exp(-rate * dynamics.time());
        EXPECT_NEAR(dynamics.unbalanced_force_ratio() * state.largest_mean_force, expected, 0.02 * expected)
            << kind << is_tied << yields;
    }
}

// Dashpots of a very stiff spring make large forces of rounding errors, here some ten times the tolerance. The block
// is not stopped by them before the soft spring carries its load.
TEST(dynamics, rounding_errors_do_not_stop_rock_before_it_rests)
{
    const double stiff = 1e12, soft = 1e9, push = 1000; // [Pa/m], [Pa/m], [N/m]
    Moving pushed(stack(9.81, {}, stiff, soft), rigid, {.stiffness_damping = 1e-4, .tolerance = 1e-6});
    std::vector<std::size_t> block;
    for (std::size_t g = 0; g < pushed.rock().position.size(); ++g)
        if (pushed.rock().is_free[g].x() > 0 && pushed.rock().position[g].y() > 0.1)
            block.push_back(g);
    for (const std::size_t g : block)
        pushed.rock().load[g].x() += push / static_cast<double>(block.size());
    bool is_at_rest = false;
    for (int n = 1; n < 2000000 && !is_at_rest; ++n) {
        pushed.dynamics.step();
        is_at_rest = n % Dynamics::check_every == 0 && pushed.dynamics.is_at_rest();
    }
    ASSERT_TRUE(is_at_rest);
    EXPECT_LE(pushed.dynamics.unbalanced_force_ratio(), 1e-6);
    double carried = 0;
    for (const large_displacements::Touching& touching : pushed.dynamics.touching())
        carried += touching.traction.y() * (touching.between[1] - touching.between[0]).norm();
    EXPECT_NEAR(std::abs(carried), push, 1e-5 * push);
}

// What is kept and taken up by a new analysis goes on with the same bytes.
TEST(dynamics, state_taken_up_again_gives_the_same_bytes)
{
    const double dip = 30 * std::numbers::pi / 180;
    for (const Kind kind : {rigid, deformable}) {
        Section stressed = incline(dip, 20 * std::numbers::pi / 180);
        for (Vector3d& stress : stressed.assembly.zones.stress) // the second one does not begin with it
            stress = {-2e4, -1e4, 3e3};
        Moving first(std::move(stressed), kind, {.stiffness_damping = 2e-5});
        for (int n = 0; n < 700; ++n)
            first.dynamics.step();
        first.dynamics.put_back();
        Checkpoint kept;
        mechanics::transfer(Transfer(Transfer::Way::keep), first.rock(), kept);
        first.dynamics.transfer(Transfer(Transfer::Way::keep), kept.dynamics);

        Moving second(incline(dip, 20 * std::numbers::pi / 180), kind, {.stiffness_damping = 2e-5});
        const Checkpoint as_kept = kept;
        mechanics::transfer(Transfer(Transfer::Way::restore), second.rock(), kept);
        second.dynamics.transfer(Transfer(Transfer::Way::restore), kept.dynamics);
        EXPECT_EQ(bytes(kept.dynamics), bytes(as_kept.dynamics));
        second.dynamics.put_back();
        EXPECT_EQ(second.rock().displacement, first.rock().displacement);
        EXPECT_EQ(second.rock().zones.stress, first.rock().zones.stress);

        std::array<std::string, 2> ends;
        for (Moving* one : {&first, &second}) {
            one->dynamics.start();
            for (int n = 0; n < 300; ++n)
                one->dynamics.step();
            DynamicsState state;
            one->dynamics.transfer(Transfer(Transfer::Way::keep), state);
            ends[one == &second] = bytes(state);
        }
        EXPECT_GT(ends[0].size(), 1000u);
        EXPECT_EQ(ends[0], ends[1]) << kind;
        EXPECT_NE(ends[0], bytes(as_kept.dynamics));
    }
}

// F = R U: Biot's stress T = C (U - 1), Cauchy's stress R T U R' / det U, and the forces of zones on their
// gridpoints have the virial sum of f x X' = -A R T.
RC_GTEST_PROP(dynamics, a_uniform_deformation_gives_the_stress_of_the_formula, ())
{
    static Moving moving(block(), deformable);
    const auto number = [](double low, double high) {
        return low + (high - low) * *rc::gen::inRange(0, 1001) / 1000;
    };
    const Eigen::Rotation2Dd turn(number(-3.1, 3.1));
    Matrix2d stretch;
    const double shear = number(-0.1, 0.1);
    stretch << number(0.8, 1.2), shear, shear, number(0.8, 1.2);
    if (*rc::gen::inRange(0, 4) == 0)
        stretch.setIdentity(); // turned only
    const Matrix2d rotation = turn.toRotationMatrix(), gradient = rotation * stretch;
    moving.deform(gradient);

    const mechanics::Assembly& rock = moving.rock();
    const double e = 3e10, nu = 0.25, lame = e * nu / (1 + nu) / (1 - 2 * nu), g = e / 2 / (1 + nu);
    const Matrix2d strain = stretch - Matrix2d::Identity();
    const Matrix2d biot = lame * strain.trace() * Matrix2d::Identity() + 2 * g * strain;
    const Matrix2d symmetric = (biot * stretch + stretch * biot) / 2;
    const Matrix2d cauchy = rotation * symmetric * rotation.transpose() / stretch.determinant();
    const std::vector<Vector2d> before = moving.places();
    for (const Vector3d& stress : rock.zones.stress)
        RC_ASSERT((stress - Vector3d(cauchy(0, 0), cauchy(1, 1), cauchy(0, 1))).norm() < 1e-12 * e);

    // Forces by what they move in the first step, which is dt^2 / 2 f / m.
    const double dt = moving.dynamics.dt();
    moving.dynamics.step();
    const std::vector<Vector2d> after = moving.places();
    const std::vector<double> mass = lumped_masses(rock);
    Matrix2d virial = Matrix2d::Zero();
    for (std::size_t p = 0; p < mass.size(); ++p)
        virial += mass[p] * 2 / dt / dt * (after[p] - before[p]) *
                  (moving.section.mesh.gridpoint[p] - Vector2d(1, 0.5)).transpose();
    RC_ASSERT((virial + 2 * rotation * biot).norm() < 1e-7 * e);
}

} // namespace dynamics_test
