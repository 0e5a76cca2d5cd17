// Whole analyses of a small section: which steps are made, and that those rejected leave nothing behind.

#include "../mechanics/sections.hpp"

#include "analysis/analysis.hpp"
#include "analysis/safety.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <numeric>

namespace analysis_test
{

using namespace jointcreep;
using analysis::Analysis;
using analysis::Recording;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

constexpr double day = unit::day;

// 20 m x 10 m on three joints that creep, along the normal with K / E = 4 at a rate of 1 / 2 days, in shear
// with K / E = 1 at 1 / 8 days. Its right side leaves on day 1, and the joints left open and slip.
struct Study {
    Scene scene;
    Network network;
    EquivalentJoints joints;

    explicit Study(bool excavated = true)
    {
        scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
        scene.zone_size = 2.5;
        scene.gravity = 9.81;
        scene.in_situ_stress.elevation = 10;
        scene.in_situ_stress.gradient_yy = 2700 * 9.81;
        scene.in_situ_stress.gradient_xx = 0.3 * 2700 * 9.81;
        scene.boundaries = {{.from = {0, 0}, .to = {20, 0}, .fix_x = true, .fix_y = true},
                            {.from = {0, 0}, .to = {0, 10}, .fix_x = true},
                            {.from = {20, 0}, .to = {20, 10}, .fix_x = true}};
        scene.points = {{"top", {5, 10}, 0}, {"toe", {12.5, 5}, 0}};
        scene.end = 30 * day;
        scene.creep.emplace().step = day;
        scene.equilibrium = {.tolerance = 1e-8, .unloading_increments = 1, .most_steps = 400000};
        if (excavated)
            scene.stages = {{"corner", day, {{{13, 3}, {21, 3}, {21, 11}, {13, 11}}}}};
        add_joint(network.joints, {-1, 3}, {21, 4});
        add_joint(network.joints, {6, -1}, {9, 11});
        add_joint(network.joints, {11.5, -1}, {12, 11});
        cut();
    }
    // After changing what makes up the section.
    void cut()
    {
        network.names = names_of(scene);
        network.names.joint_set = {"joint"};
        network.blocks = blocks::cut(scene, network.joints);
        joints = joints_everywhere(scene, network.blocks, 1e9, 4e8, 0.35);
        for (std::size_t e = 0; e < joints.normal_stiffness.size(); ++e) {
            joints.normal_kelvin_stiffness[e] = joints.normal_stiffness[e] / 4;
            joints.shear_kelvin_stiffness[e] = joints.shear_stiffness[e];
            joints.normal_kelvin_viscosity[e] = joints.normal_kelvin_stiffness[e] * 2 * day;
            joints.shear_kelvin_viscosity[e] = joints.shear_kelvin_stiffness[e] * 8 * day;
        }
    }
    // By its error, beginning with `first` [s].
    void choose_steps(double tolerance, double first)
    {
        scene.creep->step.reset();
        scene.creep->tolerance = tolerance;
        scene.creep->first_step = first;
    }
    Analysis analysis(int threads = 1) const
    {
        return {scene, network, joints, threads, recording, [](const analysis::Progress&) {}};
    }
    Result run(int threads = 1) const
    {
        Analysis analysed = analysis(threads);
        analysed.run();
        return analysed.result();
    }

    Recording recording;
};

Index sum(const std::vector<Index>& numbers)
{
    return std::accumulate(numbers.begin(), numbers.end(), Index{0});
}

Index rejected(const Result& result)
{
    return sum(result.equilibria.searches) - static_cast<Index>(result.equilibria.searches.size());
}

double largest_difference(const Result& a, const Result& b)
{
    const std::size_t n = a.mesh.gridpoint.size();
    double largest = 0;
    for (std::size_t g = 0; g < n; ++g)
        largest = std::max(largest, (a.states.displacement[a.states.displacement.size() - n + g] -
                                     b.states.displacement[b.states.displacement.size() - n + g])
                                        .norm());
    return largest;
}

double largest_last(const Result& a)
{
    Result none = a;
    std::fill(none.states.displacement.begin(), none.states.displacement.end(), Vector2d::Zero());
    return largest_difference(a, none);
}

std::string refusal_of(const Study& study)
{
    try {
        study.analysis();
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST(analysis, steps_of_a_fixed_length_are_equal_up_to_each_date)
{
    Study study;
    study.scene.creep->step = 0.7 * day;
    study.scene.creep->scheme = CreepScheme::backward; // not cut where contacts close
    study.scene.end = 3 * day;
    const Result result = study.run();
    const std::vector<double> expected{0, 0.5, 1, 1, 1 + 2. / 3, 1 + 4. / 3, 3};
    ASSERT_EQ(result.history.time.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(result.history.time[i], expected[i], 1e-12) << i;
    EXPECT_EQ(result.history.time.back(), 3); // dates are met exactly
    EXPECT_EQ(result.history.event[3], "corner");
    EXPECT_EQ(rejected(result), 0);
}

TEST(analysis, something_happens_in_this_section)
{
    const Result result = Study().run();
    const auto n = static_cast<std::ptrdiff_t>(result.mesh.contact_edge.size());
    std::map<Index, int> numbers;
    std::for_each(result.states.contact_status.end() - n, result.states.contact_status.end(),
                  [&](Index status) { ++numbers[status]; });
    EXPECT_GT(numbers[static_cast<Index>(ContactStatus::removed)], 0);
    EXPECT_GT(numbers[static_cast<Index>(ContactStatus::slipping)] +
                  numbers[static_cast<Index>(ContactStatus::open)],
              0);
    EXPECT_GT(largest_last(result), 1e-4);
    for (const double ratio : result.equilibria.unbalanced_force_ratio)
        EXPECT_LE(ratio, 1e-8);
    EXPECT_EQ(sum(result.equilibria.is_implicit), static_cast<Index>(result.equilibria.is_implicit.size()));
}

// By relaxation, which keeps no memory, to the last bit: a first step of 9 days that is rejected for one of
// 1.8 days is the same as beginning with that. Rock creeps, too, and a boundary moves.
TEST(analysis, rejected_steps_leave_no_trace)
{
    Study study(false);
    study.scene.rocks[0].kelvin = ShearKelvin{1e10, 1e10 * day};
    study.scene.boundaries[2].displacement = Vector2d(-2e-3, 0);
    study.scene.boundaries[2].load_history = {{{0, 0}, {30 * day, 1}}};
    study.scene.equilibrium.engine = EngineChoice::relaxation;
    study.scene.equilibrium.tolerance = 1e-6;
    study.choose_steps(3e-7, 9 * day);
    study.scene.creep->shortest_step = 1e-3 * day;
    const Result one = study.run();
    study.choose_steps(3e-7, 9 * day * 0.2);
    const Result other = study.run();
    EXPECT_GT(rejected(one), rejected(other));
    EXPECT_EQ(one.history.time, other.history.time);
    EXPECT_EQ(one.history.displacement, other.history.displacement);
    EXPECT_EQ(one.states.displacement, other.states.displacement);
    EXPECT_EQ(one.states.stress, other.states.stress);
    EXPECT_EQ(one.states.traction, other.states.traction);
    EXPECT_GT(largest_last(one), 1e-3);
}

TEST(analysis, with_a_tolerance_the_first_step_does_not_matter)
{
    Study study;
    const double tolerance = 1e-6;
    study.scene.end = 3 * day; // while creep is under way
    study.choose_steps(tolerance, 0.01 * day);
    const Result fine = study.run();
    for (const double first : {0.1, 0.5, 2.0}) {
        study.choose_steps(tolerance, first * day);
        const Result result = study.run();
        EXPECT_LT(largest_difference(result, fine), tolerance) << first;
        EXPECT_EQ(rejected(result) > 0, first > 1) << first;
        EXPECT_EQ(result.history.time.back(), 3);
    }
    EXPECT_GT(largest_last(fine), 100 * tolerance);
}

TEST(analysis, a_published_step_at_its_limit_or_beyond_is_refused)
{
    Study study;
    study.scene.creep->scheme = CreepScheme::published;
    // (1 - exp(-x)) (1 + K / E) = 2 at the limit
    const double limit = -std::log1p(-2. / 5) * 2;
    study.scene.creep->step = 1.0001 * limit * day;
    const std::string refusal = refusal_of(study);
    EXPECT_NE(refusal.find("joint \"joint\""), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("stable only below 1.0216"), std::string::npos) << refusal;
    study.scene.creep->step = 0.9999 * limit * day;
    EXPECT_EQ(refusal_of(study), "");
    study.scene.creep->scheme = CreepScheme::fitted;
    study.scene.creep->step = 10 * day;
    EXPECT_EQ(refusal_of(study), "");
}

TEST(analysis, more_steps_than_anyone_wants_are_refused)
{
    Study study;
    study.scene.creep->step = 1e-6 * day;
    EXPECT_THROW(study.analysis().run(), input_error);
}

TEST(analysis, the_stop_rate_ends_creep_after_the_last_stage)
{
    Study study;
    study.scene.end = 300 * day;
    study.scene.points.push_back({"late", {5, 10}, 200 * day});
    const double rate = 1e-6 / day;
    study.scene.creep->stop_rate = rate;
    Analysis analysis = study.analysis();
    analysis.run();
    ASSERT_TRUE(analysis.end_of_creep());
    const History& history = analysis.result().history;
    EXPECT_EQ(history.time.back(), *analysis.end_of_creep() / day);
    EXPECT_GT(history.time.back(), 2);
    EXPECT_LT(history.time.back(), 200);
    EXPECT_EQ(history.first_reading_row.back(), static_cast<Index>(history.time.size()) - 1);
    // No point moves faster in the last step; some do in the step before, or other rock did.
    const std::size_t points = history.point.size(), rows = history.time.size();
    for (std::size_t p = 0; p < points; ++p)
        EXPECT_LT(
            (history.displacement[(rows - 1) * points + p] - history.displacement[(rows - 2) * points + p])
                .norm(),
            rate * day * (history.time[rows - 1] - history.time[rows - 2]));

    study.scene.stages[0].time = 100 * day; // nothing creeps before, and that ends nothing
    Analysis late = study.analysis();
    late.run();
    ASSERT_TRUE(late.end_of_creep());
    EXPECT_GT(*late.end_of_creep(), 101 * day);
    study.scene.end = 102 * day;
    study.scene.points.back().first_reading = 0;
    Analysis never = study.analysis();
    never.run();
    EXPECT_FALSE(never.end_of_creep());
    EXPECT_EQ(never.result().history.time.back(), 102);
}

// Where joints slip the engines go different ways; here they do not.
TEST(analysis, both_engines_agree)
{
    Study study;
    for (double* strength : {&study.joints.cohesion[0], &study.joints.tensile_strength[0]})
        std::fill(strength, strength + study.joints.cohesion.size(), 1e12);
    study.scene.end = 4 * day;
    const Result implicit = study.run();
    study.scene.equilibrium.engine = EngineChoice::relaxation;
    const Result relaxation = study.run();
    EXPECT_EQ(implicit.history.time, relaxation.history.time);
    EXPECT_EQ(sum(relaxation.equilibria.is_implicit), 0);
    EXPECT_LT(largest_difference(implicit, relaxation), 1e-5 * largest_last(relaxation));
}

TEST(analysis, tells_where_it_is_and_how_searches_go)
{
    for (const EngineChoice engine : {EngineChoice::implicit, EngineChoice::relaxation}) {
        Study study;
        study.scene.equilibrium.engine = engine;
        double fraction = 0;
        Index searches = 0;
        std::string what, first;
        std::optional<double> time;
        const auto look = [&](const analysis::Progress& now) {
            EXPECT_GE(now.fraction, fraction);
            EXPECT_LE(now.fraction, 1);
            if (now.what == study.scene.stages.back().name) {
                EXPECT_LT(now.fraction, 1) << "its equilibrium is searched for";
            }
            fraction = now.fraction;
            what = now.what;
            time = now.time;
            if (first.empty())
                first = now.what;
            EXPECT_EQ(now.time.has_value(), now.what != "in-situ equilibrium");
            if (now.search == nullptr)
                return;
            ++searches;
            EXPECT_GE(now.search->steps, 0);
            EXPECT_TRUE(std::isfinite(now.search->unbalanced_force_ratio));
            EXPECT_EQ(now.tolerance, study.scene.equilibrium.tolerance);
        };
        Analysis analysed(study.scene, study.network, study.joints, 1, {}, look);
        analysed.run();
        EXPECT_GT(searches, 2);
        EXPECT_GT(fraction, 0);
        EXPECT_EQ(first, "in-situ equilibrium");
        EXPECT_EQ(what, "") << "creep, at a time";
        EXPECT_GT(time.value_or(0), 0);
    }
}

TEST(analysis, what_stops_keeps_the_states_so_far)
{
    const Study study;
    analysis::Trial trial(study.scene, study.network, study.joints, 1,
                          std::numeric_limits<double>::infinity(), 1, {}, [](const analysis::Progress& now) {
                              if (now.time > 2 * day)
                                  throw analysis::Stopped();
                          });
    EXPECT_FALSE(trial.is_stopped());
    trial.run();
    EXPECT_TRUE(trial.is_stopped());
    EXPECT_EQ(trial.analysis().result().failure.reason, "stopped by a signal");
    EXPECT_EQ(trial.outcome().ending, analysis::Ending::undecided);
    EXPECT_GT(trial.analysis().result().states.time.size(), 1);
}

TEST(analysis, threads_do_not_change_the_result)
{
    Study study;
    study.scene.end = 3 * day;
    study.scene.zone_size = 0.35; // enough zones for two
    study.scene.creep->step = 2 * day;
    const Result one = study.run(), two = study.run(2);
    ASSERT_GT(one.mesh.zone_gridpoint.size(), 2000u);
    EXPECT_EQ(one.states.displacement, two.states.displacement);
    EXPECT_EQ(one.states.traction, two.states.traction);
}

TEST(analysis, the_implicit_engine_has_no_step_history)
{
    Study study;
    study.scene.equilibrium.engine = EngineChoice::implicit;
    study.recording.step_history_every = 10;
    EXPECT_NE(refusal_of(study), "");
    study.scene.equilibrium.engine = EngineChoice::automatic;
    EXPECT_EQ(study.analysis().engine(), EngineChoice::relaxation);
}

// What is written at a moment, and the moment's number among all.
struct Kept {
    Result so_far;
    Checkpoint checkpoint;
};

std::vector<Kept> kept_by(Study study, std::chrono::duration<double> every)
{
    std::vector<Kept> kept;
    study.recording.keep_every = every;
    study.recording.keep = [&](const Result& so_far, const Checkpoint& checkpoint) {
        kept.push_back({so_far, checkpoint});
    };
    study.run();
    return kept;
}

void expect_same(const Result& a, const Result& b)
{
    EXPECT_EQ(a.mesh.gridpoint, b.mesh.gridpoint);
    EXPECT_EQ(a.history.time, b.history.time);
    EXPECT_EQ(a.history.displacement, b.history.displacement);
    EXPECT_EQ(a.history.first_reading_row, b.history.first_reading_row);
    EXPECT_EQ(a.states.time, b.states.time);
    EXPECT_EQ(a.states.displacement, b.states.displacement);
    EXPECT_EQ(a.states.reaction, b.states.reaction);
    EXPECT_EQ(a.states.stress, b.states.stress);
    EXPECT_EQ(a.states.traction, b.states.traction);
    EXPECT_EQ(a.states.initial_gap, b.states.initial_gap);
    EXPECT_EQ(a.equilibria.steps, b.equilibria.steps);
    EXPECT_EQ(a.equilibria.searches, b.equilibria.searches);
    EXPECT_EQ(a.equilibria.solves, b.equilibria.solves);
    EXPECT_EQ(a.equilibria.damped_energy, b.equilibria.damped_energy);
    EXPECT_EQ(a.equilibria.remaining_displacement, b.equilibria.remaining_displacement);
    EXPECT_EQ(a.step_history.solver_time, b.step_history.solver_time);
    EXPECT_EQ(a.guards.weight_error, b.guards.weight_error);
    EXPECT_EQ(a.guards.penetration, b.guards.penetration);
    EXPECT_EQ(a.step_history.displacement, b.step_history.displacement);
    EXPECT_EQ(a.dynamics.stored_energy, b.dynamics.stored_energy);
    EXPECT_EQ(a.dynamics.damped_energy, b.dynamics.damped_energy);
    EXPECT_EQ(a.dynamics.contact_traction, b.dynamics.contact_traction);
}

// Runs continued from some of all moments have the whole run's result. Returns how many moments there are in searches.
std::ptrdiff_t expect_same_from_everywhere(const Study& study)
{
    const Result whole = study.run();
    const std::vector<Kept> kept = kept_by(study, std::chrono::duration<double>(0));
    const std::size_t stride = std::max<std::size_t>(1, kept.size() / 23);
    for (std::size_t i = 0; i < kept.size(); i += stride) {
        Analysis continued = study.analysis();
        continued.go_on(kept[i].so_far, kept[i].checkpoint);
        SCOPED_TRACE("moment " + std::to_string(i) + " of " + std::to_string(kept.size()));
        expect_same(whole, continued.result());
        if (testing::Test::HasFailure())
            break;
    }
    return std::count_if(kept.begin(), kept.end(),
                         [](const Kept& one) { return !one.checkpoint.search.empty(); });
}

TEST(analysis, continues_from_the_middle_of_a_dynamic_relaxation)
{
    for (const Damping damping :
         {Damping::adaptive, Damping::kinetic, Damping::local, Damping::combined, Damping::mass}) {
        Study study;
        study.scene.end = 2 * day;
        study.scene.equilibrium.engine = EngineChoice::relaxation;
        study.scene.equilibrium.tolerance = 1e-4;
        study.scene.equilibrium.unloading_increments = 2;
        study.scene.equilibrium.damping = damping;
        study.scene.equilibrium.local_damping = 0.8;
        if (damping == Damping::mass) {
            study.scene.equilibrium.masses = Masses::real;
            study.scene.equilibrium.mass_damping = 60;
            study.scene.equilibrium.stiffness_damping = 1e-4;
        }
        if (damping == Damping::local)
            study.recording.step_history_every = 70;
        EXPECT_GT(expect_same_from_everywhere(study), 20) << static_cast<int>(damping);
    }
}

// The implicit engine forgets what it has learnt after every 50th step.
TEST(analysis, continues_from_between_two_creep_steps)
{
    Study study;
    study.scene.creep->step = 0.1 * day;
    study.scene.end = 16 * day;
    study.recording.state_every = 7;
    EXPECT_EQ(expect_same_from_everywhere(study), 0);
    const std::vector<Kept> kept = kept_by(study, std::chrono::duration<double>(0));
    EXPECT_EQ(kept.size(), 1u + 1 + 2); // the beginning, the stage, and after 50 and 100 steps
    EXPECT_EQ(kept_by(study, std::chrono::hours(1)).size(), 1u);
}

TEST(analysis, continues_where_creep_steps_are_chosen_and_cut)
{
    Study study;
    study.choose_steps(1e-6, 0.01 * day);
    study.scene.creep->scheme = CreepScheme::fitted;
    EXPECT_EQ(expect_same_from_everywhere(study), 0);
    study.scene.equilibrium.engine = EngineChoice::relaxation;
    study.scene.equilibrium.tolerance = 1e-6;
    study.scene.end = 4 * day;
    EXPECT_GT(expect_same_from_everywhere(study), 20);
}

TEST(analysis, a_search_of_another_run_is_refused)
{
    Study study;
    study.scene.end = 2 * day;
    study.scene.equilibrium.engine = EngineChoice::relaxation;
    std::vector<Kept> kept = kept_by(study, std::chrono::duration<double>(0));
    Kept& last = kept.back();
    ASSERT_FALSE(last.checkpoint.search.empty());
    const auto refuses = [&](const Checkpoint& checkpoint) {
        Analysis continued = study.analysis();
        EXPECT_THROW(continued.go_on(last.so_far, checkpoint), input_error);
    };
    Checkpoint other = last.checkpoint;
    other.search.pop_back();
    refuses(other);
    other.search.insert(other.search.end(), 2, 0.0);
    refuses(other);
    other = last.checkpoint;
    other.search[0] += 1; // the number of gridpoints
    refuses(other);
    other = last.checkpoint;
    other.stage = 7;
    refuses(other);
}

} // namespace analysis_test
