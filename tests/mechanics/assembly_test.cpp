// Forces of zones and contacts together: none for rigid motion, in balance with each other.

#include "sections.hpp"

#include "mechanics/excavation.hpp"

#include <gtest/gtest.h>

#include <random>

namespace assembly_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using namespace jointcreep::mechanics;

namespace
{

void move_at_random(Assembly& assembly, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(-1e-3, 1e-3);
    for (Vector2d& d : assembly.displacement)
        d = {u(random), u(random)};
}

} // namespace

TEST(assembly, rigid_translation_gives_no_force)
{
    Section s = jointed_plate();
    for (Vector2d& d : s.assembly.displacement)
        d = {0.3, -0.2};
    find_forces(s.assembly);
    EXPECT_LT(balance_of(s.assembly).largest, 1e-3); // of stiffnesses about 1e10
}

TEST(assembly, forces_add_up_to_nothing)
{
    Section s = jointed_plate();
    move_at_random(s.assembly, 1);
    find_forces(s.assembly);
    Vector2d sum = Vector2d::Zero();
    double moment = 0, magnitude = 0;
    for (std::size_t g = 0; g < s.assembly.force.size(); ++g) {
        const Vector2d f = s.assembly.force[g], p = s.mesh.gridpoint[g];
        sum += f;
        moment += p.x() * f.y() - p.y() * f.x();
        magnitude += f.norm();
    }
    EXPECT_LT(sum.norm(), 1e-12 * magnitude);
    // Contacts join gridpoints at one place, so they make no moment either.
    EXPECT_LT(std::abs(moment), 1e-12 * 20 * magnitude);
}

TEST(assembly, gershgorin_bounds_the_highest_frequency)
{
    // Rayleigh quotients of many motions stay below the largest row sum over mass, and the best comes near
    // it.
    Section s = jointed_plate();
    const std::vector<double> sums = stiffness_row_sums(s.assembly), mass = lumped_masses(s.assembly);
    double bound = 0;
    for (std::size_t g = 0; g < sums.size(); ++g)
        bound = std::max(bound, sums[g] / mass[g]);
    move_at_random(s.assembly, 2);
    double quotient = 0;
    for (int i = 0; i < 200; ++i) { // power iteration on M^-1 K
        find_forces(s.assembly);
        double work = 0, inertia = 0;
        for (std::size_t g = 0; g < mass.size(); ++g) {
            work -= s.assembly.displacement[g].dot(s.assembly.force[g]);
            inertia += mass[g] * s.assembly.displacement[g].squaredNorm();
        }
        quotient = work / inertia;
        for (std::size_t g = 0; g < mass.size(); ++g)
            s.assembly.displacement[g] = -s.assembly.force[g] / mass[g] / bound;
    }
    EXPECT_LT(quotient, bound);
    EXPECT_GT(quotient, 0.4 * bound);
}

TEST(assembly, the_same_bits_for_any_number_of_threads)
{
    Section one = jointed_plate(), three = jointed_plate();
    three.assembly.threads = 3;
    move_at_random(one.assembly, 3);
    move_at_random(three.assembly, 3);
    find_forces(one.assembly);
    find_forces(three.assembly);
    EXPECT_EQ(one.assembly.force, three.assembly.force);
}

TEST(assembly, starting_from_here_keeps_forces_and_open_gaps)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.05);
    scene.zone_size = 3;
    Joints joints;
    add_joint(joints, {-1, 5}, {11, 5.5});
    Section s = assembled(std::move(scene), joints, 4e9, 1e9, 0.5);
    move_at_random(s.assembly, 4);
    find_forces(s.assembly);
    const auto force = s.assembly.force;
    const auto moved = s.assembly.displacement;
    start_from_here(s.assembly);
    for (std::size_t g = 0; g < force.size(); ++g)
        EXPECT_LT((s.assembly.force[g] - force[g]).norm(), 1e-3);
    // Going back to where it came from is the same as if nothing had been reset.
    Section t = assembled(s.scene, joints, 4e9, 1e9, 0.5);
    t.assembly.displacement = moved;
    find_forces(t.assembly);
    for (std::size_t g = 0; g < moved.size(); ++g) {
        s.assembly.displacement[g] = -moved[g];
        t.assembly.displacement[g].setZero();
    }
    find_forces(s.assembly);
    find_forces(t.assembly);
    for (std::size_t g = 0; g < force.size(); ++g)
        EXPECT_LT((s.assembly.force[g] - t.assembly.force[g]).norm(), 1.0); // of 1e7
}

TEST(assembly, what_excavation_releases_keeps_the_rest_in_balance)
{
    Scene scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
    scene.zone_size = 1.5;
    scene.gravity = 9.81;
    scene.stages.push_back({"cut", 1, {{{12, 4}, {21, 4}, {21, 11}, {10, 11}}}});
    scene.in_situ_stress.compression_xx = 1e6;
    scene.in_situ_stress.compression_yy = 2e6;
    Joints joints;
    add_joint(joints, {-1, 3}, {21, 5});
    add_joint(joints, {6, -1}, {9, 11});
    Section s = assembled(std::move(scene), joints, 5e9, 2e9);
    find_forces(s.assembly);
    const auto before = s.assembly.force;
    const auto released = excavate(s.assembly, s.network.blocks, s.mesh, Loading(s.scene, s.mesh), 0);
    for (std::size_t g = 0; g < released.size(); ++g)
        s.assembly.load[g] += released[g];
    find_forces(s.assembly);
    std::size_t gone = 0, near_the_cut = 0;
    for (std::size_t g = 0; g < before.size(); ++g) {
        if (s.assembly.is_free[g].isZero()) {
            ++gone;
            continue;
        }
        near_the_cut += released[g].norm() > 0 ? 1 : 0;
        EXPECT_LT((s.assembly.force[g] - before[g]).norm(), 1e-6 * 2e6);
    }
    EXPECT_GT(gone, 10u);
    EXPECT_GT(near_the_cut, 5u);
}

// The right side is fixed above the cut only.
TEST(assembly, excavated_boundaries_fix_nothing)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.05);
    scene.zone_size = 2;
    scene.boundaries = {{.from = {0, 0}, .to = {10, 0}, .fix_x = true, .fix_y = true},
                        {.from = {10, 6}, .to = {10, 10}, .fix_x = true},
                        {.from = {0, 10}, .to = {0, 6}, .fix_x = true}};
    scene.stages.push_back({"cut", 1, {{{5, 6}, {11, 6}, {11, 11}, {5, 11}}}});
    Section s = assembled(std::move(scene), {}, 1, 1);
    const auto fixed_in = [&](double x, double y) {
        std::vector<Vector2d> found;
        for (std::size_t g = 0; g < s.assembly.position.size(); ++g)
            if ((s.assembly.position[g] - Vector2d(x, y)).norm() < 1e-9)
                found.push_back(Vector2d(1, 1) - s.assembly.is_free[g]);
        return found;
    };
    using Found = std::vector<Vector2d>;
    EXPECT_EQ(fixed_in(10, 6), (Found{{1, 0}}));
    excavate(s.assembly, s.network.blocks, s.mesh, Loading(s.scene, s.mesh), 0);
    EXPECT_EQ(fixed_in(10, 6), (Found{{0, 0}}));
    EXPECT_EQ(fixed_in(0, 6), (Found{{1, 0}}));
    EXPECT_EQ(fixed_in(10, 0), (Found{{1, 1}}));
    EXPECT_EQ(fixed_in(10, 10), (Found{{1, 1}})); // without rock
}

} // namespace assembly_test
