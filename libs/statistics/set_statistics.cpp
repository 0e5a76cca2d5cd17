#include "statistics/set_statistics.hpp"

#include "model/polygon.hpp"
#include "sampling/density.hpp"
#include "sampling/joint_sets.hpp"
#include "sampling/orientations.hpp"
#include "statistics/rows.hpp"
#include "statistics/window.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

namespace jointcreep::statistics
{

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace
{

constexpr double pi = std::numbers::pi;
constexpr double rounding = 1e-6; // of constants, relative or in radians

// The same line's angle in (-pi/2, pi/2].
double as_line(double angle)
{
    angle = std::remainder(angle, pi);
    return angle <= -pi / 2 ? angle + pi : angle;
}

double turn_from(const Vector2d& along, const Vector2d& direction)
{
    return as_line(std::atan2(cross(along, direction), along.dot(direction)));
}

double mean_of(const std::vector<double>& values)
{
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// The pole of a plane in the section's frame, as in the file.
Vector3d pole_of(double dip, double dip_direction, double azimuth)
{
    const Vector2d in_section = sampling::section_normal(dip, dip_direction, azimuth);
    return {in_section.x(), in_section.y(), std::sin(dip) * std::sin(dip_direction - azimuth)};
}

// A joint where it crosses the scanline.
struct Crossing {
    double turn; // from the mean trace [rad]
    Vector3d pole;
    bool is_open;
    double shift; // from the line's own place, along the mean normal [m]
};

// A line inside the window.
struct Tally {
    double length = 0, open = 0; // [m]
    double ends = 0;             // of traces
};

// All that is seen of a set.
struct Seen {
    double scanline = 0; // length [m]
    std::vector<Crossing> crossings;
    std::vector<double> spacings; // between lines that follow each other by number, in space [m]
    std::vector<double> spacings_as_uniform;
    std::vector<Tally> lines;
    std::vector<double> lengths; // of the traces that begin and end inside [m]
    std::vector<double> lengths_as_uniform;
    double in_circle_crossings = 0, in_circle_ends = 0;
};

Window window_of(const Scene& scene, const JointSet& set)
{
    return set.region ? Window(scene.outline, *set.region) : Window(scene.outline);
}

struct Scanline {
    double offset;  // along the mean trace
    Interval reach; // along the mean normal
};

Scanline scanline_of(const Window& window, const MeanTrace& mean)
{
    const Interval width = window.extent(mean.along);
    Scanline best{0, {0, 0}};
    const int tries = 32;
    for (int i = 0; i < tries; ++i) {
        const double offset = width.low + (i + 0.5) / tries * (width.high - width.low);
        for (const Interval& stretch : window.stretches({offset * mean.along, mean.across()}))
            if (stretch.high - stretch.low > best.reach.high - best.reach.low)
                best = {offset, stretch};
    }
    return best;
}

// Number of the line, without that of its piece.
Index line_of(Index number)
{
    const std::int64_t half = sampling::piece_step / 2;
    const std::int64_t within = (static_cast<std::int64_t>(number) + half) % sampling::piece_step;
    return static_cast<Index>((within < 0 ? within + sampling::piece_step : within) - half);
}

struct InCircle {
    double crossings, ends;
};

InCircle in_circle(const Circle& circle, const Vector2d& from, const Vector2d& to)
{
    const bool from_in = (from - circle.centre).norm() < circle.radius,
               to_in = (to - circle.centre).norm() < circle.radius;
    if (from_in || to_in)
        return {from_in && to_in ? 0.0 : 1.0, double(from_in) + double(to_in)};
    const Vector2d along = to - from;
    const double at = (circle.centre - from).dot(along) / along.squaredNorm();
    const bool is_cut = at > 0 && at < 1 && (from + at * along - circle.centre).norm() < circle.radius;
    return {is_cut ? 2.0 : 0.0, 0};
}

// Where a joint crosses the scanline: along the joint from its first end, and along the mean normal [m].
struct OnScanline {
    double along, place;
};

std::optional<OnScanline> crossing_of(const Scanline& scanline, const MeanTrace& mean, const Vector2d& from,
                                      const Vector2d& direction, double length)
{
    const double advance = direction.dot(mean.along);
    const double at = (scanline.offset - from.dot(mean.along)) / advance;
    if (advance == 0 || !(at >= 0 && at <= length))
        return {};
    const double where = (from + at * direction).dot(mean.across());
    if (!(where >= scanline.reach.low && where <= scanline.reach.high))
        return {};
    return OnScanline{at, where};
}

// Adds a joint of a line of a set, with its traces, to what is seen of the line.
void add_to_line(Tally& tally, Seen& seen, const JointSet& set, const std::vector<Interval>& stretches,
                 double length, const std::vector<Interval>& traces)
{
    const auto common = [](const Interval& stretch, double low, double high) {
        return std::max(0.0, std::min(stretch.high, high) - std::max(stretch.low, low));
    };
    for (const Interval& stretch : stretches) {
        tally.length += common(stretch, 0.0, length);
        for (const Interval& trace : traces) {
            tally.open += common(stretch, trace.low, trace.high);
            const auto is_inside = [&](double end) { return end > stretch.low && end < stretch.high; };
            const bool begins = is_inside(trace.low), ends = is_inside(trace.high);
            tally.ends += begins + ends;
            if (begins && ends && set.length) {
                const double trace_length = trace.high - trace.low;
                seen.lengths.push_back(trace_length);
                seen.lengths_as_uniform.push_back(
                    std::min(1.0, positive_distribution(*set.length, trace_length) /
                                      positive_distribution(*set.length, stretch.high - trace.low)));
            }
        }
    }
}

// Adds the spacings of lines that follow each other by number; `places`: of lines by number, along the mean normal [m].
void add_spacings(Seen& seen, const JointSet& set, const MeanTrace& mean, const Interval& extent,
                  const std::map<Index, double>& places)
{
    for (auto here = places.begin(); here != places.end(); ++here)
        if (const auto next = std::next(here); next != places.end() && next->first == here->first + 1) {
            const double spacing = (next->second - here->second) * mean.normal_part;
            const double farthest = (extent.high - here->second) * mean.normal_part;
            seen.spacings.push_back(spacing);
            seen.spacings_as_uniform.push_back(
                std::min(1.0, positive_distribution(set.spacing, spacing) /
                                  positive_distribution(set.spacing, farthest)));
        }
}

Seen look_at(const JointSet& set, const Window& window, const MeanTrace& mean, const Circle& circle,
             const Joints& joints, const Grouped<Index>& traces, Index index)
{
    Seen seen;
    const Scanline scanline = scanline_of(window, mean);
    seen.scanline = scanline.reach.high - scanline.reach.low;
    const Interval extent = window.extent(mean.across());
    std::map<Index, Tally> lines;
    std::map<Index, double> places;
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        if (joints.set[j] != index)
            continue;
        const Vector2d from = joints.from[j], to = joints.to[j], direction = (to - from).normalized();
        const double length = (to - from).norm();
        const Index number = line_of(joints.number[j]);
        const double place = joints.point[j].dot(mean.across());
        if (place >= extent.low && place <= extent.high)
            places[number] = place;

        std::vector<Interval> open;
        for (const Index t : traces[j]) {
            const Vector2d &begin = joints.trace_from[t], &end = joints.trace_to[t];
            open.push_back({(begin - from).dot(direction), (end - from).dot(direction)});
            const InCircle here = in_circle(circle, begin, end);
            seen.in_circle_crossings += here.crossings;
            seen.in_circle_ends += here.ends;
        }
        if (const auto met = crossing_of(scanline, mean, from, direction, length)) {
            const bool is_open = std::any_of(open.begin(), open.end(), [&](const Interval& trace) {
                return trace.low <= met->along && met->along <= trace.high;
            });
            seen.crossings.push_back(
                {turn_from(mean.along, direction), joints.pole[j], is_open, met->place - place});
        }
        add_to_line(lines[number], seen, set, window.stretches({from, direction}), length, open);
    }
    for (const auto& [number, tally] : lines)
        if (tally.length > 0)
            seen.lines.push_back(tally);
    add_spacings(seen, set, mean, extent, places);
    return seen;
}

// Mean, deviation and law of angles.
void add_angles(Statistics& statistics, const std::string& subject, const std::string& name,
                const ProbabilityLaw& law, const std::vector<double>& values)
{
    const std::size_t count = values.size();
    const bool is_enough = count >= least_sample;
    const double mean = count > 0 ? mean_of(values) : 0;
    if (law.kind == ProbabilityLaw::Kind::constant || law.deviation == 0) {
        const bool all = std::all_of(values.begin(), values.end(),
                                     [&](double x) { return std::abs(x - law.mean) < rounding; });
        if (count > 0)
            add(statistics, subject,
                {.quantity = name,
                 .unit = "rad",
                 .achieved = mean,
                 .sample_size = count,
                 .target = law.mean,
                 .is_exact = all});
        return;
    }
    double squares = 0;
    for (const double x : values)
        squares += (x - mean) * (x - mean);
    const auto n = static_cast<double>(count);
    const double deviation = count > 1 ? std::sqrt(squares / (n - 1)) : 0;

    Row of_mean{.quantity = name + ", mean",
                .unit = "rad",
                .achieved = mean,
                .sample_size = count,
                .target = law.mean,
                .is_judged = true};
    Row of_deviation{.quantity = name + ", deviation",
                     .unit = "rad",
                     .achieved = deviation,
                     .sample_size = count,
                     .target = law.deviation,
                     .is_judged = true};
    Row of_law{.quantity = name + ", law", .unit = "1", .sample_size = count, .is_judged = true};
    if (is_enough) {
        const double error = deviation / std::sqrt(n);
        const double reach = error * student_quantile((1 - confidence) / 2, n - 1);
        of_mean.interval = Range{mean - reach, mean + reach};
        of_mean.p_value = student_p((mean - law.mean) / error, n - 1);
        // The variance of a sample's variance is (kurtosis - 1) / n of its square: that of chi squared with
        // so many degrees.
        const double degrees = 2 * (n - 1) / (kurtosis(law) - 1), sum = degrees * deviation * deviation;
        of_deviation.interval = Range{std::sqrt(sum / chi_squared_quantile((1 - confidence) / 2, degrees)),
                                      std::sqrt(sum / chi_squared_quantile((1 + confidence) / 2, degrees))};
        of_deviation.p_value = chi_squared_p(sum / (law.deviation * law.deviation), degrees);
        std::vector<double> uniforms;
        for (const double x : values)
            uniforms.push_back(distribution(law, x));
        of_law.judge(kolmogorov_smirnov(uniforms));
    }
    add(statistics, subject, of_mean);
    add(statistics, subject, of_deviation);
    add(statistics, subject, of_law);
}

// Poles of a set with Fisher's law, turned toward its mean.
struct SeenPoles {
    double resultant = 0, along = 0;   // length of their sum R, and its part C along the mean
    std::vector<double> angles, turns; // from the mean, and around it, as uniform numbers by the law
};

SeenPoles poles_of(const FisherLaw& law, double azimuth, const std::vector<Crossing>& crossings)
{
    const Vector3d mean = pole_of(law.dip, law.dip_direction, azimuth);
    const Vector3d first = mean.unitOrthogonal(), second = mean.cross(first);
    const double kappa = law.concentration;
    SeenPoles seen;
    Vector3d sum(0, 0, 0);
    for (const Crossing& crossing : crossings) {
        const Vector3d pole = crossing.pole.dot(mean) < 0 ? -crossing.pole : crossing.pole;
        sum += pole;
        const double w = (pole - mean).squaredNorm() / 2; // 1 - cos(t)
        seen.angles.push_back((std::expm1(-kappa * w) - std::exp(-kappa * (2 - w)) + std::exp(-2 * kappa)) /
                              std::expm1(-2 * kappa));
        seen.turns.push_back(std::atan2(pole.dot(second), pole.dot(first)) / (2 * pi) + 0.5);
    }
    seen.resultant = sum.norm();
    seen.along = sum.dot(mean);
    return seen;
}

// Rows of Fisher's law. A plane has two poles. The file has the upward one, which may lie more than 90
// degrees from the mean. So the angle t from the mean is taken up to 90 degrees only, where by law
//     P(cos(t) >= c) = (sinh(kappa) - sinh(kappa c)) / sinh(kappa) .
// With poles turned toward the mean, 2 kappa (n - R) is nearly chi squared with 2 (n - 1) degrees for kappa
// above 5, R being the length of their sum (Fisher, Lewis, Embleton 1987, section 5.3).
void add_poles(Statistics& statistics, const std::string& subject, const FisherLaw& law, double azimuth,
               const std::vector<Crossing>& crossings)
{
    const double kappa = law.concentration;
    const auto n = static_cast<double>(crossings.size());
    const SeenPoles seen = poles_of(law, azimuth, crossings);
    const double resultant = seen.resultant, along = seen.along;
    const bool is_enough = crossings.size() >= least_sample, is_narrow = kappa >= 5;
    const auto row = [&](const char* quantity, const char* unit, std::optional<double> target,
                         bool is_judged) {
        return Row{.quantity = quantity,
                   .unit = unit,
                   .sample_size = crossings.size(),
                   .target = target,
                   .is_judged = is_judged};
    };
    Row off = row("mean pole, off its target", "rad", 0, is_narrow),
        concentration = row("pole concentration", "1", kappa, is_narrow),
        of_angles = row("poles off the mean, law", "1", {}, true),
        of_turns = row("poles around the mean, law", "1", {}, true);
    if (is_enough) {
        off.achieved = std::acos(std::clamp(along / resultant, -1.0, 1.0));
        concentration.achieved = (n - 2) / (n - resultant);
        of_angles.judge(kolmogorov_smirnov(seen.angles));
        of_turns.judge(kuiper(seen.turns));
    }
    if (is_enough && is_narrow) {
        // (n - 1) (R - C) / (n - R) is F distributed with 2 and 2 (n - 1) degrees (Watson, Williams 1956).
        const double degrees = 2 * (n - 1);
        off.p_value = fisher_f_p((n - 1) * (resultant - along) / (n - resultant), 2, degrees);
        const double farthest = fisher_f_quantile(1 - confidence, 2, degrees);
        const double cone =
            std::acos(std::clamp(1 - farthest * (n - resultant) / ((n - 1) * resultant), -1.0, 1.0));
        off.interval = Range{std::max(0.0, off.achieved - cone), off.achieved + cone};
        const double spread = 2 * (n - resultant);
        concentration.interval = Range{chi_squared_quantile((1 + confidence) / 2, degrees) / spread,
                                       chi_squared_quantile((1 - confidence) / 2, degrees) / spread};
        concentration.p_value = chi_squared_p(spread * kappa, degrees);
    }
    for (const Row& one : {off, concentration, of_angles, of_turns})
        add(statistics, subject, one);
}

// Rows of dip and dip direction as drawn. A pole has two such pairs, {dip, direction} and {-dip, direction + pi},
// and its opposite two more; the one nearest to the mean dip direction, then to the mean dip, is meant.
void add_planes(Statistics& statistics, const std::string& subject, const ProbabilityLaw& dip_law,
                const ProbabilityLaw& direction_law, double azimuth, const std::vector<Crossing>& crossings)
{
    std::vector<double> dips, directions;
    for (const Crossing& crossing : crossings) {
        const Vector3d& pole = crossing.pole;
        const double dip = std::atan2(std::hypot(pole.x(), pole.z()), pole.y());
        const double direction = azimuth + std::atan2(pole.z(), pole.x());
        double best_off = std::numeric_limits<double>::infinity();
        std::pair<double, double> best;
        for (const auto& [d, a] : {std::pair{dip, direction}, std::pair{-dip, direction + pi},
                                   std::pair{pi - dip, direction + pi}, std::pair{dip - pi, direction}}) {
            const double turn = std::remainder(a - direction_law.mean, 2 * pi);
            const double off = std::hypot(turn, d - dip_law.mean);
            if (off < best_off) {
                best_off = off;
                best = {d, direction_law.mean + turn};
            }
        }
        dips.push_back(best.first);
        directions.push_back(best.second);
    }
    add_angles(statistics, subject, "dip", dip_law, dips);
    add_angles(statistics, subject, "dip direction", direction_law, directions);
}

void add_orientation(Statistics& statistics, const Scene& scene, const JointSet& set, const Seen& seen)
{
    if (set.trace_angle) {
        std::vector<double> angles;
        for (const Crossing& crossing : seen.crossings)
            angles.push_back(set.trace_angle->mean + crossing.turn);
        add_angles(statistics, set.name, "trace angle", *set.trace_angle, angles);
    } else if (set.orientation) {
        add_poles(statistics, set.name, *set.orientation, *scene.azimuth, seen.crossings);
    } else if (set.dip) {
        add_planes(statistics, set.name, *set.dip, *set.dip_direction, *scene.azimuth, seen.crossings);
    }
}

// Variance that scatter adds to the number of lines on the scanline: lines change places across its ends.
// P(1 - P) summed over the lines, P being the probability to come in, is half the mean difference of two
// shifts, times the lines per metre.
double blur_of(const std::vector<Crossing>& crossings, const Renewal& renewal, double length)
{
    std::vector<double> shifts;
    for (const Crossing& crossing : crossings)
        shifts.push_back(crossing.shift);
    std::sort(shifts.begin(), shifts.end());
    const auto n = static_cast<double>(shifts.size());
    double differences = 0; // of all pairs
    for (std::size_t i = 0; i < shifts.size(); ++i)
        differences += (2 * static_cast<double>(i) - n + 1) * shifts[i];
    const double mean_difference = n > 1 ? 2 * differences / (n * (n - 1)) : 0;
    const double most = std::max(0.0, 1 - renewal.squared_variation) * length / renewal.mean; // Poisson's
    return std::min(most, mean_difference / renewal.mean);
}

// Variance of the number of lines that the window meets, over its mean.
double dispersion_of(const JointSet& set, const MeanTrace& mean, const Interval& extent, const Seen& seen)
{
    const Moments moments = positive_moments(set.spacing);
    Renewal lines{moments.mean / mean.normal_part, moments.squared_variation, moments.third};
    const double length = extent.high - extent.low;
    lines.blur = blur_of(seen.crossings, lines, length);
    return count_variance(length, lines) * lines.mean / length;
}

// Rows of the scanline: lines, and where they are joint.
void add_spacing(Statistics& statistics, const JointSet& set, const MeanTrace& mean, const Seen& seen)
{
    const Moments moments = positive_moments(set.spacing);
    Renewal lines{moments.mean / mean.normal_part, moments.squared_variation, moments.third};
    lines.blur = blur_of(seen.crossings, lines, seen.scanline);
    const std::size_t count = seen.crossings.size();
    const double expected = seen.scanline / lines.mean;

    Row of_mean{.quantity = "spacing, mean",
                .unit = "m",
                .sample_size = count,
                .target = moments.mean,
                .is_judged = true};
    of_mean.achieved = seen.scanline * mean.normal_part / std::max(1.0, static_cast<double>(count));
    if (expected >= least_sample) {
        const Range range = mean_range(count, seen.scanline, lines, confidence);
        of_mean.interval = Range{range.low * mean.normal_part, range.high * mean.normal_part};
        of_mean.p_value = count_p(count, seen.scanline, lines);
    }
    add(statistics, set.name, of_mean);

    Row of_law{
        .quantity = "spacing, law", .unit = "1", .sample_size = seen.spacings.size(), .is_judged = true};
    if (set.spacing.kind == ProbabilityLaw::Kind::constant || set.spacing.deviation == 0) {
        of_law.is_exact = std::all_of(seen.spacings.begin(), seen.spacings.end(), [&](double spacing) {
            return std::abs(spacing / moments.mean - 1) < rounding;
        });
    } else if (seen.spacings.size() >= least_sample) {
        of_law.judge(kolmogorov_smirnov(seen.spacings_as_uniform));
    }
    add(statistics, set.name, of_law);

    // Every line is joint at the scanline with the probability `persistence`, whatever the others are.
    const double k = set.persistence;
    if (k == 0)
        return;
    const auto open = static_cast<std::size_t>(std::count_if(seen.crossings.begin(), seen.crossings.end(),
                                                             [](const Crossing& c) { return c.is_open; }));
    const double c = k * lines.squared_variation + 1 - k;
    const Renewal joints{lines.mean / k, c, k == 1 ? lines.third : 2 * c * c, k * k * lines.blur};
    Row p10{.quantity = "P10 along the mean normal",
            .unit = "1/m",
            .achieved = static_cast<double>(open) / seen.scanline,
            .sample_size = open,
            .target = 1 / joints.mean,
            .is_judged = k < 1};
    if (expected * k >= least_sample) {
        const Range range = mean_range(open, seen.scanline, joints, confidence);
        p10.interval = Range{1 / range.high, 1 / range.low};
        if (k < 1) // else it says what the mean spacing says
            p10.p_value = count_p(open, seen.scanline, joints);
    }
    add(statistics, set.name, p10);
}

// A sum over lines, as a density, or the ratio of two such sums: estimate and standard error. Judged by its
// logarithm, whose error is more nearly normal.
void add_ratio(Statistics& statistics, const std::string& subject, Row row, double error, std::size_t lines,
               std::optional<double> error_by_law = {})
{
    row.is_judged = true;
    if (lines >= least_sample && row.achieved > 0 && error > 0 && row.target) {
        const auto degrees = static_cast<double>(lines) - 1;
        const double relative = error / row.achieved;
        const double reach = relative * student_quantile((1 - confidence) / 2, degrees);
        row.interval = Range{row.achieved * std::exp(-reach), row.achieved * std::exp(reach)};
        row.p_value = error_by_law ? normal_p((row.achieved - *row.target) / *error_by_law)
                                   : student_p(std::log(row.achieved / *row.target) / relative, degrees);
    }
    add(statistics, subject, row);
}

void add_persistence(Statistics& statistics, const JointSet& set, const Seen& seen)
{
    const double k = set.persistence;
    double length = 0, open = 0, squares = 0;
    for (const Tally& line : seen.lines) {
        length += line.length;
        open += line.open;
    }
    const double achieved = length > 0 ? open / length : 0;
    Row row{.quantity = "persistence",
            .unit = "1",
            .achieved = achieved,
            .sample_size = seen.lines.size(),
            .target = k};
    if (k == 0 || k == 1) {
        row.is_exact = std::abs(achieved - k) < rounding || length == 0;
        return add(statistics, set.name, row);
    }
    row.is_judged = true;
    if (seen.lines.size() >= least_sample && achieved > 0 && achieved < 1) {
        for (const Tally& line : seen.lines)
            squares += std::pow(line.open - achieved * line.length, 2);
        const auto n = static_cast<double>(seen.lines.size());
        // By the log odds, which have no bounds.
        const auto odds = [](double x) { return std::log(x / (1 - x)); };
        const auto from_odds = [](double x) { return 1 / (1 + std::exp(-x)); };
        const double error = std::sqrt(squares * n / (n - 1)) / length / (achieved * (1 - achieved));
        const double reach = error * student_quantile((1 - confidence) / 2, n - 1);
        row.interval = Range{from_odds(odds(achieved) - reach), from_odds(odds(achieved) + reach)};
        row.p_value = student_p((odds(achieved) - odds(k)) / error, n - 1);
    }
    add(statistics, set.name, row);
}

void add_lengths(Statistics& statistics, const JointSet& set, const Seen& seen)
{
    const double target = positive_moments(*set.length).mean;
    double open = 0, ends = 0, squares = 0;
    for (const Tally& line : seen.lines) {
        open += line.open;
        ends += line.ends;
    }
    Row of_mean{.quantity = "trace length, mean",
                .unit = "m",
                .sample_size = static_cast<std::size_t>(ends / 2),
                .target = target};
    if (ends > 0)
        of_mean.achieved = 2 * open / ends;
    for (const Tally& line : seen.lines)
        squares += std::pow(line.open - of_mean.achieved * line.ends / 2, 2);
    // Where lengths scatter much, they are judged by the law's own scatter, a variance for every trace: a
    // sample that lacks the longest traces shows too little. (Where they do not, edges scatter as much.)
    const auto n = static_cast<double>(seen.lines.size());
    const double scatter = positive_moments(*set.length).squared_variation;
    std::optional<double> by_law;
    if (scatter > 0.25 && ends > 0)
        by_law = target * std::sqrt(2 * scatter / ends);
    add_ratio(statistics, set.name, of_mean,
              n > 1 && ends > 0 ? 2 * std::sqrt(squares * n / (n - 1)) / ends : 0,
              std::min(seen.lines.size(), of_mean.sample_size), by_law);

    Row of_law{
        .quantity = "trace length, law", .unit = "1", .sample_size = seen.lengths.size(), .is_judged = true};
    if (set.length->kind == ProbabilityLaw::Kind::constant || set.length->deviation == 0) {
        of_law.is_exact = std::all_of(seen.lengths.begin(), seen.lengths.end(), [&](double length) {
            return std::abs(length / target - 1) < rounding;
        });
    } else if (seen.lengths.size() >= least_sample) {
        of_law.judge(kolmogorov_smirnov(seen.lengths_as_uniform));
    }
    add(statistics, set.name, of_law);
}

// Rows of the circle, by the joint traces that cross it and their ends in it; without P20 if that is not given.
void add_in_circle(Statistics& statistics, const std::string& subject, const Circle& circle, double crossings,
                   double ends, std::optional<double> p20, double p21)
{
    const double r = circle.radius;
    if (p20)
        add(statistics, subject,
            {.quantity = "P20 in a circle",
             .unit = "1/m2",
             .achieved = ends / (2 * pi * r * r),
             .sample_size = static_cast<std::size_t>(ends),
             .target = *p20});
    add(statistics, subject,
        {.quantity = "P21 in a circle",
         .unit = "1/m",
         .achieved = crossings / (4 * r),
         .sample_size = static_cast<std::size_t>(crossings),
         .target = p21});
}

// P21 of lines by their laws [1/m].
double p21_by_law(const Scene& scene, const JointSet& set, const MeanTrace& mean)
{
    if (!set.poles.empty())
        return sampling::density_of(set, scene).p21;
    double stretched = 0; // length of lines inside, for their number along the mean normal
    const std::vector<double> turns = turns_by_law(scene, set);
    for (const double turn : turns)
        stretched +=
            1 / std::cos(std::min(std::abs(turn), 85 * pi / 180)) / static_cast<double>(turns.size());
    return set.persistence * mean.normal_part / positive_moments(set.spacing).mean * stretched;
}

// The variance of a sum over the lines: what chance does on a line, and what the number of lines does, with
// the dispersion of a renewal process.
void add_densities(Statistics& statistics, const Scene& scene, const JointSet& set, const MeanTrace& mean,
                   const Window& window, const Circle& circle, const Seen& seen)
{
    const double k = set.persistence;
    if (k == 0)
        return;
    const double spread = dispersion_of(set, mean, window.extent(mean.across()), seen);
    const double p21 = p21_by_law(scene, set, mean);
    const double mean_length = set.length ? positive_moments(*set.length).mean : 0;
    const double area = window.area();
    if (area <= 0)
        return;

    double open = 0, ends = 0, open_variance = 0, ends_variance = 0;
    for (const Tally& line : seen.lines) {
        open += line.open;
        ends += line.ends;
        const double wanted = k * line.length;
        open_variance += spread * wanted * wanted + std::pow(line.open - wanted, 2);
        if (k < 1)
            ends_variance += spread * std::pow(wanted / mean_length, 2) +
                             std::pow(line.ends / 2 - wanted / mean_length, 2);
    }
    const auto half_ends = static_cast<std::size_t>(ends / 2);
    if (k < 1)
        add_ratio(statistics, set.name,
                  {.quantity = "P20",
                   .unit = "1/m2",
                   .achieved = ends / 2 / area,
                   .sample_size = half_ends,
                   .target = p21 / mean_length},
                  std::sqrt(ends_variance) / area, std::min(seen.lines.size(), half_ends));
    add_ratio(statistics, set.name,
              {.quantity = "P21",
               .unit = "1/m",
               .achieved = open / area,
               .sample_size = seen.lines.size(),
               .target = p21},
              std::sqrt(open_variance) / area, seen.lines.size());

    if (circle.radius <= 0)
        return;
    const double n = seen.in_circle_crossings, m = seen.in_circle_ends;
    add_in_circle(statistics, set.name, circle, n, m, k < 1 ? std::optional(p21 / mean_length) : std::nullopt,
                  p21);
    if (k < 1 && m > 0)
        add(statistics, set.name,
            {.quantity = "trace length in a circle, mean",
             .unit = "m",
             .achieved = pi * circle.radius * n / (2 * m),
             .sample_size = static_cast<std::size_t>(n),
             .target = mean_length});
}

// A number of joints that is Poisson distributed, on so much of scanline or area.
void add_poisson(Statistics& statistics, const std::string& subject, Row row, double size)
{
    row.achieved = static_cast<double>(row.sample_size) / size;
    row.is_judged = row.target.has_value();
    if (row.target && *row.target * size >= least_sample) {
        const Renewal poisson{1 / *row.target, 1, 2};
        const Range range = mean_range(row.sample_size, size, poisson, confidence);
        row.interval = Range{1 / range.high, 1 / range.low};
        row.p_value = count_p(row.sample_size, size, poisson);
    }
    add(statistics, subject, row);
}

// Chords that a section makes of discs, which it meets by their diameters D: P(chord > l) is the
// integral of (1 - F(sqrt(l^2 + v^2))) / E[D] over v from 0 (from Warburton's 1980 by parts, v^2 = D^2 -
// l^2).
std::vector<double> chords_as_uniform(const ProbabilityLaw& diameter, const std::vector<double>& chords)
{
    const double longest = chords.empty() ? 0 : *std::max_element(chords.begin(), chords.end());
    const double mean = positive_moments(diameter).mean;
    double end = std::max(mean, longest);
    while (1 - positive_distribution(diameter, end) > 1e-9)
        end *= 1.3;
    const int steps = 600, places = 300;
    std::vector<double> below(places + 1);
    for (int i = 0; i <= places; ++i) {
        const double l = longest * i / places;
        double sum = 0;
        for (int s = 0; s < steps; ++s) {
            // Finer near 0, where most of the diameters are.
            const double u = (s + 0.5) / steps, v = end * u * u;
            sum += (1 - positive_distribution(diameter, std::hypot(l, v))) * 2 * end * u / steps;
        }
        below[static_cast<std::size_t>(i)] = 1 - std::min(1.0, sum / mean);
    }
    std::vector<double> uniforms;
    for (const double chord : chords) {
        const double at = std::min(chord / longest * places, places - 1e-9);
        const auto i = static_cast<std::size_t>(at);
        uniforms.push_back(below[i] + (at - static_cast<double>(i)) * (below[i + 1] - below[i]));
    }
    return uniforms;
}

// Angles from the mean trace by a set's law in space, which a section meets by |n_p|.
std::vector<double> turns_as_uniform(const sampling::Orientations& orientations, const MeanTrace& mean,
                                     const std::vector<double>& turns)
{
    const sampling::Rose rose = orientations.rose();
    std::vector<std::pair<double, double>> law; // angle, share
    double total = 0;
    for (std::size_t i = 0; i < rose.pole.size(); ++i) {
        const Vector2d normal = rose.pole[i].head<2>();
        const double share = rose.share[i] * normal.norm();
        if (share > 0)
            law.emplace_back(turn_from(mean.along, {normal.y(), -normal.x()}), share);
        total += share;
    }
    std::sort(law.begin(), law.end());
    std::vector<double> sum(1, 0.0);
    for (const auto& [turn, share] : law)
        sum.push_back(sum.back() + share / total);
    std::vector<double> uniforms;
    for (const double turn : turns) {
        const auto after = std::upper_bound(law.begin(), law.end(), std::pair{turn, 2.0}) - law.begin();
        uniforms.push_back(sum[static_cast<std::size_t>(after)]);
    }
    return uniforms;
}

// All that is seen of a set of segments or discs.
struct SeenTraces {
    std::map<Index, double> inside; // length of each in the window [m]
    std::vector<double> turns;      // from the mean trace, of those whose point is inside [rad]
    std::vector<double> lengths;    // of these [m]
    std::size_t crossings = 0;      // of the scanline
    double in_circle_crossings = 0, in_circle_ends = 0;
};

SeenTraces look_at_traces(const Window& window, const MeanTrace& mean, const Scanline& scanline,
                          const Circle& circle, const Joints& joints, Index index)
{
    SeenTraces seen;
    std::set<Index> have_point;
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        if (joints.set[j] != index)
            continue;
        const Vector2d from = joints.from[j], to = joints.to[j], direction = (to - from).normalized();
        const double length = (to - from).norm();
        const Index number = line_of(joints.number[j]);
        for (const Interval& stretch : window.stretches({from, direction}))
            seen.inside[number] += std::max(0.0, std::min(stretch.high, length) - std::max(stretch.low, 0.0));
        if (window.contains(joints.point[j]) && have_point.insert(number).second) {
            seen.turns.push_back(turn_from(mean.along, direction));
            seen.lengths.push_back(length);
        }
        const InCircle here = in_circle(circle, from, to);
        seen.in_circle_crossings += here.crossings;
        seen.in_circle_ends += here.ends;
        seen.crossings += crossing_of(scanline, mean, from, direction, length).has_value();
    }
    return seen;
}

void add_trace_angles(Statistics& statistics, const Scene& scene, const JointSet& set, const MeanTrace& mean,
                      const std::vector<double>& turns)
{
    if (set.trace_angle) {
        std::vector<double> angles;
        for (const double turn : turns)
            angles.push_back(set.trace_angle->mean + turn);
        return add_angles(statistics, set.name, "trace angle", *set.trace_angle, angles);
    }
    if (!set.poles.empty())
        return;
    Row row{.quantity = "trace angle, law", .unit = "1", .sample_size = turns.size(), .is_judged = true};
    const bool is_constant = set.dip && set.dip->deviation == 0 && set.dip_direction->deviation == 0;
    if (is_constant)
        row.is_exact =
            std::all_of(turns.begin(), turns.end(), [](double turn) { return std::abs(turn) < rounding; });
    else if (turns.size() >= least_sample)
        row.judge(kolmogorov_smirnov(turns_as_uniform(sampling::Orientations(set, scene), mean, turns)));
    add(statistics, set.name, row);
}

// Where a region cuts traces off, those whose point it leaves no piece of are missing: P20 is not judged. Where traces
// end at other joints, the laws are those before: P21 and P10 are not.
void add_trace_densities(Statistics& statistics, const Scene& scene, const JointSet& set,
                         const MeanTrace& mean, const Scanline& scanline, double area, const SeenTraces& seen)
{
    const bool are_ended = !set.terminates_at.empty();
    const sampling::SetDensity wanted = sampling::density_of(set, scene);
    add_poisson(statistics, set.name,
                {.quantity = "P20",
                 .unit = "1/m2",
                 .sample_size = seen.turns.size(),
                 .target = set.region ? std::optional<double>() : wanted.p20},
                area);
    double total = 0, squares = 0;
    for (const auto& [number, length] : seen.inside) {
        total += length;
        squares += length * length;
    }
    Row p21{.quantity = "P21", .unit = "1/m", .achieved = total / area, .sample_size = seen.inside.size()};
    if (are_ended) {
        add(statistics, set.name, p21);
    } else {
        p21.target = wanted.p21;
        add_ratio(statistics, set.name, p21, std::sqrt(squares) / area, seen.inside.size());
    }
    const Vector2d across = mean.across();
    add_poisson(statistics, set.name,
                {.quantity = "P10 along the mean normal",
                 .unit = "1/m",
                 .sample_size = seen.crossings,
                 .target = are_ended ? std::optional<double>()
                                     : sampling::expected_p10(set, scene, {across.x(), across.y(), 0})},
                scanline.reach.high - scanline.reach.low);
}

// Of traces that nothing cuts off.
void add_whole_lengths(Statistics& statistics, const JointSet& set, const std::vector<double>& lengths)
{
    const bool are_discs = set.kind == SetKind::discs;
    const ProbabilityLaw& size = are_discs ? *set.diameter : *set.length;
    const Moments moments = positive_moments(size);
    const double c = moments.squared_variation, second = 1 + c, third = moments.third + 3 * c + 1;
    const double target = moments.mean * (are_discs ? pi / 4 * second : 1);
    const double variance =
        moments.mean * moments.mean * (are_discs ? 2.0 / 3 * third - std::pow(pi / 4 * second, 2) : c);
    const auto count = static_cast<double>(lengths.size());
    Row of_mean{.quantity = "trace length, mean",
                .unit = "m",
                .achieved = lengths.empty() ? 0 : mean_of(lengths),
                .sample_size = lengths.size(),
                .target = target};
    Row of_law{
        .quantity = "trace length, law", .unit = "1", .sample_size = lengths.size(), .is_judged = true};
    if (!are_discs && (size.kind == ProbabilityLaw::Kind::constant || size.deviation == 0)) {
        of_mean.is_exact = of_law.is_exact = std::all_of(lengths.begin(), lengths.end(), [&](double length) {
            return std::abs(length / target - 1) < rounding;
        });
        add(statistics, set.name, of_mean);
        return add(statistics, set.name, of_law);
    }
    double off = 0;
    for (const double length : lengths)
        off += std::pow(length - of_mean.achieved, 2);
    add_ratio(statistics, set.name, of_mean, lengths.size() > 1 ? std::sqrt(off / (count - 1) / count) : 0,
              lengths.size(), std::sqrt(variance / std::max(1.0, count)));
    if (lengths.size() >= least_sample) {
        std::vector<double> uniforms;
        if (are_discs)
            uniforms = chords_as_uniform(size, lengths);
        else
            for (const double length : lengths)
                uniforms.push_back(positive_distribution(size, length));
        of_law.judge(kolmogorov_smirnov(uniforms));
    }
    add(statistics, set.name, of_law);
}

// Of traces that a region or other sets cut off: what is there of them, which no law says. Not judged.
void add_visible_lengths(Statistics& statistics, const JointSet& set, const SeenTraces& seen)
{
    std::vector<double> visible;
    for (const auto& [number, length] : seen.inside)
        if (length > 0)
            visible.push_back(length);
    if (!visible.empty())
        add(statistics, set.name,
            {.quantity = "trace length inside, mean",
             .unit = "m",
             .achieved = mean_of(visible),
             .sample_size = visible.size()});
}

// A set of segments or discs: traces about Poisson points, /joints/point. Those whose point is inside are a
// fair sample of orientations and lengths, however far they reach.
void add_traces(Statistics& statistics, const Scene& scene, const JointSet& set, const MeanTrace& mean,
                const Window& window, const Circle& circle, const Joints& joints, Index index)
{
    const Scanline scanline = scanline_of(window, mean);
    const SeenTraces seen = look_at_traces(window, mean, scanline, circle, joints, index);
    add_trace_angles(statistics, scene, set, mean, seen.turns);
    const double area = window.area();
    if (area <= 0)
        return;
    add_trace_densities(statistics, scene, set, mean, scanline, area, seen);
    const bool are_ended = !set.terminates_at.empty();
    if (!set.region && !are_ended)
        add_whole_lengths(statistics, set, seen.lengths);
    else
        add_visible_lengths(statistics, set, seen);
    if (circle.radius <= 0 || are_ended)
        return;
    const sampling::SetDensity wanted = sampling::density_of(set, scene);
    add_in_circle(statistics, set.name, circle, seen.in_circle_crossings, seen.in_circle_ends,
                  set.region ? std::nullopt : std::optional(wanted.p20), wanted.p21);
}

ProbabilityLaw times(ProbabilityLaw law, double factor)
{
    law.mean *= factor;
    law.deviation *= factor;
    law.least *= factor;
    law.most *= factor;
    return law;
}

} // namespace

MeanTrace mean_trace(const Scene& scene, const JointSet& set)
{
    const Vector2d trace = sampling::Orientations(set, scene).mean_trace();
    return {trace.normalized(), trace.norm()};
}

std::vector<double> turns_by_law(const Scene& scene, const JointSet& set)
{
    std::vector<double> turns;
    const auto share = [](int i, int steps) { return (i + 0.5) / steps; };
    if (set.trace_angle) {
        const int steps = set.trace_angle->deviation > 0 ? 512 : 1;
        for (int i = 0; i < steps; ++i)
            turns.push_back(as_line(quantile(*set.trace_angle, share(i, steps)) - set.trace_angle->mean));
        return turns;
    }
    const Vector2d along = mean_trace(scene, set).along;
    const auto add_plane = [&](const Vector2d& normal) {
        turns.push_back(turn_from(along, {normal.y(), -normal.x()}));
    };
    const int steps = 48;
    if (set.orientation) {
        const FisherLaw& law = *set.orientation;
        const Vector3d mean = pole_of(law.dip, law.dip_direction, *scene.azimuth),
                       first = mean.unitOrthogonal(), second = mean.cross(first);
        for (int i = 0; i < steps; ++i) {
            const double w =
                -std::log1p(share(i, steps) * std::expm1(-2 * law.concentration)) / law.concentration;
            for (int j = 0; j < steps; ++j) {
                const double turn = 2 * pi * share(j, steps);
                const Vector3d pole = (1 - w) * mean + std::sqrt(w * (2 - w)) *
                                                           (std::cos(turn) * first + std::sin(turn) * second);
                add_plane(pole.head<2>());
            }
        }
        return turns;
    }
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            add_plane(sampling::section_normal(quantile(*set.dip, share(i, steps)),
                                               quantile(*set.dip_direction, share(j, steps)),
                                               *scene.azimuth));
    return turns;
}

void add_set(Statistics& statistics, const Scene& scene, const Joints& joints, const Grouped<Index>& traces,
             Index index)
{
    JointSet set = scene.joint_sets[static_cast<std::size_t>(index)];
    if (!set.rocks.empty())
        return; // windows are polygons
    const Window window = window_of(scene, set);
    MeanTrace mean = mean_trace(scene, set);
    const Scanline scanline = scanline_of(window, mean);
    if (scanline.reach.high <= scanline.reach.low)
        return; // the region is outside the section
    const Circle circle = window.circle();
    if (set.kind != SetKind::lines)
        return add_traces(statistics, scene, set, mean, window, circle, joints, index);
    if (!set.poles.empty()) {
        JointSet plain = set;
        plain.density.reset();
        mean.normal_part = positive_moments(set.spacing).mean / sampling::density_of(plain, scene).spacing;
    }
    if (set.density) {
        // The spacing's law is one of shape; its mean follows from the density.
        const double in_section = sampling::density_of(set, scene).spacing;
        set.spacing = times(set.spacing, in_section * mean.normal_part / positive_moments(set.spacing).mean);
        set.density.reset();
    }
    const Seen seen = look_at(set, window, mean, circle, joints, traces, index);
    add_orientation(statistics, scene, set, seen);
    add_spacing(statistics, set, mean, seen);
    add_persistence(statistics, set, seen);
    if (set.length && set.persistence > 0 && set.persistence < 1)
        add_lengths(statistics, set, seen);
    add_densities(statistics, scene, set, mean, window, circle, seen);
}

} // namespace jointcreep::statistics
