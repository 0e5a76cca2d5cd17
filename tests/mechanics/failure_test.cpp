// Rock that nothing holds, found before any step; blocks that move, named.

#include "sections.hpp"

#include "mechanics/failure.hpp"
#include "mechanics/loading.hpp"

#include <gtest/gtest.h>

namespace failure_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

// Two blocks of 10 m x 5 m on each other, the lower one on ground that is held.
Section stack(double gravity, const std::vector<Boundary>& more = {})
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 3;
    scene.gravity = gravity;
    scene.boundaries = {{.from = {0, 0}, .to = {10, 0}, .fix_x = true, .fix_y = true}};
    scene.boundaries.insert(scene.boundaries.end(), more.begin(), more.end());
    Joints joints;
    add_joint(joints, {0, 5}, {10, 5});
    Section s = assembled(std::move(scene), joints, 1e9, 1e9, 0.5);
    mechanics::Loading(s.scene, s.mesh).apply(s.assembly, 0);
    return s;
}

Failure without_contacts(Section s)
{
    EXPECT_TRUE(failure_of_unsupported(s.mesh, s.assembly).block.empty()) << "the joint holds it";
    s.assembly.contacts.status.assign(s.assembly.contacts.status.size(), ContactStatus::removed);
    return failure_of_unsupported(s.mesh, s.assembly);
}

} // namespace

TEST(failure_of_unsupported, names_the_block_and_where_it_is)
{
    const Failure failure = without_contacts(stack(9.81));
    ASSERT_EQ(failure.block.size(), 1U);
    EXPECT_LT((failure.place[0] - Vector2d(5, 7.5)).norm(), 1e-9);
    EXPECT_EQ(failure.motion[0], Vector2d(0, 0));
}

TEST(failure_of_unsupported, five_blocks_are_shown)
{
    Failure failure;
    for (Index block = 0; block < 5; ++block) {
        failure.block.push_back(block);
        failure.place.emplace_back(block, 0);
        failure.motion.emplace_back(0, 0);
    }
    EXPECT_EQ(
        mechanics::shown_blocks(failure),
        "block 0 at [0, 0] m; block 1 at [1, 0] m; block 2 at [2, 0] m; block 3 at [3, 0] m; block 4 at [4, 0] m");
    for (Index block = 5; block < 7; ++block)
        failure.block.push_back(block);
    EXPECT_NE(mechanics::shown_blocks(failure).find("block 4 at [4, 0] m; and 2 more"), std::string::npos);
}

TEST(failure_of_unsupported, looks_at_each_direction)
{
    const Boundary roller{.from = {0, 5}, .to = {0, 10}, .fix_x = true};
    const Boundary shelf{.from = {0, 10}, .to = {10, 10}, .fix_y = true};
    EXPECT_EQ(without_contacts(stack(9.81, {roller})).block.size(), 1U) << "it may slide down the side";
    EXPECT_EQ(without_contacts(stack(9.81, {shelf})).block.size(), 0U) << "nothing pushes it sideways";
    const Boundary wind{.from = {10, 5}, .to = {10, 10}, .traction = Vector2d(-1e3, 0)};
    EXPECT_EQ(without_contacts(stack(9.81, {shelf, wind})).block.size(), 1U);
    EXPECT_EQ(without_contacts(stack(0)).block.size(), 0U) << "nothing pushes it at all";
    const Boundary against{.from = {0, 5}, .to = {0, 10}, .traction = Vector2d(1e3, 0)};
    EXPECT_EQ(without_contacts(stack(0, {wind, against})).block.size(), 0U) << "pushes that cancel";
}

// On rollers that slope, the block is pushed along them; on level ones, or on two kinds of them, it is not.
TEST(failure_of_unsupported, on_rollers_is_what_is_pushed_along_them)
{
    const auto on = [](const std::vector<Boundary>& boundaries) {
        Scene scene = section({{0, 0}, {10, 2}, {10, 10}, {0, 10}}, 0.1);
        scene.zone_size = 3;
        scene.gravity = 9.81;
        scene.boundaries = boundaries;
        Section s = assembled(std::move(scene), {}, 1e9, 1e9, 0.5);
        mechanics::Loading(s.scene, s.mesh).apply(s.assembly, 0);
        return failure_of_unsupported(s.mesh, s.assembly).block.size();
    };
    const Boundary base{.from = {0, 0}, .to = {10, 2}, .fix_normal = true},
        side{.from = {0, 0}, .to = {0, 10}, .fix_normal = true},
        top{.from = {0, 10}, .to = {10, 10}, .fix_normal = true};
    EXPECT_EQ(on({base}), 1U);
    EXPECT_EQ(on({base, side}), 0U);
    EXPECT_EQ(on({top}), 0U) << "nothing pushes it sideways";
    EXPECT_EQ(on({side}), 1U) << "it may slide down the side";
}

TEST(failure_of, names_what_moves_the_fastest_first)
{
    const Section s = stack(9.81);
    mechanics::no_equilibrium error("on purpose");
    error.steps = 7;
    std::vector<char> is_lower(s.assembly.position.size(), 0);
    for (std::size_t z = 0; z < s.mesh.zone_block.size(); ++z) {
        const auto& corners = s.mesh.zone_gridpoint[z];
        const double y = (s.assembly.position[corners[0]] + s.assembly.position[corners[1]] +
                          s.assembly.position[corners[2]])
                             .y() /
                         3;
        for (const Index g : corners)
            is_lower[g] = y < 5;
    }
    for (const char lower : is_lower)
        error.motion.emplace_back(lower ? 0.2 : 1.0, 0);
    const Failure failure = failure_of(error, s.mesh, s.assembly);
    EXPECT_EQ(failure.reason, "no equilibrium: on purpose");
    EXPECT_EQ(failure.steps, 7);
    ASSERT_EQ(failure.block.size(), 2U);
    EXPECT_LT((failure.place[0] - Vector2d(5, 7.5)).norm(), 1e-9);
    EXPECT_GT(failure.motion[0].norm(), failure.motion[1].norm());
    EXPECT_LT((failure.motion[1] - Vector2d(0.2, 0)).norm(), 1e-12);
    // A block that moves by less than a tenth of that is not named.
    for (std::size_t g = 0; g < error.motion.size(); ++g)
        error.motion[g].x() *= is_lower[g] ? 0.01 : 1.0;
    EXPECT_EQ(failure_of(error, s.mesh, s.assembly).block, std::vector<Index>{failure.block[0]});
    EXPECT_NE(mechanics::shown_blocks(failure).find("at [5, 7.5] m by ["), std::string::npos);
}

} // namespace failure_test
