#include "estimation/creep_curve.hpp"

#include "estimation/profile.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace jointcreep::estimation
{

namespace
{

// tau is looked for between the shortest time between readings and many records.
constexpr double shortest_share = 0.05, longest_share = 100;

constexpr const char* same_way =
    " m; expected both in one direction, as those of a joint under one load are (count displacements from "
    "before the load, not from a reading after it)";

double shortest_interval(const CreepCurve& curve)
{
    double shortest = curve.time.back();
    for (std::size_t i = 0; i < curve.time.size(); ++i) {
        const double since = curve.time[i] - (i > 0 ? curve.time[i - 1] : 0.0);
        if (since > 0)
            shortest = std::min(shortest, since);
    }
    return shortest;
}

void check(const CreepCurve& curve)
{
    const std::size_t wanted = curve.elastic_part ? 3 : 4;
    if (curve.time.size() < wanted)
        throw input_error(std::to_string(curve.time.size()) + " readings; expected at least " +
                          std::to_string(wanted));
    if (!(curve.time.back() > 0))
        throw input_error("all readings are of the moment when the load changed");
}

double deviation_of(const CreepCurve& curve, std::size_t i)
{
    return curve.deviation.empty() ? 1.0 : curve.deviation[i];
}

// With tau given, what is left is linear: {d_e, d_c}, or {d_c}.
VectorXd linear_parts(const CreepCurve& curve, const Instruments& instruments, double tau,
                      double& sum_of_squares)
{
    const auto n = static_cast<Eigen::Index>(curve.time.size());
    MatrixXd A(n, curve.elastic_part ? 1 : 2);
    VectorXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double weight = 1 / deviation_of(curve, k), crept = -std::expm1(-curve.time[k] / tau);
        if (!curve.elastic_part)
            A(i, 0) = weight;
        A(i, A.cols() - 1) = weight * crept;
        b[i] = weight * (curve.displacement[k] - curve.elastic_part.value_or(0));
    }
    const Evaluation left = instruments.independent({b, A});
    VectorXd parts = left.jacobian.colPivHouseholderQr().solve(left.residual);
    sum_of_squares = (left.jacobian * parts - left.residual).squaredNorm();
    return parts;
}

// exp(value +- half), as a value with its interval.
Estimate estimate(double value, double half)
{
    return {value, {value * std::exp(-half), value * std::exp(half)}};
}

// The best tau on a grid, by the sum of squares that `sum_at` gives.
double best_on_grid(double shortest, double longest, const std::function<double(double)>& sum_at)
{
    constexpr int steps = 400;
    double best = shortest, least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= steps; ++i) {
        const double tau = shortest * std::pow(longest / shortest, static_cast<double>(i) / steps);
        if (const double sum = sum_at(tau); sum < least) {
            least = sum;
            best = tau;
        }
    }
    return best;
}

// Profiles of the sum of squares: its minimum over the other parameters, with one of E / K, eta / K and tau fixed.
class Profiles
{
public:
    enum Fixed { stiffness, viscosity, time };

    // Around the best fit, d_e [m], e = E / K and tau [s].
    Profiles(const CreepCurve& curve, const Instruments& instruments, double elastic_part, double ratio,
             double tau)
        : curve_(curve), instruments_(instruments), size_(elastic_part),
          best_(curve.elastic_part ? VectorXd(2) : VectorXd(VectorXd::Ones(3)))
    {
        best_[0] = std::log(ratio);
        best_[1] = std::log(tau);
    }

    // Where it is below `limit`. An end is 0 or infinite where that is more than a factor of 1000 away.
    Interval interval(Fixed fixed, double limit, double least_sum, double first_step) const
    {
        VectorXd at = best_;
        if (fixed == viscosity)
            at[0] += at[1];
        const Eigen::Index i = fixed == time ? 1 : 0;
        Bounds bounds{VectorXd::Constant(at.size(), -1e3), VectorXd::Constant(at.size(), 1e3)};
        // Far from the minimum, where creep is over at once or hardly begins, the sum is flat: nothing would bring the
        // search back.
        if (fixed != time) {
            bounds.low[1] = std::log(shortest_share * shortest_interval(curve_));
            bounds.high[1] = std::log(longest_share * curve_.time.back());
        }
        const auto end = [&](double side) {
            VectorXd guess = at;
            guess[i] += side * std::clamp(first_step, 1e-7, 0.5);
            // The minimum is the least: it was found on a grid of tau.
            return profile_end(model(fixed == viscosity), at, least_sum, limit, i, guess, bounds,
                               {.share = 1e-4,
                                .least_gain = 1e-6,
                                .tolerance = std::numeric_limits<double>::infinity(),
                                .most_runs = 6000})
                .at;
        };
        return {std::exp(end(-1)), std::exp(end(1))};
    }

private:
    // Over {ln e or, by viscosity, ln (e tau); ln tau; d_e over its best unless that is known}.
    Model model(bool by_viscosity) const
    {
        return [this, by_viscosity](const VectorXd& p) -> std::optional<Evaluation> {
            const auto n = static_cast<Eigen::Index>(curve_.time.size());
            Evaluation at{VectorXd(n), MatrixXd(n, p.size())};
            const double inverse = std::exp((by_viscosity ? p[1] : 0) - p[0]), // 1 / e
                d = p.size() == 3 ? size_ * p[2] : size_;
            for (Eigen::Index i = 0; i < n; ++i) {
                const auto k = static_cast<std::size_t>(i);
                const double x = curve_.time[k] / std::exp(p[1]), crept = -std::expm1(-x) * inverse,
                             weight = 1 / deviation_of(curve_, k);
                at.residual[i] = weight * (d * (1 + crept) - curve_.displacement[k]);
                at.jacobian(i, 0) = -weight * d * crept;
                at.jacobian(i, 1) = weight * d * ((by_viscosity ? crept : 0) - x * std::exp(-x) * inverse);
                if (p.size() == 3)
                    at.jacobian(i, 2) = weight * size_ * (1 + crept);
            }
            return instruments_.independent(at);
        };
    }

    const CreepCurve& curve_;
    const Instruments& instruments_;
    double size_;
    VectorXd best_;
};

// What a curve is fitted over: {d_e unless that is known, d_c, ln tau}. Displacements are in a unit of their own
// size, so that all unknowns are numbers of about 1.
struct Unknowns {
    Eigen::Index elastic, creep, log_tau; // places of d_e, or -1 if it is known, d_c and ln tau
    double size;                          // unit of displacements [m]
};

Unknowns unknowns_of(const CreepCurve& curve)
{
    double size = 0;
    for (const double d : curve.displacement)
        size = std::max(size, std::abs(d));
    if (size == 0)
        throw input_error("all displacements are 0");
    const Eigen::Index elastic = curve.elastic_part ? -1 : 0;
    return {elastic, elastic + 1, elastic + 2, size};
}

// d_e [m].
double elastic_part(const CreepCurve& curve, const Unknowns& u, const VectorXd& p)
{
    return u.elastic < 0 ? *curve.elastic_part : p[u.elastic] * u.size;
}

Evaluation evaluate(const CreepCurve& curve, const Unknowns& u, const VectorXd& p)
{
    const auto n = static_cast<Eigen::Index>(curve.time.size());
    Evaluation at{VectorXd(n), MatrixXd(n, p.size())};
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double x = curve.time[k] / std::exp(p[u.log_tau]), crept = -std::expm1(-x),
                     weight = 1 / deviation_of(curve, k);
        at.residual[i] =
            weight * (elastic_part(curve, u, p) + p[u.creep] * u.size * crept - curve.displacement[k]);
        if (u.elastic >= 0)
            at.jacobian(i, u.elastic) = weight * u.size;
        at.jacobian(i, u.creep) = weight * u.size * crept;
        at.jacobian(i, u.log_tau) = -weight * u.size * p[u.creep] * x * std::exp(-x);
    }
    return at;
}

InstrumentFit best_fit(const CreepCurve& curve, const Unknowns& u, Instruments& instruments)
{
    const double shortest = shortest_share * shortest_interval(curve),
                 longest = longest_share * curve.time.back();
    double sum = 0;
    const double tau = best_on_grid(shortest, longest, [&](double at) {
        linear_parts(curve, instruments, at, sum);
        return sum;
    });
    VectorXd start(u.log_tau + 1);
    start.head(u.log_tau) = linear_parts(curve, instruments, tau, sum) / u.size;
    start[u.log_tau] = std::log(tau);
    VectorXd low = VectorXd::Constant(start.size(), -1e6), high = -low;
    low[u.log_tau] = std::log(shortest);
    high[u.log_tau] = std::log(longest);
    return minimise([&](const VectorXd& p) { return evaluate(curve, u, p); }, instruments, start, low, high,
                    400, 1e-12);
}

// Intervals of d_e, d_c, tau, E and eta, and the correlation of the last two.
void add_intervals(CurveFit& fit, const CreepCurve& curve, const Unknowns& u, const Instruments& instruments,
                   const Minimum& minimum)
{
    const VectorXd& p = minimum.parameters;
    const Confidence& confidence = fit.confidence;
    const double quantile = confidence.quantile;
    const auto linear = [&](Eigen::Index i, double value) -> Interval {
        if (i < 0)
            return {value, value};
        const double half = quantile * confidence.standard_error(i) * u.size;
        return {value - half, value + half};
    };
    fit.elastic_interval = linear(u.elastic, fit.elastic_part);
    fit.creep_interval = linear(u.creep, fit.creep_part);

    // Logarithms of E / K = d_e / d_c and eta / K = tau E / K.
    VectorXd of_stiffness = VectorXd::Zero(p.size()), of_time = of_stiffness;
    if (u.elastic >= 0)
        of_stiffness[u.elastic] = 1 / p[u.elastic];
    of_stiffness[u.creep] = -1 / p[u.creep];
    of_time[u.log_tau] = 1;
    const VectorXd of_viscosity = of_stiffness + of_time;
    const double stiffness_error = confidence.standard_error(of_stiffness),
                 viscosity_error = confidence.standard_error(of_viscosity);
    const double ratio = fit.elastic_part / fit.creep_part;
    const Profiles profiles(curve, instruments, fit.elastic_part, ratio, fit.retardation_time);
    // The sum of squares rises by 1 within one standard error of independent readings with unit variance.
    const MatrixXd& J = minimum.there.jacobian;
    const auto profile = [&](Profiles::Fixed fixed, const VectorXd& gradient, double error) {
        const double unit_error =
            std::sqrt(std::max(0.0, gradient.dot((J.transpose() * J).ldlt().solve(gradient))));
        const double noise = quantile * (unit_error > 0 && error > 0 && instruments.changes_errors()
                                             ? error / unit_error
                                             : confidence.noise_factor);
        return profiles.interval(fixed, minimum.sum_of_squares() + noise * noise, minimum.sum_of_squares(),
                                 quantile * error);
    };
    fit.time = {fit.retardation_time, profile(Profiles::time, of_time, confidence.standard_error(of_time))};
    fit.stiffness = {ratio, profile(Profiles::stiffness, of_stiffness, stiffness_error)};
    fit.viscosity = {ratio * fit.retardation_time,
                     profile(Profiles::viscosity, of_viscosity, viscosity_error)};
    const double product = stiffness_error * viscosity_error;
    fit.correlation = product > 0 ? of_stiffness.dot(confidence.covariance * of_viscosity) / product : 0;
}

// What the record does not give.
void add_limits(CurveFit& fit, const CreepCurve& curve, AtBound of_time)
{
    fit.record_length = curve.time.back() / fit.retardation_time;
    const auto second = std::find_if(curve.time.begin(), curve.time.end(), [](double t) { return t > 0; });
    fit.is_too_coarse = *second > 4 * fit.retardation_time; // 98 percent of creep
    fit.is_stiffness_open = of_time == AtBound::high ||
                            fit.stiffness.interval.low < fit.stiffness.value / 2 ||
                            fit.stiffness.interval.high > 2 * fit.stiffness.value;
    fit.is_too_short = fit.is_stiffness_open && fit.record_length < 2;
}

// d_e and d_c must have one direction.
void check_parts(double elastic_part, double creep_part)
{
    const double ratio = elastic_part / creep_part;
    if (!(ratio > 0) || !std::isfinite(ratio))
        throw input_error("the elastic part is " + shown(elastic_part) + " m and the creep part " +
                          shown(creep_part) + same_way);
}

// tau, with d_e and d_c fixed; over {ln tau}.
Minimum solve_for_time(const CreepCurve& curve, double elastic_part, double creep_part)
{
    const Model model = [&](const VectorXd& p) -> std::optional<Evaluation> {
        const auto n = static_cast<Eigen::Index>(curve.time.size());
        Evaluation at{VectorXd(n), MatrixXd(n, 1)};
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            const double x = curve.time[k] / std::exp(p[0]), weight = 1 / deviation_of(curve, k);
            at.residual[i] = weight * (elastic_part - creep_part * std::expm1(-x) - curve.displacement[k]);
            at.jacobian(i, 0) = -weight * creep_part * x * std::exp(-x);
        }
        return at;
    };
    const double shortest = shortest_share * shortest_interval(curve),
                 longest = longest_share * curve.time.back();
    const auto vector = [](double value) { return VectorXd::Constant(1, value); };
    const double start = best_on_grid(
        shortest, longest, [&](double tau) { return model(vector(std::log(tau)))->residual.squaredNorm(); });
    return minimise(model, vector(std::log(start)), vector(std::log(shortest)), vector(std::log(longest)),
                    200, 1e-12);
}

} // namespace

CurveFit fit_curve(const CreepCurve& curve, const Errors& errors)
{
    check(curve);
    const Unknowns u = unknowns_of(curve);
    Readings readings{.time = curve.time,
                      .series = std::vector<std::size_t>(curve.time.size(), 0),
                      .knows_deviations = !curve.deviation.empty()};
    for (std::size_t i = 0; i < curve.time.size(); ++i)
        readings.deviation.push_back(deviation_of(curve, i));
    Instruments instruments(std::move(readings), errors);
    if (const std::size_t wanted = static_cast<std::size_t>(u.log_tau) + 1 + instruments.unknowns();
        curve.time.size() <= wanted)
        throw input_error(std::to_string(curve.time.size()) + " readings for " + std::to_string(wanted) +
                          " unknowns, " + std::to_string(instruments.unknowns()) +
                          " of them errors of instruments; expected more readings");
    const auto [minimum, raw, is_settled] = best_fit(curve, u, instruments);
    const VectorXd& p = minimum.parameters;
    CurveFit fit;
    fit.is_settled = is_settled;
    fit.elastic_part = elastic_part(curve, u, p);
    fit.creep_part = p[u.creep] * u.size;
    fit.retardation_time = std::exp(p[u.log_tau]);
    check_parts(fit.elastic_part, fit.creep_part);
    fit.confidence = instruments.confidence(raw, minimum);
    add_intervals(fit, curve, u, instruments, minimum);
    for (std::size_t k = 0; k < curve.time.size(); ++k)
        fit.computed.push_back(curve.displacement[k] +
                               raw.residual[static_cast<Eigen::Index>(k)] * deviation_of(curve, k));
    fit.errors = instruments.errors(raw, fit.confidence);
    fit.outliers = instruments.outliers(raw);
    fit.doubts = instruments.doubts(raw, minimum);
    fit.correlation_time = instruments.correlation_time();
    fit.instrument = instruments.added(raw);
    add_limits(fit, curve, minimum.at_bound[static_cast<std::size_t>(u.log_tau)]);
    return fit;
}

ClosedEstimate closed_estimate(const CreepCurve& curve, double end)
{
    check(curve);
    if (!(end > curve.time.front()) || end > curve.time.back())
        throw input_error(
            "creep is taken to be over on day " + shown(end / unit::day) +
            " after the load; expected a time after the first reading and not after the last, " +
            shown(curve.time.back() / unit::day));
    ClosedEstimate found{};
    found.end = end;
    found.elastic_part = curve.elastic_part.value_or(curve.displacement.front());
    const auto after = static_cast<std::size_t>(
        std::find_if(curve.time.begin(), curve.time.end(), [&](double t) { return t >= end; }) -
        curve.time.begin());
    const double share = (end - curve.time[after - 1]) / (curve.time[after] - curve.time[after - 1]);
    const double at_end =
        curve.displacement[after - 1] + share * (curve.displacement[after] - curve.displacement[after - 1]);
    found.creep_part = at_end - found.elastic_part;
    check_parts(found.elastic_part, found.creep_part);
    const double ratio = found.elastic_part / found.creep_part;

    const Minimum minimum = solve_for_time(curve, found.elastic_part, found.creep_part);
    const double tau = std::exp(minimum.parameters[0]);
    const Confidence confidence = confidence_of(minimum, !curve.deviation.empty());

    // What an error of d(T_c), and of d_e where it is a reading, makes of the logarithms of E and tau.
    const auto n = static_cast<Eigen::Index>(curve.time.size());
    const VectorXd of_tau = minimum.there.jacobian.col(0);
    VectorXd of_end(n), of_elastic(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double crept = -std::expm1(-curve.time[k] / tau), weight = 1 / deviation_of(curve, k);
        of_end[i] = weight * crept;
        of_elastic[i] = weight * (1 - crept);
    }
    const double squared = of_tau.squaredNorm();
    const auto carried = [&](const VectorXd& effect) {
        return squared > 0 ? -of_tau.dot(effect) / squared : 0.0;
    };
    const double end_noise =
                     confidence.noise_factor * std::hypot((1 - share) * deviation_of(curve, after - 1),
                                                          share * deviation_of(curve, after)),
                 elastic_noise = curve.elastic_part ? 0.0 : confidence.noise_factor * deviation_of(curve, 0);
    const double stiffness_by_end = -end_noise / found.creep_part,
                 stiffness_by_elastic = elastic_noise * (1 / found.elastic_part + 1 / found.creep_part);
    found.stiffness_error = std::hypot(stiffness_by_end, stiffness_by_elastic);
    found.stiffness = estimate(ratio, confidence.quantile * found.stiffness_error);
    found.viscosity = estimate(
        ratio * tau, confidence.quantile *
                         std::hypot(std::hypot(stiffness_by_end + carried(of_end) * end_noise,
                                               stiffness_by_elastic + carried(of_elastic) * elastic_noise),
                                    confidence.standard_error(Eigen::Index{0})));
    return found;
}

} // namespace jointcreep::estimation
