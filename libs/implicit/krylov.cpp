#include "implicit/krylov.hpp"

#include <Eigen/Cholesky>

namespace jointcreep::implicit
{

void KrylovSpace::add(const VectorXd& direction, const VectorXd& image)
{
    if (size_ == 0 && image_.rows() != image.size()) { // another matrix
        direction_.resize(direction.size(), 0);
        image_.resize(image.size(), 0);
    }
    if (size_ == image_.cols()) {
        constexpr int room = 8;
        direction_.conservativeResize(Eigen::NoChange, size_ + room);
        image_.conservativeResize(Eigen::NoChange, size_ + room);
    }
    direction_.col(size_) = direction;
    image_.col(size_) = image;
    ++size_;
}

// Of what has joined the first `kept` columns, with its shares in the solution, their sum is kept.
void KrylovSpace::condense(int kept, const VectorXd& shares, double norm_of_right)
{
    size_ = kept;
    const double norm = shares.norm();
    if (!(norm > 0))
        return;
    const VectorXd direction = direction_.middleCols(kept, shares.size()) * (shares / norm),
                   image = image_.middleCols(kept, shares.size()) * (shares / norm);
    Eigen::Index place = kept;
    if (kept == most_kept_)
        help_.minCoeff(&place);
    else
        help_.conservativeResize(++size_);
    direction_.col(place) = direction;
    image_.col(place) = image;
    help_[place] = norm / norm_of_right;
}

// By the Cholesky factor of the images' products with each other, column by column, so that sums do not
// depend on the number of threads. Forgets all if they are not independent enough for that.
void KrylovSpace::make_orthonormal()
{
    constexpr double least_pivot = 1e-5;
    if (size_ == 0)
        return;
    Eigen::MatrixXd products(size_, size_);
    for (int i = 0; i < size_; ++i)
        products.col(i).noalias() = image_.leftCols(size_).transpose() * image_.col(i);
    const Eigen::LLT<Eigen::MatrixXd> factor(products);
    const Eigen::MatrixXd upper = factor.matrixU();
    if (factor.info() != Eigen::Success ||
        !(upper.diagonal().minCoeff() > least_pivot * upper.diagonal().maxCoeff()))
        return forget();
    for (Eigen::MatrixXd* columns : {&image_, &direction_})
        for (int i = 0; i < size_; ++i) {
            columns->col(i).noalias() -= columns->leftCols(i) * upper.col(i).head(i);
            columns->col(i) /= upper(i, i);
        }
}

} // namespace jointcreep::implicit
