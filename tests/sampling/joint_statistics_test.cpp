// What networks must satisfy on average, over many realizations.

#include "sampling/joint_sets.hpp"

#include "model/units.hpp"
#include "sampling/laws.hpp"
#include "statistics.hpp"

#include <gtest/gtest.h>

using namespace jointcreep;
using namespace jointcreep::statistics;
using namespace jointcreep::unit;
using Eigen::Vector2d;

namespace
{

using Kind = Law::Kind;

const Law exponential_spacing{Kind::negative_exponential, 4, 4}, lognormal_spacing{Kind::lognormal, 4, 3},
    constant_spacing{Kind::constant, 4, 0}, normal_spacing{Kind::normal, 4, 3};

Scene scene_of(const Law& trace_angle, const Law& spacing, double persistence, const Law& length, double left,
               double bottom, double right, double top)
{
    JointSet set;
    set.name = "bedding";
    set.material = "clay";
    set.trace_angle = trace_angle;
    set.spacing = spacing;
    set.length = length;
    set.persistence = persistence;
    Scene scene;
    scene.outline = {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
    scene.joint_materials = {{"clay", 1e8, 1e8, 0, .3, 0, {}}};
    scene.joint_sets = {set};
    return scene;
}

Scene wide_scene(const Law& trace_angle, const Law& spacing, double persistence = 1)
{
    return scene_of(trace_angle, spacing, persistence, {Kind::lognormal, 6, 4}, 20, -70, 120, -10);
}

double cross(const Vector2d& a, const Vector2d& b)
{
    return a.x() * b.y() - a.y() * b.x();
}

bool meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d)
{
    return (cross(b - a, c - a) < 0) != (cross(b - a, d - a) < 0) &&
           (cross(d - c, a - c) < 0) != (cross(d - c, b - c) < 0);
}

// Length of the part of a segment inside a convex polygon given counter-clockwise.
double length_inside(const Polygon& polygon, const Vector2d& from, const Vector2d& to)
{
    double low = 0, high = 1;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d side = polygon[(i + 1) % polygon.size()] - polygon[i];
        const double at_from = cross(side, from - polygon[i]), at_to = cross(side, to - polygon[i]);
        if (at_from < 0 && at_to < 0)
            return 0;
        if (at_from < 0)
            low = std::max(low, at_from / (at_from - at_to));
        else if (at_to < 0)
            high = std::min(high, at_from / (at_from - at_to));
    }
    return std::max(0.0, high - low) * (to - from).norm();
}

// One number a realization.
Samples over_realizations(const Scene& scene, int realizations,
                          const std::function<double(const Joints&)>& measure)
{
    Samples samples;
    for (int r = 0; r < realizations; ++r)
        samples.push_back(measure(sample_joints(scene, 20030601, r)));
    return samples;
}

// Joints on a scanline of 50 m through the middle of the wide scene.
Samples scanline_counts(const Scene& scene, const Vector2d& direction)
{
    const Vector2d middle = (scene.outline[0] + scene.outline[2]) / 2;
    const Vector2d from = middle - 25 * direction, to = middle + 25 * direction;
    return over_realizations(scene, 2000, [&](const Joints& joints) {
        int count = 0;
        for (std::size_t j = 0; j < joints.set.size(); ++j)
            count += meet(from, to, joints.from[j], joints.to[j]);
        return double(count);
    });
}

Vector2d normal_at(double trace_angle)
{
    return {-std::sin(trace_angle), std::cos(trace_angle)};
}

// The spacing around the origin, and the origin's place in it.
struct Anchor {
    Samples spacing, place;
};

Anchor anchors(const Law& spacing)
{
    const Scene scene = scene_of({Kind::constant, 0, 0}, spacing, 1, spacing, -1, -400, 1, 400);
    Anchor anchor;
    for (int r = 0; r < 5000; ++r) {
        const Joints joints = sample_joints(scene, 20030601, r);
        double above = 0, below = 0;
        for (std::size_t j = 0; j < joints.set.size(); ++j) {
            if (joints.number[j] == 0)
                above = joints.from[j].y();
            if (joints.number[j] == -1)
                below = joints.from[j].y();
        }
        anchor.spacing.push_back(above - below);
        anchor.place.push_back(-below / (above - below));
    }
    return anchor;
}

bool is_stationary_anchor(const Samples& spacing, const Law& law)
{
    return follow(spacing, size_biased_distribution(law));
}

// Traces on level lines 2 km long, one or so a realization; intervals by distance from the line's left end.
struct Traces {
    double line;
    std::vector<std::pair<double, double>> traces;
};

std::vector<Traces> long_lines(const Law& length, double persistence, double width, int realizations)
{
    const Scene scene = scene_of({Kind::constant, 0, 0}, {Kind::constant, 20, 0}, persistence, length, 100, 0,
                                 100 + width, 20);
    std::vector<Traces> lines;
    for (int r = 0; r < realizations; ++r) {
        const Joints joints = sample_joints(scene, 20030601, r);
        const std::size_t first = lines.size();
        for (std::size_t j = 0; j < joints.set.size(); ++j)
            lines.push_back({joints.to[j].x() - joints.from[j].x(), {}});
        for (std::size_t t = 0; t < joints.trace_joint.size(); ++t) {
            const double left = joints.from[joints.trace_joint[t]].x();
            lines[first + joints.trace_joint[t]].traces.emplace_back(joints.trace_from[t].x() - left,
                                                                     joints.trace_to[t].x() - left);
        }
    }
    return lines;
}

double joint_fraction(const Traces& line)
{
    double sum = 0;
    for (const auto& [from, to] : line.traces)
        sum += to - from;
    return sum / line.line;
}

const Law lognormal_length{Kind::lognormal, 6, 4}, exponential_length{Kind::negative_exponential, 6, 6},
    normal_length{Kind::normal, 6, 5}, constant_length{Kind::constant, 6, 0};

} // namespace

TEST(Frequency, OnAScanlineAlongTheMeanNormalIsOneOverTheSpacing)
{
    for (const Law& spacing : {exponential_spacing, lognormal_spacing, constant_spacing, normal_spacing})
        for (const double scatter : {0.0, 8.0}) {
            const Scene scene = wide_scene({Kind::normal, 20 * deg, scatter * deg}, spacing);
            EXPECT_TRUE(
                have_mean(scanline_counts(scene, normal_at(20 * deg)), 50 / mean_of_positive(spacing)))
                << static_cast<int>(spacing.kind) << ", scatter " << scatter;
        }
}

TEST(Frequency, FallsWithTheCosineOnAScanlineAcross)
{
    const Scene scene = wide_scene({Kind::constant, 20 * deg, 0}, exponential_spacing);
    EXPECT_TRUE(have_mean(scanline_counts(scene, normal_at(60 * deg)), 50 / 4. * std::cos(40 * deg)));
}

TEST(Frequency, OfPlanesIsOneOverTheSpacingInTheSection)
{
    Scene scene = wide_scene({Kind::constant, 0, 0}, exponential_spacing);
    scene.azimuth = 40 * deg;
    scene.joint_sets[0].trace_angle.reset();
    scene.joint_sets[0].dip = Law{Kind::normal, 70 * deg, 3 * deg};
    scene.joint_sets[0].dip_direction = Law{Kind::normal, 100 * deg, 3 * deg};
    const double n_p = section_normal(70 * deg, 100 * deg, 40 * deg).norm(); // .58
    const Samples counts = scanline_counts(scene, normal_at(trace_angle(70 * deg, 100 * deg, 40 * deg)));
    EXPECT_TRUE(have_mean(counts, 50 / 4. * n_p));
    EXPECT_FALSE(have_mean(counts, 50 / 4.)); // the true spacing taken for the one in the section
}

TEST(Frequency, OfAPoissonSetHasPoissonVariance)
{
    const Samples counts =
        scanline_counts(wide_scene({Kind::constant, .3, 0}, exponential_spacing), normal_at(.3));
    Samples squares;
    for (const double count : counts)
        squares.push_back(std::pow(count - 12.5, 2));
    EXPECT_TRUE(have_mean(squares, 12.5));
}

TEST(Intensity, IsTheFrequencyOverTheMeanCosineOfTheScatter)
{
    for (const double scatter : {0.0, 8.0, 15.0}) {
        const Scene scene = wide_scene({Kind::normal, 110 * deg, scatter * deg}, exponential_spacing);
        const Samples p21 = over_realizations(scene, 2000, [&](const Joints& joints) {
            double sum = 0;
            for (std::size_t j = 0; j < joints.set.size(); ++j)
                sum += length_inside(scene.outline, joints.from[j], joints.to[j]);
            return sum / (100 * 60);
        });
        double stretch = 0, weight = 0; // mean of 1/cos
        for (double z = -5; z <= 5; z += .01) {
            stretch += std::exp(-z * z / 2) / std::cos(z * scatter * deg);
            weight += std::exp(-z * z / 2);
        }
        EXPECT_TRUE(have_mean(p21, stretch / weight / 4)) << "scatter " << scatter;
        EXPECT_FALSE(have_mean(p21, 1.05 * stretch / weight / 4));
    }
}

TEST(Anchor, SeesSpacingsBySizeAndTakesAUniformPlaceInThem)
{
    for (const Law& spacing : {exponential_spacing, lognormal_spacing, normal_spacing}) {
        const Anchor anchor = anchors(spacing);
        EXPECT_TRUE(is_stationary_anchor(anchor.spacing, spacing));
        EXPECT_TRUE(follow(anchor.place, [](double x) { return x; }));
    }
}

TEST(Anchor, WouldBeCaughtWithoutSizeBias)
{
    Stream stream({1, 0, 0}, 0, Purpose::spacing);
    Samples plain;
    for (int i = 0; i < 5000; ++i)
        plain.push_back(draw_positive(lognormal_spacing, stream));
    EXPECT_FALSE(is_stationary_anchor(plain, lognormal_spacing));
}

TEST(Persistence, IsTheWantedOneOnAnyStretchOfLine)
{
    for (const Law& length : {lognormal_length, exponential_length, normal_length, constant_length})
        for (const double persistence : {.1, .5, .9})
            for (const double width : {2.0, 50.0}) { // short of a trace, and many
                Samples fractions;
                for (const Traces& line : long_lines(length, persistence, width, 4000))
                    fractions.push_back(joint_fraction(line));
                EXPECT_TRUE(have_mean(fractions, persistence))
                    << static_cast<int>(length.kind) << ' ' << width;
                if (persistence == .5) {
                    EXPECT_FALSE(have_mean(fractions, persistence * .9));
                }
            }
}

TEST(Persistence, VariesOnLongLinesAsAnAlternatingRenewalProcess)
{
    // Var(k_T) = (Var L E[G]^2 + Var G E[L]^2) / ((E[L] + E[G])^3 T), asymptotically
    for (const Law& length : {lognormal_length, exponential_length, constant_length}) {
        const double k = .6, width = 3000, bridge = length.mean * (1 - k) / k;
        Samples squares;
        for (const Traces& line : long_lines(length, k, width, 3000))
            squares.push_back(std::pow(joint_fraction(line) - k, 2));
        const double expected = (std::pow(length.deviation * bridge, 2) + std::pow(bridge * length.mean, 2)) /
                                (std::pow(length.mean + bridge, 3) * width);
        EXPECT_TRUE(have_mean(squares, expected)) << mean(squares) << " for " << expected;
        EXPECT_FALSE(have_mean(squares, 1.2 * expected));
    }
}

TEST(TraceLength, FollowsTheLawWhereNoWindowEndsIt)
{
    for (const Law& length : {lognormal_length, exponential_length, normal_length}) {
        // The first ten traces that begin on a line long enough to hold them whole.
        Samples lengths, bridges;
        for (const Traces& line : long_lines(length, .6, 1000, 1000)) {
            std::size_t i = line.traces[0].first == 0 ? 1 : 0;
            for (const std::size_t end = i + 10; i < end; ++i) {
                lengths.push_back(line.traces[i].second - line.traces[i].first);
                bridges.push_back(line.traces[i + 1].first - line.traces[i].second);
            }
        }
        EXPECT_TRUE(follow(lengths, positive_distribution(length)));
        const double bridge = mean_of_positive(length) * .4 / .6;
        EXPECT_TRUE(follow(bridges, [&](double x) { return -std::expm1(-x / bridge); }));
    }
}

TEST(TraceLength, IsSizeBiasedWhereAScanlineMeetsIt)
{
    for (const Law& length : {lognormal_length, exponential_length, normal_length}) {
        Samples hit, beyond;
        for (const Traces& line : long_lines(length, .6, 400, 5000))
            for (const auto& [from, to] : line.traces)
                if (from < 200 && to > 200) {
                    hit.push_back(to - from);
                    beyond.push_back(to - 200);
                }
        EXPECT_GT(hit.size(), 2000);
        EXPECT_TRUE(follow(hit, size_biased_distribution(length)));
        EXPECT_FALSE(follow(hit, positive_distribution(length)));
        EXPECT_TRUE(follow(beyond, residual_distribution(length)));
    }
}

TEST(TraceLength, IsAResidualWhereALineBeginsInATrace)
{
    Samples begun;
    for (const Traces& line : long_lines(lognormal_length, .6, 1000, 5000))
        if (line.traces[0].first == 0)
            begun.push_back(line.traces[0].second);
    EXPECT_TRUE(follow(begun, residual_distribution(lognormal_length)));

    // Without size bias: a uniform part of a plain length.
    Stream stream({1, 0, 0}, 0, Purpose::traces_ahead);
    Samples plain;
    for (std::size_t i = 0; i < begun.size(); ++i)
        plain.push_back(draw_positive(lognormal_length, stream) * uniform(stream));
    EXPECT_FALSE(follow(plain, residual_distribution(lognormal_length)));
}
