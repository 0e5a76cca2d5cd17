#include "joint/bridged.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jointcreep::joint
{

namespace
{

constexpr double pi = std::numbers::pi;
constexpr double ellipse = 32 / (3 * pi * pi); // mean square over square of the mean, 1.081
constexpr int terms = 8;
constexpr double last_argument = 200; // of the Bessel functions: beyond it their mean decay is used
constexpr double equal_rates = 1e-9;
constexpr double fewest_traces = 0.01; // persistence above which staggered lines interact

using Matrix = Eigen::Matrix<double, terms, terms>;

// K_0 L / (k E') of one line.
double empty_stiffness(double k)
{
    // The secant 1 / cos(pi k / 2) as a sine of pi (1 - k) / 2: accurate for k near 1.
    return -pi / (4 * std::log(std::sin(pi * (1 - k) / 2)));
}

// Bessel function of order 0 or 1; from 25 on Hankel's expansion, much faster there.
double bessel(int order, double x)
{
    if (x < 25)
        return std::cyl_bessel_j(order, x);
    double term = 1, cosine = 1, sine = 0;
    for (int i = 1; i <= 12; ++i) {
        term *= (4 * order * order - (2 * i - 1) * (2 * i - 1)) / (8 * x * i);
        (i % 2 == 0 ? cosine : sine) += i % 4 < 2 ? term : -term;
    }
    const double phase = x - (2 * order + 1) * pi / 4;
    return std::sqrt(2 / (pi * x)) * (cosine * std::cos(phase) - sine * std::sin(phase));
}

// Odd Bessel functions J_1, J_3, ... of x.
Eigen::Matrix<double, terms, 1> odd_bessel(double x)
{
    Eigen::Matrix<double, terms, 1> values;
    double before = bessel(0, x), here = bessel(1, x);
    for (int n = 1; n < 2 * terms; ++n) {
        if (n % 2 == 1)
            values[n / 2] = here;
        // Upward recurrence is stable only up to the order x.
        const double next = n + 1 < x ? 2 * n / x * here - before : std::cyl_bessel_j(n + 1, x);
        before = here;
        here = next;
    }
    return values;
}

// Ratio of the traction to that of a single line, for the m-th wave along lines the spacing `s` apart (lengths over the
// period).
double sum_over_lines(int m, double s, Direction direction)
{
    const double half = pi * m * s;
    const double sign = direction == Direction::normal ? 1 : -1;
    if (half > 300)
        return 1;
    if (m % 2 == 0)
        return 1 / std::tanh(half) + sign * half / std::pow(std::sinh(half), 2);
    return std::tanh(half) - sign * half / std::pow(std::cosh(half), 2);
}

} // namespace

double staggered_stiffness(double persistence, double spacing, double stiffness, Direction direction)
{
    const double k = persistence;
    Eigen::Matrix<double, terms, 1> order;
    for (int i = 0; i < terms; ++i)
        order[i] = (i % 2 == 0 ? 1 : -1) * (2 * i + 1);

    // The rock's energy: wave by wave, and beyond the last one by the mean decay of the Bessel functions.
    Matrix energy = Matrix::Zero();
    const int waves = static_cast<int>(std::ceil(last_argument / (pi * k)));
    for (int m = 1; m <= waves; ++m) {
        const double argument = pi * m * k;
        const Eigen::Matrix<double, terms, 1> wave = odd_bessel(argument).cwiseProduct(order);
        energy += sum_over_lines(m, spacing, direction) / m * wave * wave.transpose();
    }
    energy += 1 / (pi * pi * k * (waves + 0.5)) * order.cwiseAbs() * order.cwiseAbs().transpose();
    energy *= pi / 4;

    for (int i = 0; i < terms; ++i)
        for (int j = 0; j < terms; ++j) {
            const double p = 2 * i + 1, q = 2 * j + 1;
            energy(i, j) += stiffness * k / 2 * (1 / (1 - (p - q) * (p - q)) - 1 / (1 - (p + q) * (p + q)));
        }
    // Mean opening along the line: only the first term has one.
    Eigen::Matrix<double, terms, 1> mean = Eigen::Matrix<double, terms, 1>::Zero();
    mean[0] = pi * k / 4;
    return 1 / mean.dot(energy.ldlt().solve(mean));
}

Bridging bridging(StiffnessRule rule, const BridgedLine& line, double stiffness, Direction direction)
{
    const double k = line.persistence;
    const double unit = line.plane_modulus * k / line.trace_length;
    switch (rule) {
    case StiffnessRule::joint:
        break;
    case StiffnessRule::lower_bound:
        return {unit * empty_stiffness(k), 1 / k};
    case StiffnessRule::upper_bound:
        return {unit * empty_stiffness(k), ellipse / k};
    case StiffnessRule::staggered: {
        if (k < fewest_traces)
            return {unit * empty_stiffness(k), 1 / k};
        const double spacing = line.spacing * k / line.trace_length;
        const double empty = staggered_stiffness(k, spacing, 0, direction);
        if (!(stiffness > 0))
            return {unit * empty, 1 / k};
        const double filled = staggered_stiffness(k, spacing, stiffness / unit, direction);
        return {unit * empty, unit * (filled - empty) / stiffness};
    }
    }
    return {};
}

JointChain joint_chain_of(const JointMaterial& material, Direction direction)
{
    const bool normal = direction == Direction::normal;
    JointChain chain{normal ? material.normal_stiffness : material.shear_stiffness, {}, 0};
    for (const Kelvin& unit : material.kelvin)
        chain.units.push_back({normal ? unit.normal_stiffness : unit.shear_stiffness,
                               normal ? unit.normal_viscosity : unit.shear_viscosity});
    if (material.maxwell)
        chain.maxwell_viscosity =
            normal ? material.maxwell->normal_viscosity : material.maxwell->shear_viscosity;
    return chain;
}

JointChain bridged(const JointChain& joint, const Bridging& bridging)
{
    const double bridges = bridging.bridges, share = bridging.share;
    JointChain chain{bridges + share * joint.spring, {}, 0};
    if (!(joint.spring > 0))
        return chain; // a smooth joint has no shear traction that could creep
    if (bridges <= 0) {
        for (const KelvinUnit& unit : joint.units)
            chain.units.push_back({share * unit.stiffness, share * unit.viscosity});
        chain.maxwell_viscosity = share * joint.maxwell_viscosity;
        return chain;
    }

    // The joint's compliance under a traction proportional to exp(-x t): 1/K + sum of 1 / (eta (rate - x)), with a
    // Maxwell dashpot as rate 0. Units with equal rates are merged.
    struct Pole {
        double rate, fluidity; // E / eta [1/s], 1 / eta [m/(Pa s)]
    };
    std::vector<Pole> poles;
    if (joint.maxwell_viscosity > 0)
        poles.push_back({0, 1 / joint.maxwell_viscosity});
    for (const KelvinUnit& unit : joint.units)
        poles.push_back({unit.stiffness / unit.viscosity, 1 / unit.viscosity});
    std::sort(poles.begin(), poles.end(), [](const Pole& a, const Pole& b) { return a.rate < b.rate; });
    std::vector<Pole> distinct;
    for (const Pole& pole : poles)
        if (!distinct.empty() && pole.rate - distinct.back().rate <= equal_rates * pole.rate)
            distinct.back().fluidity += pole.fluidity;
        else
            distinct.push_back(pole);

    // With the bridges beside it, 1 / (bridges + share / J) has its poles where J = -share / bridges. J rises from
    // minus to plus infinity between two poles, and after the last pole to 1/K.
    const double wanted = 1 / joint.spring + share / bridges;
    for (std::size_t i = 0; i < distinct.size(); ++i) {
        const auto excess = [&](double beyond) { // at the rate of this pole plus `beyond`
            double sum = wanted - distinct[i].fluidity / beyond;
            for (std::size_t j = 0; j < distinct.size(); ++j)
                if (j != i)
                    sum += distinct[j].fluidity / (distinct[j].rate - distinct[i].rate - beyond);
            return sum;
        };
        double all = 0;
        for (const Pole& pole : distinct)
            all += pole.fluidity;
        double low = 0;
        double high = i + 1 < distinct.size() ? distinct[i + 1].rate - distinct[i].rate : 2 * all / wanted;
        for (int halving = 0; halving < 200; ++halving) {
            const double middle = (low + high) / 2;
            if (!(middle > low && middle < high))
                break;
            (excess(middle) < 0 ? low : high) = middle;
        }
        const double beyond = (low + high) / 2, rate = distinct[i].rate + beyond;
        double slope = 0; // of J
        for (std::size_t j = 0; j < distinct.size(); ++j) {
            const double distance = j == i ? -beyond : distinct[j].rate - rate;
            slope += distinct[j].fluidity / (distance * distance);
        }
        const double viscosity = bridges * bridges * slope / share;
        chain.units.push_back({rate * viscosity, viscosity});
    }
    return chain;
}

} // namespace jointcreep::joint
