// creepfit_trials: fits of creepfit to many sets of readings in one process, for the tables of docs/back-analysis.md.
//
//   creepfit_trials FACTORS RESPONSE joints.h5 [joints-2.h5 ...] < LIST
//
// FACTORS   as creepfit --fit has them
// RESPONSE  "runs": every step of a fit is a run of the section, as in creepfit
//           "DEGREE,RUNS,CHECKS,LOW:HIGH,...": polynomials of that degree in the factors' logarithms, fitted to the displacements
//           and sensitivities of RUNS runs with factors between LOW and HIGH (of each factor). They are compared with CHECKS other
//           runs. Steps beyond these bounds are runs.
// LIST      a line for each set: READINGS.csv, numbers of the networks to fit (1,4,5), options of creepfit for errors
//
// Prints CSV, a row for each set and factor, as soon as it is known. With several networks there is a row for the first of
// them by itself (networks is 1), and one for the first 2, 3, 5, 10, 20 (estimation/across.hpp). Where there is no fit, or
// one that ended at a wrong minimum and has no intervals, value is empty, and so are bounds that are infinite.

#include "creepfit_errors.hpp"
#include "creepfit_factors.hpp"
#include "creepfit_files.hpp"

#include "back_analysis/back_analysis.hpp"
#include "estimation/across.hpp"
#include "model/error.hpp"
#include "scene/measurements.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <iostream>
#include <optional>
#include <sstream>

using namespace jointcreep;
using back_analysis::Run;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace
{

std::vector<std::string> split(const std::string& text, char separator)
{
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);)
        if (!part.empty())
            parts.push_back(part);
    return parts;
}

// Displacements of a section as polynomials in the factors' logarithms.
class Response
{
public:
    Response(const back_analysis::Section& section, const std::string& text, std::size_t n_factors)
        : section_(section)
    {
        const std::vector<std::string> words = split(text, ',');
        if (words.size() != 3 + n_factors)
            throw input_error('"' + text + "\": expected DEGREE,RUNS,CHECKS and bounds of each factor");
        for (std::size_t i = 0; i < n_factors; ++i) {
            const std::vector<std::string> bounds = split(words[3 + i], ':');
            low_.push_back(std::log(std::stod(bounds.at(0))));
            high_.push_back(std::log(std::stod(bounds.at(1))));
        }
        add_exponents(std::stoi(words[0]), {});
        fit(std::stoi(words[1]), std::stoi(words[2]));
    }

    Run operator()(const std::vector<double>& factors) const
    {
        const VectorXd x = scaled(factors);
        if (x.lpNorm<Eigen::Infinity>() > 1 + 1e-9) // rounding: the search may end at a bound
            return section_(factors);
        Run run = like_;
        const auto n = static_cast<Eigen::Index>(factors.size());
        for (Eigen::Index of = -1; of < n; ++of) {
            VectorXd cells = coefficients_.transpose() * terms(x, of);
            if (of >= 0)
                cells *= 2 / (high_[static_cast<std::size_t>(of)] - low_[static_cast<std::size_t>(of)]);
            auto& to = of < 0 ? run.history.displacement : run.sensitivities[static_cast<std::size_t>(of)];
            for (std::size_t k = 0; k < to.size(); ++k)
                to[k] = cells.segment<2>(2 * static_cast<Eigen::Index>(k));
        }
        return run;
    }

private:
    void add_exponents(int degree, const std::vector<int>& first)
    {
        if (first.size() == low_.size()) {
            exponents_.push_back(first);
            return;
        }
        for (int power = 0; power <= degree; ++power) {
            std::vector<int> next = first;
            next.push_back(power);
            add_exponents(degree - power, next);
        }
    }

    VectorXd scaled(const std::vector<double>& factors) const
    {
        VectorXd x(static_cast<Eigen::Index>(factors.size()));
        for (std::size_t i = 0; i < factors.size(); ++i)
            x[static_cast<Eigen::Index>(i)] =
                (2 * std::log(factors[i]) - low_[i] - high_[i]) / (high_[i] - low_[i]);
        return x;
    }

    // The terms, or their derivatives by one of x.
    VectorXd terms(const VectorXd& x, Eigen::Index derivative) const
    {
        VectorXd all(static_cast<Eigen::Index>(exponents_.size()));
        for (std::size_t t = 0; t < exponents_.size(); ++t) {
            double product = 1;
            for (Eigen::Index i = 0; i < x.size(); ++i) {
                const int power = exponents_[t][static_cast<std::size_t>(i)];
                product *= i != derivative ? std::pow(x[i], power)
                           : power == 0    ? 0.0
                                           : power * std::pow(x[i], power - 1);
            }
            all[static_cast<Eigen::Index>(t)] = product;
        }
        return all;
    }

    // Halton's points between the bounds.
    std::vector<double> factors_of(int number) const
    {
        constexpr std::array<int, 8> primes{2, 3, 5, 7, 11, 13, 17, 19};
        std::vector<double> factors;
        for (std::size_t i = 0; i < low_.size(); ++i) {
            double inverse = 0, digit = 1;
            for (int left = number; left > 0; left /= primes.at(i)) {
                digit /= primes.at(i);
                inverse += digit * (left % primes.at(i));
            }
            factors.push_back(std::exp(low_[i] + inverse * (high_[i] - low_[i])));
        }
        return factors;
    }

    void fit(int runs, int checks)
    {
        const auto n = static_cast<Eigen::Index>(low_.size());
        MatrixXd left, right;
        for (int number = 1; number <= runs; ++number) {
            const std::vector<double> factors = factors_of(number);
            const Run run = section_(factors);
            const auto cells = static_cast<Eigen::Index>(2 * run.history.displacement.size());
            if (number == 1) {
                like_ = run;
                left.resize(runs * (1 + n), static_cast<Eigen::Index>(exponents_.size()));
                right.resize(left.rows(), cells);
            }
            require_same_rows(run);
            const VectorXd x = scaled(factors);
            for (Eigen::Index of = -1; of < n; ++of) {
                const Eigen::Index row = (number - 1) * (1 + n) + of + 1;
                const auto& from =
                    of < 0 ? run.history.displacement : run.sensitivities[static_cast<std::size_t>(of)];
                left.row(row) = terms(x, of).transpose();
                for (std::size_t k = 0; k < from.size(); ++k)
                    right.row(row).segment<2>(2 * static_cast<Eigen::Index>(k)) =
                        from[k].transpose() *
                        (of < 0 ? 1.0
                                : (high_[static_cast<std::size_t>(of)] - low_[static_cast<std::size_t>(of)]) /
                                      2);
            }
        }
        coefficients_ = left.colPivHouseholderQr().solve(right);
        double largest = 0, size = 0;
        for (int number = runs + 1; number <= runs + checks; ++number) {
            const std::vector<double> factors = factors_of(number);
            const Run run = section_(factors), by_terms = (*this)(factors);
            require_same_rows(run);
            for (std::size_t k = 0; k < run.history.displacement.size(); ++k) {
                largest = std::max(largest,
                                   (run.history.displacement[k] - by_terms.history.displacement[k]).norm());
                size = std::max(size, run.history.displacement[k].norm());
            }
        }
        std::cerr << "response of " << runs << " runs: at most " << largest * 1e3 << " mm off " << checks
                  << " others, which move by up to " << size * 1e3 << " mm\n";
    }

    void require_same_rows(const Run& run) const
    {
        if (run.history.time != like_.history.time)
            throw input_error("the days of the history depend on the factors");
    }

    back_analysis::Section section_;
    std::vector<double> low_, high_;          // logarithms
    std::vector<std::vector<int>> exponents_; // of the terms
    MatrixXd coefficients_;                   // [term, cell]
    Run like_;
};

struct NetworkFits {
    store::JointsFile file;
    Scene scene;
    back_analysis::Section section;
};

struct Trial {
    std::string readings;
    std::vector<std::size_t> networks;
    estimation::Errors errors{};
    bool profile_intervals = false;
    std::optional<estimation::EnsembleSearch> ensemble{};
};

// The options of a line of the list.
void read_options(const std::vector<std::string>& words, Trial& trial)
{
    estimation::Errors& errors = trial.errors;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (words[i] == "--offset")
            errors.offset = true;
        else if (words[i] == "--drift")
            errors.drift = true;
        else if (words[i] == "--robust")
            errors.robust = true;
        else if (words[i] == "--correlated-noise")
            errors.correlated = true;
        else if (words[i] == "--profile-intervals")
            trial.profile_intervals = true;
        else if (words[i] == "--ensemble" && i + 1 < words.size())
            trial.ensemble = {.members = std::stoi(words[++i])};
        else if (words[i] == "--steps" && i + 1 < words.size())
            errors.steps = creepfit::steps_in(words[++i]);
        else
            throw input_error('"' + words[i] + "\": no option of errors");
}

void print_row(const Trial& trial, std::size_t networks, const std::string& rest)
{
    std::cout << trial.readings << ',' << networks << ',' << rest << std::endl;
}

std::string end_of(double logarithm)
{
    return std::isfinite(logarithm) ? shown(std::exp(logarithm)) : "";
}

constexpr std::array<std::size_t, 6> counts{1, 2, 3, 5, 10, 20};

// The networks of a trial; the rows of the first, and of the first few together.
void fit(const Trial& trial, std::deque<NetworkFits>& networks, back_analysis::Settings settings)
{
    settings.errors = trial.errors;
    settings.profile_intervals = trial.profile_intervals;
    settings.ensemble = trial.ensemble;
    const std::string text = creepfit::text_of(trial.readings);
    std::vector<estimation::OfOneModel> models;
    bool knows_deviations = false;
    for (const std::size_t number : trial.networks) {
        NetworkFits& network = networks.at(number);
        const auto measurements = scene::measurements_in_csv(text, network.scene);
        knows_deviations =
            measurements.front().deviation.has_value() && !trial.errors.robust && !trial.errors.correlated;
        const back_analysis::Found found =
            back_analysis::fit(network.scene, network.section, measurements, settings);
        if (!found.minimum.is_converged || found.better) { // without intervals
            for (const std::size_t together : counts)
                if (together > models.size() && together <= trial.networks.size())
                    print_row(trial, together, ",,,,,,");
            return;
        }
        models.push_back({found.minimum.parameters, found.confidence});
        const bool is_doubtful = !found.doubts.empty() || found.confidence.p_value < creepfit::bad_fit;
        const std::size_t n = models.size();
        if (std::ranges::find(counts, n) == counts.end())
            continue;
        const auto across = n > 1 ? estimation::across(models, knows_deviations)
                                  : std::vector<std::optional<estimation::Across>>();
        for (std::size_t i = 0; i < settings.factors.size(); ++i) {
            const std::string name = creepfit::option_of(settings.factors[i]) + ',';
            if (n == 1) {
                const double value = found.minimum.parameters[static_cast<Eigen::Index>(i)];
                const estimation::Interval interval = found.interval(i);
                print_row(trial, n,
                          name + shown(std::exp(value)) + ',' + end_of(interval.low) + ',' +
                              end_of(interval.high) + ',' + (found.is_resolved[i] ? "yes," : "no,") +
                              (is_doubtful ? "yes," : "no,") + std::to_string(found.minimum.evaluations));
            } else if (across[i]) {
                print_row(trial, n,
                          name + shown(std::exp(across[i]->value)) + ',' + end_of(across[i]->interval.low) +
                              ',' + end_of(across[i]->interval.high) + ",,,");
            } else {
                print_row(trial, n, name + ",,,no,,");
            }
        }
    }
}

void fit_all(const std::vector<std::string>& arguments)
{
    if (arguments.size() < 3)
        throw input_error("expected FACTORS RESPONSE joints.h5 ... < LIST");
    const back_analysis::Settings settings{.factors = creepfit::factors_in(arguments[0])};
    std::deque<NetworkFits> networks;
    for (std::size_t k = 2; k < arguments.size(); ++k) {
        NetworkFits& network = networks.emplace_back();
        network.file = store::read_joints(arguments[k]);
        network.scene =
            scene::parse_scene_of_file(network.file.provenance.scene, arguments[k], network.file.network);
        const back_analysis::Section by_runs =
            back_analysis::section_of(network.scene, network.file.network, network.file.equivalent, settings);
        if (arguments[1] != "runs") {
            network.section = Response(by_runs, arguments[1], settings.factors.size());
            continue;
        }
        // All fits begin with the same factors.
        network.section = [by_runs, start = std::optional<Run>(),
                           settings](const std::vector<double>& factors) mutable {
            for (std::size_t i = 0; i < factors.size(); ++i)
                if (factors[i] != settings.factors[i].start)
                    return by_runs(factors);
            if (!start)
                start = by_runs(factors);
            return *start;
        };
    }
    std::cout << "readings,networks,factor,value,low_95,high_95,resolved,warned,runs" << std::endl;
    for (std::string line; std::getline(std::cin, line);) {
        std::vector<std::string> words = split(line, ' ');
        if (words.size() < 2)
            throw input_error('"' + line + "\": expected READINGS.csv NETWORKS and options");
        Trial trial{words[0], {}};
        read_options({words.begin() + 2, words.end()}, trial);
        for (const std::string& number : split(words[1], ','))
            trial.networks.push_back(std::stoul(number));
        fit(trial, networks, settings);
    }
}

} // namespace

int main(int argc, char** argv)
{
    try {
        fit_all({argv + 1, argv + argc});
    } catch (const std::exception& error) {
        std::cerr << "creepfit_trials: " << error.what() << '\n';
        return 1;
    }
}
