// GMRES on small systems: what it says of its residual is true, and what it can solve it solves.

#include "implicit/gmres.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <random>

using Eigen::MatrixXd;
using Eigen::VectorXd;
using jointcreep::implicit::gmres;

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

} // namespace

RC_GTEST_PROP(gmres, returns_the_true_residual, ())
{
    const int n = *rc::gen::inRange(1, 30), most = *rc::gen::inRange(1, 35);
    const System system(n, *rc::gen::inRange(0u, 1000000u));
    const bool knows_something = *rc::gen::inRange(0, 2) == 0;
    const VectorXd first = knows_something ? VectorXd(VectorXd::Ones(n)) : VectorXd(VectorXd::Zero(n));
    const VectorXd scale = VectorXd::LinSpaced(n, 0.5, 2); // any preconditioner
    const auto product = [&](const VectorXd& x) { return system.times(x); };
    const auto precondition = [&](const VectorXd& x) { return VectorXd(x.cwiseProduct(scale)); };
    VectorXd x = first;
    const double enough = 1e-9 * system.right.norm();
    const double norm = gmres(product, precondition, system.right, enough, most, x);
    const double before = (system.right - system.A * first).norm();
    RC_ASSERT(std::abs(norm - (system.right - system.A * x).norm()) < 1e-10 * before);
    RC_ASSERT(norm <= before * (1 + 1e-12));
    if (most >= n && Eigen::FullPivLU<MatrixXd>(system.A).rcond() > 1e-6)
        RC_ASSERT(norm <= enough);
}

// The least residual in the Krylov space, found by least squares.
RC_GTEST_PROP(gmres, is_the_best_of_its_space, ())
{
    const int n = 12, most = *rc::gen::inRange(1, 8);
    const System system(n, *rc::gen::inRange(0u, 1000000u));
    MatrixXd space(n, most);
    space.col(0) = system.right;
    for (int i = 1; i < most; ++i)
        space.col(i) = (system.A * space.col(i - 1)).normalized();
    const VectorXd best = (system.A * space).colPivHouseholderQr().solve(system.right);
    VectorXd x = VectorXd::Zero(n);
    const double norm =
        gmres([&](const VectorXd& v) { return system.times(v); }, as_it_is, system.right, 0, most, x);
    RC_ASSERT(std::abs(norm - (system.right - system.A * space * best).norm()) < 1e-7 * system.right.norm());
}

// A block in the air: nothing holds it, and no force is on it there.
TEST(gmres, solves_a_singular_system_that_is_consistent)
{
    System system(9, 1);
    system.A.col(3) = 2 * system.A.col(5); // of rank 8
    system.right = system.A * VectorXd::LinSpaced(9, -1, 1);
    VectorXd x = VectorXd::Zero(9);
    const auto product = [&](const VectorXd& v) { return system.times(v); };
    const double norm = gmres(product, as_it_is, system.right, 1e-10 * system.right.norm(), 9, x);
    EXPECT_LE(norm, 1e-10 * system.right.norm());
    EXPECT_LE((system.right - system.A * x).norm(), 2e-10 * system.right.norm());
}

TEST(gmres, says_how_far_it_is_from_what_has_no_solution)
{
    MatrixXd A = MatrixXd::Zero(2, 2);
    A(0, 0) = 2;
    const VectorXd right = VectorXd::Ones(2);
    VectorXd x = VectorXd::Zero(2);
    const double norm = gmres([&](const VectorXd& v) { return VectorXd(A * v); }, as_it_is, right, 0, 10, x);
    EXPECT_TRUE(x.allFinite());
    EXPECT_NEAR(norm, 1, 1e-12);
    EXPECT_NEAR((right - A * x).norm(), norm, 1e-12);
}

TEST(gmres, leaves_what_is_good_enough)
{
    const System system(5, 2);
    VectorXd x = system.A.partialPivLu().solve(system.right);
    const VectorXd before = x;
    int products = 0;
    const auto product = [&](const VectorXd& v) {
        ++products;
        return system.times(v);
    };
    EXPECT_LE(gmres(product, as_it_is, system.right, 1e-6, 10, x), 1e-6);
    EXPECT_EQ(x, before);
    EXPECT_EQ(products, 1); // to see that
}
