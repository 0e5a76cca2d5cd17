// Networks against closed forms of stochastic geometry, and wrong samplers that must fail the same checks.
//
// Every check is one of statistics.hpp, wrong about a right sampler once in a thousand times; seeds are
// fixed. REALIZATIONS in the environment sets how many realizations each takes: 200, or 2000 with ctest
// --preset test -C Slow.

#include "blocks/cut.hpp"
#include "model/units.hpp"
#include "sampling/density.hpp"
#include "sampling/joint_sets.hpp"
#include "sampling/laws.hpp"
#include "scene/field_data.hpp"
#include "statistics.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <memory>

namespace acceptance_test
{

using namespace jointcreep;
using namespace jointcreep::sampling;
using namespace jointcreep::statistics;
using namespace jointcreep::unit;
using Eigen::Vector2d, Eigen::Vector3d;

namespace
{

using Kind = ProbabilityLaw::Kind;
using Measure = Density::Measure;
constexpr double pi = std::numbers::pi;

int realizations()
{
    const char* const given = std::getenv("REALIZATIONS");
    return given ? std::atoi(given) : 200;
}

const ProbabilityLaw lognormal{Kind::lognormal, 8, 5}, exponential{Kind::negative_exponential, 8, 8},
    constant{Kind::constant, 8, 0}, even = uniform_law(2, 14), power = power_law(3, 3, 60),
                                    bell{Kind::normal, 8, 2.5};
const std::vector<ProbabilityLaw> sizes{lognormal, exponential, constant, even, power, bell};

// A window of 60 m by 40 m, off the origin.
const double width = 60, height = 40;
const Vector2d corner(11, -17), middle = corner + Vector2d(width, height) / 2;

Scene scene_of(const std::vector<JointSet>& sets)
{
    Scene scene;
    scene.outline = {corner, corner + Vector2d(width, 0), corner + Vector2d(width, height),
                     corner + Vector2d(0, height)};
    scene.azimuth = 70 * deg;
    scene.rock = "rock";
    scene.rocks = {{"rock", 2700, 1e10, .25, {}}};
    scene.joint_materials = {{"clay", 1e8, 1e8, 0, .3, 0, {}}};
    scene.joint_sets = sets;
    scene.cutting = {1e-5, 0};
    return scene;
}

Scene square(double side, const std::vector<JointSet>& sets)
{
    Scene scene = scene_of(sets);
    scene.outline = {{0, 0}, {side, 0}, {side, side}, {0, side}};
    return scene;
}

JointSet segments(const ProbabilityLaw& trace_angle, const ProbabilityLaw& length, Measure measure,
                  double value)
{
    JointSet set;
    set.name = "segments";
    set.material = "clay";
    set.kind = SetKind::segments;
    set.trace_angle = trace_angle;
    set.length = length;
    set.density = Density{measure, value};
    return set;
}

JointSet lines(const ProbabilityLaw& trace_angle, const ProbabilityLaw& spacing)
{
    JointSet set;
    set.name = "lines";
    set.material = "clay";
    set.trace_angle = trace_angle;
    set.spacing = spacing;
    set.persistence = 1;
    return set;
}

const FisherLaw slanting{60 * deg, 110 * deg, 15}, flat{10 * deg, 300 * deg, 60},
    beside{85 * deg, 150 * deg, 8}; // its mean plane is 17 degrees off the section

JointSet discs(const FisherLaw& law, const ProbabilityLaw& diameter, Measure measure, double value)
{
    JointSet set;
    set.name = "discs";
    set.material = "clay";
    set.kind = SetKind::discs;
    set.orientation = law;
    set.diameter = diameter;
    set.density = Density{measure, value};
    return set;
}

ProbabilityLaw isotropic()
{
    return uniform_law(-90 * deg, 90 * deg);
}

ProbabilityLaw about(double angle, double deviation)
{
    return deviation == 0 ? ProbabilityLaw{Kind::constant, angle, 0}
                          : ProbabilityLaw{Kind::normal, angle, deviation};
}

// Traces of one realization.
struct Trace {
    Vector2d from, to;
    Vector2d centre() const { return (from + to) / 2; }
    double length() const { return (to - from).norm(); }
};
using Traces = std::vector<Trace>;
using Sampling = std::function<Traces(int realization)>;

Traces traces_of(const Joints& joints)
{
    Traces traces;
    for (std::size_t t = 0; t < joints.trace_from.size(); ++t)
        traces.push_back({joints.trace_from[t], joints.trace_to[t]});
    return traces;
}

// Each realization is sampled once.
Sampling sampled(const Scene& scene)
{
    const auto known = std::make_shared<std::map<int, Traces>>();
    return [scene, known](int realization) {
        const auto [at, is_new] = known->try_emplace(realization);
        if (is_new)
            at->second = traces_of(sample_joints(scene, 20030602, realization));
        return at->second;
    };
}

// Sampling whose traces are changed one by one, with a stream of their own.
Sampling changed(const Sampling& network, const std::function<Trace(const Trace&, Stream&)>& change)
{
    return [network, change](int realization) {
        Traces traces = network(realization);
        Stream stream({5, realization, 0}, 0, Purpose::size);
        for (Trace& trace : traces)
            trace = change(trace, stream);
        return traces;
    };
}

Samples measured(const Sampling& network, const std::function<double(const Traces&)>& measure)
{
    Samples samples;
    for (int r = 0; r < realizations(); ++r)
        samples.push_back(measure(network(r)));
    return samples;
}

// Of all traces of all realizations.
Samples pooled(const Sampling& network, const std::function<void(const Traces&, Samples&)>& collect)
{
    Samples samples;
    for (int r = 0; r < realizations(); ++r)
        collect(network(r), samples);
    return samples;
}

double cross(const Vector2d& a, const Vector2d& b)
{
    return a.x() * b.y() - a.y() * b.x();
}

// Length inside the box from `low` to `high`.
double length_in(const Trace& trace, const Vector2d& low, const Vector2d& high)
{
    double begin = 0, end = 1;
    const Vector2d run = trace.to - trace.from;
    for (int axis = 0; axis < 2; ++axis) {
        if (run[axis] == 0) {
            if (trace.from[axis] < low[axis] || trace.from[axis] > high[axis])
                return 0;
            continue;
        }
        const double a = (low[axis] - trace.from[axis]) / run[axis],
                     b = (high[axis] - trace.from[axis]) / run[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return std::max(0.0, end - begin) * run.norm();
}

bool is_in_window(const Vector2d& p)
{
    return p.x() > corner.x() && p.x() < corner.x() + width && p.y() > corner.y() &&
           p.y() < corner.y() + height;
}

// Where a trace crosses another, from 0 at its `from` to 1; none: -1.
double crossing(const Trace& trace, const Trace& other)
{
    const double a = cross(other.to - other.from, trace.from - other.from),
                 b = cross(other.to - other.from, trace.to - other.from);
    const double c = cross(trace.to - trace.from, other.from - trace.from),
                 d = cross(trace.to - trace.from, other.to - trace.from);
    return (a < 0) != (b < 0) && (c < 0) != (d < 0) ? a / (a - b) : -1;
}

// --- Checks -----------------------------------------------------------------------------------------------

bool has_p21(const Sampling& network, double p21)
{
    return have_mean(measured(network,
                              [](const Traces& traces) {
                                  double sum = 0;
                                  for (const Trace& trace : traces)
                                      sum += length_in(trace, corner, corner + Vector2d(width, height));
                                  return sum / (width * height);
                              }),
                     p21);
}

// In a strip of 3 m along the edges left and right.
bool has_p21_at_the_edge(const Sampling& network, double p21)
{
    const double strip = 3;
    return have_mean(measured(network,
                              [&](const Traces& traces) {
                                  double sum = 0;
                                  for (const Trace& trace : traces)
                                      for (const double x : {0.0, width - strip})
                                          sum += length_in(trace, corner + Vector2d(x, 0),
                                                           corner + Vector2d(x + strip, height));
                                  return sum / (2 * strip * height);
                              }),
                     p21);
}

Samples midpoint_counts(const Sampling& network)
{
    return measured(network, [](const Traces& traces) {
        return double(std::count_if(traces.begin(), traces.end(),
                                    [](const Trace& trace) { return is_in_window(trace.centre()); }));
    });
}

bool has_p20(const Sampling& network, double p20)
{
    return have_mean(midpoint_counts(network), p20 * width * height);
}

// Variance of a Poisson number (network with that mean).
bool has_poisson_counts(const Sampling& network, double p20)
{
    Samples squares;
    const double expected = p20 * width * height;
    for (const double count : midpoint_counts(network))
        squares.push_back(std::pow(count - expected, 2));
    return have_mean(squares, expected);
}

Trace scanline(double angle)
{
    const Vector2d half = 19 * Vector2d(std::cos(angle), std::sin(angle));
    return {middle - half, middle + half};
}

bool has_p10(const Sampling& network, double angle, double p10)
{
    const Trace line = scanline(angle);
    return have_mean(measured(network,
                              [&](const Traces& traces) {
                                  return double(
                                      std::count_if(traces.begin(), traces.end(), [&](const Trace& trace) {
                                          return crossing(line, trace) >= 0;
                                      }));
                              }),
                     p10 * line.length());
}

// Those with midpoints in the window: neither censored nor biased.
bool has_lengths(const Sampling& network, const Distribution& law)
{
    return follow(pooled(network,
                         [](const Traces& traces, Samples& lengths) {
                             for (const Trace& trace : traces)
                                 if (is_in_window(trace.centre()))
                                     lengths.push_back(trace.length());
                         }),
                  law);
}

bool has_angles(const Sampling& network, double mean, const Distribution& law)
{
    return follow(pooled(network,
                         [&](const Traces& traces, Samples& angles) {
                             for (const Trace& trace : traces)
                                 if (is_in_window(trace.centre())) {
                                     const Vector2d run = trace.to - trace.from;
                                     angles.push_back(
                                         std::remainder(std::atan2(run.y(), run.x()) - mean, pi));
                                 }
                         }),
                  law);
}

Samples lengths_hit(const Sampling& network)
{
    const Trace line = scanline(0);
    return pooled(network, [&](const Traces& traces, Samples& lengths) {
        for (const Trace& trace : traces)
            if (crossing(line, trace) >= 0)
                lengths.push_back(trace.length());
    });
}

bool is_size_biased(const Samples& hit, const ProbabilityLaw& law)
{
    return follow(hit, size_biased_distribution(law));
}

bool has_crossings(const Sampling& network, double per_area)
{
    return have_mean(measured(network,
                              [](const Traces& traces) {
                                  double count = 0;
                                  for (std::size_t i = 0; i < traces.size(); ++i)
                                      for (std::size_t j = 0; j < i; ++j)
                                          if (const double at = crossing(traces[i], traces[j]); at >= 0)
                                              count += is_in_window(traces[i].from +
                                                                    at * (traces[i].to - traces[i].from));
                                  return count / (width * height);
                              }),
                     per_area);
}

// --- Closed forms -----------------------------------------------------------------------------------------

double moment(const ProbabilityLaw& law, int order)
{
    // By the trapezoidal rule, apart from sampling/laws.cpp.
    if (law.kind == Kind::constant)
        return std::pow(law.mean, order);
    const std::vector<double> places = grid(law);
    double sum = 0, total = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
        const double a = density(law, places[i - 1]), b = density(law, places[i]),
                     step = places[i] - places[i - 1];
        total += step * (a + b) / 2;
        sum += step * (std::pow(places[i - 1], order) * a + std::pow(places[i], order) * b) / 2;
    }
    return sum / total;
}

// Of traces of discs: P(trace < l) = 1 - E[sqrt(D^2 - l^2); D > l] / E[D], from g(l) = (l / E[D]) times the
// integral of f(D) / sqrt(D^2 - l^2) over D > l (Warburton 1980).
Distribution disc_trace_distribution(const ProbabilityLaw& law)
{
    if (law.kind == Kind::constant)
        return [d = law.mean](double l) { return l >= d ? 1 : 1 - std::sqrt(1 - l * l / (d * d)); };
    const std::vector<double> places = grid(law);
    std::vector<double> weight;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double before = i == 0 ? 0 : places[i] - places[i - 1],
                     after = i + 1 == places.size() ? 0 : places[i + 1] - places[i];
        weight.push_back(density(law, places[i]) * (before + after) / 2);
    }
    double mean = 0;
    for (std::size_t i = 0; i < places.size(); ++i)
        mean += weight[i] * places[i];
    std::vector<double> at, sums; // a table, since samples are many
    for (int i = 0; i <= 600; ++i) {
        const double l = places.back() * std::pow(i / 600., 3);
        double sum = 0;
        for (std::size_t j = 0; j < places.size(); ++j)
            if (places[j] > l)
                sum += weight[j] * std::sqrt(places[j] * places[j] - l * l);
        at.push_back(l);
        sums.push_back(1 - sum / mean);
    }
    return [at, sums](double l) {
        const auto i = static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), l) - at.begin());
        if (i == at.size())
            return 1.0;
        return sums[i - 1] + (l - at[i - 1]) / (at[i] - at[i - 1]) * (sums[i] - sums[i - 1]);
    };
}

// Poles by Fisher's law on a grid, with x east, y north and z up, and means over them: apart from
// sampling/orientations.cpp.
struct Poles {
    std::vector<Vector3d> pole;
    std::vector<double> share;

    double mean(const std::function<double(const Vector3d&)>& value) const
    {
        double sum = 0, total = 0;
        for (std::size_t i = 0; i < pole.size(); ++i) {
            sum += share[i] * value(pole[i]);
            total += share[i];
        }
        return sum / total;
    }
};

Vector3d upward(double dip, double dip_direction)
{
    return {std::sin(dip) * std::sin(dip_direction), std::sin(dip) * std::cos(dip_direction), std::cos(dip)};
}

Poles poles_of(const FisherLaw& law)
{
    Poles all;
    const Vector3d mean = upward(law.dip, law.dip_direction), first = mean.unitOrthogonal(),
                   second = mean.cross(first);
    const int steps = 300;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double t = (i + .5) / steps * std::min(pi, 9 / std::sqrt(law.concentration)),
                         turn = (j + .5) / steps * 2 * pi;
            all.pole.push_back(std::cos(t) * mean +
                               std::sin(t) * (std::cos(turn) * first + std::sin(turn) * second));
            all.share.push_back(std::sin(t) * std::exp(law.concentration * (std::cos(t) - 1)));
        }
    return all;
}

// The section's horizontal direction and its normal.
Vector3d right_of(double azimuth)
{
    return {std::sin(azimuth), std::cos(azimuth), 0};
}

double sine_to_section(const Vector3d& n, double azimuth)
{
    const Vector3d across = right_of(azimuth).cross(Vector3d::UnitZ());
    return n.cross(across).norm();
}

const double azimuth = 70 * deg;

// Trace angles, off the mean plane's, of planes that a section meets: each by the sine of its angle to it, or
// without that bias.
Distribution angles_in_section(const FisherLaw& law, bool biased)
{
    const Poles all = poles_of(law);
    const Vector3d up(0, 0, 1), right = right_of(azimuth);
    const auto angle = [&](const Vector3d& n) { return std::atan2(-n.dot(right), n.dot(up)); };
    const double mean = angle(upward(law.dip, law.dip_direction));
    std::vector<std::pair<double, double>> by_angle;
    double total = 0;
    for (std::size_t i = 0; i < all.pole.size(); ++i) {
        const double share = all.share[i] * (biased ? sine_to_section(all.pole[i], azimuth) : 1);
        by_angle.emplace_back(std::remainder(angle(all.pole[i]) - mean, pi), share);
        total += share;
    }
    std::sort(by_angle.begin(), by_angle.end());
    std::vector<double> angles, sums;
    double sum = 0;
    for (const auto& [off, share] : by_angle) {
        angles.push_back(off);
        sums.push_back(sum += share / total);
    }
    return [angles, sums](double off) {
        const auto after = std::upper_bound(angles.begin(), angles.end(), off) - angles.begin();
        return after == 0 ? 0.0 : sums[after - 1];
    };
}

// E|sin| of the angle between two directions of a law, and E|cos| to a scanline.
double mean_over(const ProbabilityLaw& angle, const std::function<double(double)>& value)
{
    double sum = 0, total = 0;
    const int steps = 2000;
    for (int i = 0; i < steps; ++i) {
        const double at = (i + .5) / steps;
        double x = angle.mean, weight = 1;
        if (angle.kind == Kind::uniform)
            x = angle.least + at * (angle.most - angle.least);
        if (angle.kind == Kind::normal) {
            x = angle.mean + (14 * at - 7) * angle.deviation;
            weight = std::exp(-std::pow(14 * at - 7, 2) / 2);
        }
        sum += weight * value(x);
        total += weight;
    }
    return sum / total;
}

double mean_sine(const ProbabilityLaw& angle)
{
    return mean_over(angle, [&](double a) {
        return mean_over(angle, [&](double b) { return std::abs(std::sin(a - b)); });
    });
}

double mean_sine_to(const ProbabilityLaw& angle, double scanline_angle)
{
    return mean_over(angle, [&](double a) { return std::abs(std::sin(a - scanline_angle)); });
}

} // namespace

// --- D, G, N: segments ------------------------------------------------------------------------------------

TEST(Segments, HaveTheirDensitiesToTheEdge)
{
    const double p21 = .4;
    for (const ProbabilityLaw& length : sizes)
        for (const ProbabilityLaw& angle : {about(30 * deg, 10 * deg), isotropic()}) {
            const Sampling network = sampled(scene_of({segments(angle, length, Measure::p21, p21)}));
            const double p20 = p21 / moment(length, 1);
            EXPECT_TRUE(has_p21(network, p21)) << int(length.kind);
            EXPECT_TRUE(has_p21_at_the_edge(network, p21)) << int(length.kind);
            EXPECT_TRUE(has_p20(network, p20)) << int(length.kind);
            EXPECT_TRUE(has_poisson_counts(network, p20)) << int(length.kind);
            for (const double line : {0.0, 50 * deg})
                EXPECT_TRUE(has_p10(network, line, p21 * mean_sine_to(angle, line))) << int(length.kind);
        }
    const Sampling few = sampled(scene_of({segments(isotropic(), lognormal, Measure::p20, .02)}));
    EXPECT_TRUE(has_p20(few, .02));
    EXPECT_TRUE(has_p21(few, .02 * 8));
}

TEST(Segments, CrossAsOftenAsTheyShould)
{
    for (const ProbabilityLaw& angle : {about(30 * deg, 20 * deg), isotropic()}) {
        const Sampling network = sampled(scene_of({segments(angle, lognormal, Measure::p21, .4)}));
        EXPECT_TRUE(has_crossings(network, .5 * .4 * .4 * mean_sine(angle)));
        EXPECT_FALSE(has_crossings(network, .4 * .4 * mean_sine(angle)));
    }
    EXPECT_NEAR(mean_sine(isotropic()), 2 / pi, 1e-5);
    EXPECT_NEAR(mean_sine_to(isotropic(), .3), 2 / pi, 1e-5);
}

TEST(Segments, HaveTheirLengthsAndAreMetBySize)
{
    for (const ProbabilityLaw& length : sizes) {
        if (length.kind == Kind::constant)
            continue;
        const Sampling network =
            sampled(scene_of({segments(about(80 * deg, 5 * deg), length, Measure::p21, .4)}));
        EXPECT_TRUE(has_lengths(network, positive_distribution(length))) << int(length.kind);
        EXPECT_FALSE(has_lengths(network, size_biased_distribution(length))) << int(length.kind);
        EXPECT_TRUE(is_size_biased(lengths_hit(network), length)) << int(length.kind);
    }
}

TEST(Segments, HaveSemiTracesAsPriestAndHudson)
{
    // Beyond a scanline, by h(x) = (1 - F(x)) / E[l]; of exponential lengths the share below c is 1 -
    // e^-c/E[l].
    const Trace line = scanline(0);
    for (const ProbabilityLaw& length : {lognormal, exponential, even}) {
        const Samples beyond =
            pooled(sampled(scene_of({segments(about(80 * deg, 0), length, Measure::p21, .4)})),
                   [&](const Traces& traces, Samples& lengths) {
                       for (const Trace& trace : traces)
                           if (crossing(line, trace) >= 0)
                               lengths.push_back((1 - crossing(trace, line)) * trace.length());
                   });
        EXPECT_TRUE(follow(beyond, residual_distribution(length)));
        if (length.kind != Kind::negative_exponential) {
            EXPECT_FALSE(follow(beyond, positive_distribution(length)));
            continue;
        }
        Samples below;
        for (const double x : beyond)
            below.push_back(x < 5 ? 1 : 0);
        EXPECT_TRUE(have_mean(below, -std::expm1(-5. / 8)));
    }
}

TEST(Segments, WouldBeCaughtWithTheEdgeEffectLeftIn)
{
    // Midpoints in the window only, and as many as give the right density in all of it.
    const Sampling network = sampled(scene_of({segments(isotropic(), exponential, Measure::p21, .4)}));
    const Sampling inside_only = [network](int realization) {
        Traces traces = network(realization);
        std::erase_if(traces, [](const Trace& trace) { return !is_in_window(trace.centre()); });
        return traces;
    };
    EXPECT_TRUE(has_p20(inside_only, .05));
    EXPECT_FALSE(has_p21(inside_only, .4));
    EXPECT_FALSE(has_p21_at_the_edge(inside_only, .4));
    // The window widened by half the mean length.
    const Sampling by_mean = [network](int realization) {
        Traces traces = network(realization);
        std::erase_if(traces, [](const Trace& trace) {
            const Vector2d off = (trace.centre() - middle).cwiseAbs() - Vector2d(width, height) / 2;
            return off.maxCoeff() > 4;
        });
        return traces;
    };
    EXPECT_FALSE(has_p21_at_the_edge(by_mean, .4));
}

TEST(Segments, WouldBeCaughtWithLogParametersTakenForTheLengths)
{
    const Sampling network = sampled(scene_of({segments(isotropic(), lognormal, Measure::p20, .05)}));
    // exp(N(ln mean, (deviation / mean)^2)).
    const Sampling wrong = changed(network, [](const Trace& trace, Stream& stream) {
        const double length = std::exp(draw({Kind::normal, std::log(8.), 5. / 8}, stream));
        const Vector2d half = (trace.to - trace.from).normalized() * length / 2;
        return Trace{trace.centre() - half, trace.centre() + half};
    });
    EXPECT_TRUE(has_lengths(network, positive_distribution(lognormal)));
    EXPECT_FALSE(has_lengths(wrong, positive_distribution(lognormal)));
    EXPECT_FALSE(has_p21(wrong, .4));
}

TEST(Segments, WouldBeCaughtWithoutSizeBias)
{
    for (const ProbabilityLaw& length : {lognormal, exponential, even, power}) {
        Stream stream({1, 0, 0}, 0, Purpose::size);
        Samples plain;
        for (int i = 0; i < 20 * realizations(); ++i)
            plain.push_back(draw_positive(length, stream));
        EXPECT_FALSE(is_size_biased(plain, length));
    }
    // A fixed number in place of a Poisson one.
    const Sampling network = sampled(scene_of({segments(isotropic(), constant, Measure::p20, .05)}));
    const Sampling fixed_number = [network](int realization) {
        Traces traces = network(realization);
        std::erase_if(traces, [](const Trace& trace) { return !is_in_window(trace.centre()); });
        traces.resize(120, {middle, middle + Vector2d(1, 0)});
        return traces;
    };
    EXPECT_TRUE(has_poisson_counts(network, .05));
    EXPECT_FALSE(has_poisson_counts(fixed_number, .05));
}

// --- I, K: discs ------------------------------------------------------------------------------------------

TEST(Discs, HaveTheirDensitiesInTheSection)
{
    const double p32 = .4;
    for (const FisherLaw& law : {slanting, flat, beside})
        for (const ProbabilityLaw& diameter : sizes) {
            const Sampling network = sampled(scene_of({discs(law, diameter, Measure::p32, p32)}));
            const Poles all = poles_of(law);
            const double met = all.mean([](const Vector3d& n) { return sine_to_section(n, azimuth); });
            const double p30 = p32 / (pi / 4 * moment(diameter, 2));
            EXPECT_TRUE(has_p21(network, p32 * met)) << int(diameter.kind);
            EXPECT_TRUE(has_p21_at_the_edge(network, p32 * met)) << int(diameter.kind);
            EXPECT_TRUE(has_p20(network, p30 * moment(diameter, 1) * met)) << int(diameter.kind);
            EXPECT_TRUE(has_poisson_counts(network, p30 * moment(diameter, 1) * met));
            for (const double line : {20 * deg, 90 * deg}) {
                const Vector3d v = std::cos(line) * right_of(azimuth) + std::sin(line) * Vector3d::UnitZ();
                const double p10 = p32 * all.mean([&](const Vector3d& n) { return std::abs(n.dot(v)); });
                EXPECT_TRUE(has_p10(network, line, p10)) << int(diameter.kind);
            }
            EXPECT_FALSE(has_p21(network, p32 * (met < .9 ? 1 : .9))); // of those across the section
        }
}

TEST(Discs, HaveTheTraceLengthsOfWarburton)
{
    for (const ProbabilityLaw& diameter : sizes) {
        const Sampling network = sampled(scene_of({discs(slanting, diameter, Measure::p32, .4)}));
        EXPECT_TRUE(has_lengths(network, disc_trace_distribution(diameter))) << int(diameter.kind);
        const Samples lengths = pooled(network, [](const Traces& traces, Samples& all) {
            for (const Trace& trace : traces)
                if (is_in_window(trace.centre()))
                    all.push_back(trace.length());
        });
        EXPECT_TRUE(have_mean(lengths, pi / 4 * moment(diameter, 2) / moment(diameter, 1)));
    }
}

TEST(Discs, HaveTheTracesOfDiscsCutInSpace)
{
    // The second method: discs in a box of space, cut by the plane z = 0 one by one.
    const ProbabilityLaw diameter = even;
    const double side = 40, p30 = 2e-3;
    const FisherLaw law = slanting;
    const Vector3d mean = Vector3d(.5, .3, .8).normalized();
    Samples lengths, counts;
    double met = 0;
    int planes = 0;
    for (int r = 0; r < realizations(); ++r) {
        Stream stream({9, r, 0}, 0, Purpose::position);
        double count = 0;
        const std::int64_t n = draw_poisson(p30 * side * side * 2 * diameter.most, stream);
        for (std::int64_t i = 0; i < n; ++i) {
            const double d = draw_positive(diameter, stream);
            const Vector3d centre(0, 0, (2 * uniform(stream) - 1) * diameter.most),
                normal = draw_fisher(mean, law.concentration, stream);
            const double sine = normal.head<2>().norm(), off = centre.z() / sine; // in the disc's plane
            met += sine;
            ++planes;
            if (std::abs(off) < d / 2) {
                lengths.push_back(2 * std::sqrt(d * d / 4 - off * off));
                ++count;
            }
        }
        counts.push_back(count);
    }
    EXPECT_TRUE(follow(lengths, disc_trace_distribution(diameter)));
    EXPECT_TRUE(have_mean(counts, p30 * diameter.mean * met / planes * side * side));
}

TEST(Discs, LieAsPolesThatTheSectionMeets)
{
    for (const FisherLaw& law : {slanting, beside}) {
        const Sampling network = sampled(scene_of({discs(law, constant, Measure::p32, 1)}));
        const double mean = trace_angle(law.dip, law.dip_direction, azimuth);
        EXPECT_TRUE(has_angles(network, mean, angles_in_section(law, true)));
        if (law.concentration ==
            beside.concentration) { // of the other set the section meets nearly all alike
            EXPECT_FALSE(has_angles(network, mean, angles_in_section(law, false)));
        }
    }
}

TEST(Discs, WouldBeCaughtWithMeanChordsOrPlainDiameters)
{
    for (const ProbabilityLaw& diameter : {lognormal, exponential, even}) {
        const Sampling network = sampled(scene_of({discs(slanting, diameter, Measure::p32, .4)}));
        const auto with_length = [&](const std::function<double(Stream&)>& length) {
            return changed(network, [length](const Trace& trace, Stream& stream) {
                const Vector2d half = (trace.to - trace.from).normalized() * length(stream) / 2;
                return Trace{trace.centre() - half, trace.centre() + half};
            });
        };
        const Distribution right = disc_trace_distribution(diameter);
        const auto chord = [](double size, Stream& stream) {
            return size * std::sqrt(1 - std::pow(2 * uniform(stream) - 1, 2));
        };
        EXPECT_TRUE(has_lengths(
            with_length([&](Stream& s) { return chord(draw_size_biased(diameter, s), s); }), right));
        EXPECT_FALSE(has_lengths( // the mean chord of each, in place of one at a uniform distance
            with_length([&](Stream& s) { return pi / 4 * draw_size_biased(diameter, s); }), right));
        EXPECT_FALSE(has_lengths( // all discs alike, in place of large ones sooner
            with_length([&](Stream& s) { return chord(draw_positive(diameter, s), s); }), right));
        EXPECT_FALSE(has_lengths( // diameters for traces
            with_length([&](Stream& s) { return draw_size_biased(diameter, s); }), right));
    }
}

TEST(Rose, HasTheMeansOfItsLaw)
{
    for (const FisherLaw& law : {slanting, flat, beside}) {
        const Scene scene = scene_of({discs(law, constant, Measure::p32, 1)});
        const double met = poles_of(law).mean([](const Vector3d& n) { return sine_to_section(n, azimuth); });
        EXPECT_NEAR(density_of(scene.joint_sets[0], scene).p21, met, 5e-4);
        const Vector3d v = right_of(azimuth);
        const double along = poles_of(law).mean([&](const Vector3d& n) { return std::abs(n.dot(v)); });
        EXPECT_NEAR(expected_p10(scene.joint_sets[0], scene, Vector3d::UnitX()), along, 5e-4);
    }
}

// --- H: densities measured otherwise, measured poles ------------------------------------------------------

TEST(DensityTarget, GivesLinesTheirTracesPerScanlineAndArea)
{
    const double angle = 35 * deg;
    for (const ProbabilityLaw& spacing :
         {ProbabilityLaw{Kind::negative_exponential, 1, 1}, ProbabilityLaw{Kind::lognormal, 70, 50},
          uniform_law(1, 2), power_law(2.5, 1, 20)})
        for (const double scatter : {0.0, 12 * deg})
            for (const double persistence : {1.0, .6}) {
                JointSet set = lines(about(angle, scatter), spacing);
                set.persistence = persistence;
                set.length = lognormal;
                const double on = 70 * deg; // a scanline 35 degrees to the lines
                set.density = Density{Measure::p10, .3, {on}};
                EXPECT_TRUE(has_p10(sampled(scene_of({set})), on, .3)) << int(spacing.kind);
                set.density = Density{Measure::p21, .3};
                EXPECT_TRUE(has_p21(sampled(scene_of({set})), .3)) << int(spacing.kind);
                // Without Terzaghi's correction: as if the scanline ran across the lines.
                JointSet wrong = lines(about(angle, scatter), {Kind::negative_exponential, 1 / .3, 1 / .3});
                EXPECT_FALSE(has_p10(sampled(scene_of({wrong})), on, .3));
            }
}

TEST(DensityTarget, IsTheSameByEveryMeasure)
{
    const auto expect_same = [](JointSet set, const std::vector<Measure>& measures) {
        const Scene scene = scene_of({set});
        const SetDensity first = density_of(set, scene);
        for (const Measure measure : measures) {
            const Scanline line{{}, 40 * deg, 25 * deg};
            const double value = measure == Measure::p10 ? expected_p10(set, scene, direction_of(line, scene))
                                 : measure == Measure::p20 ? first.p20
                                 : measure == Measure::p21 ? first.p21
                                 : measure == Measure::p30 ? first.p30
                                                           : first.p32;
            JointSet other = set;
            other.density = Density{measure, value, line};
            const SetDensity again = density_of(other, scene);
            EXPECT_NEAR(again.p21, first.p21, 1e-12 * first.p21);
            EXPECT_NEAR(again.p20, first.p20, 1e-12 * first.p20);
            EXPECT_NEAR(again.p32, first.p32, 1e-12 * first.p32);
            EXPECT_NEAR(again.spacing, first.spacing, 1e-12 * first.spacing);
        }
    };
    expect_same(discs(slanting, lognormal, Measure::p32, .3),
                {Measure::p10, Measure::p20, Measure::p21, Measure::p30, Measure::p32});
    JointSet in_space = segments({}, lognormal, Measure::p21, .3);
    in_space.trace_angle.reset();
    in_space.orientation = slanting;
    expect_same(in_space, {Measure::p10, Measure::p20, Measure::p21, Measure::p32});
    JointSet of_lines = lines({}, exponential);
    of_lines.trace_angle.reset();
    of_lines.orientation = flat;
    expect_same(of_lines, {Measure::p10, Measure::p21, Measure::p32});
}

namespace
{

// Two families of planes, as many of one as of the other by area, of which a scanline meets one far more
// often.
const std::vector<MeasuredPole> families{{80 * deg, 60 * deg, 1}, {75 * deg, 140 * deg, 1}};
const Scanline hole{{}, 62 * deg, 5 * deg};

double along_hole(const MeasuredPole& pole)
{
    const Vector3d down(std::cos(hole.plunge) * std::sin(hole.trend),
                        std::cos(hole.plunge) * std::cos(hole.trend), -std::sin(hole.plunge));
    return std::abs(upward(pole.dip, pole.dip_direction).dot(down));
}

// What 400 readings of the scanline are.
std::vector<MeasuredPole> readings()
{
    Stream stream({3, 0, 0}, 0, Purpose::orientation);
    const double first = along_hole(families[0]) / (along_hole(families[0]) + along_hole(families[1]));
    std::vector<MeasuredPole> poles;
    for (int i = 0; i < 400; ++i)
        poles.push_back(families[i < std::lround(400 * first) ? 0 : 1]);
    return poles;
}

// The share of traces of the first family in the section: they are met by the sine of their angle to it.
bool has_first_family(const Sampling& network, double share)
{
    const double first = trace_angle(families[0].dip, families[0].dip_direction, azimuth);
    return have_mean(pooled(network,
                            [&](const Traces& traces, Samples& of_first) {
                                for (const Trace& trace : traces)
                                    if (is_in_window(trace.centre())) {
                                        const Vector2d run = trace.to - trace.from;
                                        const double off =
                                            std::remainder(std::atan2(run.y(), run.x()) - first, pi);
                                        of_first.push_back(std::abs(off) < 1e-9 ? 1 : 0);
                                    }
                            }),
                     share);
}

} // namespace

TEST(MeasuredPoles, AreWeighedByTerzaghi)
{
    JointSet set = discs(slanting, constant, Measure::p32, .5);
    set.orientation.reset();
    set.poles = readings();
    const double a = sine_to_section(upward(families[0].dip, families[0].dip_direction), azimuth),
                 b = sine_to_section(upward(families[1].dip, families[1].dip_direction), azimuth);
    const double share = a / (a + b);
    EXPECT_FALSE(has_first_family(sampled(scene_of({set})), share)); // as they were counted
    scene::correct_for_scanline(set.poles, hole, 10 * deg);
    EXPECT_TRUE(has_first_family(sampled(scene_of({set})), share));
    EXPECT_TRUE(has_p21(sampled(scene_of({set})), .5 * (a + b) / 2));
}

TEST(MeasuredPoles, GiveLinesWhatAPlaneOfThemMeets)
{
    // Infinite planes in space: traces a metre of scanline and of area.
    JointSet set = lines({}, {Kind::negative_exponential, 1, 1});
    set.trace_angle.reset();
    set.poles = {
        {70 * deg, 75 * deg, 2}, {60 * deg, 50 * deg, 1}, {85 * deg, 100 * deg, 3}, {55 * deg, 80 * deg, 1}};
    set.density = Density{Measure::p32, .3};
    double p21 = 0, p10 = 0, total = 0;
    const double line = -30 * deg;
    const Vector3d v = std::cos(line) * right_of(azimuth) + std::sin(line) * Vector3d::UnitZ();
    for (const MeasuredPole& pole : set.poles) {
        const Vector3d n = upward(pole.dip, pole.dip_direction);
        p21 += .3 * pole.weight * sine_to_section(n, azimuth);
        p10 += .3 * pole.weight * std::abs(n.dot(v));
        total += pole.weight;
    }
    EXPECT_TRUE(has_p21(sampled(scene_of({set})), p21 / total));
    EXPECT_TRUE(has_p10(sampled(scene_of({set})), line, p10 / total));
    EXPECT_FALSE(has_p21(sampled(scene_of({set})), 1.1 * p21 / total));
}

// --- F: rock quality designation --------------------------------------------------------------------------

TEST(RockQuality, IsThatOfPriestAndHudson)
{
    // The share of a scanline in pieces longer than t: e^-(f t) (1 + f t) for exponential spacings.
    const double t = 1, f = 1 / 1.5;
    const auto quality = [&](const ProbabilityLaw& spacing) {
        return measured(sampled(scene_of({lines(about(90 * deg, 0), spacing)})), [&](const Traces& traces) {
            std::vector<double> places;
            for (const Trace& trace : traces)
                places.push_back(trace.from.x());
            std::sort(places.begin(), places.end());
            double share = 0;
            for (int i = 0; i < 50; ++i) {
                const double at = corner.x() + 15 + .6 * i;
                const auto after = std::upper_bound(places.begin(), places.end(), at);
                if (after == places.begin() || after == places.end())
                    return 0.0;
                share += *after - *(after - 1) > t ? .02 : 0;
            }
            return share;
        });
    };
    const double expected = std::exp(-f * t) * (1 + f * t);
    EXPECT_TRUE(have_mean(quality({Kind::negative_exponential, 1.5, 1.5}), expected));
    EXPECT_FALSE(have_mean(quality({Kind::lognormal, 1.5, .7}), expected));
}

// --- A, B, C, M: cells -------------------------------------------------------------------------------------

namespace
{

struct Cell {
    double area;
    Vector2d leftmost;
    int sides;
    bool holds_centre;
};

bool is_inside(const Polygon& ring, const Vector2d& p)
{
    bool inside = false;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if ((a.y() > p.y()) != (b.y() > p.y()) &&
            p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
            inside = !inside;
    }
    return inside;
}

// Corners of a ring at which it turns.
int sides_of(const Polygon& ring)
{
    int sides = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d in = (ring[(i + 1) % ring.size()] - ring[i]).normalized(),
                       out = (ring[(i + 2) % ring.size()] - ring[(i + 1) % ring.size()]).normalized();
        sides += std::abs(cross(in, out)) > 1e-7;
    }
    return sides;
}

std::vector<Cell> cells_of(const Scene& scene, int realization)
{
    const Blocks blocks = blocks::cut(scene, sample_joints(scene, 20030602, realization));
    Vector2d centre(0, 0);
    for (const Vector2d& p : scene.outline)
        centre += p / double(scene.outline.size());
    std::vector<Cell> cells;
    double sum = 0;
    for (std::size_t b = 0; b < blocks.block_area.size(); ++b) {
        const Index r = blocks.block_ring[b];
        Polygon ring;
        for (Index i = blocks.ring_start[r]; i < blocks.ring_start[r + 1]; ++i)
            ring.push_back(blocks.vertex[blocks.ring_vertex[i]]);
        const auto leftmost = *std::min_element(
            ring.begin(), ring.end(), [](const Vector2d& a, const Vector2d& b2) { return a.x() < b2.x(); });
        cells.push_back({blocks.block_area[b], leftmost, sides_of(ring), is_inside(ring, centre)});
        sum += blocks.block_area[b];
    }
    double outline = 0;
    for (std::size_t i = 0; i < scene.outline.size(); ++i)
        outline += cross(scene.outline[i], scene.outline[(i + 1) % scene.outline.size()]) / 2;
    EXPECT_NEAR(sum, outline, 1e-9 * outline); // M
    return cells;
}

Samples over_cells(const Scene& scene, const std::function<double(const std::vector<Cell>&)>& measure)
{
    Samples samples;
    for (int r = 0; r < realizations(); ++r)
        samples.push_back(measure(cells_of(scene, r)));
    return samples;
}

double count_of(const std::vector<Cell>& cells)
{
    return double(cells.size());
}

double area_at_centre(const std::vector<Cell>& cells)
{
    for (const Cell& cell : cells)
        if (cell.holds_centre)
            return cell.area;
    return 0;
}

const double plane = 100, intensity = .3;

// Poisson lines but for a length: segments so long that next to none ends in the window.
Scene poisson_lines(const ProbabilityLaw& angle)
{
    return square(plane, {segments(angle, {Kind::constant, 5e4, 0}, Measure::p21, intensity)});
}

bool has_faces_of_poisson_lines(const Scene& scene)
{
    const double perimeter = 4 * plane, area = plane * plane;
    return have_mean(over_cells(scene, count_of),
                     1 + intensity * perimeter / pi + intensity * intensity * area / pi);
}

} // namespace

TEST(PoissonLines, MakeAsManyCellsAsTheyShould)
{
    EXPECT_TRUE(has_faces_of_poisson_lines(poisson_lines(isotropic())));
    EXPECT_FALSE(has_faces_of_poisson_lines(poisson_lines(uniform_law(-45 * deg, 45 * deg))));
}

TEST(PoissonLines, MakeTheCellsOfMilesAndMatheron)
{
    // Cells by their leftmost corner in an inner window, which takes each as likely as another: in number
    // L^2/pi an area, of mean area pi/L^2, E[A^2] = pi^4 / (2 L^4), mean sides 4, P(triangle) = 2 - pi^2/6.
    const double margin = 25, inner = std::pow(plane - 2 * margin, 2),
                 number = inner * intensity * intensity / pi, area = pi / (intensity * intensity);
    const Scene scene = poisson_lines(isotropic());
    Samples count, sum, squares, sides, triangles;
    for (int r = 0; r < realizations(); ++r) {
        double of[5] = {};
        for (const Cell& cell : cells_of(scene, r)) {
            if ((cell.leftmost - Vector2d(plane, plane) / 2).cwiseAbs().maxCoeff() > plane / 2 - margin)
                continue;
            of[0] += 1;
            of[1] += cell.area;
            of[2] += cell.area * cell.area;
            of[3] += cell.sides;
            of[4] += cell.sides == 3;
        }
        count.push_back(of[0]), sum.push_back(of[1]), squares.push_back(of[2]);
        sides.push_back(of[3] - 4 * of[0]);
        triangles.push_back(of[4] - (2 - pi * pi / 6) * of[0]);
    }
    EXPECT_TRUE(have_mean(count, number)) << mean(count) << " for " << number;
    EXPECT_TRUE(have_mean(sum, number * area)) << mean(sum) << " for " << number * area;
    EXPECT_TRUE(have_mean(squares, number * area * area * pi * pi / 2));
    EXPECT_TRUE(have_mean(sides, 0)) << mean(sides);
    EXPECT_TRUE(have_mean(triangles, 0)) << mean(triangles);
}

TEST(Lines, MakeAsManyCellsAsTheyShould)
{
    // E[faces] = 1 + sum of f_i w_i + X A for stationary sets that are independent, whatever their spacing.
    const std::vector<double> angle{15 * deg, 75 * deg, 130 * deg};
    const std::vector<ProbabilityLaw> spacing{
        {Kind::lognormal, 6, 3}, {Kind::negative_exponential, 8, 8}, uniform_law(2, 12)};
    std::vector<JointSet> sets;
    double expected = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        sets.push_back(lines(about(angle[i], 0), spacing[i]));
        sets.back().name += std::to_string(i);
        const double f = 1 / spacing[i].mean;
        expected += f * (width * std::abs(std::sin(angle[i])) + height * std::abs(std::cos(angle[i])));
        for (std::size_t j = 0; j < i; ++j)
            expected += f / spacing[j].mean * std::abs(std::sin(angle[i] - angle[j])) * width * height;
    }
    EXPECT_TRUE(have_mean(over_cells(scene_of(sets), count_of), expected));
    sets[1].spacing = {Kind::negative_exponential, 10, 10};
    EXPECT_FALSE(have_mean(over_cells(scene_of(sets), count_of), expected));
}

TEST(Lines, MakeTheParallelogramsOfTheirSpacings)
{
    // The cell at a point: A = S1 S2 / sin g with both spacings by size. Exponential: of mean 4 E[A], and
    // P(A < a) from two gammas of shape 2; lognormal: lognormal, the variances of the logarithms add.
    const double g = 70 * deg;
    const auto at_centre = [&](const ProbabilityLaw& first, const ProbabilityLaw& second) {
        JointSet a = lines(about(10 * deg, 0), first), b = lines(about(10 * deg + g, 0), second);
        b.name = "others";
        return over_cells(square(120, {a, b}), area_at_centre);
    };
    const ProbabilityLaw spacing{Kind::negative_exponential, 4, 4}, other{Kind::negative_exponential, 5, 5};
    const double mean_area = 20 / std::sin(g);
    const Distribution two_gammas = [&](double a) {
        double sum = 0;
        const double step = .01, z = a / mean_area;
        for (double s = step / 2; s < 40; s += step)
            sum += step * s * std::exp(-s) * (1 - (1 + z / s) * std::exp(-z / s));
        return sum;
    };
    const Samples exponential_cells = at_centre(spacing, other);
    EXPECT_TRUE(follow(exponential_cells, two_gammas));
    EXPECT_TRUE(have_mean(exponential_cells, 4 * mean_area));

    const ProbabilityLaw narrow{Kind::lognormal, 4, 2};
    const double variance = std::log(1 + .25);
    const auto lognormal_cells = [&](double bias) {
        // Size bias moves the mean of each logarithm by its variance.
        const double log_mean = 2 * (std::log(4.) - variance / 2 + bias * variance) - std::log(std::sin(g));
        return [=](double a) { return std::erfc(-(std::log(a) - log_mean) / std::sqrt(4 * variance)) / 2; };
    };
    const Samples cells = at_centre(narrow, narrow);
    EXPECT_TRUE(follow(cells, lognormal_cells(1)));
    EXPECT_FALSE(follow(cells, lognormal_cells(0))); // without size bias
    EXPECT_FALSE(follow(cells, two_gammas));
}

// --- L: terminations --------------------------------------------------------------------------------------

namespace
{

// Level lines of exponential spacing, and upright segments that end at them. A trace grown from its midpoint
// goes half its length at most, and is ended at the rate p f |sin|.
Scene ended(double probability, const ProbabilityLaw& length, double angle)
{
    JointSet beds = lines(about(0, 0), {Kind::negative_exponential, 5, 5});
    beds.name = "beds";
    JointSet crossing_them = segments(about(angle, 0), length, Measure::p20, .03);
    crossing_them.terminates_at = {"beds"};
    crossing_them.termination_probability = probability;
    return square(200, {beds, crossing_them});
}

// Upper halves of traces with midpoints well inside, as drawn from `number` on: the whole trace is that of
// the set without terminations.
Samples upper_halves(const Scene& scene)
{
    Scene free = scene;
    free.joint_sets[1].terminates_at.clear();
    Samples halves;
    for (int r = 0; r < realizations(); ++r) {
        const Joints ended_joints = sample_joints(scene, 20030602, r),
                     whole = sample_joints(free, 20030602, r);
        std::map<Index, Trace> by_number;
        for (std::size_t j = 0; j < whole.set.size(); ++j)
            if (whole.set[j] == 1)
                by_number[whole.number[j]] = {whole.from[j], whole.to[j]};
        int taken = 0;
        for (std::size_t j = 0; j < ended_joints.set.size(); ++j) {
            if (ended_joints.set[j] != 1)
                continue;
            const Vector2d centre = by_number.at(ended_joints.number[j]).centre();
            if ((centre - Vector2d(100, 100)).cwiseAbs().maxCoeff() > 50)
                continue;
            halves.push_back((ended_joints.to[j] - centre).norm());
            if (++taken == 1)
                break; // neighbours end at the same bed
        }
    }
    return halves;
}

bool is_ended(const Samples& halves, const ProbabilityLaw& length, double probability, double angle)
{
    const double rate = probability / 5 * std::abs(std::sin(angle));
    const Distribution whole = positive_distribution(length);
    return follow(halves, [&](double x) { return 1 - (1 - whole(2 * x)) * std::exp(-rate * x); });
}

} // namespace

TEST(Terminations, EndTracesAtTheirRate)
{
    const ProbabilityLaw length{Kind::negative_exponential, 20, 20};
    for (const double probability : {1.0, .4}) {
        const Samples halves = upper_halves(ended(probability, length, 60 * deg));
        EXPECT_TRUE(is_ended(halves, length, probability, 60 * deg)) << probability;
        EXPECT_FALSE(is_ended(halves, length, 1.4 - probability, 60 * deg)) << probability;
        EXPECT_FALSE(is_ended(halves, length, 0, 60 * deg)) << probability;
    }
}

TEST(Terminations, MakeTNodesForTheCutter)
{
    // A trace that ends at every bed parts one cell in two, wherever it began: exactly, in every realization.
    // But one that ends inside a cell, where its own length ends, parts nothing, and is all cut back.
    const Vector2d low(0, 0), high(200, 200);
    for (const double angle : {90 * deg, 63.7 * deg}) {
        Scene scene = ended(1, {Kind::constant, 400, 0}, angle);
        scene.joint_sets[0].trace_angle = about(7.3 * deg, 0);
        scene.joint_sets[1].density = Density{Measure::p20, .002};
        Scene free = scene;
        free.joint_sets[1].terminates_at.clear();
        for (int r = 0; r < std::max(5, realizations() / 20); ++r) {
            const Joints joints = sample_joints(scene, 20030602, r), whole = sample_joints(free, 20030602, r);
            std::map<Index, Trace> by_number;
            for (std::size_t j = 0; j < whole.set.size(); ++j)
                if (whole.set[j] == 1)
                    by_number[whole.number[j]] = {whole.from[j], whole.to[j]};
            int parts = 1;
            double cut_back = 0;
            for (std::size_t j = 0; j < joints.set.size(); ++j) {
                const Trace trace{joints.from[j], joints.to[j]};
                const Trace own = joints.set[j] == 1 ? by_number.at(joints.number[j]) : trace;
                const auto is_loose = [&](const Vector2d& end, const Vector2d& own_end) {
                    return end == own_end && (end - low).minCoeff() > 0 && (high - end).minCoeff() > 0;
                };
                if (is_loose(trace.from, own.from) || is_loose(trace.to, own.to))
                    cut_back += length_in(trace, low, high);
                else
                    parts += length_in(trace, low, high) > 0;
            }
            const Blocks blocks = blocks::cut(scene, joints);
            if (blocks.report.merged_block_area == 0) { // else a sliver below the limits is gone
                EXPECT_EQ(int(blocks.block_area.size()), parts) << r;
            }
            EXPECT_NEAR(blocks.report.pruned_length, cut_back, 1e-3);
        }
    }
}

TEST(Terminations, LeaveNoCrossingsButWhereTheyFail)
{
    const auto crossings = [](double probability) {
        const Scene scene = ended(probability, {Kind::lognormal, 20, 8}, 75 * deg);
        const Joints joints = sample_joints(scene, 20030602, 0);
        int count = 0;
        for (std::size_t i = 0; i < joints.set.size(); ++i)
            for (std::size_t j = 0; j < joints.set.size() && joints.set[i] == 1; ++j) {
                const Vector2d run = (joints.to[i] - joints.from[i]).normalized() * 1e-6;
                const Trace shortened{joints.from[i] + run, joints.to[i] - run};
                const Trace bed{joints.from[j], joints.to[j]};
                if (joints.set[j] == 0)
                    if (const double at = crossing(shortened, bed); at >= 0) {
                        const Vector2d p = shortened.from + at * (shortened.to - shortened.from);
                        count += p.minCoeff() > 0 && p.maxCoeff() < 200;
                    }
            }
        return count;
    };
    EXPECT_EQ(crossings(1), 0);
    EXPECT_GT(crossings(.5), 100);
}

} // namespace acceptance_test
