// Displacement that contacts do not yet balance, of each piece of rock by itself.

#include "sections.hpp"

#include "mechanics/rest.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rest_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

constexpr double K = 1e9;

// Two blocks of 2 m x 2 m beside each other on ground with a joint, or on other supports; nothing between them.
Section two_blocks(std::vector<Boundary> supports = {{.from = {10, 5}, .to = {14, 5}, .joint = "joint"}})
{
    Scene scene = section({{10, 5}, {14, 5}, {14, 7}, {10, 7}}, 0.1);
    scene.zone_size = 1;
    scene.boundaries = std::move(supports);
    Joints joints;
    add_joint(joints, {12, 4}, {12, 8});
    Section s = assembled(std::move(scene), joints, K, K);
    for (std::size_t c = 0; c < s.assembly.contacts.status.size(); ++c)
        if (s.mesh.contact_centre[c].y() > 5)
            s.assembly.contacts.status[c] = ContactStatus::removed;
    return s;
}

// Loads each block, half at each of its lower corners, by forces that nothing balances yet [N/m].
void put_on(Section& s, double left, double right)
{
    std::fill(s.assembly.force.begin(), s.assembly.force.end(), Vector2d(0, 0));
    for (const auto& zone : s.mesh.zone_gridpoint) {
        double middle = 0;
        for (const Index g : zone)
            middle += s.assembly.position[g].x() / 3;
        for (const Index g : zone) {
            const Vector2d& place = s.assembly.position[g];
            if (place.y() > 5 || std::abs(std::abs(place.x() - 12) - 1) < 0.9) // no lower corner
                continue;
            s.assembly.force[g] = s.assembly.load[g] = {0, -(middle < 12 ? left : right) / 2};
        }
    }
}

double remaining(const Section& s, double share = 0.1, double rounding = 0)
{
    return mechanics::largest_remaining_displacement(s.assembly, share, rounding).displacement;
}

} // namespace

TEST(remaining_displacement, is_force_over_stiffness_of_the_piece_that_has_most)
{
    Section s = two_blocks();
    for (const auto& [left, right] : {std::pair(1e4, 3e4), {3e4, 1e4}, {3e4, 0.0}, {0.0, 3e4}}) {
        put_on(s, left, right);
        const auto found = mechanics::largest_remaining_displacement(s.assembly, 0.1, 0);
        EXPECT_NEAR(found.displacement, 3e4 / (2 * K), 1e-6 * 3e4 / (2 * K)) << left << ' ' << right;
        EXPECT_EQ(s.assembly.position[found.gridpoint].x() < 12 ||
                      (s.assembly.position[found.gridpoint].x() == 12 && left > right),
                  left > right);
    }
}

TEST(remaining_displacement, counts_forces_above_a_share_and_above_rounding)
{
    Section s = two_blocks();
    put_on(s, 1e4, 1e4);
    EXPECT_EQ(remaining(s, 1.5), 0) << "less than the share of its load";
    EXPECT_EQ(remaining(s, 0.1, 2e5), 0) << "rounding";
    EXPECT_GT(remaining(s, 0.9, 9e3), 0);
    std::fill(s.assembly.load.begin(), s.assembly.load.end(), Vector2d(0, 0));
    EXPECT_EQ(remaining(s), 0) << "no load of its own";
}

// A share counts of weight and tractions together: here tractions carry nearly all of the weight.
TEST(remaining_displacement, counts_what_weight_and_tractions_leave)
{
    Section s = two_blocks();
    put_on(s, 1e4, 0);
    for (std::size_t g = 0; g < s.assembly.load.size(); ++g) {
        s.assembly.applied[g] = -0.95 * s.assembly.load[g];
        s.assembly.force[g] = s.assembly.load[g] + s.assembly.applied[g];
    }
    EXPECT_NEAR(remaining(s, 0.1), 0.05 * 1e4 / (2 * K), 1e-6 * 1e4 / (2 * K));
}

// A block on a fixed boundary, with no contact, does not move, while its neighbour is on a joint.
TEST(remaining_displacement, of_a_block_on_a_fixed_boundary)
{
    Section s = two_blocks({{.from = {10, 5}, .to = {12, 5}, .fix_x = true, .fix_y = true},
                            {.from = {12, 5}, .to = {14, 5}, .joint = "joint"}});
    std::fill(s.assembly.force.begin(), s.assembly.force.end(), Vector2d(0, 0));
    for (std::size_t g = 0; g < s.assembly.load.size(); ++g)
        if (s.assembly.position[g].y() > 6.9 && s.assembly.position[g].x() < 11.9)
            s.assembly.force[g] = s.assembly.load[g] = {1e4, -1e4};
    EXPECT_GT(remaining(s), 0);
    EXPECT_LT(remaining(s), 1e5 / K);
}

TEST(size_of, is_the_diagonal)
{
    EXPECT_NEAR(mechanics::size_of(two_blocks().assembly), std::hypot(4, 2), 1e-12);
}

} // namespace rest_test
