#include "statistics/statistics.hpp"

#include "statistics/block_shape.hpp"
#include "statistics/nodes.hpp"
#include "statistics/rows.hpp"
#include "statistics/set_statistics.hpp"
#include "statistics/window.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace jointcreep::statistics
{

namespace
{

// What lines of all sets do together, where it has a closed form: no regions, no single joints, and each set
// of lines with a spacing, either without scatter or with negative exponential spacing, so that its lines are
// independent.
struct Expected {
    double crossings = 0;       // of joint traces, per area [1/m2]
    double line_crossings = 0;  // of the lines, bridges included, per area [1/m2]
    double pieces = 0;          // into which the outline cuts the lines
    double relative_error = 0;  // of the number of blocks, by the number of lines of each set [-]
    bool is_cut_through = true; // no rock bridges
};

double secant(double turn)
{
    return 1 / std::max(std::cos(turn), 0.05);
}

// A set of lines: its frequency along the mean normal, directions of its lines, and how many pieces of them there are.
struct Lines {
    double frequency, persistence;     // [1/m], [-]
    std::vector<double> angles, turns; // of lines, in the section and from the mean trace [rad]
    double pieces = 0;                 // into which the outline cuts them
    double dispersion = 0;             // variance of their number over its mean [-]
};

Lines lines_of(const Scene& scene, const JointSet& set, const Window& window)
{
    const MeanTrace mean = mean_trace(scene, set);
    const Moments spacing = positive_moments(set.spacing);
    Lines lines{mean.normal_part / spacing.mean, set.persistence, {}, turns_by_law(scene, set)};
    const double angle = std::atan2(mean.along.y(), mean.along.x());
    for (const double turn : lines.turns) {
        lines.angles.push_back(angle + turn);
        lines.pieces += lines.frequency * secant(turn) *
                        window.stretches_per_density({std::cos(angle + turn), std::sin(angle + turn)}) /
                        static_cast<double>(lines.turns.size());
    }
    const Renewal renewal{1 / lines.frequency, spacing.squared_variation, spacing.third};
    const Interval extent = window.extent(mean.across());
    lines.dispersion =
        count_variance(extent.high - extent.low, renewal) / ((extent.high - extent.low) * lines.frequency);
    return lines;
}

// Crossings of the lines of two sets, or of one with itself [1/m2].
double crossings_of(const Lines& a, const Lines& b)
{
    double mean = 0; // of the sine between two lines, over the cosines of their turns
    const std::size_t step_a = 1 + a.turns.size() / 256, step_b = 1 + b.turns.size() / 256;
    std::size_t pairs = 0;
    for (std::size_t i = step_a / 2; i < a.turns.size(); i += step_a)
        for (std::size_t j = step_b / 2; j < b.turns.size(); j += step_b, ++pairs)
            mean += std::abs(std::sin(a.angles[i] - b.angles[j])) * secant(a.turns[i]) * secant(b.turns[j]);
    return a.frequency * b.frequency * mean / static_cast<double>(pairs) * (&a == &b ? 0.5 : 1);
}

// Of sets of lines alone, whose number is that of a renewal process.
std::optional<Expected> expected_of(const Scene& scene)
{
    const auto is_other = [](const JointSet& set) {
        return set.kind != SetKind::lines || set.density || !set.poles.empty() || !set.rocks.empty();
    };
    if (!scene.holes.empty() || !scene.joints.empty() || !scene.mapped.empty() || scene.joint_sets.empty() ||
        std::any_of(scene.joint_sets.begin(), scene.joint_sets.end(), is_other))
        return {};
    const Window window(scene.outline);
    const double area = window.area();
    std::vector<Lines> sets;
    Expected expected;
    for (const JointSet& set : scene.joint_sets) {
        Lines lines = lines_of(scene, set, window);
        const bool is_exponential = set.spacing.kind == ProbabilityLaw::Kind::negative_exponential;
        if (set.region || (lines.turns.size() > 1 && !is_exponential))
            return {};
        expected.pieces += lines.pieces;
        expected.is_cut_through = expected.is_cut_through && set.persistence == 1;
        sets.push_back(std::move(lines));
    }
    std::vector<double> met(sets.size(), 0.0); // crossings of each set's lines with others [1/m2]
    for (std::size_t a = 0; a < sets.size(); ++a)
        for (std::size_t b = 0; b <= a; ++b) {
            const double crossings = crossings_of(sets[a], sets[b]);
            expected.line_crossings += crossings;
            expected.crossings += crossings * sets[a].persistence * sets[b].persistence;
            met[a] += crossings;
            met[b] += crossings;
        }
    double variance = 0;
    for (std::size_t a = 0; a < sets.size(); ++a)
        variance += sets[a].dispersion / sets[a].pieces * std::pow(sets[a].pieces + met[a] * area, 2);
    expected.relative_error = std::sqrt(variance) / (1 + expected.pieces + expected.line_crossings * area);
    return expected;
}

void add_sizes(Statistics& statistics, const Scene& scene, const Blocks& blocks,
               const std::optional<Expected>& expected)
{
    const std::string subject = "blocks";
    const std::vector<double>& area = blocks.block_area;
    const std::size_t count = area.size();
    const double total = std::accumulate(area.begin(), area.end(), 0.0);
    const std::vector<double> ones(count, 1.0);
    const bool is_bonded = std::count(blocks.edge_kind.begin(), blocks.edge_kind.end(),
                                      static_cast<Index>(EdgeKind::bonded)) > 0;

    // Euler: lines that a section cuts into p pieces with c crossings make 1 + p + c blocks of it.
    Row number{
        .quantity = "number", .unit = "1", .achieved = static_cast<double>(count), .sample_size = count};
    Row mean{.quantity = "area, mean",
             .unit = "m2",
             .achieved = total / static_cast<double>(count),
             .sample_size = count};
    if (expected && expected->is_cut_through && !is_bonded) {
        const double area_of_section = Window(scene.outline).area();
        number.target = 1 + expected->pieces + expected->line_crossings * area_of_section;
        mean.target = area_of_section / *number.target;
        const double reach = std::exp(1.96 * expected->relative_error);
        number.interval = Range{number.achieved / reach, number.achieved * reach};
        mean.interval = Range{mean.achieved / reach, mean.achieved * reach};
    }
    add(statistics, subject, number);
    add(statistics, subject, mean);
    double squares = 0;
    for (const double a : area)
        squares += a * a;
    const auto plain = [&](const std::string& quantity, const std::string& unit, double value) {
        add(statistics, subject,
            {.quantity = quantity, .unit = unit, .achieved = value, .sample_size = count});
    };
    plain("area, mean weighted by area", "m2", squares / total);
    for (const int percent : {10, 50, 90})
        plain("area, quantile " + std::to_string(percent) + " %", "m2",
              weighted_quantile(area, ones, percent / 100.0));
    for (const int percent : {10, 50, 90})
        plain("area, quantile " + std::to_string(percent) + " % by area", "m2",
              weighted_quantile(area, area, percent / 100.0));

    const BlockShapes shapes = block_shapes(blocks);
    const std::vector<double> corners(shapes.corners.begin(), shapes.corners.end());
    const auto average = [&](const std::vector<double>& values, const std::vector<double>& weights) {
        return std::inner_product(values.begin(), values.end(), weights.begin(), 0.0) /
               std::accumulate(weights.begin(), weights.end(), 0.0);
    };
    plain("corners, mean", "1", average(corners, ones));
    plain("corners, mean weighted by area", "1", average(corners, area));
    plain("aspect, median", "1", weighted_quantile(shapes.aspect, ones, 0.5));
    plain("aspect, median by area", "1", weighted_quantile(shapes.aspect, area, 0.5));
    plain("Kalenchuk alpha, median by area", "1", weighted_quantile(shapes.alpha, area, 0.5));
    plain("Kalenchuk beta, median by area", "1", weighted_quantile(shapes.beta, area, 0.5));
}

void add_nodes(Statistics& statistics, const Scene& scene, const Joints& joints,
               const std::optional<Expected>& expected)
{
    const Window window(scene.outline);
    const Eigen::Vector2d size(
        window.extent(Eigen::Vector2d::UnitX()).high - window.extent(Eigen::Vector2d::UnitX()).low,
        window.extent(Eigen::Vector2d::UnitY()).high - window.extent(Eigen::Vector2d::UnitY()).low);
    const Nodes nodes = count_nodes(joints, scene.outline, 1e-6 * size.norm());
    const auto plain = [&](const std::string& quantity, double value, std::int64_t count) {
        add(statistics, "nodes",
            {.quantity = quantity,
             .unit = "1",
             .achieved = value,
             .sample_size = static_cast<std::size_t>(count)});
    };
    Row crossings{.quantity = "X, crossings",
                  .unit = "1",
                  .achieved = static_cast<double>(nodes.x),
                  .sample_size = static_cast<std::size_t>(nodes.x)};
    if (expected)
        crossings.target = expected->crossings * window.area();
    add(statistics, "nodes", crossings);
    plain("Y, ends at a joint", static_cast<double>(nodes.y), nodes.y);
    plain("I, free ends", static_cast<double>(nodes.i), nodes.i);
    plain("connections per branch", nodes.connections_per_branch(), nodes.x + nodes.y + nodes.i);
}

} // namespace

Statistics statistics_of(const Scene& scene, const Network& network)
{
    Statistics statistics;
    const Grouped<Index> traces = grouped(network.joints.trace_joint, network.joints.set.size()); // rows
    for (std::size_t set = 0; set < scene.joint_sets.size(); ++set)
        add_set(statistics, scene, network.joints, traces, static_cast<Index>(set));
    const std::optional<Expected> expected = expected_of(scene);
    if (!network.blocks.block_area.empty())
        add_sizes(statistics, scene, network.blocks, expected);
    add_nodes(statistics, scene, network.joints, expected);
    judge(statistics);
    return statistics;
}

} // namespace jointcreep::statistics
