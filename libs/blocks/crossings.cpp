#include "blocks/crossings.hpp"

#include "blocks/cut.hpp"
#include "model/error.hpp"
#include "model/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace jointcreep::blocks
{

using Eigen::Vector2d;

namespace
{

// Measured, two sets of lines with 1e6 to 9e6 crossings (docs/cutting.md); where many joints meet in a point, less.
constexpr double seconds_of_a_crossing = 4e-6;

// Of a square with sides of the shortest edge through which m joints go: merging moves them onto each other again and
// again. Measured, 200 to 1500 joints in bands of one to a hundred of these edges (docs/cutting.md).
constexpr double seconds_of_a_crowd = 1e-12, power_of_a_crowd = 4;
constexpr double longest_crowd = 3600; // [s], refused beyond it

bool cross_in(const Box& box, const Vector2d& p, const Vector2d& p_to, const Vector2d& q,
              const Vector2d& q_to)
{
    const Vector2d d = p_to - p, e = q_to - q, o = q - p;
    const double below = cross(d, e);
    if (below == 0)
        return false;
    const double along = cross(o, e) / below, along_other = cross(o, d) / below;
    const Vector2d place = p + along * d;
    return along >= 0 && along <= 1 && along_other >= 0 && along_other <= 1 &&
           (place.array() >= box.low.array()).all() && (place.array() <= box.high.array()).all();
}

double pairs_of(const Joints& joints)
{
    const auto count = static_cast<double>(joints.set.size());
    return count * (count - 1) / 2;
}

// What makes joints of a set fewer or shorter.
std::string advice_for(const Scene& scene, Index set)
{
    const auto row = static_cast<std::size_t>(set);
    if (row >= scene.joint_sets.size())
        return "Give fewer or shorter joints";
    const JointSet& of = scene.joint_sets[row];
    if (of.kind == SetKind::lines)
        return of.density ? "Reduce its density" : "Increase its spacing";
    return std::string("Reduce its density or its ") + (of.kind == SetKind::discs ? "diameter" : "length");
}

// How long joints take that come closer to each other than the shortest edge over a long way [s]: from how many pass by
// random places on joints, always the same ones.
double seconds_of_crowds(const Scene& scene, const Joints& joints)
{
    const std::size_t count = joints.set.size();
    const double near = scene.cutting.shortest_edge / 2;
    if (count < 2 || !(near > 0))
        return 0;
    std::vector<double> until(count); // length of joints up to each one
    double length = 0;
    for (std::size_t i = 0; i < count; ++i)
        until[i] = length += (joints.to[i] - joints.from[i]).norm();
    if (!(length > 0))
        return 0;
    const std::size_t tries = std::clamp<std::size_t>(std::size_t{20'000'000} / count, 10, 300);
    std::mt19937_64 random; // NOLINT: the same places in every run
    double sum = 0;
    for (std::size_t t = 0; t < tries; ++t) {
        const double at = static_cast<double>(random() >> 11) * 0x1p-53 * length;
        const auto on = std::min<std::size_t>(
            static_cast<std::size_t>(std::ranges::upper_bound(until, at) - until.begin()), count - 1);
        const Vector2d way = joints.to[on] - joints.from[on];
        const Vector2d place = joints.to[on] - (until[on] - at) / std::max(way.norm(), near) * way;
        double crowd = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Vector2d d = joints.to[i] - joints.from[i], o = place - joints.from[i];
            const double along = std::clamp(o.dot(d) / std::max(d.squaredNorm(), near * near), 0.0, 1.0);
            crowd += (o - along * d).squaredNorm() <= near * near ? 1 : 0;
        }
        sum += std::pow(crowd, power_of_a_crowd - 1);
    }
    return seconds_of_a_crowd * length / scene.cutting.shortest_edge * sum / static_cast<double>(tries);
}

} // namespace

Box box_of(const Polygon& outline)
{
    Box box{outline[0], outline[0]};
    for (const Vector2d& p : outline) {
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
    }
    return box;
}

ExpectedCrossings expected_crossings(const Joints& joints, const Box& box)
{
    const std::size_t count = joints.set.size();
    if (count < 2)
        return {};
    const double pairs = pairs_of(joints);
    // A hundred hits or more where there are too many crossings.
    const auto tries = static_cast<std::size_t>(std::clamp(100 * pairs / most_crossings, 1e5, 3e7));
    std::mt19937_64 random;       // NOLINT: the same pairs in every run
    std::map<Index, double> hits; // of sets
    double all = 0;
    for (std::size_t i = 0; i < tries; ++i) {
        const std::size_t a = random() % count, b = random() % count;
        if (a == b || !cross_in(box, joints.from[a], joints.to[a], joints.from[b], joints.to[b]))
            continue;
        ++all;
        ++hits[joints.set[a]];
        ++hits[joints.set[b]];
    }
    ExpectedCrossings expected;
    expected.number = all / static_cast<double>(tries) * pairs;
    if (!hits.empty())
        expected.set = std::ranges::max_element(hits, {}, [](const auto& of) { return of.second; })->first;
    return expected;
}

void check_crossings(const Scene& scene, const Joints& joints, const Box& box)
{
    if (const double seconds = seconds_of_crowds(scene, joints); seconds > longest_crowd)
        throw input_error(
            "joints come closer to each other than shortest_edge_m = " + shown(scene.cutting.shortest_edge) +
            " over long distances: cutting would take about " + rounded(seconds / longest_crowd, 2) +
            " hours. Give fewer joints that are nearly parallel there, or a smaller shortest_edge_m");
    if (pairs_of(joints) <= most_crossings)
        return;
    const ExpectedCrossings expected = expected_crossings(joints, box);
    if (!(expected.number > most_crossings))
        return;
    throw input_error("about " + rounded(expected.number, 2) +
                      " crossings of joints in the section; expected at most " + rounded(most_crossings, 2) +
                      ". Most are on joint set \"" + names_of(scene).joint_set[expected.set] + "\". " +
                      advice_for(scene, expected.set));
}

CuttingCost expected_cost(const Scene& scene, const Joints& joints)
{
    const double of_crowds = seconds_of_crowds(scene, joints);
    if (pairs_of(joints) * seconds_of_a_crossing + of_crowds < 1 || of_crowds > longest_crowd)
        return {};
    const double crossings = expected_crossings(joints, box_of(scene.outline)).number;
    if (crossings > most_crossings)
        return {};
    return {crossings, crossings * seconds_of_a_crossing + of_crowds};
}

} // namespace jointcreep::blocks
