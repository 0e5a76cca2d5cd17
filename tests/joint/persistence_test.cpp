// The persistence of sampled joints is the one wanted, within the error that it is said to have.

#include "joint/pieces.hpp"
#include "sampling/joint_sets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace persistence_test
{

using namespace jointcreep;
using namespace jointcreep::joint;

namespace
{

// Mean and mean square over realizations of (persistence found - wanted) / its standard error.
std::pair<double, double> deviations(const ProbabilityLaw& length, double persistence, int realizations)
{
    Scene scene;
    scene.outline = {{0, 0}, {90, 0}, {90, 40}, {50, 60}, {0, 60}};
    scene.joint_materials = {{"joint", 1e9, 1e9, 0, .5, 0}};
    JointSet set;
    set.name = "set";
    set.material = "joint";
    set.trace_angle = ProbabilityLaw{ProbabilityLaw::Kind::normal, .4, .05};
    set.spacing = {ProbabilityLaw::Kind::negative_exponential, 6, 6};
    set.length = length;
    set.persistence = persistence;
    scene.joint_sets = {set};
    double sum = 0, squares = 0;
    for (int realization = 0; realization < realizations; ++realization) {
        const Pieces pieces =
            pieces_of(sampling::sample_joints(scene, 20260501, realization), scene.outline, {});
        double joint = 0, all = 0;
        for (std::size_t line = 0; line < pieces.line_length.size(); ++line) {
            joint += pieces.line_length[line] * pieces.line_persistence[line];
            all += pieces.line_length[line];
        }
        const double off =
            (joint / all - persistence) / persistence_error(length, persistence, pieces.line_length);
        sum += off;
        squares += off * off;
    }
    return {sum / realizations, squares / realizations};
}

} // namespace

// By 400 realizations the mean is known to 1 / 20, and the mean square of a normal variable to sqrt(2) / 20.
// Four times that is allowed for; lines of some traces only are less spread than the error says, by the ends
// of their traces.
TEST(Persistence, OfSampledJointsIsWithinItsError)
{
    const ProbabilityLaw lognormal{ProbabilityLaw::Kind::lognormal, 3, 1.5},
        exponential{ProbabilityLaw::Kind::negative_exponential, 3, 3};
    for (const ProbabilityLaw& length : {lognormal, exponential})
        for (const double persistence : {.4, .8}) {
            const auto [mean, square] = deviations(length, persistence, 400);
            EXPECT_NEAR(mean, 0, 4. / 20) << persistence;
            EXPECT_GT(square, 1 - 4 * std::numbers::sqrt2 / 20 - .1) << persistence;
            EXPECT_LT(square, 1 + 4 * std::numbers::sqrt2 / 20) << persistence;
        }
}

} // namespace persistence_test
