#include "sampling/joint_sets.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "sampling/streams.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace joint_sets_test
{

using namespace jointcreep;
using namespace jointcreep::sampling;
using namespace jointcreep::unit;
using Eigen::Vector2d, Eigen::Vector3d;

namespace
{

using Kind = ProbabilityLaw::Kind;

JointSet joint_set(const std::string& name, double angle, double scatter, double spacing, double persistence)
{
    JointSet set;
    set.name = name;
    set.material = "clay";
    set.trace_angle = ProbabilityLaw{Kind::normal, angle, scatter};
    set.spacing = {Kind::negative_exponential, spacing, spacing};
    set.length = ProbabilityLaw{Kind::lognormal, 5, 2};
    set.persistence = persistence;
    return set;
}

JointSet spatial_set(double dip, double dip_direction)
{
    JointSet set = joint_set("spatial", 0, 0, 2, 1);
    set.trace_angle.reset();
    set.dip = ProbabilityLaw{Kind::constant, dip, 0};
    set.dip_direction = ProbabilityLaw{Kind::constant, dip_direction, 0};
    return set;
}

Polygon box(double left, double bottom, double right, double top)
{
    return {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}

Scene scene_of(const std::vector<JointSet>& sets, const Polygon& outline = box(-10, -20, 60, 30))
{
    Scene scene;
    scene.outline = outline;
    scene.joint_materials = {{"rough", 1e9, 1e9, 0, .5, 0, {}}, {"clay", 1e8, 1e8, 0, .3, 0, {}}};
    scene.joint_sets = sets;
    return scene;
}

// One joint with its traces, as numbers that compare byte for byte.
using Row = std::vector<double>;
using Rows = std::map<Index, Row>; // by joint number

Rows rows(const Joints& joints, Index set, bool with_traces = true)
{
    Rows rows;
    const auto add = [](Row& row, const Vector2d& p) { row.insert(row.end(), {p.x(), p.y()}); };
    for (std::size_t j = 0; j < joints.set.size(); ++j)
        if (joints.set[j] == set) {
            Row& row = rows[joints.number[j]];
            EXPECT_TRUE(row.empty()) << "two joints have number " << joints.number[j];
            add(row, joints.from[j]);
            add(row, joints.to[j]);
        }
    for (std::size_t t = 0; with_traces && t < joints.trace_joint.size(); ++t) {
        const Index j = joints.trace_joint[t];
        if (joints.set[j] == set) {
            add(rows[joints.number[j]], joints.trace_from[t]);
            add(rows[joints.number[j]], joints.trace_to[t]);
        }
    }
    return rows;
}

bool is_inside(const Polygon& polygon, const Vector2d& p)
{
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if ((a.y() > p.y()) != (b.y() > p.y()) &&
            p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
            inside = !inside;
    }
    return inside;
}

std::string refusal(const Scene& scene)
{
    try {
        sample_joints(scene, 1, 0);
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

void expect_refusal(const Scene& scene, const std::vector<std::string>& parts)
{
    const std::string message = refusal(scene);
    for (const std::string& part : parts)
        EXPECT_NE(message.find(part), std::string::npos) << "\"" << message << "\" does not say " << part;
}

} // namespace

TEST(SectionNormal, IsThePlanesNormalLessItsPartAlongTheSectionsNormal)
{
    rc::check([] {
        const auto angle = [](double most) { return most * *rc::gen::inRange(0, 100001) / 1e5; };
        const double dip = angle(std::numbers::pi / 2), dip_direction = angle(2 * std::numbers::pi),
                     azimuth = angle(2 * std::numbers::pi);
        // In space x is east, y north, z up. The plane is spanned by its strike and its line of steepest
        // descent.
        const Vector3d strike(std::cos(dip_direction), -std::sin(dip_direction), 0);
        const Vector3d descent(std::cos(dip) * std::sin(dip_direction),
                               std::cos(dip) * std::cos(dip_direction), -std::sin(dip));
        const Vector3d normal = descent.cross(strike) * (descent.cross(strike).z() < 0 ? -1 : 1);
        const Vector3d e_x(std::sin(azimuth), std::cos(azimuth), 0), e_y(0, 0, 1), e_z = e_x.cross(e_y);
        const Vector3d n_p = normal - normal.dot(e_z) * e_z;

        const Vector2d section = section_normal(dip, dip_direction, azimuth);
        const double sign = dip < std::numbers::pi / 2 ? 1 : n_p.dot(section.x() * e_x) < 0 ? -1 : 1;
        RC_ASSERT((sign * n_p - section.x() * e_x - section.y() * e_y).norm() < 1e-12);

        // The trace lies in the plane and in the section.
        if (n_p.norm() > 1e-3) {
            const double trace = trace_angle(dip, dip_direction, azimuth);
            RC_ASSERT(std::abs((std::cos(trace) * e_x + std::sin(trace) * e_y).dot(normal)) < 1e-9);
        }
    });
}

TEST(TraceAngle, IsWhatAGeologistSees)
{
    // Looking north on a section that runs east: a plane dipping 30 degrees east falls to the right.
    EXPECT_NEAR(trace_angle(30 * deg, 90 * deg, 90 * deg), -30 * deg, 1e-15);
    EXPECT_NEAR(trace_angle(30 * deg, 270 * deg, 90 * deg), 30 * deg, 1e-15);
    // Dipping towards the viewer it looks level; 60 degrees away from the section it dips by atan(tan 30 cos
    // 60).
    EXPECT_NEAR(trace_angle(30 * deg, 180 * deg, 90 * deg), 0, 1e-15);
    EXPECT_NEAR(trace_angle(30 * deg, 150 * deg, 90 * deg), -std::atan(std::tan(30 * deg) / 2), 1e-15);
}

TEST(SampleJoints, MakesEverySingleJointASetOfItsOwn)
{
    Scene scene = scene_of({joint_set("a", .3, .1, 4, .5), joint_set("b", 1.8, .1, 4, .5)});
    scene.joints = {{"fault", "rough", {0, 1}, {50, 3}}, {"seam", "clay", {0, 5}, {50, 5}}};
    const Joints joints = sample_joints(scene, 1, 0);
    const std::size_t n = joints.set.size(), t = joints.trace_joint.size();
    ASSERT_GT(n, 10);
    EXPECT_EQ(joints.set[n - 2], 2);
    EXPECT_EQ(joints.set[n - 1], 3);
    EXPECT_EQ(joints.number[n - 1], 0);
    EXPECT_EQ(joints.material[0], 1);
    EXPECT_EQ(joints.material[n - 2], 0);
    EXPECT_EQ(joints.from[n - 2], Vector2d(0, 1));
    EXPECT_EQ(joints.to[n - 2], Vector2d(50, 3));
    EXPECT_EQ(joints.trace_joint[t - 2], n - 2);
    EXPECT_EQ(joints.trace_from[t - 2], Vector2d(0, 1));
    EXPECT_EQ(joints.trace_to[t - 2], Vector2d(50, 3));
}

TEST(SampleJoints, GivesAllColumnsTheSameLength)
{
    const Joints joints = sample_joints(scene_of({joint_set("a", .3, .1, 4, .5)}), 1, 0);
    const std::size_t n = joints.set.size(), t = joints.trace_joint.size();
    EXPECT_EQ(joints.number.size(), n);
    EXPECT_EQ(joints.material.size(), n);
    EXPECT_EQ(joints.from.size(), n);
    EXPECT_EQ(joints.to.size(), n);
    EXPECT_EQ(joints.trace_from.size(), t);
    EXPECT_EQ(joints.trace_to.size(), t);
}

TEST(SampleJoints, IsTheSameForTheSameSeedAndRealizationOnly)
{
    const Scene scene = scene_of({joint_set("a", .3, .1, 4, .5)});
    const Rows once = rows(sample_joints(scene, 1, 0), 0);
    EXPECT_EQ(once, rows(sample_joints(scene, 1, 0), 0));
    EXPECT_NE(once, rows(sample_joints(scene, 2, 0), 0));
    EXPECT_NE(once, rows(sample_joints(scene, 1ULL << 32U | 1U, 0), 0));
    EXPECT_NE(once, rows(sample_joints(scene, 1, 1), 0));
}

TEST(SampleJoints, MakesTheNetworkItAlwaysMade)
{
    // Recorded at the first version, since only the bytes say that users' networks have not changed. The
    // tolerance is for mathematical libraries that round otherwise.
    const Joints joints = sample_joints(scene_of({joint_set("a", .3, .1, 4, .5)}), 1, 0);
    const auto first = std::find(joints.number.begin(), joints.number.end(), 0) - joints.number.begin();
    EXPECT_NEAR(joints.from[first].x(), -12.067241499219108, 1e-9);
    EXPECT_NEAR(joints.from[first].y(), -15.846911707426742, 1e-9);
    EXPECT_NEAR(joints.trace_to[0].x(), -9.8460012223395523, 1e-9);
    EXPECT_NEAR(joints.trace_to[0].y(), -14.741318395264404, 1e-9);
}

TEST(SampleJoints, LeavesASetAloneWhenOthersComeGoOrMove)
{
    const JointSet a = joint_set("a", .3, .1, 4, .5), b = joint_set("b", 1.8, .1, 3, .7),
                   c = joint_set("c", 1, 0, 5, 1);
    const Joints first = sample_joints(scene_of({a, b}), 1, 0);
    const Joints second = sample_joints(scene_of({c, b, a}), 1, 0);
    EXPECT_EQ(rows(first, 0), rows(second, 2));
    EXPECT_EQ(rows(first, 1), rows(second, 1));
    EXPECT_EQ(rows(first, 1), rows(sample_joints(scene_of({b}), 1, 0), 0));
    // The name is what counts.
    EXPECT_NE(rows(first, 0), rows(sample_joints(scene_of({joint_set("A", .3, .1, 4, .5)}), 1, 0), 0));
}

TEST(SampleJoints, LeavesASetOfFisherUniformAndPowerLawsAloneToo)
{
    JointSet a = spatial_set(70 * deg, 100 * deg);
    a.dip.reset();
    a.dip_direction.reset();
    a.orientation = FisherLaw{70 * deg, 100 * deg, 50};
    a.spacing = uniform_law(1, 4);
    a.length = power_law(2.5, 1, 30);
    a.persistence = .6;
    Scene first = scene_of({a, joint_set("b", 1.8, .1, 3, .7)}),
          second = scene_of({joint_set("c", 1, 0, 5, 1), a});
    first.azimuth = second.azimuth = 60 * deg;
    const Rows once = rows(sample_joints(first, 1, 0), 0);
    EXPECT_GT(once.size(), 10);
    EXPECT_EQ(once, rows(sample_joints(second, 1, 0), 1));
    EXPECT_NE(once, rows(sample_joints(first, 1, 1), 0));
    // Other traces, same lines.
    second.joint_sets[1].length = uniform_law(1, 9);
    EXPECT_EQ(rows(sample_joints(first, 1, 0), 0, false), rows(sample_joints(second, 1, 0), 1, false));
    EXPECT_NE(once, rows(sample_joints(second, 1, 0), 1));
}

TEST(SampleJoints, KeepsPurposesApart)
{
    JointSet set = joint_set("a", .3, .1, 4, .5);
    const Joints plain = sample_joints(scene_of({set}), 1, 0);
    // Other traces, same lines.
    set.length = ProbabilityLaw{Kind::negative_exponential, 2, 2};
    set.persistence = .8;
    EXPECT_EQ(rows(plain, 0, false), rows(sample_joints(scene_of({set}), 1, 0), 0, false));
    EXPECT_NE(rows(plain, 0), rows(sample_joints(scene_of({set}), 1, 0), 0));

    // Other places, same directions.
    set.spacing = {Kind::constant, 4, 0};
    const Rows before = rows(plain, 0, false), after = rows(sample_joints(scene_of({set}), 1, 0), 0, false);
    int both = 0;
    for (const auto& [number, row] : after)
        if (const auto other = before.find(number); other != before.end()) {
            const auto angle = [](const Row& r) { return std::atan2(r[3] - r[1], r[2] - r[0]); };
            EXPECT_NEAR(angle(row), angle(other->second), 1e-12);
            ++both;
        }
    EXPECT_GT(both, 5);
}

TEST(SampleJoints, LeavesLinesAndTracesAloneWhenTheSectionGrowsInItsWindow)
{
    const JointSet set = joint_set("a", .3, .1, 4, .5);
    const Joints small = sample_joints(scene_of({set}, box(5, 5, 45, 35)), 1, 0);
    const Joints large = sample_joints(scene_of({set}, box(4, 3, 46, 39)), 1, 0);
    std::set<Row> traces;
    for (std::size_t t = 0; t < large.trace_joint.size(); ++t)
        traces.insert({large.trace_from[t].x(), large.trace_from[t].y(), large.trace_to[t].x(),
                       large.trace_to[t].y(), double(large.number[large.trace_joint[t]])});
    int whole = 0;
    for (std::size_t t = 0; t < small.trace_joint.size(); ++t) {
        const Index j = small.trace_joint[t];
        if (small.trace_from[t] == small.from[j] || small.trace_to[t] == small.to[j])
            continue; // ended by the outline
        EXPECT_TRUE(traces.contains({small.trace_from[t].x(), small.trace_from[t].y(), small.trace_to[t].x(),
                                     small.trace_to[t].y(), double(small.number[j])}));
        ++whole;
    }
    EXPECT_GT(whole, 10);
}

TEST(SampleJoints, LeavesLinesWithoutScatterAloneWhenTheSectionGrowsAnyhow)
{
    const JointSet set = joint_set("a", .3, 0, 2, .5);
    const Rows small = rows(sample_joints(scene_of({set}, box(5, 5, 45, 35)), 1, 0), 0, false);
    const Rows large = rows(sample_joints(scene_of({set}, box(-700, -800, 900, 1000)), 1, 0), 0, false);
    ASSERT_GT(small.size(), 5);
    const Vector2d normal(-std::sin(.3), std::cos(.3));
    for (const auto& [number, row] : small) {
        ASSERT_TRUE(large.contains(number));
        const Row& other = large.at(number);
        EXPECT_NEAR(normal.dot(Vector2d(row[0], row[1])), normal.dot(Vector2d(other[0], other[1])), 1e-9);
    }
}

TEST(SampleJoints, ReachesBeyondTheOutlineAtBothEnds)
{
    const Polygon outline{{0, 0}, {40, 0}, {40, 25}, {30, 25}, {20, 10}, {0, 10}}; // a slope
    const Joints joints = sample_joints(
        scene_of({joint_set("a", .3, .2, 1, 1), joint_set("b", -1.4, .2, 1, 1)}, outline), 1, 0);
    ASSERT_GT(joints.set.size(), 40);
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        const Vector2d direction = (joints.to[j] - joints.from[j]).normalized();
        for (const Vector2d& corner : outline) {
            EXPECT_GT((corner - joints.from[j]).dot(direction), 1e-5);
            EXPECT_GT((joints.to[j] - corner).dot(direction), 1e-5);
        }
        int hits = 0;
        for (int i = 0; i < 1000; ++i)
            hits += is_inside(outline, joints.from[j] + i / 1000. * (joints.to[j] - joints.from[j]));
        EXPECT_TRUE(hits > 0 || (joints.to[j] - joints.from[j]).norm() < 50); // a corner may be cut by less
    }
}

TEST(SampleJoints, PutsTracesInOrderOnTheirLine)
{
    const Joints joints = sample_joints(scene_of({joint_set("a", .3, .1, 4, .5)}), 3, 0);
    std::map<Index, double> reached;
    for (std::size_t t = 0; t < joints.trace_joint.size(); ++t) {
        const Index j = joints.trace_joint[t];
        const Vector2d direction = (joints.to[j] - joints.from[j]).normalized();
        const auto along = [&](const Vector2d& p) { return (p - joints.from[j]).dot(direction); };
        for (const Vector2d& end : {joints.trace_from[t], joints.trace_to[t]})
            EXPECT_LT((end - joints.from[j] - along(end) * direction).norm(), 1e-12);
        EXPECT_LT(along(joints.trace_from[t]), along(joints.trace_to[t]));
        if (reached.contains(j)) {
            EXPECT_GT(along(joints.trace_from[t]), reached[j]);
        }
        EXPECT_GE(along(joints.trace_from[t]), 0);
        EXPECT_LE(along(joints.trace_to[t]), (joints.to[j] - joints.from[j]).norm() + 1e-12);
        reached[j] = along(joints.trace_to[t]);
    }
    EXPECT_GT(joints.trace_joint.size(), 20);
}

TEST(SampleJoints, IsOneTraceAtPersistence1AndNoneAt0)
{
    JointSet set = joint_set("a", .3, .1, 4, 1);
    set.length.reset();
    const Joints full = sample_joints(scene_of({set}), 1, 0);
    EXPECT_EQ(full.trace_from, full.from);
    EXPECT_EQ(full.trace_to, full.to);
    set.persistence = 0;
    const Joints none = sample_joints(scene_of({set}), 1, 0);
    EXPECT_EQ(none.from, full.from);
    EXPECT_TRUE(none.trace_joint.empty());
}

TEST(SampleJoints, CutsLinesByTheRegionIntoPieces)
{
    JointSet set = joint_set("a", .1, .1, .3, .6);
    const Joints free = sample_joints(scene_of({set}, box(0, 0, 30, 10)), 1, 0);
    set.region = Polygon{{0, 0}, {30, 0}, {30, 10}, {20, 10}, {20, 4}, {10, 4}, {10, 10}, {0, 10}}; // a U
    const Joints joints = sample_joints(scene_of({set}, box(-100, -100, 200, 100)), 1, 0);
    const Rows whole = rows(free, 0, false), pieces = rows(joints, 0, false);
    int seconds = 0;
    for (const auto& [number, row] : pieces) {
        const Index line = (number + piece_step / 2) % piece_step - piece_step / 2,
                    piece = (number - line) / piece_step;
        ASSERT_TRUE(piece == 0 || piece == 1);
        seconds += piece;
        const Vector2d from(row[0], row[1]), to(row[2], row[3]);
        for (int i = 0; i <= 100; ++i)
            EXPECT_TRUE(is_inside(*set.region, from + (1 + 98. * i / 100) / 100 * (to - from)));
        EXPECT_FALSE(is_inside(*set.region, from));
        EXPECT_FALSE(is_inside(*set.region, to));
        // It lies on the line of its number, which the region has not changed.
        ASSERT_TRUE(whole.contains(line));
        const Row& other = whole.at(line);
        const Vector2d a(other[0], other[1]), direction = (Vector2d(other[2], other[3]) - a).normalized();
        for (const Vector2d& end : {from, to})
            EXPECT_LT((end - a - (end - a).dot(direction) * direction).norm(), 1e-9);
    }
    EXPECT_GT(seconds, 3);
    for (std::size_t t = 0; t < joints.trace_joint.size(); ++t)
        EXPECT_TRUE(is_inside(*set.region, (joints.trace_from[t] + joints.trace_to[t]) / 2));
}

namespace
{

JointSet segment_set(const std::string& name, double angle, double scatter, double p21)
{
    JointSet set = joint_set(name, angle, scatter, 1, 0);
    set.kind = SetKind::segments;
    set.density = Density{Density::Measure::p21, p21};
    return set;
}

JointSet disc_set(const std::string& name, double p32)
{
    JointSet set = segment_set(name, 0, 0, 1);
    set.kind = SetKind::discs;
    set.trace_angle.reset();
    set.orientation = FisherLaw{60 * deg, 100 * deg, 20};
    set.density = Density{Density::Measure::p32, p32};
    set.diameter = ProbabilityLaw{Kind::lognormal, 6, 3};
    return set;
}

Scene scene_in_space(const std::vector<JointSet>& sets)
{
    Scene scene = scene_of(sets);
    scene.azimuth = 60 * deg;
    return scene;
}

} // namespace

TEST(SampleJoints, LeavesSetsOfSegmentsAndDiscsAloneToo)
{
    const JointSet lines = joint_set("lines", .3, .1, 4, .5), segments = segment_set("segments", 1.5, .2, .3),
                   discs = disc_set("discs", .3);
    const Joints first = sample_joints(scene_in_space({lines, segments, discs}), 1, 0);
    JointSet denser = segments;
    denser.density->value = .4;
    const Joints second = sample_joints(scene_in_space({discs, denser, lines}), 1, 0);
    EXPECT_GT(rows(first, 1).size(), 20);
    EXPECT_GT(rows(first, 2).size(), 20);
    EXPECT_EQ(rows(first, 0), rows(second, 2));
    EXPECT_EQ(rows(first, 2), rows(second, 0));
    EXPECT_NE(rows(first, 1), rows(second, 1));
    EXPECT_EQ(rows(first, 1), rows(sample_joints(scene_in_space({segments}), 1, 0), 0));
    EXPECT_NE(rows(first, 1), rows(sample_joints(scene_in_space({segments}), 2, 0), 0));
    EXPECT_NE(rows(first, 1), rows(sample_joints(scene_in_space({segments}), 1, 1), 0));
    // A denser set has the joints of the other one, and more.
    const Rows few = rows(first, 1);
    for (const auto& [number, row] : rows(second, 1))
        if (few.contains(number)) {
            EXPECT_EQ(few.at(number), row);
        }

    // Terminations change the ends of their own set's joints alone.
    JointSet ended = segments;
    ended.terminates_at = {"lines", "discs"};
    const Joints third = sample_joints(scene_in_space({ended, lines, discs}), 1, 0);
    EXPECT_EQ(rows(first, 0), rows(third, 1));
    EXPECT_EQ(rows(first, 2), rows(third, 2));
    EXPECT_NE(rows(first, 1), rows(third, 0));
    int shorter = 0;
    for (const auto& [number, row] : rows(third, 0)) {
        const Row& whole = few.at(number);
        const double length = std::hypot(row[2] - row[0], row[3] - row[1]),
                     before = std::hypot(whole[2] - whole[0], whole[3] - whole[1]);
        EXPECT_LE(length, before + 1e-12);
        shorter += length < before - 1e-9;
    }
    EXPECT_GT(shorter, 20);
}

TEST(SampleJoints, KeepsSegmentsWhenTheSectionGrowsInItsWindow)
{
    const JointSet set = segment_set("a", .3, .2, .3);
    const Rows small = rows(sample_joints(scene_of({set}, box(1, 1, 63, 31)), 1, 0), 0);
    const Rows large = rows(sample_joints(scene_of({set}, box(.5, .5, 63.5, 31.5)), 1, 0), 0);
    EXPECT_GT(small.size(), 50);
    for (const auto& [number, row] : small)
        EXPECT_EQ(row, large.at(number));
}

TEST(SampleJoints, MakesASegmentOneTraceInTheSection)
{
    const Polygon outline{{0, 0}, {40, 0}, {40, 25}, {30, 25}, {20, 10}, {0, 10}};
    const Joints joints = sample_joints(scene_of({segment_set("a", .7, .3, 1)}, outline), 1, 0);
    EXPECT_EQ(joints.trace_from, joints.from);
    EXPECT_EQ(joints.trace_to, joints.to);
    ASSERT_GT(joints.set.size(), 50);
    int past = 0;
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        int hits = 0;
        for (int i = 0; i <= 2000; ++i)
            hits += is_inside(outline, joints.from[j] + i / 2000. * (joints.to[j] - joints.from[j]));
        EXPECT_GT(hits, 0) << j;
        past += hits < 2001;
    }
    EXPECT_GT(past, 10);
}

TEST(SampleJoints, KeepsToTheRocksOfASet)
{
    Scene scene =
        scene_of({joint_set("lines", .4, .1, 1, 1), segment_set("segments", 1.4, .3, .8)}, box(0, 0, 40, 30));
    scene.rock = "hard";
    scene.regions = {
        {"soft", box(-5, 20, 45, 40)}, {"hard", box(10, 22, 20, 40)}, {"clay", box(30, 5, 35, 10)}};
    for (JointSet& set : scene.joint_sets)
        set.rocks = {"soft", "clay"};
    const auto is_there = [&](const Vector2d& p) {
        return is_inside(scene.outline, p) &&
               ((is_inside(scene.regions[0].outline, p) && !is_inside(scene.regions[1].outline, p)) ||
                is_inside(scene.regions[2].outline, p));
    };
    const Joints joints = sample_joints(scene, 1, 0);
    std::map<Index, double> length;
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        const Vector2d run = joints.to[j] - joints.from[j];
        for (int i = 1; i < 100; ++i)
            EXPECT_TRUE(is_there(joints.from[j] + i / 100. * run)) << j;
        length[joints.set[j]] += run.norm();
    }
    // All of it, not some: lines as if there were no rocks, by hand.
    Scene everywhere = scene;
    for (JointSet& set : everywhere.joint_sets)
        set.rocks.clear();
    std::map<Index, double> wanted;
    const Joints all = sample_joints(everywhere, 1, 0);
    for (std::size_t j = 0; j < all.set.size(); ++j)
        for (int i = 0; i < 20000; ++i) {
            const Vector2d run = all.to[j] - all.from[j];
            wanted[all.set[j]] += is_there(all.from[j] + (i + .5) / 20000 * run) ? run.norm() / 20000 : 0;
        }
    for (const Index set : {0, 1}) {
        EXPECT_GT(wanted[set], 50);
        EXPECT_NEAR(length[set], wanted[set], 2e-3 * wanted[set]);
    }
}

TEST(SampleJoints, MakesEveryPieceOfAMappedTraceAJoint)
{
    Scene scene = scene_of({joint_set("a", .3, .1, 4, .5)});
    scene.joints = {{"fault", "rough", {0, 1}, {50, 3}}};
    scene.mapped = {{"map",
                     "rough",
                     {{7, {{{0, 0}, {1, 2}, {1, 2}, {3, 3}}, {{5, 5}, {6, 6}}}}, {2, {{{8, 8}, {9, 9}}}}}}};
    const Rows found = rows(sample_joints(scene, 1, 0), 2);
    const Rows wanted{{7 * mapped_step, {0, 0, 1, 2, 0, 0, 1, 2}},
                      {7 * mapped_step + 1, {1, 2, 3, 3, 1, 2, 3, 3}},
                      {7 * mapped_step + 2, {5, 5, 6, 6, 5, 5, 6, 6}},
                      {2 * mapped_step, {8, 8, 9, 9, 8, 8, 9, 9}}};
    EXPECT_EQ(found, wanted);
    scene.mapped[0].traces[0].id = 1 << 21;
    expect_refusal(scene, {"\"map\"", "id 2097152"});
    scene.mapped[0].traces[0] = {1, {Polygon()}};
    for (int i = 0; i <= mapped_step + 1; ++i)
        scene.mapped[0].traces[0].polylines[0].emplace_back(i, 0);
    expect_refusal(scene, {"\"map\"", "more than 1024 straight pieces"});
}

TEST(SampleJoints, RefusesKindsWithoutWhatTheyNeed)
{
    JointSet set = segment_set("a", 0, 0, .3);
    set.density.reset();
    expect_refusal(scene_of({set}), {"\"a\"", "need a density"});
    set = segment_set("a", 0, 0, 1e9);
    expect_refusal(scene_of({set}), {"\"a\"", "density is too large"});
    set = segment_set("a", 0, 0, .3);
    set.length.reset();
    expect_refusal(scene_of({set}), {"\"a\"", "needs a length"});
    set = segment_set("a", 0, 0, .3);
    set.density = Density{Density::Measure::p10, .3, {0}};
    expect_refusal(scene_of({set}), {"\"a\"", "runs along the set"});
    set = joint_set("a", 0, 0, 3, 1);
    set.terminates_at = {"b"};
    expect_refusal(scene_of({set, segment_set("b", 1, 0, .3)}), {"\"a\"", "lines"});
    set = segment_set("a", 0, 0, .3);
    set.terminates_at = {"b"};
    expect_refusal(scene_of({set}), {"\"a\"", "\"b\"", "expected the name of a joint set"});
    JointSet other = segment_set("b", 1, 0, .3);
    other.terminates_at = {"a"};
    expect_refusal(scene_of({set, other}), {"circle"});
}

TEST(SampleJoints, TurnsAPlaneIntoItsTrace)
{
    Scene scene = scene_of({spatial_set(60 * deg, 120 * deg)});
    scene.azimuth = 75 * deg;
    const Joints joints = sample_joints(scene, 1, 0);
    ASSERT_GT(joints.set.size(), 5);
    const double angle = trace_angle(60 * deg, 120 * deg, 75 * deg);
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        const Vector2d along = joints.to[j] - joints.from[j];
        EXPECT_NEAR(std::atan2(along.y(), along.x()), angle, 1e-12);
    }
}

TEST(SampleJoints, WorksFarFromTheOrigin)
{
    const Joints joints =
        sample_joints(scene_of({joint_set("a", .3, .1, 4, .5)}, box(400000, 3000000, 400050, 3000050)), 1, 0);
    EXPECT_GT(joints.set.size(), 5);
    expect_refusal(scene_of({joint_set("a", .3, .1, .1, .5)}, box(400000, 3000000, 400050, 3000050)),
                   {"\"a\"", "origin", "spacing (mean 0.1 m)"});
}

TEST(SampleJoints, RefusesTooManyJointsOrTraces)
{
    expect_refusal(scene_of({joint_set("a", .3, .1, 1e-6, 1)}),
                   {"\"a\"", "spacing is too small, or density too large, for the section"});
    JointSet set = joint_set("a", .3, .1, 1, .5);
    set.length = ProbabilityLaw{Kind::constant, 1e-6, 0};
    expect_refusal(scene_of({set}), {"\"a\"", "length (mean 1e-06 m) is too small for the section"});
}

TEST(SampleJoints, RefusesNamesThatShareAKey)
{
    ASSERT_EQ(set_key("costarring"), set_key("liquid"));
    expect_refusal(scene_of({joint_set("liquid", 0, 0, 9, 1), joint_set("costarring", 1, 0, 9, 1)}),
                   {"\"liquid\"", "\"costarring\"", "rename"});
    expect_refusal(scene_of({joint_set("a", 0, 0, 9, 1), joint_set("a", 1, 0, 9, 1)}),
                   {"two joint sets", "\"a\""});
}

TEST(SampleJoints, RefusesWhatIsMissing)
{
    JointSet set = joint_set("a", 0, 0, 9, .5);
    set.length.reset();
    expect_refusal(scene_of({set}), {"\"a\"", "persistence of 0.5", "no length"});
    set = joint_set("a", 0, 0, 9, 1);
    set.material = "unknown";
    expect_refusal(scene_of({set}), {"\"a\"", "joint material \"unknown\""});
    set.trace_angle.reset();
    expect_refusal(scene_of({set}), {"\"a\"", "orientation"});
    expect_refusal(scene_of({spatial_set(60 * deg, 120 * deg)}), {"\"spatial\"", "azimuth"});
}

TEST(SampleJoints, RefusesASetParallelToTheSection)
{
    Scene scene = scene_of({spatial_set(90 * deg, 165 * deg)});
    scene.azimuth = 75 * deg;
    expect_refusal(scene, {"\"spatial\"", "parallel to the section"});
}

} // namespace joint_sets_test
