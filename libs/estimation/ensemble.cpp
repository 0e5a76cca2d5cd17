#include "estimation/ensemble.hpp"

#include "model/error.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>

#include <algorithm>
#include <limits>

namespace jointcreep::estimation
{

namespace
{

// Normal draws, [parameter, member], whose mean is 0 and whose covariance is 1.
MatrixXd draws(Eigen::Index parameters, Eigen::Index members, std::uint64_t seed)
{
    boost::random::mt19937_64 random(seed);
    boost::random::normal_distribution<double> normal;
    MatrixXd z = MatrixXd::NullaryExpr(parameters, members, [&] { return normal(random); });
    z.colwise() -= VectorXd(z.rowwise().mean());
    const MatrixXd covariance = z * z.transpose() / static_cast<double>(members - 1);
    return covariance.llt().matrixL().solve(z);
}

MatrixXd root_of(const MatrixXd& covariance)
{
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(covariance).operatorSqrt();
}

MatrixXd inverse_of(const MatrixXd& positive)
{
    return positive.llt().solve(MatrixXd::Identity(positive.rows(), positive.cols()));
}

} // namespace

Inversion invert(const Residuals& model, const Independent& independent, const Prior& prior,
                 const EnsembleSearch& search)
{
    constexpr int tempered = 4;
    const Eigen::Index n = prior.mean.size(), least = least_members(n), members = search.members;
    if (members < least)
        throw input_error(std::to_string(members) + " members for " + std::to_string(n) +
                          " parameters; expected " + std::to_string(least) + " or more");
    const MatrixXd z = draws(n, members, search.seed);
    const MatrixXd information = prior.deviation.array().square().inverse().matrix().asDiagonal();

    // The best of all that had an answer.
    struct Best {
        VectorXd at, residual;
        double sum = std::numeric_limits<double>::infinity();
    } best;
    const auto answer = [&](const VectorXd& at) {
        std::optional<VectorXd> residual = model(at);
        if (!residual)
            return residual;
        const MatrixXd none(residual->size(), 0);
        const double sum = independent({*residual, none}).residual.squaredNorm() +
                           (at - prior.mean).cwiseQuotient(prior.deviation).squaredNorm();
        if (sum < best.sum)
            best = {at, *residual, sum};
        return residual;
    };

    Inversion found;
    found.mean = prior.mean;
    found.covariance = inverse_of(information);
    found.step = VectorXd::Zero(n);
    const auto fail = [&](std::string why) {
        found.failure = std::move(why);
        found.is_converged = false;
        found.mean = best.at;
        found.raw.residual = best.residual;
        return found;
    };
    if (const auto residual = answer(prior.mean))
        found.raw = {*residual, MatrixXd::Zero(residual->size(), n)};
    else
        throw input_error("the model has no answer at the mean of the prior");
    while (found.rounds < search.most_rounds && !found.is_converged) {
        ++found.rounds;
        const double t = std::min(1.0, static_cast<double>(found.rounds) / tempered);

        // 1. The members that have an answer.
        const MatrixXd spread = root_of(found.covariance) * z;
        std::vector<Eigen::Index> answered;
        MatrixXd residuals; // [reading, member]
        for (Eigen::Index j = 0; j < members; ++j)
            if (const auto residual = answer(found.mean + spread.col(j))) {
                residuals.conservativeResize(residual->size(),
                                             static_cast<Eigen::Index>(answered.size()) + 1);
                residuals.rightCols(1) = *residual;
                answered.push_back(j);
            }
        if (static_cast<Eigen::Index>(answered.size()) < least)
            return fail("only " + std::to_string(answered.size()) + " of " + std::to_string(members) +
                        " members have an answer; expected " + std::to_string(least) + " or more");

        // 2. Residuals as a linear function of the parameters.
        MatrixXd terms(static_cast<Eigen::Index>(answered.size()), n + 1);
        terms.col(0).setOnes();
        terms.rightCols(n) = MatrixXd(spread(Eigen::all, answered)).transpose();
        const MatrixXd coefficients = terms.colPivHouseholderQr().solve(MatrixXd(residuals.transpose()));
        found.raw = {coefficients.row(0).transpose(), coefficients.bottomRows(n).transpose()};

        // 3. The step, with the readings' weight t.
        const Evaluation linear = independent(found.raw);
        found.covariance = inverse_of(t * linear.jacobian.transpose() * linear.jacobian + information);
        found.step = -found.covariance * (t * linear.jacobian.transpose() * linear.residual +
                                          information * (found.mean - prior.mean));
        found.mean += found.step;
        found.is_converged = t == 1 && (found.step.lpNorm<Eigen::Infinity>() <= converged_step ||
                                        found.step.dot(found.covariance.llt().solve(found.step)) <=
                                            converged_errors * converged_errors);
    }
    const auto residual = answer(found.mean);
    if (!residual)
        return fail("the mean of the members has no answer");
    found.raw.residual = *residual;
    return found;
}

VectorXd disagreement(const Inversion& found, const Prior& prior)
{
    constexpr double smallest = 1e-6; // share of the variance
    VectorXd by(prior.mean.size());
    for (Eigen::Index i = 0; i < by.size(); ++i) {
        const double variance = prior.deviation[i] * prior.deviation[i],
                     less = variance - found.covariance(i, i);
        by[i] = less > smallest * variance ? (found.mean[i] - prior.mean[i]) / std::sqrt(less) : 0.0;
    }
    return by;
}

} // namespace jointcreep::estimation
