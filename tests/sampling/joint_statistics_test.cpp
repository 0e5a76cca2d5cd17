// What networks must satisfy on average, over many realizations.

#include "sampling/joint_sets.hpp"

#include "model/units.hpp"
#include "sampling/laws.hpp"
#include "statistics.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace joint_statistics_test
{

using namespace jointcreep;
using namespace jointcreep::sampling;
using namespace jointcreep::statistics;
using namespace jointcreep::unit;
using Eigen::Vector2d;

namespace
{

using Kind = ProbabilityLaw::Kind;

const ProbabilityLaw exponential_spacing{Kind::negative_exponential, 4, 4},
    lognormal_spacing{Kind::lognormal, 4, 3}, constant_spacing{Kind::constant, 4, 0},
    normal_spacing{Kind::normal, 4, 3}, uniform_spacing = uniform_law(1, 7),
                                        power_spacing = power_law(2.5, 1.5, 40);

Scene scene_of(const ProbabilityLaw& trace_angle, const ProbabilityLaw& spacing, double persistence,
               const ProbabilityLaw& length, double left, double bottom, double right, double top)
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

Scene wide_scene(const ProbabilityLaw& trace_angle, const ProbabilityLaw& spacing, double persistence = 1)
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

Anchor anchors(const ProbabilityLaw& spacing)
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

bool is_stationary_anchor(const Samples& spacing, const ProbabilityLaw& law)
{
    return follow(spacing, size_biased_distribution(law));
}

// Traces on level lines 2 km long, one or so a realization; intervals by distance from the line's left end.
struct Traces {
    double line;
    std::vector<std::pair<double, double>> traces;
};

std::vector<Traces> long_lines(const ProbabilityLaw& length, double persistence, double width,
                               int realizations)
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

const ProbabilityLaw lognormal_length{Kind::lognormal, 6, 4},
    exponential_length{Kind::negative_exponential, 6, 6}, normal_length{Kind::normal, 6, 5},
    constant_length{Kind::constant, 6, 0}, uniform_length = uniform_law(1, 11),
                                           power_length = power_law(2.5, 2, 60);

// One set of planes with poles by Fisher's law, in the wide scene.
Scene fisher_scene(const FisherLaw& law, double azimuth, const ProbabilityLaw& spacing)
{
    Scene scene = wide_scene({}, spacing);
    scene.azimuth = azimuth;
    scene.joint_sets[0].trace_angle.reset();
    scene.joint_sets[0].orientation = law;
    return scene;
}

// Angles that traces make with the trace of the mean plane, with their weights, by Fisher's law on a grid of
// poles. Worked in space, with x east, y north and z up, apart from how the sampler does it.
struct WeightedAngles {
    std::vector<std::pair<double, double>> angle_weight; // by angle; the weights sum to 1
    double mean_secant = 0;                              // of 1 / cos(angle)
};

WeightedAngles traces_by_fisher(const FisherLaw& law, double azimuth)
{
    using Eigen::Vector3d;
    const Vector3d pole(std::sin(law.dip) * std::sin(law.dip_direction),
                        std::sin(law.dip) * std::cos(law.dip_direction), std::cos(law.dip));
    const Vector3d right(std::sin(azimuth), std::cos(azimuth), 0), up(0, 0, 1);
    const auto trace_angle_of = [&](const Vector3d& n) { return std::atan2(-n.dot(right), n.dot(up)); };
    const double mean = trace_angle_of(pole);
    const Vector3d first = pole.unitOrthogonal(), second = pole.cross(first);
    const int steps = 500;
    WeightedAngles all;
    double total = 0;
    const double farthest = std::min(std::numbers::pi, 9 / std::sqrt(law.concentration));
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double t = (i + .5) / steps * farthest, turn = (j + .5) / steps * 2 * std::numbers::pi;
            const double weight =
                std::sin(t) * std::exp(-2 * law.concentration * std::pow(std::sin(t / 2), 2));
            const Vector3d n =
                std::cos(t) * pole + std::sin(t) * (std::cos(turn) * first + std::sin(turn) * second);
            const double off = std::remainder(trace_angle_of(n) - mean, std::numbers::pi);
            all.angle_weight.emplace_back(off, weight);
            all.mean_secant += weight / std::cos(off);
            total += weight;
        }
    std::sort(all.angle_weight.begin(), all.angle_weight.end());
    for (auto& [angle, weight] : all.angle_weight)
        weight /= total;
    all.mean_secant /= total;
    return all;
}

Distribution distribution_of(const WeightedAngles& all)
{
    std::vector<double> angles, sums;
    double sum = 0;
    for (const auto& [angle, weight] : all.angle_weight) {
        angles.push_back(angle);
        sums.push_back(sum += weight);
    }
    return [angles, sums](double angle) {
        const auto after = std::upper_bound(angles.begin(), angles.end(), angle) - angles.begin();
        return after == 0 ? 0.0 : sums[after - 1];
    };
}

// Angles of the lines nearest to the origin with the mean trace, at the angle `mean`. Lines turn about points
// of a window along it, here [0, 128] m, which the outline covers: so none is missed for its angle.
Samples trace_angles(Scene scene, double mean)
{
    const Vector2d along(std::cos(mean), std::sin(mean)), across = 30 * normal_at(mean);
    scene.outline = {.5 * along - across, 127.5 * along - across, 127.5 * along + across,
                     .5 * along + across};
    Samples angles;
    for (int r = 0; r < 5000; ++r) {
        const Joints joints = sample_joints(scene, 20030601, r);
        for (std::size_t j = 0; j < joints.set.size(); ++j)
            if (std::abs(joints.number[j]) < 4) {
                const Vector2d run = joints.to[j] - joints.from[j];
                angles.push_back(std::remainder(std::atan2(run.y(), run.x()) - mean, std::numbers::pi));
            }
    }
    return angles;
}

// Length of lines per area of the wide scene.
Samples intensities(const Scene& scene)
{
    return over_realizations(scene, 2000, [&](const Joints& joints) {
        double sum = 0;
        for (std::size_t j = 0; j < joints.set.size(); ++j)
            sum += length_inside(scene.outline, joints.from[j], joints.to[j]);
        return sum / (100 * 60);
    });
}

struct FisherCase {
    FisherLaw law;
    double azimuth;
};

// Across the section, slanting to it, and flat; widely and hardly scattered.
const std::vector<FisherCase> fisher_cases{{{70 * deg, 90 * deg, 60}, 90 * deg},
                                           {{55 * deg, 130 * deg, 200}, 60 * deg},
                                           {{10 * deg, 300 * deg, 100}, 45 * deg},
                                           {{90 * deg, 20 * deg, 400}, 60 * deg}};

// The persistence on stretches of lines, and its variance on long ones.
bool has_persistence(const std::vector<Traces>& lines, double persistence)
{
    Samples fractions;
    for (const Traces& line : lines)
        fractions.push_back(joint_fraction(line));
    return have_mean(fractions, persistence);
}

// Lines by a wrong sampler: one that begins in a trace takes a uniform part of a plain length, not of a
// size-biased one.
std::vector<Traces> lines_begun_without_size_bias(const ProbabilityLaw& length, double persistence,
                                                  double width, int lines)
{
    const double bridge = mean_of_positive(length) * (1 - persistence) / persistence;
    std::vector<Traces> begun;
    for (int i = 0; i < lines; ++i) {
        Stream stream({1, 0, 0}, i, Purpose::traces_ahead);
        Traces line{width, {}};
        bool in_trace = uniform(stream) < persistence;
        for (double place = 0; place < width; in_trace = !in_trace) {
            double step = in_trace ? draw_positive(length, stream) : draw_exponential(bridge, stream);
            if (place == 0 && in_trace)
                step *= uniform(stream);
            if (in_trace)
                line.traces.emplace_back(place, std::min(width, place + step));
            place += step;
        }
        begun.push_back(line);
    }
    return begun;
}

} // namespace

TEST(Frequency, OnAScanlineAlongTheMeanNormalIsOneOverTheSpacing)
{
    for (const ProbabilityLaw& spacing : {exponential_spacing, lognormal_spacing, constant_spacing,
                                          normal_spacing, uniform_spacing, power_spacing})
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
    scene.joint_sets[0].dip = ProbabilityLaw{Kind::normal, 70 * deg, 3 * deg};
    scene.joint_sets[0].dip_direction = ProbabilityLaw{Kind::normal, 100 * deg, 3 * deg};
    const double n_p = section_normal(70 * deg, 100 * deg, 40 * deg).norm(); // .58
    const Samples counts = scanline_counts(scene, normal_at(trace_angle(70 * deg, 100 * deg, 40 * deg)));
    EXPECT_TRUE(have_mean(counts, 50 / 4. * n_p));
    EXPECT_FALSE(have_mean(counts, 50 / 4.)); // the true spacing taken for the one in the section
}

TEST(Frequency, OfPlanesByFishersLawIsOneOverTheSpacingInTheSection)
{
    for (const auto& [law, azimuth] : fisher_cases)
        for (const ProbabilityLaw& spacing : {exponential_spacing, power_spacing}) {
            const Scene scene = fisher_scene(law, azimuth, spacing);
            const double n_p = section_normal(law.dip, law.dip_direction, azimuth).norm();
            const Samples counts =
                scanline_counts(scene, normal_at(trace_angle(law.dip, law.dip_direction, azimuth)));
            EXPECT_TRUE(have_mean(counts, 50 / spacing.mean * n_p)) << n_p;
            EXPECT_FALSE(have_mean(counts, 1.05 * 50 / spacing.mean * n_p));
        }
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
        const Samples p21 = intensities(scene);
        double stretch = 0, weight = 0; // mean of 1/cos
        for (double z = -5; z <= 5; z += .01) {
            stretch += std::exp(-z * z / 2) / std::cos(z * scatter * deg);
            weight += std::exp(-z * z / 2);
        }
        EXPECT_TRUE(have_mean(p21, stretch / weight / 4)) << "scatter " << scatter;
        EXPECT_FALSE(have_mean(p21, 1.05 * stretch / weight / 4));
    }
}

TEST(Intensity, OfAUniformLawOfAnglesIsTheFrequencyOverTheMeanCosine)
{
    // The mean of 1 / cos(z) over |z| < h is log((1 + sin(h)) / (1 - sin(h))) / (2 h).
    for (const double half_width : {10 * deg, 30 * deg}) {
        const double sine = std::sin(half_width);
        const double secant = std::log((1 + sine) / (1 - sine)) / (2 * half_width);
        const Samples p21 = intensities(
            wide_scene(uniform_law(110 * deg - half_width, 110 * deg + half_width), uniform_spacing));
        EXPECT_TRUE(have_mean(p21, secant / uniform_spacing.mean));
        EXPECT_FALSE(have_mean(p21, 1.05 * secant / uniform_spacing.mean));
    }
}

TEST(Intensity, OfPlanesByFishersLawIsTheFrequencyOverTheMeanCosine)
{
    for (const auto& [law, azimuth] : fisher_cases) {
        const double expected = traces_by_fisher(law, azimuth).mean_secant *
                                section_normal(law.dip, law.dip_direction, azimuth).norm() / 4;
        const Samples p21 = intensities(fisher_scene(law, azimuth, exponential_spacing));
        EXPECT_TRUE(have_mean(p21, expected)) << mean(p21) << " for " << expected;
        EXPECT_FALSE(have_mean(p21, 1.05 * expected));
    }
}

TEST(TraceAngle, IsThatOfPolesByFishersLaw)
{
    auto cases = fisher_cases;
    cases.push_back({{55 * deg, 130 * deg, 20}, 60 * deg}); // where the part across the section counts
    cases.push_back({{90 * deg, 20 * deg, 30}, 60 * deg});
    for (const auto& [law, azimuth] : cases) {
        const Samples angles = trace_angles(fisher_scene(law, azimuth, constant_spacing),
                                            trace_angle(law.dip, law.dip_direction, azimuth));
        EXPECT_EQ(angles.size(), 35000);
        EXPECT_TRUE(follow(angles, distribution_of(traces_by_fisher(law, azimuth)))) << law.concentration;
        FisherLaw other = law; // of 5 percent more scatter
        other.concentration = law.concentration / 1.1;
        EXPECT_FALSE(follow(angles, distribution_of(traces_by_fisher(other, azimuth)))) << law.concentration;
    }
}

TEST(Anchor, SeesSpacingsBySizeAndTakesAUniformPlaceInThem)
{
    for (const ProbabilityLaw& spacing :
         {exponential_spacing, lognormal_spacing, normal_spacing, uniform_spacing, power_spacing}) {
        const Anchor anchor = anchors(spacing);
        EXPECT_TRUE(is_stationary_anchor(anchor.spacing, spacing));
        EXPECT_TRUE(follow(anchor.place, [](double x) { return x; }));
    }
}

TEST(Anchor, WouldBeCaughtWithoutSizeBias)
{
    for (const ProbabilityLaw& spacing : {lognormal_spacing, uniform_spacing, power_spacing}) {
        Stream stream({1, 0, 0}, 0, Purpose::spacing);
        Samples plain;
        for (int i = 0; i < 5000; ++i)
            plain.push_back(draw_positive(spacing, stream));
        EXPECT_FALSE(is_stationary_anchor(plain, spacing));
    }
}

TEST(Persistence, IsTheWantedOneOnAnyStretchOfLine)
{
    for (const ProbabilityLaw& length :
         {lognormal_length, exponential_length, normal_length, constant_length, uniform_length, power_length})
        for (const double persistence : {.1, .5, .9})
            for (const double width : {2.0, 50.0}) { // short of a trace, and many
                const std::vector<Traces> lines = long_lines(length, persistence, width, 4000);
                EXPECT_TRUE(has_persistence(lines, persistence))
                    << static_cast<int>(length.kind) << ' ' << width;
                if (persistence == .5) {
                    EXPECT_FALSE(has_persistence(lines, persistence * .9));
                }
            }
}

TEST(Persistence, WouldBeCaughtWithoutSizeBiasAtTheStartOfALine)
{
    for (const ProbabilityLaw& length : {lognormal_length, power_length})
        EXPECT_FALSE(has_persistence(lines_begun_without_size_bias(length, .5, 5, 4000), .5));
}

TEST(Persistence, VariesOnLongLinesAsAnAlternatingRenewalProcess)
{
    // Var(k_T) = (Var L E[G]^2 + Var G E[L]^2) / ((E[L] + E[G])^3 T), asymptotically
    for (const ProbabilityLaw& length :
         {lognormal_length, exponential_length, constant_length, uniform_length, power_length}) {
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
    for (const ProbabilityLaw& length :
         {lognormal_length, exponential_length, normal_length, uniform_length, power_length}) {
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
    for (const ProbabilityLaw& length :
         {lognormal_length, exponential_length, normal_length, uniform_length, power_length}) {
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

} // namespace joint_statistics_test
