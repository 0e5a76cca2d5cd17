// Sensitivities of whole analyses against central differences of whole runs.

#include "jointed_section.hpp"

#include "analysis/analysis.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <gtest/gtest.h>

namespace sensitivity_test
{

using namespace jointcreep;
using analysis::Analysis;
using analysis::Recording;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

constexpr double day = unit::day;

const std::vector<Scaled> all{Scaled::kelvin_stiffness,
                              Scaled::kelvin_viscosity,
                              Scaled::joint_stiffness,
                              Scaled::horizontal_stress,
                              // of one direction
                              {Scaled::kelvin_stiffness, 0},
                              {Scaled::kelvin_viscosity, 1},
                              {Scaled::joint_stiffness, 1},
                              // and of one material
                              {Scaled::joint_stiffness, Scaled::both, 1},
                              {Scaled::kelvin_stiffness, 1, 0}};

constexpr std::size_t whole = 4; // of `all` those of all joints in both directions

struct Study : JointedSection {
    explicit Study(std::optional<double> friction_angle = {}) : JointedSection(friction_angle)
    {
        // Every other edge is of another material.
        for (std::size_t e = 0; e < joints.normal_stiffness.size(); ++e)
            joints.material.push_back(static_cast<Index>(e % 2));
    }

    struct Found {
        History history;
        std::vector<std::vector<Vector2d>> sensitivities;
        Index slipping = 0, open = 0, slipping_in_situ = 0;
    };
    Found run(bool with_sensitivities, Scaled parameter = {}, double logarithm = 0) const
    {
        Scene changed = scene;
        EquivalentJoints stiffer = joints;
        sensitivity::scale(stiffer, changed.in_situ_stress, parameter, std::exp(logarithm));
        const Recording recording{0, 0, with_sensitivities ? all : std::vector<Scaled>{}};
        Analysis analysis(changed, network, stiffer, 1, recording, [](const analysis::Progress&) {});
        analysis.run();
        Found found{analysis.result().history, analysis.sensitivities()};
        const std::vector<Index>& status = analysis.result().states.contact_status;
        found.slipping = static_cast<Index>(
            std::count(status.begin(), status.end(), static_cast<Index>(ContactStatus::slipping)));
        for (const auto& [joint, n] : analysis.findings().at_yield_in_situ)
            found.slipping_in_situ += n;
        found.open = static_cast<Index>(
            std::count(status.begin(), status.end(), static_cast<Index>(ContactStatus::open)));
        return found;
    }

    // The largest difference over rows and points between a sensitivity and the central difference of runs,
    // over the largest sensitivity to the parameter, which is to be at least 1e-5 m, a tenth of it for a part of the
    // joints, which is then taken as 1e-5 m.
    double error(Scaled parameter, double h) const
    {
        const Found middle = run(true), below = run(false, parameter, -h), above = run(false, parameter, h);
        if (middle.history.time != below.history.time || middle.history.time != above.history.time)
            return 1e9;
        const auto p = static_cast<std::size_t>(std::find(all.begin(), all.end(), parameter) - all.begin());
        double largest = 0, difference = 0;
        for (std::size_t i = 0; i < middle.sensitivities[p].size(); ++i) {
            const Vector2d by_runs =
                (above.history.displacement[i] - below.history.displacement[i]) / (2 * h);
            largest = std::max(largest, by_runs.norm());
            difference = std::max(difference, (middle.sensitivities[p][i] - by_runs).norm());
        }
        // Differences have an error of their own, whatever their size.
        constexpr double small = 1e-5; // [m]
        const bool has_effect = largest > (p < whole ? 1 : 0.1) * small;
        return has_effect ? difference / std::max(largest, small) : 1e9;
    }
    double largest_error(double h) const
    {
        double largest = 0;
        for (const Scaled parameter : all)
            largest = std::max(largest, error(parameter, h));
        return largest;
    }
};

const std::vector<CreepScheme> schemes{CreepScheme::published, CreepScheme::backward,
                                       CreepScheme::linear_force, CreepScheme::fitted};

} // namespace

TEST(sensitivity, of_joints_that_hold_is_that_of_whole_runs)
{
    for (const CreepScheme scheme : schemes) {
        Study study;
        study.scene.creep->scheme = scheme;
        study.scene.creep->step = 0.5 * day;
        EXPECT_LT(study.largest_error(3e-4), 1e-7) << static_cast<int>(scheme);
    }
}

TEST(sensitivity, of_joints_that_slip_open_and_close_is_that_of_whole_runs)
{
    for (const CreepScheme scheme : schemes)
        for (const double friction_angle : {0.6, 0.5, 0.35}) {
            Study study(friction_angle);
            study.scene.creep->scheme = scheme;
            const Study::Found found = study.run(true);
            EXPECT_GT(found.slipping, 2);
            EXPECT_GT(found.open, 3);
            EXPECT_LT(study.largest_error(1e-4), 1e-6) << static_cast<int>(scheme) << ' ' << friction_angle;
        }
}

TEST(sensitivity, of_stress_by_a_profile_is_that_of_whole_runs)
{
    Study study;
    InSituStress& stress = study.scene.in_situ_stress;
    stress.ground = {{0, 10}, {20, 10}};
    stress.profile = {{0, 5e4, 0, 0}, {4, 3e5, 4 * 2700 * 9.81, 0}, {10, 4e5, 10 * 2700 * 9.81, 0}};
    EXPECT_LT(study.error(Scaled::horizontal_stress, 3e-4), 1e-7);
}

TEST(sensitivity, of_joints_that_dilate_is_that_of_whole_runs)
{
    for (const CreepScheme scheme : {CreepScheme::backward, CreepScheme::fitted})
        for (const double friction_angle : {0.8, 0.5, 0.35}) {
            Study study(friction_angle);
            study.scene.creep->scheme = scheme;
            std::fill(study.joints.dilation_angle.begin(), study.joints.dilation_angle.end(), 0.2);
            EXPECT_LT(study.largest_error(1e-4), 1e-6) << static_cast<int>(scheme) << ' ' << friction_angle;
            std::fill(study.joints.dilation_until.begin(), study.joints.dilation_until.end(), 1e-5);
            EXPECT_LT(study.largest_error(1e-4), 1e-6) << static_cast<int>(scheme) << ' ' << friction_angle;
        }
}

// Their friction is that of joints that have slipped before. (A change that decides whether a joint breaks in
// a step has no derivative; the cohesion is one at which none of these does.)
TEST(sensitivity, of_joints_that_weaken_is_that_of_whole_runs)
{
    for (const CreepScheme scheme : {CreepScheme::backward, CreepScheme::fitted})
        for (const double dilation_angle : {0.0, 0.2}) {
            Study study(0.6);
            study.scene.creep->scheme = scheme;
            for (std::size_t e = 0; e < study.joints.law.size(); ++e) {
                study.joints.law[e] = 1; // residual strength
                study.joints.cohesion[e] = 6e3;
                study.joints.own["residual_cohesion"][e] = 2e3;
                study.joints.own["residual_friction_angle"][e] = 0.4;
                study.joints.dilation_angle[e] = dilation_angle;
            }
            const Study::Found weak = study.run(false);
            EXPECT_GT(weak.slipping, 2);
            EXPECT_LT(study.largest_error(1e-4), 1e-6) << static_cast<int>(scheme) << ' ' << dilation_angle;
        }
}

// With these joints slip before anything is dug.
TEST(sensitivity, of_in_situ_slip_is_that_of_whole_runs)
{
    Study study(0.35);
    study.scene.in_situ_stress.compression_xx = 0;
    study.scene.in_situ_stress.gradient_xx = 0.2 * 2700 * 9.81;
    EXPECT_GT(study.run(true).slipping_in_situ, 0);
    EXPECT_LT(study.largest_error(1e-4), 1e-6);
}

TEST(sensitivity, of_unloading_in_increments_is_that_of_whole_runs)
{
    for (const double friction_angle : {0.2, 0.4}) {
        Study study(friction_angle);
        study.scene.equilibrium.unloading_increments = 4;
        // Where joints dilate and slip back the end depends on the way there.
        std::fill(study.joints.dilation_angle.begin(), study.joints.dilation_angle.end(), 0.15);
        EXPECT_LT(study.largest_error(1e-4), 1e-6) << friction_angle;
    }
}

TEST(sensitivity, of_chains_dashpots_and_creeping_rock_is_that_of_whole_runs)
{
    for (const std::optional<double> friction_angle : {std::optional<double>{}, std::optional<double>{0.5}}) {
        Study study(friction_angle);
        study.scene.rocks[0].kelvin = ShearKelvin{2e9, 4e9 * day};
        study.scene.rocks[0].maxwell_viscosity = 1e11 * day;
        EquivalentJoints& joints = study.joints;
        for (auto* list : {&joints.normal_kelvin_stiffness, &joints.shear_kelvin_stiffness,
                           &joints.normal_kelvin_viscosity, &joints.shear_kelvin_viscosity}) {
            std::vector<double> two;
            for (const double value : *list) {
                two.push_back(value);
                two.push_back(3 * value);
            }
            *list = two;
        }
        for (std::size_t e = 0; e < joints.normal_stiffness.size(); ++e) {
            joints.normal_maxwell_viscosity[e] = joints.normal_stiffness[e] * 50 * day;
            joints.shear_maxwell_viscosity[e] = joints.shear_stiffness[e] * 90 * day;
        }
        EXPECT_LT(study.largest_error(1e-4), 1e-6) << friction_angle.value_or(0);
    }
}

// Loads on the outline that change while joints creep, and do not depend on the parameters.
TEST(sensitivity, of_loads_over_time_is_that_of_whole_runs)
{
    Study study;
    study.scene.boundaries[2].displacement = Vector2d(-1e-3, 0);
    study.scene.boundaries[2].load_history = {{{0, 0}, {7.3 * day, 1}, {12 * day, 0.5}}};
    EXPECT_LT(study.largest_error(2e-4), 1e-7);
}

// Steps chosen by their error are taken as they are; a run at another parameter chooses others, which makes
// the difference of runs rough.
TEST(sensitivity, of_chosen_steps_is_nearly_that_of_whole_runs)
{
    Study study(0.5);
    study.scene.creep->step.reset();
    study.scene.creep->tolerance = 1e-7;
    study.scene.creep->longest_step = 2 * day;
    const Study::Found middle = study.run(true), below = study.run(false, Scaled::kelvin_stiffness, -0.01),
                       above = study.run(false, Scaled::kelvin_stiffness, 0.01);
    for (int point = 0; point < 2; ++point) {
        const auto last = [point](const auto& rows) { return *(rows.end() - 3 + point); };
        const Vector2d by_runs = (last(above.history.displacement) - last(below.history.displacement)) / 0.02;
        EXPECT_LT((last(middle.sensitivities[0]) - by_runs).norm(), 0.02 * by_runs.norm()) << point;
    }
}

// Each for its own reason.
TEST(sensitivity, says_of_which_joints_it_has_none)
{
    std::size_t refused = 0;
    for (std::size_t place = 0; place < joint::laws().size(); ++place) {
        const joint::LawInfo& law = joint::laws()[place];
        if (law.no_sensitivities.empty())
            continue;
        ++refused;
        Study study(0.5);
        study.joints.law.assign(study.joints.normal_stiffness.size(), static_cast<Index>(place));
        for (const std::string_view own : law.own)
            study.joints.own[std::string(own)].assign(study.joints.law.size(), 1);
        try {
            study.run(true);
            ADD_FAILURE() << law.name;
        } catch (const input_error& error) {
            EXPECT_NE(std::string_view(error.what()).find(law.no_sensitivities), std::string_view::npos)
                << error.what();
        }
    }
    EXPECT_EQ(refused, 2U); // Barton-Bandis, continuously yielding
}

TEST(sensitivity, dynamic_relaxation_has_none)
{
    Study study;
    study.scene.equilibrium.engine = EngineChoice::relaxation;
    EXPECT_THROW(study.run(true), input_error);
}

} // namespace sensitivity_test
