#include "implicit/krylov.hpp"

namespace jointcreep::implicit
{

VectorXd KrylovSpace::project(VectorXd& residual, double norm_of_right)
{
    VectorXd in_space = shares_in(residual);
    residual.noalias() -= images() * in_space;
    help_ = 0.5 * help_ + in_space.cwiseAbs() / norm_of_right;
    return in_space;
}

bool KrylovSpace::orthonormalise(Direction& next, const std::vector<Direction>& found) const
{
    constexpr double rounding = 1e-14; // left of a product that lies in the space
    next.of_space = VectorXd::Zero(size_);
    next.of_new = VectorXd::Zero(static_cast<Eigen::Index>(found.size()));
    const double whole = next.image.norm();
    next.length = whole;
    for (int pass = 0; pass < 2 && (pass == 0 || next.length < 0.5 * whole); ++pass) {
        if (size_ > 0) {
            const VectorXd shares = shares_in(next.image);
            next.image.noalias() -= images() * shares;
            next.of_space += shares;
        }
        for (std::size_t i = 0; i < found.size(); ++i) {
            const double share = found[i].image.dot(next.image);
            next.image -= share * found[i].image;
            next.of_new[static_cast<Eigen::Index>(i)] += share;
        }
        next.length = next.image.norm();
    }
    if (!(next.length > rounding * whole) || !std::isfinite(next.length))
        return false;
    next.image /= next.length;
    return true;
}

VectorXd KrylovSpace::join(const std::vector<Direction>& found, double norm_of_right, Eigen::Index rows)
{
    VectorXd part = VectorXd::Zero(rows), image = part, back = VectorXd::Zero(size_),
             weight(static_cast<Eigen::Index>(found.size()));
    double help = 0;
    for (std::size_t j = 0; j < found.size(); ++j) {
        weight[static_cast<Eigen::Index>(j)] = found[j].share;
        image += found[j].share * found[j].image;
        help = std::hypot(help, found[j].share);
    }
    for (auto j = static_cast<Eigen::Index>(found.size()); j-- > 0;) {
        const Direction& direction = found[static_cast<std::size_t>(j)];
        const double times = weight[j] / direction.length;
        part += times * direction.raw;
        back += times * direction.of_space;
        weight.head(j) -= times * direction.of_new;
    }
    if (size_ > 0)
        part.noalias() -= solutions() * back;
    if (help > 0)
        keep(part / help, image / help, help / norm_of_right);
    return part;
}

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
