// Linear systems one after another, whose right sides and matrices are much alike: forces of one creep step
// are like those of the last one, and a contact that changes its state leaves most of the matrix as it was.
//
// GCR, preconditioned from the right: what it minimises is the residual itself, and that is what decides
// whether forces balance. Each solution starts from the best there is in the space of earlier solutions
// (as Fischer's projection, Comput. Methods Appl. Mech. Eng. 163, 1998), and joins them. Where an iteration
// gains little, the next direction comes from the last product instead of from the residual, which keeps the
// method from breaking down (adaptive simpler GMRES: Jiranek, Rozloznik, J. Comput. Appl. Math. 234, 2010).
// From an empty space it finds what GMRES finds.

#pragma once

#include <Eigen/Core>

#include <cmath>

namespace jointcreep::implicit
{

using Eigen::VectorXd;

class KrylovSpace
{
public:
    // Of more solutions than this, the one goes that has helped least of late.
    explicit KrylovSpace(int most_kept) : most_kept_(most_kept) {}

    void forget() { size_ = 0; }

    // The matrix has changed by something with the product `change(x)`.
    template <class Change>
    void follow(const Change& change)
    {
        for (int i = 0; i < size_; ++i)
            image_.col(i) += change(direction_.col(i));
        make_orthonormal();
    }

    // The solution x of product(x) = right, until the residual's norm is at most `enough`, or for `most`
    // iterations, each with one product and one application of the preconditioner. Returns the norm reached,
    // by the recurrence.
    template <class Product, class Precondition>
    double solve(const Product& product, const Precondition& precondition, const VectorXd& right,
                 double enough, int most, VectorXd& x);

private:
    void make_orthonormal();
    void add(const VectorXd& direction, const VectorXd& image);
    void condense(int kept, const VectorXd& shares, double norm_of_right);

    int most_kept_;
    int size_ = 0;                      // columns in use; the others are room for more
    Eigen::MatrixXd direction_, image_; // a column each; images are products with the matrix, and orthonormal
    VectorXd help_; // of each solution kept: its shares in right sides, less and less the longer ago
};

template <class Product, class Precondition>
double KrylovSpace::solve(const Product& product, const Precondition& precondition, const VectorXd& right,
                          double enough, int most, VectorXd& x)
{
    constexpr double rounding = 1e-14; // what is left of a product beside the space, if nothing new is in it
    constexpr double little = 0.9;     // is left of the residual by an iteration that gains enough
    x = VectorXd::Zero(right.size());
    const double norm_of_right = right.norm();
    double norm = norm_of_right;
    if (!(norm > enough))
        return norm;
    VectorXd residual = right;
    const int kept = size_;
    if (kept > 0) {
        const VectorXd shares = image_.leftCols(kept).transpose() * residual;
        x.noalias() += direction_.leftCols(kept) * shares;
        residual.noalias() -= image_.leftCols(kept) * shares;
        help_.head(kept) = 0.5 * help_.head(kept) + shares.cwiseAbs() / norm_of_right;
        norm = residual.norm();
    }
    VectorXd new_shares(most);
    bool by_residual = true;
    for (int n = 0; n < most && norm > enough; ++n) {
        VectorXd direction =
            precondition(by_residual ? VectorXd(residual / norm) : VectorXd(image_.col(size_ - 1)));
        VectorXd image = product(direction);
        const double whole = image.norm();
        double length = whole;
        for (int pass = 0; size_ > 0 && pass < 2 && (pass == 0 || length < 0.5 * whole); ++pass) {
            const VectorXd shares = image_.leftCols(size_).transpose() * image;
            image.noalias() -= image_.leftCols(size_) * shares;
            direction.noalias() -= direction_.leftCols(size_) * shares;
            length = image.norm();
        }
        if (!(length > rounding * whole) || !std::isfinite(length)) {
            if (!by_residual || size_ == kept)
                break; // nothing new to be had
            by_residual = false;
            continue;
        }
        add(direction / length, image / length);
        const double share = image_.col(size_ - 1).dot(residual);
        x += share * direction_.col(size_ - 1);
        residual -= share * image_.col(size_ - 1);
        new_shares[size_ - 1 - kept] = share;
        const double before = norm;
        norm = residual.norm();
        by_residual = norm < little * before;
    }
    condense(kept, new_shares.head(size_ - kept), norm_of_right);
    return norm;
}

} // namespace jointcreep::implicit
