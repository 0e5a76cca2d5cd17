// What limits ask for in words, and values of any shape as one flat array.

#include "fields/fields.hpp"

#include <gtest/gtest.h>

namespace jointcreep::fields::fields_test
{

TEST(Limits, SayWhatTheyAskFor)
{
    EXPECT_EQ(wanted(any()), "finite");
    EXPECT_EQ(wanted(positive()), "> 0");
    EXPECT_EQ(wanted(at_least(-1)), ">= -1");
    EXPECT_EQ(wanted(between(0, 3)), "0 to 3");
    EXPECT_EQ(wanted(ascending()), ">= 0, not decreasing");
    EXPECT_EQ(wanted(index_of("block")), "index of block");
    EXPECT_EQ(wanted(index_or_none("block")), "index of block or -1");
    EXPECT_EQ(wanted(rows_in("share")), "0, not decreasing, up to the number of shares");
}

TEST(Values, AreOneFlatArrayTheComponentsRunningFastest)
{
    std::vector<Eigen::Vector3d> stress = {{1, 2, 3}, {4, 5, 6}};
    const Values values = &stress;
    EXPECT_EQ(rows(values), 2u);
    EXPECT_EQ(components(values), 3u);
    const auto all = std::get<std::span<double>>(flat(values));
    EXPECT_EQ(std::vector(all.begin(), all.end()), (std::vector<double>{1, 2, 3, 4, 5, 6}));
    all[4] = 9;
    EXPECT_EQ(stress[1], Eigen::Vector3d(4, 9, 6));
    resize(values, 5);
    EXPECT_EQ(stress.size(), 5u);
}

TEST(Values, OfPairsAndSingleNumbersAreFlatToo)
{
    std::vector<std::array<Index, 2>> vertices = {{7, 8}};
    EXPECT_EQ(components(&vertices), 2u);
    EXPECT_EQ(std::get<std::span<Index>>(flat(&vertices))[1], 8);

    double time = 5;
    EXPECT_EQ(rows(&time), 1u);
    EXPECT_EQ(components(&time), 1u);
    resize(&time, 1);
    EXPECT_EQ(std::get<std::span<double>>(flat(&time))[0], 5);
}

} // namespace jointcreep::fields::fields_test
