// What the report is worth: right networks fail as seldom as it says and their intervals hold the target as
// often as they say, over many realizations; wrong networks fail.

#include "scenes.hpp"

#include "sampling/joint_sets.hpp"
#include "statistics/distribution.hpp"
#include "statistics/statistics.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>

namespace verdicts_test
{

using namespace jointcreep;
using namespace jointcreep::statistics;
using namespace jointcreep::unit;

namespace
{

Statistics report_of(const Scene& drawn_from, const Scene& held_against, int realization)
{
    Network network;
    network.joints = sampling::sample_joints(drawn_from, 20061212, realization);
    return statistics_of(held_against, network);
}

bool fails(const Statistics& rows)
{
    return std::count(rows.verdict.begin(), rows.verdict.end(), static_cast<Index>(Verdict::fail)) > 0;
}

// Share of the networks that fail anywhere.
double flagged(const Scene& drawn_from, const Scene& held_against, int realizations)
{
    int count = 0;
    for (int r = 0; r < realizations; ++r)
        count += fails(report_of(drawn_from, held_against, r));
    return double(count) / realizations;
}

// More than `share` of `n` allows: by 3.3 deviations of a binomial count, one in a thousand.
double most(double share, double n)
{
    return n * share + 3.3 * std::sqrt(n * share * (1 - share)) + 1;
}

struct Tally {
    std::vector<double> p;
    int intervals = 0, holding = 0;
};

void stretch(ProbabilityLaw& law, double factor)
{
    law.mean *= factor;
    law.deviation *= factor;
    law.least *= factor;
    law.most *= factor;
}

// Three times as wide and high as the example: 20 to 120 lines.
Scene large(const Example& example)
{
    Scene scene = example.scene;
    for (Eigen::Vector2d& corner : scene.outline)
        corner *= 3;
    if (scene.joint_sets[0].region)
        for (Eigen::Vector2d& corner : *scene.joint_sets[0].region)
            corner *= 3;
    return scene;
}

} // namespace

// The p-values of counts are discrete: of these only that small ones are not too many is asked.
TEST(Verdicts, OfRightNetworksAreRight)
{
    const int realizations = 250;
    int failing = 0, runs = 0;
    std::vector<Example> all = examples();
    for (const Example& example : other_kinds())
        all.push_back(example);
    for (const Example& example : all) {
        std::map<std::string, Tally> tallies;
        int failing_here = 0;
        for (int r = 0; r < realizations; ++r) {
            const Statistics rows = report_of(example.scene, example.scene, r);
            failing_here += fails(rows);
            for (std::size_t i = 0; i < rows.p_value.size(); ++i) {
                Tally& tally = tallies[rows.quantity[i]];
                if (rows.is_tested[i])
                    tally.p.push_back(rows.p_value[i]);
                if (rows.has_interval[i] && rows.has_target[i]) {
                    ++tally.intervals;
                    tally.holding += rows.low[i] <= rows.target[i] && rows.target[i] <= rows.high[i];
                }
                ASSERT_TRUE(std::isfinite(rows.achieved[i]) && std::isfinite(rows.p_value[i]));
            }
        }
        EXPECT_LE(failing_here, most(.01, realizations)) << example.name;
        failing += failing_here;
        runs += realizations;
        for (const auto& [quantity, tally] : tallies) {
            const std::string what = example.name + ": " + quantity;
            const auto n = static_cast<double>(tally.p.size());
            for (const double level : {.001, .01, .05, .2}) {
                const auto below =
                    std::count_if(tally.p.begin(), tally.p.end(), [&](double p) { return p < level; });
                EXPECT_LE(double(below), most(level, n)) << what << " at " << level;
            }
            const bool is_count = quantity.starts_with("spacing, mean") || quantity.starts_with("P10");
            if (n > 0 && !is_count) {
                EXPECT_GT(kolmogorov_smirnov(tally.p).p_value, 1e-4) << what;
            }
            if (tally.intervals > 0) {
                EXPECT_LE(tally.intervals - tally.holding, most(.05, tally.intervals)) << what;
                EXPECT_LE(tally.holding, most(.95, tally.intervals) + .02 * tally.intervals) << what;
            }
        }
    }
    EXPECT_LE(failing, most(.01, runs));
    EXPECT_GE(failing, 2); // not because nothing is ever flagged
}

// The table of docs/statistics.md. Shares of flagged networks, for each example.
TEST(Verdicts, OfWrongNetworksAreFail)
{
    struct Mistake {
        std::string name;
        std::function<void(JointSet&)> make;
        std::vector<double> flagged; // at least, in the order of the examples; -1 where it is none
    };
    const auto other_law = [](ProbabilityLaw& law) {
        law = law.kind == Kind::negative_exponential
                  ? ProbabilityLaw{Kind::lognormal, law.mean, law.mean * .5}
                  : ProbabilityLaw{Kind::negative_exponential, law.mean, law.mean};
    };
    const auto wider = [](ProbabilityLaw& law, double factor) {
        const double more = (law.most - law.least) / 2 * (factor - 1);
        law.deviation *= factor;
        law.least -= more;
        law.most += more;
    };
    const std::vector<Mistake> mistakes = {
        {"spacing 1.3 times as large",
         [](JointSet& set) { stretch(set.spacing, 1.3); },
         {.05, .75, .95, .85, .95}},
        {"another law of spacing", [&](JointSet& set) { other_law(set.spacing); }, {.9, .95, .95, .95, .95}},
        {"traces 1.3 times as long",
         [](JointSet& set) {
             if (set.length)
                 stretch(*set.length, 1.3);
         },
         {.95, .95, .95, -1, .95}},
        {"another law of lengths",
         [&](JointSet& set) {
             if (set.length)
                 other_law(*set.length);
         },
         {.95, .95, .95, -1, .95}},
        {"persistence lower by 0.1",
         [](JointSet& set) {
             if (set.length)
                 set.persistence -= .1;
         },
         {.95, .95, .95, -1, .95}},
        {"half the concentration, 1.41 times the deviation",
         [&](JointSet& set) {
             if (set.orientation)
                 set.orientation->concentration /= 2;
             else
                 wider(set.trace_angle ? *set.trace_angle : *set.dip, std::sqrt(2.0));
         },
         {.55, -1, .95, .95, .8}},
    };
    const int realizations = 40;
    for (const Mistake& mistake : mistakes) {
        const std::vector<Example> all = examples();
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (mistake.flagged[i] < 0)
                continue;
            const Scene right = large(all[i]);
            Scene wrong = right;
            mistake.make(wrong.joint_sets[0]);
            EXPECT_GE(flagged(wrong, right, realizations), mistake.flagged[i])
                << all[i].name << ": " << mistake.name;
        }
    }
}

TEST(Verdicts, OfWrongSegmentsAndDiscsAreFail)
{
    const std::vector<Example> all = other_kinds();
    for (const std::size_t i : {0, 1, 2}) {
        const Scene right = large(all[i]);
        const auto expect_flagged = [&](const std::string& what, const std::function<void(JointSet&)>& make) {
            Scene wrong = right;
            make(wrong.joint_sets[0]);
            EXPECT_GE(flagged(wrong, right, 30), .9) << all[i].name << ": " << what;
        };
        expect_flagged("a density 1.3 times as high", [](JointSet& set) { set.density->value *= 1.3; });
        expect_flagged("a size 1.3 times as large",
                       [](JointSet& set) { stretch(set.length ? *set.length : *set.diameter, 1.3); });
        expect_flagged("a constant size", [](JointSet& set) {
            ProbabilityLaw& size = set.length ? *set.length : *set.diameter;
            size = {Kind::constant, size.mean, 0};
        });
        expect_flagged("more scatter", [](JointSet& set) {
            if (set.orientation)
                set.orientation->concentration /= 2;
            else
                set.trace_angle->deviation *= 1.41;
        });
    }
}

// What an edge does, if it is left in: the plain mean of whole traces is too short, and would be flagged.
TEST(Verdicts, LeaveOutTheEdge)
{
    const Scene scene = examples()[0].scene;
    double plain = 0, corrected = 0;
    const int realizations = 300;
    for (int r = 0; r < realizations; ++r) {
        Network network;
        network.joints = sampling::sample_joints(scene, 5, r);
        double sum = 0;
        int count = 0;
        for (std::size_t t = 0; t < network.joints.trace_joint.size(); ++t) {
            const auto inside = [](const Eigen::Vector2d& p) {
                return p.x() > 10 && p.x() < 110 && p.y() > -20 && p.y() < 40;
            };
            if (inside(network.joints.trace_from[t]) && inside(network.joints.trace_to[t])) {
                sum += (network.joints.trace_to[t] - network.joints.trace_from[t]).norm();
                ++count;
            }
        }
        plain += sum / count / realizations;
        const Statistics rows = statistics_of(scene, network);
        for (std::size_t i = 0; i < rows.quantity.size(); ++i)
            if (rows.quantity[i] == "trace length, mean")
                corrected += rows.achieved[i] / realizations;
    }
    EXPECT_LT(plain, 5.8);
    EXPECT_NEAR(corrected, 6, .1);
}

TEST(Verdicts, AreWithheldFromSmallSamples)
{
    Scene scene = examples()[0].scene;
    stretch(scene.joint_sets[0].spacing, 10);
    const Statistics rows = report_of(scene, scene, 0);
    ASSERT_GT(rows.quantity.size(), 5u);
    for (std::size_t i = 0; i < rows.quantity.size(); ++i)
        if (rows.quantity[i].starts_with("trace angle") || rows.quantity[i].starts_with("spacing")) {
            EXPECT_EQ(rows.verdict[i], static_cast<Index>(Verdict::too_few)) << rows.quantity[i];
            EXPECT_EQ(rows.is_tested[i], 0) << rows.quantity[i];
        }
    EXPECT_NE(table(rows).find("too few"), std::string::npos);
}

// Ten are a sample, nine are not.
TEST(Verdicts, OfALawNeedTen)
{
    std::map<std::string, std::map<Index, int>> sizes; // of laws: how often there are nine, and ten
    std::vector<Example> all = examples();
    for (const Example& example : other_kinds())
        all.push_back(example);
    for (Example& example : all) {
        JointSet& set = example.scene.joint_sets[0];
        if (set.spacing.kind == Kind::constant)
            continue; // judged without a sample
        if (set.density)
            set.density->value /= 15;
        if (!set.density || set.kind == SetKind::lines)
            stretch(set.spacing, 4);
        for (int r = 0; r < 60; ++r) {
            const Statistics rows = report_of(example.scene, example.scene, r);
            for (std::size_t i = 0; i < rows.quantity.size(); ++i) {
                if (!rows.quantity[i].ends_with(", law") ||
                    rows.verdict[i] == static_cast<Index>(Verdict::none))
                    continue;
                EXPECT_EQ(rows.verdict[i] == static_cast<Index>(Verdict::too_few), rows.sample_size[i] < 10)
                    << example.name << ": " << rows.quantity[i] << " of " << rows.sample_size[i];
                ++sizes[rows.quantity[i]][rows.sample_size[i]];
            }
        }
    }
    for (auto& [quantity, count] : sizes) {
        EXPECT_GT(count[9], 0) << quantity;
        EXPECT_GT(count[10], 0) << quantity;
    }
    EXPECT_GE(sizes.size(), 4u);
}

// The interval of the mean pole's angle off its target contains 0 where the p-value of the target is above 1 less the confidence, 0.05. The
// concentration is that of the law on average: its estimate has no bias.
TEST(Verdicts, OfTheMeanPoleAgreeWithItsInterval)
{
    const Scene drawn_from = examples()[3].scene; // some 20 poles
    Scene held_against = drawn_from;
    held_against.joint_sets[0].orientation->dip += 4 * deg;
    int contain = 0, all = 0;
    double concentration = 0;
    for (int r = 0; r < 300; ++r) {
        const Statistics rows = report_of(drawn_from, held_against, r);
        const std::size_t row = row_of(rows, "", "mean pole, off its target"),
                          of_concentration = row_of(rows, "", "pole concentration");
        if (rows.is_tested[row] == 0)
            continue; // fewer than ten
        EXPECT_EQ(rows.low[row] == 0, rows.p_value[row] >= .05) << rows.p_value[row];
        contain += rows.low[row] == 0;
        concentration += rows.achieved[of_concentration] / rows.target[of_concentration];
        ++all;
    }
    EXPECT_NEAR(concentration / all, 1,
                3.3 / std::sqrt(17. * all)); // deviation of one over sqrt(n - 3), n about 20
    EXPECT_GT(contain, all / 10);
    EXPECT_LT(contain, all * 9 / 10);
}

// Constants leave nothing to chance.
TEST(Verdicts, OfConstantsAreExact)
{
    const Example example = examples()[1];
    Scene turned = example.scene;
    turned.joint_sets[0].trace_angle->mean += .001 * deg;
    for (const auto& [scene, wanted] : {std::pair{example.scene, Verdict::pass}, {turned, Verdict::fail}}) {
        const Statistics rows = report_of(scene, example.scene, 0);
        EXPECT_EQ(rows.verdict[row_of(rows, "", "trace angle")], static_cast<Index>(wanted));
    }
    Scene constant = example.scene;
    constant.joint_sets[0].spacing = {Kind::constant, 3, 0};
    constant.joint_sets[0].length = ProbabilityLaw{Kind::constant, 5, 0};
    EXPECT_FALSE(fails(report_of(constant, constant, 0)));
    Scene other = constant;
    other.joint_sets[0].spacing.mean = 3.001;
    EXPECT_TRUE(fails(report_of(other, constant, 0)));
    other = constant;
    other.joint_sets[0].length->mean = 5.001;
    EXPECT_TRUE(fails(report_of(other, constant, 0)));
}

} // namespace verdicts_test
