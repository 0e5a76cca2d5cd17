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

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace jointcreep::implicit
{

using Eigen::MatrixXd;
using Eigen::VectorXd;

class KrylovSpace
{
public:
    // With more solutions than this, the one that has helped least of late is dropped.
    explicit KrylovSpace(int most_kept) : most_kept_(most_kept) {}

    void forget() { size_ = 0; }

    // The matrix has changed by something whose product with x `add_change(x, y)` adds to y, in no other than
    // these rows, each named once.
    template <class AddChange>
    void follow(const std::vector<int>& rows, const AddChange& add_change);

    // The solution x of product(x) = right, until the residual's norm is at most `enough`, or for `most`
    // iterations, each with one product and one application of the preconditioner. Returns the norm reached,
    // by the recurrence.
    template <class Product, class Precondition>
    double solve(const Product& product, const Precondition& precondition, const VectorXd& right,
                 double enough, int most, VectorXd& x);

private:
    // The share of each solution in what comes nearest to y.
    VectorXd shares_in(const VectorXd& y) const
    {
        return factor_.solve(image_.leftCols(size_).transpose() * y);
    }
    void keep(const VectorXd& solution, const VectorXd& image, double help);
    void factorise();

    int most_kept_;
    int size_ = 0;                // columns in use
    MatrixXd solution_, image_;   // a column each; images are products with the matrix
    MatrixXd products_;           // of images with each other
    Eigen::LLT<MatrixXd> factor_; // of these
    VectorXd help_;               // of each solution: its shares in right sides, less and less the longer ago
};

template <class AddChange>
void KrylovSpace::follow(const std::vector<int>& rows, const AddChange& add_change)
{
    if (size_ == 0 || rows.empty())
        return;
    const auto products_in_rows = [&] {
        const MatrixXd part = image_(rows, Eigen::seqN(0, size_));
        return MatrixXd(part.transpose().lazyProduct(part)); // on one thread: sums are always the same
    };
    products_ -= products_in_rows();
    for (int i = 0; i < size_; ++i)
        add_change(solution_.col(i), image_.col(i));
    products_ += products_in_rows();
    factorise();
}

template <class Product, class Precondition>
double KrylovSpace::solve(const Product& product, const Precondition& precondition, const VectorXd& right,
                          double enough, int most, VectorXd& x)
{
    constexpr double rounding = 1e-14; // left of a product that lies in the space
    constexpr double little = 0.9;     // is left of the residual by an iteration that gains enough
    x = VectorXd::Zero(right.size());
    const double norm_of_right = right.norm();
    double norm = norm_of_right;
    if (!(norm > enough))
        return norm;
    const auto solutions = [&] { return solution_.leftCols(size_); };
    const auto images = [&] { return image_.leftCols(size_); };
    VectorXd residual = right, in_space = VectorXd::Zero(size_);
    if (size_ > 0) {
        in_space = shares_in(residual);
        residual.noalias() -= images() * in_space;
        norm = residual.norm();
        help_ = 0.5 * help_ + in_space.cwiseAbs() / norm_of_right;
    }

    // New directions. Their products are made orthonormal to each other and to the space:
    //   length * image = product(raw) - images of the space * of_space - earlier new images * of_new.
    struct Direction {
        VectorXd raw, image, of_space, of_new;
        double length, share;
    };
    std::vector<Direction> found;
    bool by_residual = true;
    for (int n = 0; n < most && norm > enough; ++n) {
        Direction next;
        next.raw = precondition(by_residual ? VectorXd(residual / norm) : found.back().image);
        next.image = product(next.raw);
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
        if (!(next.length > rounding * whole) || !std::isfinite(next.length)) {
            if (!by_residual || found.empty())
                break; // no new direction is left
            by_residual = false;
            continue;
        }
        next.image /= next.length;
        next.share = next.image.dot(residual);
        residual -= next.share * next.image;
        found.push_back(std::move(next));
        const double before = norm;
        norm = residual.norm();
        by_residual = norm < little * before;
    }

    // Their part of the solution, in terms of raw directions and of the space.
    VectorXd part = VectorXd::Zero(right.size()), image = part, back = VectorXd::Zero(size_),
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
    if (size_ > 0) {
        part.noalias() -= solutions() * back;
        x.noalias() = solutions() * in_space;
    }
    x += part;
    if (help > 0)
        keep(part / help, image / help, help / norm_of_right);
    return norm;
}

} // namespace jointcreep::implicit
