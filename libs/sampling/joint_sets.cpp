#include "sampling/joint_sets.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "sampling/laws.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep
{

namespace
{

using Eigen::Vector2d;

constexpr std::int64_t most_joints = 5'000'000;
constexpr std::int64_t most_skipped_lines = 10'000'000;
constexpr std::int64_t most_intervals = 10'000'000; // traces and bridges drawn for one scene
constexpr Index most_pieces = std::numeric_limits<Index>::max() / piece_step; // of a line

constexpr double least_section_normal = 1e-6; // a plane nearer to parallel leaves no trace worth the name

// A stretch of a line, by distance from the line's point, or of an axis through the origin [m].
struct Interval {
    double low, high;
};

struct Line {
    Vector2d point, direction; // unit
    Vector2d at(double distance) const { return point + distance * direction; }
};

std::string quoted(const JointSet& set)
{
    return "joint set \"" + set.name + "\"";
}

// Along the trace, in length |n_p|.
Vector2d trace_of(const Vector2d& section_normal)
{
    return {section_normal.y(), -section_normal.x()};
}

Vector2d trace_of(double angle)
{
    return {std::cos(angle), std::sin(angle)};
}

// A plane by its dip and dip direction [rad].
struct Plane {
    double dip, dip_direction;
};

Plane mean_plane(const JointSet& set)
{
    if (set.orientation)
        return {set.orientation->dip, set.orientation->dip_direction};
    if (!set.dip || !set.dip_direction)
        throw input_error(quoted(set) + " has no orientation; it needs a trace angle, a dip and a dip "
                                        "direction, or a law of its poles");
    return {set.dip->mean, set.dip_direction->mean};
}

double azimuth_for(const JointSet& set, const Scene& scene)
{
    if (!scene.azimuth)
        throw input_error(quoted(set) +
                          " has a dip and a dip direction, for which the section needs an azimuth");
    return *scene.azimuth;
}

// Upward unit normal along the section's x and y, and across it.
Eigen::Vector3d pole_of(const Plane& plane, double azimuth)
{
    const Vector2d in_section = section_normal(plane.dip, plane.dip_direction, azimuth);
    return {in_section.x(), in_section.y(), std::sin(plane.dip) * std::sin(plane.dip_direction - azimuth)};
}

Vector2d mean_trace(const JointSet& set, const Scene& scene)
{
    if (set.trace_angle)
        return trace_of(set.trace_angle->mean);
    const Plane plane = mean_plane(set);
    const Vector2d trace = trace_of(section_normal(plane.dip, plane.dip_direction, azimuth_for(set, scene)));
    if (trace.norm() < least_section_normal)
        throw input_error(quoted(set) + " is parallel to the section, and leaves no traces in it");
    return trace;
}

// By the set's laws in space.
Eigen::Vector3d draw_pole(const JointSet& set, double azimuth, Stream& stream)
{
    if (set.orientation)
        return draw_fisher(pole_of(mean_plane(set), azimuth), set.orientation->concentration, stream);
    const double dip = draw(*set.dip, stream);
    return pole_of({dip, draw(*set.dip_direction, stream)}, azimuth);
}

struct Drawn {
    Vector2d direction;   // of the trace
    Eigen::Vector3d pole; // upward; zero if the set has none
};

Drawn draw_direction(const JointSet& set, const Scene& scene, Stream& stream)
{
    if (set.trace_angle)
        return {trace_of(draw(*set.trace_angle, stream)), Eigen::Vector3d::Zero()};
    const double azimuth = azimuth_for(set, scene);
    const int most_tries = 10000;
    for (int i = 0; i < most_tries; ++i) {
        const Eigen::Vector3d pole = draw_pole(set, azimuth, stream);
        const Vector2d trace = trace_of(pole.head<2>());
        if (trace.norm() >= least_section_normal)
            return {trace.normalized(), pole.y() < 0 ? -pole : pole};
    }
    throw input_error(quoted(set) + " has next to no joints that are not parallel to the section");
}

// Standard deviation of the trace angle, to first order [rad]; `mean` from mean_trace. A pole by Fisher's law
// turns by 1/sqrt(concentration) about any axis across the mean pole, the mean trace among them.
double trace_scatter(const JointSet& set, const Vector2d& mean)
{
    if (set.trace_angle)
        return set.trace_angle->deviation;
    if (set.orientation)
        return 1 / (std::sqrt(set.orientation->concentration) * mean.norm());
    return std::hypot(set.dip->deviation, std::sin(set.dip->mean) * set.dip_direction->deviation) /
           mean.norm();
}

Interval extent(const Polygon& polygon, const Vector2d& direction)
{
    Interval extent{polygon[0].dot(direction), polygon[0].dot(direction)};
    for (const Vector2d& corner : polygon) {
        extent.low = std::min(extent.low, corner.dot(direction));
        extent.high = std::max(extent.high, corner.dot(direction));
    }
    return extent;
}

Interval widened(Interval interval, double margin)
{
    return {interval.low - margin, interval.high + margin};
}

// To multiples of the least power of two above its length.
Interval widened_to_window(Interval interval)
{
    int exponent = 0;
    std::frexp(interval.high - interval.low, &exponent);
    const double step = std::ldexp(1.0, exponent);
    return {std::floor(interval.low / step) * step, std::ceil(interval.high / step) * step};
}

double overshoot_of(const Polygon& polygon)
{
    const Interval x = extent(polygon, Vector2d::UnitX()), y = extent(polygon, Vector2d::UnitY());
    return 1e-6 * std::hypot(x.high - x.low, y.high - y.low);
}

// The stretches of a line inside a polygon. A corner on the line counts as left of it, so that crossings pair
// up.
std::vector<Interval> inside(const Polygon& polygon, const Line& line)
{
    const auto distance = [&](const Vector2d& corner) {
        const Vector2d offset = corner - line.point;
        return line.direction.x() * offset.y() - line.direction.y() * offset.x();
    };
    std::vector<double> crossings;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const double a = distance(from), b = distance(to);
        if ((a < 0) != (b < 0))
            crossings.push_back((from + a / (a - b) * (to - from) - line.point).dot(line.direction));
    }
    std::sort(crossings.begin(), crossings.end());
    std::vector<Interval> stretches;
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
        stretches.push_back({crossings[i], crossings[i + 1]});
    return stretches;
}

// The stretches of a line that become joints of a set.
std::vector<Interval> pieces(const JointSet& set, const Polygon& outline, const Line& line)
{
    std::vector<Interval> pieces;
    if (!set.region) {
        // By its corners' extent rather than by crossings: these are ill-defined where a line runs along a
        // side.
        if (!inside(outline, line).empty()) {
            const double origin = line.point.dot(line.direction);
            const Interval reach = widened(extent(outline, line.direction), overshoot_of(outline));
            pieces.push_back({reach.low - origin, reach.high - origin});
        }
        return pieces;
    }
    const double overshoot = overshoot_of(*set.region);
    for (const Interval& stretch : inside(*set.region, line)) {
        if (stretch.high - stretch.low <= overshoot)
            continue; // it only touches a corner
        const Interval piece = widened(stretch, overshoot);
        if (!pieces.empty() && piece.low <= pieces.back().high)
            pieces.back().high = piece.high;
        else
            pieces.push_back(piece);
    }
    return pieces;
}

class Sampler
{
public:
    Sampler(const Scene& scene, std::uint64_t seed, std::int32_t realization)
        : scene_(scene), seed_(seed), realization_(realization)
    {
    }

    void add(const JointSet& set, Index index);
    void add(const SingleJoint& joint, Index index);

    Joints joints;

private:
    // Calls visit(number, place along the mean normal) for all lines with a place in `reach`.
    template <class Visit>
    void for_lines(const JointSet& set, const SetStreams& streams, double factor, Interval reach,
                   Visit visit);

    std::vector<Interval> traces(const JointSet& set, const SetStreams& streams, Index number,
                                 Interval reach);

    // Traces by distance from the line's point, `start` being where the interval that holds the point ends.
    std::vector<Interval> traces_onward(const JointSet& set, Stream& stream, bool was_trace, double start,
                                        double end);

    void add_row(const std::string& name, const std::string& material, Index set, Index number,
                 const Vector2d& from, const Vector2d& to);
    void add_trace(const Vector2d& from, const Vector2d& to);
    void count_skipped(const JointSet& set);
    double draw_length(const JointSet& set, Stream& stream);

    const Scene& scene_;
    std::uint64_t seed_;
    std::int32_t realization_;
    std::int64_t skipped_ = 0, intervals_ = 0;
};

void Sampler::add(const JointSet& set, Index index)
{
    if (set.persistence > 0 && set.persistence < 1 && !set.length)
        throw input_error(quoted(set) + " has a persistence of " + shown(set.persistence) +
                          " but no length; it needs one unless persistence is 0 or 1");
    const SetStreams streams{seed_, realization_, set_key(set.name)};
    const Vector2d mean = mean_trace(set, scene_);
    const Vector2d along = mean.normalized(), across(-along.y(), along.x());
    const Polygon& region = set.region ? *set.region : scene_.outline;

    const Interval window = widened_to_window(extent(region, along));
    const double steepest = std::min(5 * trace_scatter(set, mean), 85 * unit::deg);
    const Interval reach = widened(extent(region, across), (window.high - window.low) * std::tan(steepest));

    skipped_ = 0;
    for_lines(set, streams, 1 / mean.norm(), reach, [&](Index number, double place) {
        Stream orientation(streams, number, Purpose::orientation),
            position(streams, number, Purpose::position);
        const double turning = window.low + uniform(position) * (window.high - window.low);
        const Drawn drawn = draw_direction(set, scene_, orientation);
        const Line line{place * across + turning * along, drawn.direction};
        const std::vector<Interval> joint_pieces = pieces(set, scene_.outline, line);
        if (joint_pieces.empty())
            return count_skipped(set);
        if (joint_pieces.size() > static_cast<std::size_t>(most_pieces))
            throw input_error(quoted(set) + ": its region cuts a joint into more than " +
                              std::to_string(most_pieces) + " pieces");
        const std::vector<Interval> open =
            traces(set, streams, number, {joint_pieces.front().low, joint_pieces.back().high});
        for (std::size_t p = 0; p < joint_pieces.size(); ++p) {
            const Interval& piece = joint_pieces[p];
            add_row(quoted(set), set.material, index, number + static_cast<Index>(p) * piece_step,
                    line.at(piece.low), line.at(piece.high));
            joints.pole.push_back(drawn.pole);
            joints.point.push_back(line.point);
            for (const Interval& trace : open) {
                const double low = std::max(trace.low, piece.low), high = std::min(trace.high, piece.high);
                if (low < high)
                    add_trace(line.at(low), line.at(high));
            }
        }
    });
}

void Sampler::add(const SingleJoint& joint, Index index)
{
    add_row("joint \"" + joint.name + "\"", joint.material, index, 0, joint.from, joint.to);
    joints.pole.emplace_back(0, 0, 0);
    joints.point.emplace_back((joint.from + joint.to) / 2);
    add_trace(joint.from, joint.to);
}

template <class Visit>
void Sampler::for_lines(const JointSet& set, const SetStreams& streams, double factor, Interval reach,
                        Visit visit)
{
    const auto visit_or_skip = [&](Index number, double place) {
        if (place >= reach.low && place <= reach.high)
            visit(number, place);
        else
            count_skipped(set);
    };
    const auto spacing = [&](Index number) {
        Stream stream(streams, number, Purpose::spacing);
        return factor * draw_positive(set.spacing, stream);
    };
    Stream anchor(streams, 0, Purpose::spacing);
    const double interval = factor * draw_size_biased(set.spacing, anchor);
    const double before = interval * uniform(anchor);

    double place = interval - before;
    for (Index number = 0; place <= reach.high; place += spacing(++number))
        visit_or_skip(number, place);
    place = -before;
    for (Index number = -1; place >= reach.low; place -= spacing(--number))
        visit_or_skip(number, place);
}

std::vector<Interval> Sampler::traces(const JointSet& set, const SetStreams& streams, Index number,
                                      Interval reach)
{
    if (set.persistence <= 0)
        return {};
    if (set.persistence >= 1)
        return {reach};
    Stream ahead(streams, number, Purpose::traces_ahead), behind(streams, number, Purpose::traces_behind);
    const double mean_bridge = mean_of_positive(*set.length) * (1 - set.persistence) / set.persistence;
    const bool in_trace = uniform(ahead) < set.persistence;
    Interval first{};
    if (in_trace) {
        const double length = draw_size_biased(*set.length, ahead);
        first.high = length * uniform(ahead);
        first.low = first.high - length;
    } else {
        first = {-draw_exponential(mean_bridge, behind), draw_exponential(mean_bridge, ahead)};
    }
    std::vector<Interval> traces = traces_onward(set, behind, in_trace, -first.low, -reach.low);
    std::reverse(traces.begin(), traces.end());
    for (Interval& trace : traces)
        trace = {-trace.high, -trace.low};
    if (in_trace)
        traces.push_back(first);
    const std::vector<Interval> onward = traces_onward(set, ahead, in_trace, first.high, reach.high);
    traces.insert(traces.end(), onward.begin(), onward.end());
    return traces;
}

std::vector<Interval> Sampler::traces_onward(const JointSet& set, Stream& stream, bool was_trace,
                                             double start, double end)
{
    const double mean_bridge = mean_of_positive(*set.length) * (1 - set.persistence) / set.persistence;
    std::vector<Interval> traces;
    for (double place = start; place < end; was_trace = !was_trace) {
        if (was_trace) {
            place += draw_exponential(mean_bridge, stream);
        } else {
            const double length = draw_length(set, stream);
            traces.push_back({place, place + length});
            place += length;
        }
    }
    return traces;
}

double Sampler::draw_length(const JointSet& set, Stream& stream)
{
    if (++intervals_ > most_intervals)
        throw input_error(quoted(set) + ": its length (mean " + shown(set.length->mean) +
                          " m) is too small for the section: more than " + std::to_string(most_intervals) +
                          " joint traces would result");
    return draw_positive(*set.length, stream);
}

void Sampler::add_row(const std::string& name, const std::string& material, Index set, Index number,
                      const Vector2d& from, const Vector2d& to)
{
    const auto& materials = scene_.joint_materials;
    const auto found = std::find_if(materials.begin(), materials.end(), [&](const JointMaterial& candidate) {
        return candidate.name == material;
    });
    if (found == materials.end())
        throw input_error(name + ": there is no joint material \"" + material + "\"");
    if (joints.set.size() >= most_joints)
        throw input_error(name + ": spacing is too small for the section: more than " +
                          std::to_string(most_joints) + " joints would result");
    joints.set.push_back(set);
    joints.number.push_back(number);
    joints.material.push_back(static_cast<Index>(found - materials.begin()));
    joints.from.push_back(from);
    joints.to.push_back(to);
}

void Sampler::add_trace(const Vector2d& from, const Vector2d& to)
{
    joints.trace_joint.push_back(static_cast<Index>(joints.set.size()) - 1);
    joints.trace_from.push_back(from);
    joints.trace_to.push_back(to);
}

void Sampler::count_skipped(const JointSet& set)
{
    if (++skipped_ > most_skipped_lines)
        throw input_error(
            quoted(set) + ": more than " + std::to_string(most_skipped_lines) +
            " joints would lie between the origin (0, 0) and the section, or beside it; its spacing (mean " +
            shown(set.spacing.mean) +
            " m) must be larger, or the origin of the coordinates nearer to the section");
}

void check_keys(const std::vector<JointSet>& sets)
{
    for (std::size_t i = 0; i < sets.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            if (sets[i].name == sets[j].name)
                throw input_error("there are two joint sets of the name \"" + sets[i].name + "\"");
            if (set_key(sets[i].name) == set_key(sets[j].name))
                throw input_error(
                    "the joint sets \"" + sets[j].name + "\" and \"" + sets[i].name +
                    "\" would share their random numbers, by an accident of their names; rename one");
        }
}

} // namespace

Vector2d section_normal(double dip, double dip_direction, double azimuth)
{
    return {std::sin(dip) * std::cos(dip_direction - azimuth), std::cos(dip)};
}

double trace_angle(double dip, double dip_direction, double azimuth)
{
    const Vector2d trace = trace_of(section_normal(dip, dip_direction, azimuth));
    return std::atan2(trace.y(), trace.x());
}

Joints sample_joints(const Scene& scene, std::uint64_t seed, std::int32_t realization)
{
    check_keys(scene.joint_sets);
    Sampler sampler(scene, seed, realization);
    Index index = 0;
    for (const JointSet& set : scene.joint_sets)
        sampler.add(set, index++);
    for (const SingleJoint& joint : scene.joints)
        sampler.add(joint, index++);
    return std::move(sampler.joints);
}

} // namespace jointcreep
