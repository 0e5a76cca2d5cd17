#include "sampling/streams.hpp"

#include "sampling/laws.hpp"
#include "statistics.hpp"

#include <gtest/gtest.h>

#include <set>

namespace streams_test
{

using namespace jointcreep;
using namespace jointcreep::sampling;

using Words = std::array<std::uint32_t, 4>;

TEST(Philox, GivesThePublishedVectors)
{
    // Random123's known answers for philox4x32, 10 rounds.
    EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
              (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
              (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(SetKey, IsFnv1a)
{
    EXPECT_EQ(set_key(""), 0x811c9dc5U);
    EXPECT_EQ(set_key("a"), 0xe40c292cU);
    EXPECT_EQ(set_key("foobar"), 0xbf9cf968U);
}

TEST(Stream, IsPhiloxBlockByBlock)
{
    const SetStreams set{0x0123456789abcdefU, -3, 0xfeedbeefU};
    Stream stream(set, -2, Purpose::position);
    for (std::uint32_t block = 0; block < 3; ++block) {
        const Words words =
            philox({(2U << 28U) + block, 0xfffffffdU, 0xfeedbeefU, 0xfffffffeU}, {0x89abcdefU, 0x01234567U});
        EXPECT_EQ(stream(), static_cast<std::uint64_t>(words[1]) << 32U | words[0]);
        EXPECT_EQ(stream(), static_cast<std::uint64_t>(words[3]) << 32U | words[2]);
    }
}

TEST(Stream, DiffersInEveryPartOfItsKey)
{
    std::set<std::uint64_t> first;
    int streams = 0;
    for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32U})
        for (const std::int32_t realization : {-1, 0, 1})
            for (const std::uint32_t key : {0U, 1U})
                for (const std::int32_t number : {-2, -1, 0, 1, 2})
                    for (const Purpose purpose : {Purpose::spacing, Purpose::orientation, Purpose::position,
                                                  Purpose::traces_ahead, Purpose::traces_behind}) {
                        first.insert(Stream({seed, realization, key}, number, purpose)());
                        ++streams;
                    }
    EXPECT_EQ(first.size(), streams);
}

TEST(Stream, IsUniformAndIndependentAcrossJointsAndPurposes)
{
    const SetStreams set{7, 0, set_key("a set")};
    statistics::Samples first, across_joints, across_purposes;
    for (std::int32_t joint = -10000; joint < 10000; ++joint) {
        Stream spacing(set, joint, Purpose::spacing), next(set, joint + 1, Purpose::spacing),
            orientation(set, joint, Purpose::orientation);
        const double u = uniform(spacing);
        first.push_back(u);
        across_joints.push_back((u - .5) * (uniform(next) - .5));
        across_purposes.push_back((u - .5) * (uniform(orientation) - .5));
    }
    EXPECT_TRUE(statistics::follow(first, [](double x) { return x; }));
    EXPECT_TRUE(statistics::have_mean(across_joints, 0));
    EXPECT_TRUE(statistics::have_mean(across_purposes, 0));
}

} // namespace streams_test
