#include "implicit/krylov.hpp"

namespace jointcreep::implicit
{

// Keeps a solution whose image is of length 1, and orthogonal to all others.
void KrylovSpace::keep(const VectorXd& solution, const VectorXd& image, double help)
{
    if (size_ == 0) {
        solution_.resize(solution.size(), most_kept_);
        image_.resize(image.size(), most_kept_);
        products_.resize(0, 0);
        help_.resize(0);
    }
    Eigen::Index place = size_;
    if (size_ == most_kept_) {
        help_.minCoeff(&place);
    } else {
        ++size_;
        products_.conservativeResize(size_, size_);
        help_.conservativeResize(size_);
    }
    solution_.col(place) = solution;
    image_.col(place) = image;
    products_.row(place).setZero();
    products_.col(place).setZero();
    products_(place, place) = 1;
    help_[place] = help;
    factorise();
}

// Forgets all if the images have become too nearly dependent.
void KrylovSpace::factorise()
{
    constexpr double least_pivot = 1e-5;
    factor_.compute(products_);
    if (factor_.info() != Eigen::Success)
        return forget();
    const VectorXd pivot = factor_.matrixLLT().diagonal();
    if (!(pivot.minCoeff() > least_pivot * pivot.maxCoeff()))
        forget();
}

} // namespace jointcreep::implicit
