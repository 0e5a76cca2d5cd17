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
    // A new direction of a solve: raw = precondition(...). Their products are made orthonormal to each other and to the
    // space:
    //   length * image = product(raw) - images of the space * of_space - earlier new images * of_new.
    struct Direction {
        VectorXd raw, image, of_space, of_new;
        double length, share; // share: of the image in the residual before
    };

    auto solutions() const { return solution_.leftCols(size_); }
    auto images() const { return image_.leftCols(size_); }

    // The share of each solution in what comes nearest to y.
    VectorXd shares_in(const VectorXd& y) const
    {
        return factor_.solve(image_.leftCols(size_).transpose() * y);
    }
    // The best there is in the space: takes it off the residual, and returns its shares.
    VectorXd project(VectorXd& residual, double norm_of_right);
    // Makes `next` of its raw direction and product. Returns false if that leaves nothing new.
    bool orthonormalise(Direction& next, const std::vector<Direction>& found) const;
    // The part of the solution that the new directions give, in terms of raw directions and of the space; keeps it.
    VectorXd join(const std::vector<Direction>& found, double norm_of_right, Eigen::Index rows);
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
    constexpr double little = 0.9; // is left of the residual by an iteration that gains enough
    x = VectorXd::Zero(right.size());
    const double norm_of_right = right.norm();
    double norm = norm_of_right;
    if (!(norm > enough))
        return norm;
    VectorXd residual = right, in_space = VectorXd::Zero(size_);
    if (size_ > 0) {
        in_space = project(residual, norm_of_right);
        norm = residual.norm();
    }

    std::vector<Direction> found;
    bool by_residual = true;
    for (int n = 0; n < most && norm > enough; ++n) {
        Direction next;
        next.raw = precondition(by_residual ? VectorXd(residual / norm) : found.back().image);
        next.image = product(next.raw);
        if (!orthonormalise(next, found)) {
            if (!by_residual || found.empty())
                break; // no new direction is left
            by_residual = false;
            continue;
        }
        next.share = next.image.dot(residual);
        residual -= next.share * next.image;
        found.push_back(std::move(next));
        const double before = norm;
        norm = residual.norm();
        by_residual = norm < little * before;
    }
    if (size_ > 0)
        x.noalias() = solutions() * in_space;
    x += join(found, norm_of_right, right.size());
    return norm;
}

} // namespace jointcreep::implicit
