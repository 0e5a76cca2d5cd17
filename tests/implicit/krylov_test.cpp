// Linear systems on small ones: what is said of the residual is true, what can be solved is solved, and what
// was solved before is known.

#include "implicit/krylov.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <random>

namespace krylov_test
{

using Eigen::MatrixXd;
using Eigen::VectorXd;
using jointcreep::implicit::KrylovSpace;

namespace
{

// With eigenvalues of both signs if they fall so, and not symmetric.
struct System {
    MatrixXd A;
    VectorXd right;

    explicit System(int n, unsigned seed)
    {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        const auto any = [&] { return normal(random); };
        A = MatrixXd::NullaryExpr(n, n, any) + 3 * MatrixXd::Identity(n, n);
        right = VectorXd::NullaryExpr(n, any);
    }
    VectorXd times(const VectorXd& x) const { return A * x; }
};

VectorXd as_it_is(const VectorXd& x)
{
    return x;
}

std::vector<int> rows_of(const MatrixXd& change)
{
    std::vector<int> rows;
    for (int i = 0; i < change.rows(); ++i)
        if (!change.row(i).isZero(0))
            rows.push_back(i);
    return rows;
}

} // namespace

// Of one system after another, whose matrix changes a little in between.
RC_GTEST_PROP(krylov, returns_the_true_residual, ())
{
    const int n = *rc::gen::inRange(1, 30), most = *rc::gen::inRange(1, 35);
    System system(n, *rc::gen::inRange(0u, 1000000u));
    const VectorXd scale = VectorXd::LinSpaced(n, 0.5, 2); // any preconditioner
    const auto product = [&](const VectorXd& x) { return system.times(x); };
    const auto precondition = [&](const VectorXd& x) { return VectorXd(x.cwiseProduct(scale)); };
    KrylovSpace space(*rc::gen::inRange(1, 6));
    for (int right = 0; right < 8; ++right) {
        const System other(n, *rc::gen::inRange(0u, 1000000u));
        const double whole = other.right.norm(), enough = 1e-9 * whole;
        VectorXd x;
        const double norm = space.solve(product, precondition, other.right, enough, most, x);
        RC_ASSERT(std::abs(norm - (other.right - system.A * x).norm()) < 1e-9 * whole);
        RC_ASSERT(norm <= whole * (1 + 1e-12));
        if (most >= n && Eigen::FullPivLU<MatrixXd>(system.A).rcond() > 1e-5)
            RC_ASSERT(norm <= enough);
        MatrixXd change = MatrixXd::Zero(n, n);
        change(*rc::gen::inRange(0, n), *rc::gen::inRange(0, n)) = 1;
        space.follow(rows_of(change), [&](const auto& v, auto y) { y += change * v; });
        system.A += change;
    }
}

// The least residual in the Krylov space, found by least squares.
RC_GTEST_PROP(krylov, is_the_best_of_its_space, ())
{
    const int n = 12, most = *rc::gen::inRange(1, 8);
    const System system(n, *rc::gen::inRange(0u, 1000000u));
    MatrixXd space(n, most);
    space.col(0) = system.right;
    for (int i = 1; i < most; ++i)
        space.col(i) = (system.A * space.col(i - 1)).normalized();
    const VectorXd best = (system.A * space).colPivHouseholderQr().solve(system.right);
    VectorXd x;
    const double norm = KrylovSpace(3).solve([&](const VectorXd& v) { return system.times(v); }, as_it_is,
                                             system.right, 0, most, x);
    RC_ASSERT(std::abs(norm - (system.right - system.A * space * best).norm()) < 1e-7 * system.right.norm());
}

// A block in the air: nothing holds it, and no force is on it there.
TEST(krylov, solves_a_singular_system_that_is_consistent)
{
    System system(9, 1);
    system.A.col(3) = 2 * system.A.col(5); // of rank 8
    system.right = system.A * VectorXd::LinSpaced(9, -1, 1);
    VectorXd x;
    const auto product = [&](const VectorXd& v) { return system.times(v); };
    const double norm =
        KrylovSpace(3).solve(product, as_it_is, system.right, 1e-10 * system.right.norm(), 9, x);
    EXPECT_LE(norm, 1e-10 * system.right.norm());
    EXPECT_LE((system.right - system.A * x).norm(), 2e-10 * system.right.norm());
}

TEST(krylov, says_how_far_it_is_from_what_has_no_solution)
{
    MatrixXd A = MatrixXd::Zero(2, 2);
    A(0, 0) = 2;
    const VectorXd right = VectorXd::Ones(2);
    VectorXd x;
    const double norm =
        KrylovSpace(3).solve([&](const VectorXd& v) { return VectorXd(A * v); }, as_it_is, right, 0, 10, x);
    EXPECT_TRUE(x.allFinite());
    EXPECT_NEAR(norm, 1, 1e-12);
    EXPECT_NEAR((right - A * x).norm(), norm, 1e-12);
}

// Also when the matrix has changed in between; and of more solutions than are kept, the last ones.
TEST(krylov, knows_what_it_has_solved)
{
    System system(40, 2);
    int products = 0;
    const auto product = [&](const VectorXd& v) {
        ++products;
        return system.times(v);
    };
    const auto right = [&](int i) { return VectorXd(VectorXd::Unit(40, i)); };
    KrylovSpace space(3);
    VectorXd x;
    for (int i = 0; i < 5; ++i)
        space.solve(product, as_it_is, right(i), 1e-12, 40, x);
    products = 0;
    EXPECT_LE(space.solve(product, as_it_is, 2 * right(4) - right(3), 1e-10, 40, x), 1e-10);
    EXPECT_LE((2 * right(4) - right(3) - system.A * x).norm(), 1e-9);
    EXPECT_EQ(products, 0);
    space.solve(product, as_it_is, right(0), 1e-10, 40, x);
    EXPECT_GT(products, 20) << "it was let go";

    const VectorXd solution = x;
    MatrixXd change = MatrixXd::Zero(40, 40);
    change(7, 9) = 3;
    space.follow(rows_of(change), [&](const auto& v, auto y) { y += change * v; });
    system.A += change;
    products = 0;
    const VectorXd known = system.A * solution;
    EXPECT_LE(space.solve(product, as_it_is, known, 1e-9, 40, x), 1e-9);
    EXPECT_LE((known - system.A * x).norm(), 1e-8);
    EXPECT_EQ(products, 0);

    space.forget();
    space.solve(product, as_it_is, known, 1e-9, 40, x);
    EXPECT_GT(products, 20);
}

// Two solutions that a change makes one leave nothing to divide by.
TEST(krylov, forgets_what_has_become_dependent)
{
    const MatrixXd before = MatrixXd::Identity(4, 4);
    MatrixXd after = before;
    after.col(1) = after.col(0);
    KrylovSpace space(3);
    VectorXd x;
    const auto product = [&](const VectorXd& v) { return VectorXd(before * v); };
    for (int i = 0; i < 2; ++i)
        space.solve(product, as_it_is, VectorXd::Unit(4, i), 1e-12, 4, x);
    space.follow(rows_of(after - before), [&](const auto& v, auto y) { y += (after - before) * v; });
    const double norm = space.solve([&](const VectorXd& v) { return VectorXd(after * v); }, as_it_is,
                                    VectorXd::Unit(4, 0), 1e-12, 4, x);
    EXPECT_LE(norm, 1e-12);
    EXPECT_LE((VectorXd::Unit(4, 0) - after * x).norm(), 1e-12);
}

} // namespace krylov_test
