#include "sampling/orientations.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "sampling/laws.hpp"
#include "sampling/quoted.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace jointcreep::sampling
{

using Eigen::Vector2d, Eigen::Vector3d;

namespace
{

constexpr double least_section_normal = 1e-6; // a plane nearer to parallel leaves no trace worth the name
constexpr double steepest_trace = 85 * unit::deg;
constexpr double least_in_rose = 0.05; // |n_p| of a line's plane: 3 degrees off the section

// Along the trace, in length |n_p|.
Vector2d trace_of(const Vector2d& section_normal)
{
    return {section_normal.y(), -section_normal.x()};
}

Vector2d trace_at(double angle)
{
    return {std::cos(angle), std::sin(angle)};
}

Vector3d normal_of(const Vector2d& trace)
{
    return {-trace.y(), trace.x(), 0};
}

double azimuth_for(const JointSet& set, const Scene& scene)
{
    if (!scene.azimuth)
        throw input_error(quoted(set) +
                          " has a dip and a dip direction, for which the section needs an azimuth");
    return *scene.azimuth;
}

// The axis about which the tensor of the poles is largest: signs of poles do not matter to it.
Vector3d mean_of(const std::vector<Vector3d>& poles, const std::vector<MeasuredPole>& weights)
{
    Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < poles.size(); ++i)
        tensor += weights[i].weight * poles[i] * poles[i].transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(tensor);
    const Vector3d mean = axes.eigenvectors().col(2);
    return mean.y() < 0 ? Vector3d(-mean) : mean;
}

// A law laid out: values and their probabilities.
struct Node {
    double value, weight;
};

std::vector<Node> laid_out(const ProbabilityLaw& law)
{
    const int steps = 120;
    std::vector<Node> nodes;
    if (law.deviation == 0)
        return {{law.mean, 1}};
    for (int i = 0; i < steps; ++i) {
        const double at = (i + .5) / steps;
        if (law.kind == ProbabilityLaw::Kind::uniform) {
            nodes.push_back({law.least + at * (law.most - law.least), 1.0 / steps});
        } else { // normal: the trapezoidal rule is exact but for what lies past 7 deviations
            const double z = 7 * (2 * at - 1), step = 14.0 / steps;
            nodes.push_back({law.mean + z * law.deviation,
                             std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi) * step});
        }
    }
    return nodes;
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

Vector3d pole_of(double dip, double dip_direction, double azimuth)
{
    const Vector2d in_section = section_normal(dip, dip_direction, azimuth);
    return {in_section.x(), in_section.y(), std::sin(dip) * std::sin(dip_direction - azimuth)};
}

Vector3d direction_of(const Scanline& scanline, const Scene& scene)
{
    if (scanline.angle)
        return {std::cos(*scanline.angle), std::sin(*scanline.angle), 0};
    if (!scene.azimuth)
        throw input_error("a scanline with a trend needs the section's azimuth");
    const double turn = scanline.trend - *scene.azimuth, level = std::cos(scanline.plunge);
    return {level * std::cos(turn), -std::sin(scanline.plunge), level * std::sin(turn)};
}

double Rose::along(const Vector3d& v) const
{
    double sum = 0;
    for (std::size_t i = 0; i < pole.size(); ++i)
        sum += share[i] * std::abs(pole[i].dot(v));
    return sum;
}

double Rose::in_section() const
{
    double sum = 0;
    for (std::size_t i = 0; i < pole.size(); ++i)
        sum += share[i] * pole[i].head<2>().norm();
    return sum;
}

Orientations::Orientations(const JointSet& set, const Scene& scene) : set_(set)
{
    if (set.trace_angle) {
        mean_trace_ = trace_at(set.trace_angle->mean);
        mean_pole_ = normal_of(mean_trace_);
        return;
    }
    if (!set.poles.empty()) {
        azimuth_ = azimuth_for(set, scene);
        for (const MeasuredPole& pole : set.poles)
            pole_.push_back(pole_of(pole.dip, pole.dip_direction, azimuth_));
        mean_pole_ = mean_of(pole_, set.poles);
        mean_trace_ = trace_of(mean_pole_.head<2>());
    } else {
        double dip = 0, dip_direction = 0;
        if (set.orientation) {
            dip = set.orientation->dip;
            dip_direction = set.orientation->dip_direction;
        } else if (set.dip && set.dip_direction) {
            dip = set.dip->mean;
            dip_direction = set.dip_direction->mean;
        } else {
            throw input_error(quoted(set) + " has no orientation; it needs a trace angle, a dip and a dip "
                                            "direction, or a law of its poles");
        }
        azimuth_ = azimuth_for(set, scene);
        mean_pole_ = pole_of(dip, dip_direction, azimuth_);
        mean_trace_ = trace_of(section_normal(dip, dip_direction, azimuth_));
    }
    if (mean_trace_.norm() < least_section_normal)
        throw input_error(quoted(set) + " is parallel to the section, and leaves no traces in it");

    double sum = 0;
    const Vector3d across = across_mean_trace();
    for (std::size_t i = 0; i < pole_.size(); ++i) {
        const double met =
            set.kind == SetKind::lines ? std::abs(pole_[i].dot(across)) : pole_[i].head<2>().norm();
        sum_.push_back(sum += set.poles[i].weight * met);
    }
}

Vector3d Orientations::across_mean_trace() const
{
    return normal_of(mean_trace_.normalized());
}

// Standard deviation of the trace angle, to first order. A pole by Fisher's law turns by
// 1/sqrt(concentration) about any axis across the mean pole, the mean trace among them.
double Orientations::steepest() const
{
    double scatter = 0;
    if (!pole_.empty()) {
        const Vector3d across = across_mean_trace();
        double most = 0;
        for (const Vector3d& pole : pole_)
            most = std::max(most, std::atan2(std::abs(pole.head<2>().dot(mean_trace_)) / mean_trace_.norm(),
                                             std::abs(pole.dot(across))));
        return std::min(most, steepest_trace);
    }
    if (set_.trace_angle)
        scatter = set_.trace_angle->deviation;
    else if (set_.orientation)
        scatter = 1 / (std::sqrt(set_.orientation->concentration) * mean_trace_.norm());
    else
        scatter = std::hypot(set_.dip->deviation, std::sin(set_.dip->mean) * set_.dip_direction->deviation) /
                  mean_trace_.norm();
    return std::min(5 * scatter, steepest_trace);
}

Vector3d Orientations::draw_pole(Stream& stream) const
{
    if (set_.orientation)
        return draw_fisher(mean_pole_, set_.orientation->concentration, stream);
    const double dip = draw(*set_.dip, stream);
    return pole_of(dip, draw(*set_.dip_direction, stream), azimuth_);
}

Orientations::Drawn Orientations::draw_joint(Stream& stream) const
{
    const auto upward = [](const Vector3d& pole) -> Vector3d { return pole.y() < 0 ? -pole : pole; };
    if (set_.trace_angle)
        return {trace_at(draw(*set_.trace_angle, stream)), Vector3d::Zero()};
    if (!pole_.empty()) {
        const auto after = std::upper_bound(sum_.begin(), sum_.end(), uniform(stream) * sum_.back());
        const auto i = std::min<std::ptrdiff_t>(after - sum_.begin(), std::ssize(sum_) - 1);
        return {trace_of(pole_[i].head<2>()).normalized(), upward(pole_[i])};
    }
    const int most_poles = 10000;
    for (int i = 0; i < most_poles; ++i) {
        const Vector3d pole = draw_pole(stream);
        const Vector2d trace = trace_of(pole.head<2>());
        const bool met = set_.kind == SetKind::lines || uniform(stream) < trace.norm();
        if (met && trace.norm() >= least_section_normal)
            return {trace.normalized(), upward(pole)};
    }
    throw input_error(quoted(set_) + " has next to no joints that are not parallel to the section");
}

Rose Orientations::rose() const
{
    Rose rose;
    const auto add = [&rose](const Vector3d& pole, double share) {
        rose.pole.push_back(pole);
        rose.share.push_back(share);
    };
    if (set_.trace_angle) {
        for (const Node& angle : laid_out(*set_.trace_angle))
            add(normal_of(trace_at(angle.value)), angle.weight);
    } else if (!pole_.empty()) {
        for (std::size_t i = 0; i < pole_.size(); ++i)
            add(pole_[i], set_.poles[i].weight);
    } else if (set_.orientation) {
        const int steps = 150, turns = 72;
        const double kappa = set_.orientation->concentration;
        const double widest = std::min(std::numbers::pi, 9 / std::sqrt(kappa));
        const Vector3d first = mean_pole_.unitOrthogonal(), second = mean_pole_.cross(first);
        for (int i = 0; i < steps; ++i) {
            const double t = (i + .5) / steps * widest;
            const double share = std::sin(t) * std::exp(-2 * kappa * std::pow(std::sin(t / 2), 2));
            for (int j = 0; j < turns; ++j) {
                const double turn = (j + .5) / turns * 2 * std::numbers::pi;
                add(std::cos(t) * mean_pole_ +
                        std::sin(t) * (std::cos(turn) * first + std::sin(turn) * second),
                    share);
            }
        }
    } else {
        const std::vector<Node> directions = laid_out(*set_.dip_direction);
        for (const Node& dip : laid_out(*set_.dip))
            for (const Node& direction : directions)
                add(pole_of(dip.value, direction.value, azimuth_), dip.weight * direction.weight);
    }

    if (set_.kind == SetKind::lines && pole_.empty()) { // laws of what a scanline meets
        const Vector3d across = across_mean_trace();
        for (std::size_t i = 0; i < rose.pole.size(); ++i) {
            const double n_p = rose.pole[i].head<2>().norm(), met = std::abs(rose.pole[i].dot(across));
            rose.share[i] =
                n_p < least_in_rose || met < n_p * std::cos(steepest_trace) ? 0 : rose.share[i] / met;
        }
    }
    const double total = std::accumulate(rose.share.begin(), rose.share.end(), 0.0);
    for (double& share : rose.share)
        share /= total;
    return rose;
}

} // namespace jointcreep::sampling
