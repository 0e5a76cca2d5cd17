#include "estimation/instrument.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "statistics/distribution.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace jointcreep::estimation
{

namespace
{

constexpr double huber_limit = 1.345, tukey_limit = 4.685; // 95 percent efficient with normal errors [scales]
constexpr double normal_median = 0.674489750196082;        // of the size of a standard normal error
constexpr double kinds = 5;                                // of errors that residuals may look like
constexpr double outlying = 4;                             // [scales]
constexpr int correlations = 49; // that are tried: 0, .02, ... .96 at the median distance

double huber_weight(double e)
{
    return std::min(1.0, huber_limit / std::max(std::abs(e), 1e-300));
}

double tukey_weight(double e)
{
    const double x = e / tukey_limit, rest = 1 - x * x;
    return rest > 0 ? rest * rest : 0.0;
}

double median_of(std::vector<double> values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1)
        return *middle;
    return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

MatrixXd beside(const MatrixXd& left, const MatrixXd& right)
{
    MatrixXd both(left.rows(), left.cols() + right.cols());
    both << left, right;
    return both;
}

std::vector<bool> free_parameters(const Evaluation& raw, const std::vector<AtBound>& at_bound)
{
    std::vector<bool> is_free;
    for (std::size_t i = 0; i < at_bound.size(); ++i)
        is_free.push_back(at_bound[i] == AtBound::no &&
                          raw.jacobian.col(static_cast<Eigen::Index>(i)).norm() > 0);
    return is_free;
}

// An orthonormal basis of the columns.
MatrixXd basis_of(const MatrixXd& columns)
{
    if (columns.cols() == 0)
        return MatrixXd(columns.rows(), 0);
    const VectorXd length = columns.colwise().norm().cwiseMax(1e-300);
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns * length.cwiseInverse().asDiagonal());
    return qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
}

// Product of the matrix A, with a half at each pair of neighbours of a series, and columns.
MatrixXd times_neighbours(const MatrixXd& columns, const std::vector<std::vector<Eigen::Index>>& series)
{
    MatrixXd product = MatrixXd::Zero(columns.rows(), columns.cols());
    for (const std::vector<Eigen::Index>& of : series)
        for (std::size_t i = 1; i < of.size(); ++i) {
            product.row(of[i]) += columns.row(of[i - 1]) / 2;
            product.row(of[i - 1]) += columns.row(of[i]) / 2;
        }
    return product;
}

// Errors that last from a reading to the next: the p value of q = e^T A e / e^T e of residuals e, which are normal to the
// basis Q. Its mean and variance are those of equal, independent errors.
Doubt lasting_errors(const MatrixXd& Q, const VectorXd& e,
                     const std::vector<std::vector<Eigen::Index>>& series)
{
    double pairs = 0;
    for (const std::vector<Eigen::Index>& of : series)
        pairs += of.size() > 1 ? static_cast<double>(of.size() - 1) : 0.0;
    const auto degrees = static_cast<double>(Q.rows() - Q.cols());
    const MatrixXd AQ = times_neighbours(Q, series), QAQ = Q.transpose() * AQ;
    const double trace = -QAQ.trace(), of_square = pairs / 2 - 2 * AQ.squaredNorm() + QAQ.squaredNorm();
    const double mean = trace / degrees,
                 variance = 2 * (of_square * degrees - trace * trace) / (degrees * degrees * (degrees + 2));
    const double q = e.dot(times_neighbours(e, series).col(0)) / e.squaredNorm();
    Doubt lasting{.kind = Error::lasting, .value = q};
    if (variance > 0 && q > mean)
        lasting.p_value = std::min(1.0, kinds * statistics::normal_p((q - mean) / std::sqrt(variance)) / 2);
    return lasting;
}

} // namespace

Instruments::Instruments(Readings readings, Errors errors)
    : readings_(std::move(readings)), errors_(std::move(errors))
{
    const std::size_t n = readings_.time.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (readings_.series[i] >= series_.size())
            series_.resize(readings_.series[i] + 1);
        series_[readings_.series[i]].push_back(i);
    }
    std::vector<double> distances;
    double longest = 0;
    for (std::vector<std::size_t>& of : series_) {
        std::stable_sort(of.begin(), of.end(), [this](std::size_t a, std::size_t b) {
            return readings_.time[a] < readings_.time[b];
        });
        for (std::size_t k = 1; k < of.size(); ++k)
            if (const double distance = readings_.time[of[k]] - readings_.time[of[k - 1]]; distance > 0)
                distances.push_back(distance);
        if (!of.empty())
            longest = std::max(longest, readings_.time[of.back()] - readings_.time[of.front()]);
    }
    weight_ = VectorXd::Ones(static_cast<Eigen::Index>(n));
    times_.push_back(0);
    if (errors_.correlated && !distances.empty())
        for (int k = 1; k < correlations; ++k)
            times_.push_back(-median_of(distances) / std::log(static_cast<double>(k) / (correlations + 1)));
    for (const double step : errors_.steps)
        if (std::none_of(series_.begin(), series_.end(),
                         [&](const std::vector<std::size_t>& of) { return separates(of, step); }))
            throw input_error("no point has readings before and after the step on day " +
                              shown(step / unit::day));
    unknown_columns_.resize(static_cast<Eigen::Index>(n), 0);
    for (std::size_t s = 0; s < series_.size(); ++s) {
        if (series_[s].empty())
            continue;
        std::vector<Unknown> wanted;
        if (errors_.offset)
            wanted.push_back({Error::offset, s, 0});
        if (errors_.drift)
            wanted.push_back({Error::drift, s, 0});
        for (const double step : errors_.steps)
            if (separates(series_[s], step))
                wanted.push_back({Error::step, s, step});
        const Eigen::Index before = unknown_columns_.cols();
        for (const Unknown& unknown : wanted) {
            const VectorXd column = column_of(unknown);
            const MatrixXd others = basis_of(unknown_columns_.rightCols(unknown_columns_.cols() - before));
            if (!((column - others * (others.transpose() * column)).norm() > 1e-9 * column.norm()))
                continue; // another unknown of the series does the same
            unknown_columns_ = beside(unknown_columns_, column);
            unknowns_.push_back(unknown);
        }
    }
}

bool Instruments::separates(const std::vector<std::size_t>& series, double time) const
{
    return !series.empty() && readings_.time[series.front()] < time && readings_.time[series.back()] >= time;
}

// Per metre; of a drift per metre in the series' time.
VectorXd Instruments::column_of(const Unknown& unknown) const
{
    VectorXd column = VectorXd::Zero(static_cast<Eigen::Index>(readings_.time.size()));
    const std::vector<std::size_t>& of = series_[unknown.series];
    const double first = readings_.time[of.front()], span = readings_.time[of.back()] - first;
    for (const std::size_t i : of) {
        const double t = readings_.time[i];
        const double value = unknown.kind == Error::offset  ? 1.0
                             : unknown.kind == Error::drift ? (span > 0 ? (t - first) / span : 0.0)
                                                            : (t >= unknown.time ? 1.0 : 0.0);
        column[static_cast<Eigen::Index>(i)] = value / readings_.deviation[i];
    }
    return column;
}

MatrixXd Instruments::weighted(const MatrixXd& columns) const
{
    return weight_.cwiseSqrt().asDiagonal() * columns;
}

// With unit variance and without correlation: lasting errors by e_i - c e_(i-1) over sqrt(1 - c^2), c the correlation
// with the reading before. A shared error of v deviations has the covariance 1 + v v^T, and
//     (1 + v v^T)^(-1/2) = 1 - (1 - 1 / sqrt(1 + v.v)) v v^T / v.v .
MatrixXd Instruments::whitened(MatrixXd columns, double correlation_time) const
{
    for (const std::vector<std::size_t>& of : series_) {
        if (correlation_time > 0)
            for (std::size_t k = of.size(); k-- > 1;) {
                const double distance = readings_.time[of[k]] - readings_.time[of[k - 1]],
                             c = std::min(std::exp(-distance / correlation_time), 0.999);
                const auto row = static_cast<Eigen::Index>(of[k]),
                           before = static_cast<Eigen::Index>(of[k - 1]);
                columns.row(row) =
                    ((columns.row(row) - c * columns.row(before)) / std::sqrt(1 - c * c)).eval();
            }
        if (readings_.shared.empty() || of.empty())
            continue;
        VectorXd v(static_cast<Eigen::Index>(of.size()));
        for (std::size_t k = 0; k < of.size(); ++k)
            v[static_cast<Eigen::Index>(k)] = readings_.shared[of[k]];
        const double q = v.squaredNorm();
        if (!(q > 0))
            continue;
        const MatrixXd rows = columns(of, Eigen::all);
        columns(of, Eigen::all) = rows - (1 - 1 / std::sqrt(1 + q)) / q * v * (v.transpose() * rows);
    }
    return columns;
}

Evaluation Instruments::independent(const Evaluation& raw) const
{
    MatrixXd columns = whitened(weighted(beside(raw.residual, raw.jacobian)), correlation_time_);
    if (unknown_columns_.cols() > 0) {
        const Eigen::ColPivHouseholderQR<MatrixXd> qr(
            whitened(weighted(unknown_columns_), correlation_time_));
        columns = (qr.householderQ().transpose() * columns).eval().bottomRows(columns.rows() - qr.rank());
    }
    Evaluation found{columns.col(0), columns.rightCols(columns.cols() - 1)};
    // What unknown errors may do as well has no effect of its own but rounding.
    for (Eigen::Index i = 0; i < found.jacobian.cols(); ++i)
        if (found.jacobian.col(i).norm() <= 1e-10 * raw.jacobian.col(i).norm())
            found.jacobian.col(i).setZero();
    return found;
}

std::vector<std::size_t> Instruments::kept() const
{
    std::vector<std::size_t> rows;
    for (Eigen::Index i = 0; i < weight_.size(); ++i)
        if (weight_[i] > 0)
            rows.push_back(static_cast<std::size_t>(i));
    return rows;
}

// Derivatives by all that is free: parameters and unknown errors.
MatrixXd Instruments::effects(const Evaluation& raw, const std::vector<bool>& is_free) const
{
    std::vector<Eigen::Index> free;
    for (std::size_t i = 0; i < is_free.size(); ++i)
        if (is_free[i])
            free.push_back(static_cast<Eigen::Index>(i));
    return beside(raw.jacobian(Eigen::all, free), unknown_columns_);
}

// On the model made linear at the minimum, until nothing changes.
bool Instruments::update_weights(const Evaluation& raw, const std::vector<bool>& is_free)
{
    const MatrixXd X = effects(raw, is_free);
    const Eigen::Index n = X.rows();
    const double share =
        static_cast<double>(n) / static_cast<double>(std::max<Eigen::Index>(1, n - X.cols()));
    VectorXd weight = VectorXd::Ones(n), e = raw.residual;
    double scale = 0;
    const auto repeat = [&](int most, bool finds_scale, double (*weight_of)(double)) {
        for (int k = 0; k < most; ++k) {
            const VectorXd root = weight.cwiseSqrt();
            const VectorXd step = (root.asDiagonal() * X)
                                      .eval()
                                      .colPivHouseholderQr()
                                      .solve((root.asDiagonal() * raw.residual).eval());
            const VectorXd next = raw.residual - X * step;
            if (finds_scale) {
                std::vector<double> sizes;
                for (const double residual : next)
                    sizes.push_back(std::abs(residual));
                scale = median_of(sizes) / normal_median * std::sqrt(share);
            }
            if (!(scale > 0))
                return;
            const double change = (next - e).lpNorm<Eigen::Infinity>();
            e = next;
            for (Eigen::Index i = 0; i < n; ++i)
                weight[i] = weight_of(e[i] / scale);
            if (k > 0 && change < 1e-8 * scale)
                return;
        }
    };
    repeat(100, true, huber_weight);
    repeat(200, false, tukey_weight);
    if (!(scale > 0))
        return false;
    const bool is_changed = (weight - weight_).lpNorm<Eigen::Infinity>() > 0.005;
    weight_ = weight;
    scale_ = scale;
    return is_changed;
}

// Restricted, with any scale of the errors: |V|^(-1/2) |X^T V^-1 X|^(-1/2) RSS^(-(n - p) / 2).
VectorXd Instruments::likelihood(const Evaluation& raw, const std::vector<bool>& is_free) const
{
    const MatrixXd all = beside(raw.residual, effects(raw, is_free));
    VectorXd logarithm(static_cast<Eigen::Index>(times_.size()));
    for (std::size_t k = 0; k < times_.size(); ++k) {
        const MatrixXd white = whitened(all, times_[k]);
        const Eigen::ColPivHouseholderQR<MatrixXd> qr(white.rightCols(white.cols() - 1));
        const VectorXd turned = qr.householderQ().transpose() * white.col(0);
        const auto degrees = static_cast<double>(white.rows() - qr.rank());
        double value =
            -degrees / 2 * std::log(std::max(turned.tail(white.rows() - qr.rank()).squaredNorm(), 1e-300));
        for (Eigen::Index i = 0; i < qr.rank(); ++i)
            value -= std::log(std::abs(qr.matrixR()(i, i)));
        if (times_[k] > 0)
            for (const std::vector<std::size_t>& of : series_)
                for (std::size_t i = 1; i < of.size(); ++i) {
                    const double c = std::min(
                        std::exp(-(readings_.time[of[i]] - readings_.time[of[i - 1]]) / times_[k]), 0.999);
                    value -= std::log(1 - c * c) / 2;
                }
        logarithm[static_cast<Eigen::Index>(k)] = value;
    }
    const VectorXd shares = (logarithm.array() - logarithm.maxCoeff()).exp();
    return shares / shares.sum();
}

bool Instruments::update(const Evaluation& raw, const std::vector<AtBound>& at_bound)
{
    const std::vector<bool> is_free = free_parameters(raw, at_bound);
    if (errors_.robust)
        return update_weights(raw, is_free);
    if (!errors_.correlated)
        return false;
    Eigen::Index best = 0;
    likelihood(raw, is_free).maxCoeff(&best);
    const double before = correlation_time_;
    correlation_time_ = times_[static_cast<std::size_t>(best)];
    return std::abs(correlation_time_ - before) > 0.1 * correlation_time_;
}

// As if all that move were free, in the likelihood and in the noise, too. Between correlations it is about where they would be by the
// most likely one.
VectorXd Instruments::variance_if_free(const Evaluation& raw, const std::vector<bool>& is_moving) const
{
    const VectorXd shares = likelihood(raw, is_moving);
    const MatrixXd all = beside(raw.residual, effects(raw, is_moving));
    const Eigen::Index moving = std::ranges::count(is_moving, true);
    Eigen::Index best = 0;
    shares.maxCoeff(&best);
    const auto step_and_variance = [&](Eigen::Index k) {
        const MatrixXd white = whitened(all, times_[static_cast<std::size_t>(k)]),
                       M = white.rightCols(white.cols() - 1);
        const VectorXd shorter = M.colwise().norm().cwiseInverse();
        const MatrixXd scaled = M * shorter.asDiagonal();
        const VectorXd step = -(shorter.asDiagonal() * scaled.colPivHouseholderQr().solve(white.col(0)));
        const double squares =
            (white.col(0) + M * step).squaredNorm() / static_cast<double>(M.rows() - M.cols());
        const MatrixXd inverse =
            (scaled.transpose() * scaled).ldlt().solve(MatrixXd::Identity(M.cols(), M.cols()));
        return std::pair<VectorXd, VectorXd>(
            step.head(moving), squares * inverse.diagonal().cwiseProduct(shorter.cwiseAbs2()).head(moving));
    };
    const VectorXd there = step_and_variance(best).first;
    VectorXd variance = VectorXd::Zero(moving);
    for (Eigen::Index k = 0; k < shares.size(); ++k) {
        if (shares[k] < 1e-6)
            continue;
        const auto [step, within] = step_and_variance(k);
        variance += shares[k] * (within + (step - there).cwiseAbs2());
    }
    return variance;
}

Confidence Instruments::confidence(const Evaluation& raw, const Minimum& minimum) const
{
    if (errors_.robust) {
        // Readings of weight 0 count as missing; the others have pseudo-values.
        const std::vector<std::size_t> rows = kept();
        const auto n = static_cast<double>(rows.size());
        VectorXd residual = raw.residual;
        const std::vector<double> more_by_errors = added(raw);
        for (std::size_t i = 0; i < more_by_errors.size(); ++i)
            residual[static_cast<Eigen::Index>(i)] += more_by_errors[i] / readings_.deviation[i];
        double mean = 0, squares = 0;
        VectorXd psi(static_cast<Eigen::Index>(rows.size()));
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double x = residual[static_cast<Eigen::Index>(rows[k])] / scale_,
                         y = x / tukey_limit * (x / tukey_limit);
            psi[static_cast<Eigen::Index>(k)] = scale_ * x * tukey_weight(x);
            const double slope = (1 - y) * (1 - 5 * y);
            mean += slope / n;
            squares += slope * slope / n;
        }
        mean = std::max(mean, 0.05);
        const MatrixXd X = effects(raw, std::vector<bool>(minimum.at_bound.size(), true));
        const double more =
            1 + static_cast<double>(X.cols()) / n * std::max(0.0, squares - mean * mean) / (mean * mean);
        Minimum pseudo = minimum;
        MatrixXd columns = beside(psi * (more / mean), raw.jacobian(rows, Eigen::all));
        if (unknown_columns_.cols() > 0) {
            const Eigen::ColPivHouseholderQR<MatrixXd> qr(MatrixXd(unknown_columns_(rows, Eigen::all)));
            columns = (qr.householderQ().transpose() * columns).eval().bottomRows(columns.rows() - qr.rank());
        }
        pseudo.there = {columns.col(0), columns.rightCols(columns.cols() - 1)};
        return confidence_of(pseudo, false);
    }
    Confidence found = confidence_of(minimum, readings_.knows_deviations && !errors_.correlated);
    if (!errors_.correlated || minimum.there.jacobian.norm() == 0)
        return found;
    // The variance is that within each correlation and that between them. A parameter at a bound is not known: the others
    // have the variance that they have when it is free.
    std::vector<bool> is_free, is_moving;
    std::vector<Eigen::Index> free, places; // of the free ones, among those that move
    Eigen::Index moving = 0;
    for (std::size_t i = 0; i < found.is_fixed.size(); ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        is_free.push_back(!found.is_fixed[i]);
        is_moving.push_back(minimum.there.jacobian.col(index).norm() > 0);
        if (is_free.back()) {
            free.push_back(index);
            places.push_back(moving);
        }
        if (is_moving.back())
            ++moving;
    }
    const VectorXd shares = likelihood(raw, is_free);
    const MatrixXd all = beside(raw.residual, effects(raw, is_moving));
    const auto p = static_cast<Eigen::Index>(free.size());
    std::vector<Eigen::Index> known = places; // columns without the parameters at bounds
    for (Eigen::Index column = moving; column + 1 < all.cols(); ++column)
        known.push_back(column);
    MatrixXd covariance = MatrixXd::Zero(p, p);
    for (std::size_t k = 0; k < times_.size(); ++k) {
        const double share = shares[static_cast<Eigen::Index>(k)];
        if (share < 1e-6)
            continue;
        const MatrixXd white = whitened(all, times_[k]), M = white.rightCols(white.cols() - 1),
                       X = M(Eigen::all, known);
        const VectorXd length = X.colwise().norm();
        VectorXd step = VectorXd::Zero(X.cols());
        if (X.cols() > 0)
            step = -(length.cwiseInverse().asDiagonal() *
                     (X * length.cwiseInverse().asDiagonal()).colPivHouseholderQr().solve(white.col(0)));
        const double squares =
            (white.col(0) + X * step).squaredNorm() / static_cast<double>(X.rows() - X.cols());
        const VectorXd shorter = M.colwise().norm().cwiseInverse();
        const MatrixXd scaled = M * shorter.asDiagonal();
        const MatrixXd inverse =
            shorter.asDiagonal() *
            (scaled.transpose() * scaled).ldlt().solve(MatrixXd::Identity(M.cols(), M.cols())) *
            shorter.asDiagonal();
        covariance += share * (squares * inverse(places, places) + step.head(p) * step.head(p).transpose());
    }
    VectorXd variance = p < moving ? variance_if_free(raw, is_moving) : VectorXd(moving);
    variance(places) = covariance.diagonal();
    for (Eigen::Index i = 0, place = 0; i < found.error_if_free.size(); ++i)
        if (is_moving[static_cast<std::size_t>(i)])
            found.error_if_free[i] = std::sqrt(variance[place++]);
    const VectorXd error = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
    found.covariance(free, free) = covariance;
    found.correlation(free, free) =
        error.cwiseInverse().asDiagonal() * covariance * error.cwiseInverse().asDiagonal();
    return found;
}

std::vector<FoundError> Instruments::errors(const Evaluation& raw, const Confidence& confidence) const
{
    std::vector<FoundError> found;
    if (unknown_columns_.cols() == 0)
        return found;
    const MatrixXd N = whitened(weighted(unknown_columns_), correlation_time_),
                   with = whitened(weighted(beside(raw.residual, raw.jacobian)), correlation_time_);
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(N);
    const MatrixXd by = -qr.solve(with); // of residuals, and of the parameters
    const MatrixXd inverse = (N.transpose() * N).ldlt().solve(MatrixXd::Identity(N.cols(), N.cols()));
    for (Eigen::Index u = 0; u < N.cols(); ++u) {
        const Unknown& unknown = unknowns_[static_cast<std::size_t>(u)];
        const std::vector<std::size_t>& of = series_[unknown.series];
        const double span = readings_.time[of.back()] - readings_.time[of.front()],
                     per = unknown.kind == Error::drift && span > 0 ? 1 / span : 1.0;
        const double value = by(u, 0) * per,
                     noise = confidence.noise_factor * std::sqrt(std::max(0.0, inverse(u, u))),
                     half = confidence.quantile * per *
                            std::hypot(noise, confidence.standard_error(
                                                  VectorXd(by.row(u).tail(by.cols() - 1).transpose())));
        found.push_back({unknown.kind, unknown.series, unknown.time, value, {value - half, value + half}});
    }
    return found;
}

std::vector<double> Instruments::added(const Evaluation& raw) const
{
    VectorXd sum = VectorXd::Zero(raw.residual.size());
    if (unknown_columns_.cols() > 0)
        sum = -unknown_columns_ * whitened(weighted(unknown_columns_), correlation_time_)
                                      .colPivHouseholderQr()
                                      .solve(whitened(weighted(raw.residual), correlation_time_));
    std::vector<double> values;
    for (std::size_t i = 0; i < readings_.deviation.size(); ++i)
        values.push_back(sum[static_cast<Eigen::Index>(i)] * readings_.deviation[i]);
    return values;
}

std::vector<Outlier> Instruments::outliers(const Evaluation& raw) const
{
    std::vector<Outlier> found;
    if (!errors_.robust)
        return found;
    const std::vector<double> more = added(raw);
    for (std::size_t i = 0; i < more.size(); ++i)
        if (const double e =
                (raw.residual[static_cast<Eigen::Index>(i)] + more[i] / readings_.deviation[i]) / scale_;
            std::abs(e) > outlying)
            found.push_back({i, e});
    return found;
}

std::vector<Doubt> Instruments::doubts(const Evaluation& raw, const Minimum& minimum,
                                       double significance) const
{
    const std::vector<std::size_t> rows = kept();
    const MatrixXd X =
        whitened(effects(raw, free_parameters(raw, minimum.at_bound)), correlation_time_)(rows, Eigen::all);
    const MatrixXd Q = basis_of(X);
    const VectorXd y = whitened(raw.residual, correlation_time_)(rows, 0);
    const VectorXd e = y - Q * (Q.transpose() * y);
    const auto degrees = static_cast<double>(X.rows() - Q.cols());
    const double squares = e.squaredNorm();
    if (degrees < 3 || !(squares > 0))
        return {};
    std::vector<Doubt> best;
    const auto consider = [&](const std::vector<Unknown>& candidates, auto&& column_for) {
        Doubt least;
        double tried = 0;
        for (const Unknown& candidate : candidates) {
            const VectorXd raw_column = column_for(candidate);
            const VectorXd column = whitened(raw_column, correlation_time_)(rows, 0);
            const VectorXd own = column - Q * (Q.transpose() * column);
            const double length = own.squaredNorm();
            if (!(length > 1e-8 * column.squaredNorm()))
                continue;
            ++tried;
            const double along = own.dot(e), explained = std::min(along * along / length, squares);
            const double t =
                std::sqrt(explained * (degrees - 1) / std::max(squares - explained, 1e-300 * squares));
            const double p = std::isfinite(t) ? statistics::student_p(t, degrees - 1) : 0.0;
            if (p < least.p_value)
                least = {candidate.kind, candidate.series, candidate.time, 0, -along / length, p};
        }
        least.p_value = std::min(1.0, least.p_value * tried * kinds);
        if (tried > 0 && least.p_value < significance)
            best.push_back(least);
    };
    std::vector<Unknown> offsets, drifts, steps;
    for (std::size_t s = 0; s < series_.size(); ++s) {
        if (series_[s].size() < 3)
            continue;
        offsets.push_back({Error::offset, s, 0});
        drifts.push_back({Error::drift, s, 0});
        for (std::size_t k = 1; k < series_[s].size(); ++k)
            steps.push_back({Error::step, s, readings_.time[series_[s][k]]});
    }
    const auto column = [this](const Unknown& unknown) { return column_of(unknown); };
    consider(offsets, column);
    consider(drifts, column);
    consider(steps, column);
    for (Doubt& doubt : best)
        if (doubt.kind == Error::drift) {
            const std::vector<std::size_t>& of = series_[doubt.series];
            doubt.value /= readings_.time[of.back()] - readings_.time[of.front()];
        }
    // A single error: `time` is the reading's number.
    std::vector<Unknown> singles;
    for (const std::size_t i : rows)
        singles.push_back({Error::single, readings_.series[i], static_cast<double>(i)});
    const std::size_t before = best.size();
    consider(singles, [this](const Unknown& unknown) {
        VectorXd one = VectorXd::Zero(static_cast<Eigen::Index>(readings_.time.size()));
        const auto i = static_cast<std::size_t>(unknown.time);
        one[static_cast<Eigen::Index>(i)] = 1 / readings_.deviation[i];
        return one;
    });
    if (best.size() > before) {
        best.back().reading = static_cast<std::size_t>(best.back().time);
        best.back().time = readings_.time[best.back().reading];
    }
    std::vector<std::vector<Eigen::Index>> kept_series; // places in `e`
    for (const std::vector<std::size_t>& of : series_) {
        std::vector<Eigen::Index>& places = kept_series.emplace_back();
        for (const std::size_t i : of)
            if (const auto found = std::ranges::lower_bound(rows, i); found != rows.end() && *found == i)
                places.push_back(found - rows.begin());
    }
    const Doubt lasting = lasting_errors(Q, e, kept_series);
    if (lasting.p_value < significance)
        best.push_back(lasting);
    std::stable_sort(best.begin(), best.end(),
                     [](const Doubt& a, const Doubt& b) { return a.p_value < b.p_value; });
    return best;
}

InstrumentFit minimise(const Model& raw, Instruments& instruments, const VectorXd& start, const VectorXd& low,
                       const VectorXd& high, int most_evaluations, double relative)
{
    constexpr int most_repetitions = 12;
    std::vector<std::pair<VectorXd, std::optional<Evaluation>>> done;
    const auto known = [&](const VectorXd& parameters) {
        return std::find_if(done.begin(), done.end(),
                            [&](const auto& one) { return one.first == parameters; });
    };
    const Model model = [&](const VectorXd& parameters) -> std::optional<Evaluation> {
        auto found = known(parameters);
        if (found == done.end())
            found = done.insert(done.end(), {parameters, raw(parameters)});
        if (!found->second)
            return {};
        return instruments.independent(*found->second);
    };
    InstrumentFit fit;
    VectorXd from = start;
    for (int repetition = 0;; ++repetition) {
        const int left = most_evaluations - static_cast<int>(done.size());
        // The start is known already.
        fit.minimum = minimise(model, from, low, high, left + (repetition > 0 ? 1 : 0), relative);
        fit.raw = *known(fit.minimum.parameters)->second;
        from = fit.minimum.parameters;
        if (!fit.minimum.is_converged || !instruments.update(fit.raw, fit.minimum.at_bound))
            break;
        if (repetition == most_repetitions) {
            fit.minimum.is_converged = fit.is_settled = false;
            break;
        }
    }
    fit.minimum.there = instruments.independent(fit.raw);
    fit.minimum.evaluations = static_cast<int>(done.size());
    return fit;
}

} // namespace jointcreep::estimation
