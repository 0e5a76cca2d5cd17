#include "sampling/joint_sets.hpp"

#include "model/error.hpp"
#include "sampling/density.hpp"
#include "sampling/laws.hpp"
#include "sampling/orientations.hpp"
#include "sampling/quoted.hpp"
#include "sampling/stretches.hpp"
#include "sampling/terminations.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace jointcreep::sampling
{

namespace
{

using Eigen::Vector2d;

constexpr std::int64_t most_joints = 5'000'000;
constexpr std::int64_t most_skipped_lines = 10'000'000;
constexpr std::int64_t most_intervals = 10'000'000; // traces and bridges drawn for one scene
constexpr Index most_pieces = std::numeric_limits<Index>::max() / piece_step; // of a line
constexpr Index most_mapped_ids = std::numeric_limits<Index>::max() / mapped_step;

Eigen::Vector3d in_space(const Vector2d& in_section)
{
    return {in_section.x(), in_section.y(), 0};
}

Interval widened(Interval interval, double margin)
{
    return {interval.low - margin, interval.high + margin};
}

Interval widened_to_multiples(Interval interval, double step)
{
    return {std::floor(interval.low / step) * step, std::ceil(interval.high / step) * step};
}

// The least power of two above its length.
double power_of_two_above(Interval interval)
{
    int exponent = 0;
    std::frexp(interval.high - interval.low, &exponent);
    return std::ldexp(1.0, exponent);
}

Interval widened_to_window(Interval interval)
{
    return widened_to_multiples(interval, power_of_two_above(interval));
}

// The stretches of a line that become joints of a set of lines.
std::vector<Interval> pieces(const JointSet& set, const Scene& scene, const Line& line)
{
    std::vector<Interval> stretches = where_set_exists(set, scene, line);
    if (set.region || !set.rocks.empty() || stretches.empty())
        return stretches;
    // The extent of the corners is used, not crossings: these are not defined where a line runs along a side.
    const Polygon& outline = scene.outline;
    const double origin = line.point.dot(line.direction);
    const Interval reach = widened(extent(outline, line.direction), overshoot_of(outline));
    return {{reach.low - origin, reach.high - origin}};
}

// Midpoints of traces whose size (of a segment its length, of a disc its diameter) is x have the density
// P20 x^o f(x) / E[x^o] over sizes, o = 0 for segments and 1 for discs, which a section meets by their size.
// The number of those in the box of w by h, widened by x/2 on every side, is Poisson distributed, with the mean
//     P20 E[x^o (w + x) (h + x)] / E[x^o]
// and hold every trace that comes into the box, however large sizes can be. A size of theirs has the density
// x^o (w + x) (h + x) f(x), a mixture of powers of x.
class TracesInBox
{
public:
    TracesInBox(const Polygon& bounds, const ProbabilityLaw& law, bool discs)
        : law_(law), order_(discs ? 1 : 0), x_(sides(bounds, Vector2d::UnitX())),
          y_(sides(bounds, Vector2d::UnitY())), w_(x_.high - x_.low),
          h_(y_.high - y_.low), share_{w_ * h_ * moment(order_), (w_ + h_) * moment(order_ + 1),
                                       moment(order_ + 2)}
    {
    }

    double expected(double p20) const { return p20 * all() / moment(order_); } // number of traces [-]

    struct Drawn {
        Vector2d middle;    // [m]
        double half;        // of the length of the trace [m]
        double size;        // of a disc its diameter, of a segment its length [m]
        double from_centre; // from a disc's centre to the trace, to either side [m]
    };
    Drawn draw(Stream& sizes, Stream& position) const
    {
        const double part = uniform(sizes) * all();
        const int more = part < share_[0] ? 0 : part < share_[0] + share_[1] ? 1 : 2;
        const double size = draw_biased(law_, order_ + more, sizes);
        const double off = 2 * uniform(sizes) - 1; // of the section from a disc's centre, over its radius
        const double half = size / 2 * (order_ == 1 ? std::sqrt(1 - off * off) : 1);
        const double from_centre = off * size / 2;
        const double across = x_.low - size / 2 + uniform(position) * (w_ + size);
        return {{across, y_.low - size / 2 + uniform(position) * (h_ + size)}, half, size, from_centre};
    }

private:
    static Interval sides(const Polygon& bounds, const Vector2d& axis)
    {
        const Interval side = extent(bounds, axis);
        return widened_to_multiples(side, power_of_two_above(side) / 8);
    }
    double moment(int of) const { return moment_of_positive(law_, of); }
    double all() const { return share_[0] + share_[1] + share_[2]; }

    const ProbabilityLaw& law_;
    int order_;                   // o
    Interval x_, y_;              // sides of the box [m]
    double w_, h_;                // [m]
    std::array<double, 3> share_; // of the powers of x [m^(o + 2)]
};

class Sampler
{
public:
    Sampler(const Scene& scene, std::uint64_t seed, std::int32_t realization)
        : scene_(scene), seed_(seed), realization_(realization)
    {
    }

    // `stops` are the joint traces at which the set's may end.
    void add(const JointSet& set, Index index, const TraceIndex& stops);
    void add(const SingleJoint& joint, Index index);
    void add(const MappedSet& mapped, Index index);

    Joints joints;

private:
    void add_lines(const JointSet& set, Index index);
    void add_traces(const JointSet& set, Index index, const TraceIndex& stops);

    // The stretches that are left of a segment or the trace of a disc, which reaches `half` to both sides.
    std::vector<Interval> kept_of_trace(const JointSet& set, const TraceIndex& stops,
                                        const SetStreams& streams, Index number, const Line& line,
                                        double half) const;

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
                 const Vector2d& from, const Vector2d& to, const Eigen::Vector3d& pole,
                 const Vector2d& point);
    void add_trace(const Vector2d& from, const Vector2d& to);
    void make_disc(double diameter, const Eigen::Vector3d& centre); // of the last row
    void check_pieces(const JointSet& set, std::size_t pieces) const;
    void count_skipped(const JointSet& set);
    double draw_length(const JointSet& set, Stream& stream);

    const Scene& scene_;
    std::uint64_t seed_;
    std::int32_t realization_;
    std::int64_t skipped_ = 0, intervals_ = 0;
};

void Sampler::add(const JointSet& set, Index index, const TraceIndex& stops)
{
    if (set.kind == SetKind::lines)
        add_lines(set, index);
    else
        add_traces(set, index, stops);
}

void Sampler::add_lines(const JointSet& set, Index index)
{
    if (set.persistence > 0 && set.persistence < 1 && !set.length)
        throw input_error(quoted(set) + " has a persistence of " + shown(set.persistence) +
                          " but no length; it needs one unless persistence is 0 or 1");
    if (!set.terminates_at.empty())
        throw input_error(quoted(set) + " is of lines, which do not end at others");
    const SetStreams streams{seed_, realization_, set_key(set.name)};
    const Orientations orientations(set, scene_);
    const Vector2d mean = orientations.mean_trace();
    const Vector2d along = mean.normalized(), across(-along.y(), along.x());
    const Polygon& bounds = bounds_of(set, scene_);
    const double factor = set.density || !set.poles.empty()
                              ? density_of(set, scene_).spacing / mean_of_positive(set.spacing)
                              : 1 / mean.norm();

    const Interval window = widened_to_window(extent(bounds, along));
    const Interval reach =
        widened(extent(bounds, across), (window.high - window.low) * std::tan(orientations.steepest()));

    skipped_ = 0;
    for_lines(set, streams, factor, reach, [&](Index number, double place) {
        Stream orientation(streams, number, Purpose::orientation),
            position(streams, number, Purpose::position);
        const double turning = window.low + uniform(position) * (window.high - window.low);
        const Orientations::Drawn drawn = orientations.draw_joint(orientation);
        const Line line{place * across + turning * along, drawn.trace};
        const std::vector<Interval> joint_pieces = pieces(set, scene_, line);
        if (joint_pieces.empty())
            return count_skipped(set);
        check_pieces(set, joint_pieces.size());
        const std::vector<Interval> open =
            traces(set, streams, number, {joint_pieces.front().low, joint_pieces.back().high});
        for (std::size_t p = 0; p < joint_pieces.size(); ++p) {
            const Interval& piece = joint_pieces[p];
            add_row(quoted(set), set.material, index, number + static_cast<Index>(p) * piece_step,
                    line.at(piece.low), line.at(piece.high), drawn.pole, line.point);
            for (const Interval& trace : open) {
                const double low = std::max(trace.low, piece.low), high = std::min(trace.high, piece.high);
                if (low < high)
                    add_trace(line.at(low), line.at(high));
            }
        }
    });
}

void Sampler::add_traces(const JointSet& set, Index index, const TraceIndex& stops)
{
    const bool discs = set.kind == SetKind::discs;
    const std::optional<ProbabilityLaw>& law = discs ? set.diameter : set.length;
    if (!law)
        throw input_error(quoted(set) + (discs ? " is of discs, and needs a diameter"
                                               : " is of segments, and needs a length"));
    const SetStreams streams{seed_, realization_, set_key(set.name)};
    const Orientations orientations(set, scene_);
    const TracesInBox box(bounds_of(set, scene_), *law, discs);
    const double expected = box.expected(density_of(set, scene_).p20);
    if (!(expected <= static_cast<double>(most_joints)))
        throw input_error(
            quoted(set) + ": its density is too large for the section, or its sizes: " +
            (std::isfinite(expected) ? "about " + shown(expected) + " joints" : "joints without end") +
            " would have to be drawn, and at most " + std::to_string(most_joints) + " can be");
    Stream count(streams, 0, Purpose::count);
    const Index joints_drawn = static_cast<Index>(draw_poisson(expected, count));

    for (Index number = 0; number < joints_drawn; ++number) {
        Stream sizes(streams, number, Purpose::size), position(streams, number, Purpose::position),
            orientation(streams, number, Purpose::orientation);
        const auto [middle, half, size, from_centre] = box.draw(sizes, position);
        const Orientations::Drawn drawn = orientations.draw_joint(orientation);
        const Line line{middle, drawn.trace};
        const std::vector<Interval> kept = kept_of_trace(set, stops, streams, number, line, half);
        check_pieces(set, kept.size());
        for (std::size_t p = 0; p < kept.size(); ++p) {
            const Vector2d from = line.at(kept[p].low), to = line.at(kept[p].high);
            add_row(quoted(set), set.material, index, number + static_cast<Index>(p) * piece_step, from, to,
                    drawn.pole, middle);
            if (discs)
                make_disc(size, in_space(middle) - from_centre * drawn.pole.cross(in_space(drawn.trace)));
            add_trace(from, to);
        }
    }
}

std::vector<Interval> Sampler::kept_of_trace(const JointSet& set, const TraceIndex& stops,
                                             const SetStreams& streams, Index number, const Line& line,
                                             double half) const
{
    Interval trace{-half, half};
    const auto ends_at_outline = overlap(inside(scene_.outline, line), trace);
    if (ends_at_outline.empty())
        return {};
    if (!stops.empty()) {
        Stream ahead(streams, number, Purpose::ends_ahead), behind(streams, number, Purpose::ends_behind);
        trace.high = stops.end_of(line, half, set.termination_probability, ends_at_outline, ahead);
        trace.low = -stops.end_of({line.point, -line.direction}, half, set.termination_probability,
                                  turned_round(ends_at_outline), behind);
    }
    if (set.region || !set.rocks.empty())
        return overlap(where_set_exists(set, scene_, line), trace);
    if (overlap(ends_at_outline, trace).empty())
        return {};
    return {trace};
}

void Sampler::add(const SingleJoint& joint, Index index)
{
    add_row("joint \"" + joint.name + "\"", joint.material, index, 0, joint.from, joint.to,
            Eigen::Vector3d::Zero(), (joint.from + joint.to) / 2);
    add_trace(joint.from, joint.to);
}

void Sampler::add(const MappedSet& mapped, Index index)
{
    const std::string name = "mapped set \"" + mapped.name + "\"";
    for (const MappedTrace& trace : mapped.traces) {
        if (trace.id < 0 || trace.id > most_mapped_ids)
            throw input_error(name + ": a trace has the id " + std::to_string(trace.id) + "; expected 0 to " +
                              std::to_string(most_mapped_ids));
        Index piece = 0;
        for (const Polygon& polyline : trace.polylines)
            for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
                if (polyline[i] == polyline[i + 1])
                    continue; // a place that was clicked twice
                if (piece == mapped_step)
                    throw input_error(name + ": trace " + std::to_string(trace.id) + " has more than " +
                                      std::to_string(mapped_step) + " straight pieces");
                add_row(name, mapped.material, index, trace.id * mapped_step + piece++, polyline[i],
                        polyline[i + 1], Eigen::Vector3d::Zero(), (polyline[i] + polyline[i + 1]) / 2);
                add_trace(polyline[i], polyline[i + 1]);
            }
    }
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
                          " m) is too small for the section, or its lines are too dense: more than " +
                          std::to_string(most_intervals) + " joint traces would result");
    return draw_positive(*set.length, stream);
}

void Sampler::add_row(const std::string& name, const std::string& material, Index set, Index number,
                      const Vector2d& from, const Vector2d& to, const Eigen::Vector3d& pole,
                      const Vector2d& point)
{
    const auto& materials = scene_.joint_materials;
    const auto found = std::find_if(materials.begin(), materials.end(), [&](const JointMaterial& candidate) {
        return candidate.name == material;
    });
    if (found == materials.end())
        throw input_error(name + ": there is no joint material \"" + material + "\"");
    if (joints.set.size() >= most_joints)
        throw input_error(name + ": spacing is too small, or density too large, for the section: more than " +
                          std::to_string(most_joints) + " joints would result");
    joints.set.push_back(set);
    joints.number.push_back(number);
    joints.material.push_back(static_cast<Index>(found - materials.begin()));
    joints.from.push_back(from);
    joints.to.push_back(to);
    joints.pole.push_back(pole);
    joints.point.push_back(point);
    joints.diameter.push_back(0);
    joints.centre.push_back(in_space(point));
}

void Sampler::make_disc(double diameter, const Eigen::Vector3d& centre)
{
    joints.diameter.back() = diameter;
    joints.centre.back() = centre;
}

void Sampler::add_trace(const Vector2d& from, const Vector2d& to)
{
    joints.trace_joint.push_back(static_cast<Index>(joints.set.size()) - 1);
    joints.trace_from.push_back(from);
    joints.trace_to.push_back(to);
}

void Sampler::check_pieces(const JointSet& set, std::size_t pieces) const
{
    if (pieces > static_cast<std::size_t>(most_pieces))
        throw input_error(quoted(set) + ": where it exists cuts a joint into more than " +
                          std::to_string(most_pieces) + " pieces");
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

// Puts the joints of one set behind those of others.
void append(Joints& joints, const Joints& more)
{
    const auto put = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    const auto first = static_cast<Index>(joints.set.size());
    for (const Index joint : more.trace_joint)
        joints.trace_joint.push_back(first + joint);
    put(joints.set, more.set);
    put(joints.number, more.number);
    put(joints.material, more.material);
    put(joints.from, more.from);
    put(joints.to, more.to);
    put(joints.pole, more.pole);
    put(joints.point, more.point);
    put(joints.diameter, more.diameter);
    put(joints.centre, more.centre);
    put(joints.trace_from, more.trace_from);
    put(joints.trace_to, more.trace_to);
    if (static_cast<std::int64_t>(joints.set.size()) > most_joints)
        throw input_error("the joint sets' spacings are too small, or their densities too large, for the "
                          "section: more than " +
                          std::to_string(most_joints) + " joints would result");
}

} // namespace

std::vector<std::size_t> sampling_order(const std::vector<JointSet>& sets)
{
    enum class State { waiting, open, done };
    std::vector<State> state(sets.size(), State::waiting);
    std::vector<std::size_t> order;
    const std::function<void(std::size_t)> visit = [&](std::size_t i) {
        if (state[i] == State::done)
            return;
        if (state[i] == State::open)
            throw input_error(quoted(sets[i]) +
                              " ends, by terminates_at, at sets that end at it in turn: they go in a circle");
        state[i] = State::open;
        for (const std::string& name : sets[i].terminates_at)
            for (std::size_t j = 0; j < sets.size(); ++j)
                if (sets[j].name == name)
                    visit(j);
        state[i] = State::done;
        order.push_back(i);
    };
    for (std::size_t i = 0; i < sets.size(); ++i)
        visit(i);
    return order;
}

Joints sample_joints(const Scene& scene, std::uint64_t seed, std::int32_t realization)
{
    check_keys(scene.joint_sets);
    const Names names = names_of(scene);
    std::vector<Joints> of_set(names.joint_set.size());
    const std::size_t first_single = scene.joint_sets.size(),
                      first_mapped = first_single + scene.joints.size();
    const auto sample = [&](std::size_t index, const auto& set, const auto&... stops) {
        Sampler sampler(scene, seed, realization);
        sampler.add(set, static_cast<Index>(index), stops...);
        of_set[index] = std::move(sampler.joints);
    };
    for (std::size_t i = 0; i < scene.joints.size(); ++i)
        sample(first_single + i, scene.joints[i]);
    for (std::size_t i = 0; i < scene.mapped.size(); ++i)
        sample(first_mapped + i, scene.mapped[i]);
    for (const std::size_t i : sampling_order(scene.joint_sets)) {
        const JointSet& set = scene.joint_sets[i];
        std::vector<const Joints*> stops;
        for (const std::string& name : set.terminates_at) {
            const auto found = std::find(names.joint_set.begin(), names.joint_set.end(), name);
            if (found == names.joint_set.end())
                throw input_error(quoted(set) + ": terminates_at has \"" + name +
                                  "\"; expected the name of a joint set");
            stops.push_back(&of_set[static_cast<std::size_t>(found - names.joint_set.begin())]);
        }
        sample(i, set, TraceIndex(stops));
    }
    Joints joints;
    for (const Joints& more : of_set)
        append(joints, more);
    return joints;
}

} // namespace jointcreep::sampling
