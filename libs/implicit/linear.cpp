// Linear systems at an equilibrium: to first order, how it changes.

#include "implicit/equilibrium.hpp"

namespace jointcreep::implicit
{

VectorXd Solver::solve_linear(const Assembly& assembly, const Tangents& tangents, const VectorXd& right)
{
    constexpr double exact = 1e-10, hardly = 1e-6; // residuals over the right side
    // Several right sides come with the same tangents: a factor of these very tangents is soon worth its
    // cost.
    constexpr int patience = 3, patience_with_own = 60, most_refinements = 3;
    const auto product = [&](const VectorXd& x) { return stiffness_.times(assembly, tangents, x); };
    const auto precondition = [&](const VectorXd& x) { return stiffness_.solve(x); };
    if (linear_ && tangents != *linear_) {
        const Stiffness::Change change = stiffness_.change(assembly, *linear_, tangents);
        linear_space_.follow(change.unknowns, [&](const auto& x, auto y) {
            stiffness_.add_change(assembly, change, *linear_, tangents, x, y);
        });
    }
    linear_ = tangents;

    const double norm = right.norm();
    VectorXd x = VectorXd::Zero(right.size()), residual = right, correction;
    const auto is_solved = [&](double enough) { return residual.norm() <= enough * norm; };
    const auto refine = [&](int iterations, int refinements) {
        for (int i = 0; i < refinements && !is_solved(exact); ++i) {
            linear_space_.solve(product, precondition, residual, exact / 2 * norm, iterations, correction);
            x += correction;
            residual = right - product(x);
        }
    };
    Tangents firm = tangents; // a Cholesky factor does not know slip
    for_each_force(
        [](const auto& force, auto& of_force) { of_force = without_zeros(force, of_force, soft_in_factor); },
        assembly, firm);
    const bool is_own = stiffness_.has_factor_of(firm);
    if (stiffness_.has_factor())
        refine(is_own ? patience_with_own : patience, is_own ? most_refinements : 1);
    if (!is_solved(exact) && !is_own) {
        if (!stiffness_.factorise(assembly, firm))
            return {};
        refine(patience_with_own, most_refinements);
    }
    return is_solved(hardly) && x.allFinite() ? x : VectorXd();
}

} // namespace jointcreep::implicit
