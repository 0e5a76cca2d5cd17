#include "estimation/ensemble.hpp"

#include "model/error.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>

#include <algorithm>

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
    constexpr double small_step = 0.1, smallest_step = 1e-5;
    const Eigen::Index n = prior.mean.size(), least = least_members(n), members = search.members;
    if (members < least)
        throw input_error(std::to_string(members) + " members for " + std::to_string(n) +
                          " parameters; wanted " + std::to_string(least) + " or more");
    const MatrixXd z = draws(n, members, search.seed);
    const MatrixXd information = prior.deviation.array().square().inverse().matrix().asDiagonal();

    Inversion found;
    found.mean = prior.mean;
    found.covariance = inverse_of(information);
    while (found.rounds < search.most_rounds && !found.is_converged) {
        ++found.rounds;
        const double t = std::min(1.0, static_cast<double>(found.rounds) / tempered);

        // 1. The members that have an answer.
        const MatrixXd spread = root_of(found.covariance) * z;
        std::vector<Eigen::Index> answered;
        MatrixXd residuals; // [reading, member]
        for (Eigen::Index j = 0; j < members; ++j)
            if (const auto residual = model(found.mean + spread.col(j))) {
                residuals.conservativeResize(residual->size(),
                                             static_cast<Eigen::Index>(answered.size()) + 1);
                residuals.rightCols(1) = *residual;
                answered.push_back(j);
            }
        if (static_cast<Eigen::Index>(answered.size()) < least)
            throw input_error("only " + std::to_string(answered.size()) + " of " + std::to_string(members) +
                              " members have an answer; wanted " + std::to_string(least) +
                              " or more: narrower bounds, or more members");

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
        found.is_converged =
            t == 1 && (found.step.lpNorm<Eigen::Infinity>() <= smallest_step ||
                       found.step.dot(found.covariance.llt().solve(found.step)) <= small_step * small_step);
    }
    const auto residual = model(found.mean);
    if (!residual)
        throw input_error("the model has no answer at the mean of the members; wanted narrower bounds");
    found.raw.residual = *residual;
    return found;
}

} // namespace jointcreep::estimation
