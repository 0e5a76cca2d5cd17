// The tangent stiffness of an assembly, sparse, and a Cholesky factor of something close to it.
//
// Unknowns are the displacements of gridpoints in x and y, where they are free; of a gridpoint on inclined rollers the
// displacement along them. Gridpoints tied to another share its unknowns.
// The tangent K is the sum over all kinds of force, in one of two ways. A kind with constants(), as rock, has a
// constant stiffness; only where it yields it has tangents in its place, and K is factorised for each correction.
// The others, as contacts, have tangents all the time, by what each does now; products with them are added. A
// contact that slips couples its shear traction to its normal displacement, and, if it dilates, its normal traction
// to its shear displacement: then K is not symmetric. The factor is one of K without these couplings, in which open
// and slipping contacts keep a small part of their springs, so that it exists also where K is singular; it
// preconditions, and only its nearness to K decides how many iterations a solution takes.

#pragma once

#include "mechanics/assembly.hpp"

#include <Eigen/SparseCore>

#ifdef JOINTCREEP_CHOLMOD
#include <Eigen/CholmodSupport>
#include <Eigen/UmfPackSupport>
#else
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#endif

#include <vector>

namespace jointcreep::implicit
{

using Eigen::VectorXd;
using mechanics::Assembly;
using mechanics::Tangents;
using mechanics::Vector2d;

// Share of their springs that open and slipping contacts keep in the factor.
constexpr double soft_in_factor = 1e-6;

#ifdef JOINTCREEP_CHOLMOD
// Says how UMFPACK's last call ended, of analysis, factorisation or solution: Eigen keeps only that of a factorisation.
class UmfPackFactor : public Eigen::UmfPackLU<Eigen::SparseMatrix<double, Eigen::ColMajor, int>>
{
public:
    bool is_out_of_memory() const
    {
        return static_cast<int>(m_umfpackInfo[UMFPACK_STATUS]) == UMFPACK_ERROR_out_of_memory;
    }
};
#endif

class Stiffness
{
public:
    // Follows the assembly: call it before each equilibrium. Analyses anew where rock, supports or ties have
    // changed, and puts the zones' present stiffness in.
    void follow(const Assembly& assembly);

    Eigen::Index size() const { return n_; }

    // Gathers a vector over gridpoints into the unknowns' order (forces: of the free directions), and back
    // (displacements: 0 where fixed).
    VectorXd gathered(const Assembly& assembly, const std::vector<Vector2d>& over_gridpoints) const;
    void add_to(std::vector<Vector2d>& over_gridpoints, const VectorXd& unknowns, double factor) const;

    // The solution of K x = right with all these tangents, not symmetric, and factorised for this one; with
    // `dashpots` on the diagonal [Pa], or none if empty. Empty if K has no inverse.
    VectorXd solve_yielding(const Assembly& assembly, const Tangents& tangents, const VectorXd& dashpots,
                            const VectorXd& right);

    // K x with the tangents given; kinds with a constant stiffness do not yield.
    VectorXd times(const Assembly& assembly, const Tangents& tangents, const VectorXd& x) const;

    // Where the tangents `before` and `after` differ, and the unknowns that are coupled there.
    struct Change {
        mechanics::OfEachForce<std::vector<Index>> groups;
        std::vector<int> unknowns;
    };
    Change change(const Assembly& assembly, const Tangents& before, const Tangents& after) const;
    // Adds to y what K x changes by.
    void add_change(const Assembly& assembly, const Change& change, const Tangents& before,
                    const Tangents& after, const Eigen::Ref<const VectorXd>& x, Eigen::Ref<VectorXd> y) const;

    // Factorises with these tangents; false if the matrix has no Cholesky factor. This, follow() and solve() throw
    // std::bad_alloc where memory is short: a matrix that does not fit is not one without a factor.
    bool factorise(const Assembly& assembly, const Tangents& tangents);
    VectorXd solve(const VectorXd& right) const;
    bool has_factor() const { return has_factor_; }
    void forget_factor() { has_factor_ = has_pattern_of_yielding_ = false; }
    bool has_factor_of(const Tangents& tangents) const { return has_factor_ && tangents == factor_of_; }

private:
    using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
#ifdef JOINTCREEP_CHOLMOD
    using Factor = Eigen::CholmodDecomposition<Matrix, Eigen::Lower>;
    using UnsymmetricFactor = UmfPackFactor;
#else
    using Factor = Eigen::SimplicialLLT<Matrix, Eigen::Lower>;
    using UnsymmetricFactor = Eigen::SparseLU<Matrix>;
#endif

    // What the matrix has of a kind of force: groups of gridpoints that it couples, as many in each.
    struct Part {
        std::vector<Index> there;            // groups
        std::vector<int> entry;              // where the square of each group goes, row by row; -1 nowhere
        std::vector<mechanics::Vector3d> of; // constants() that the matrix was made with

        // The square of a group; unknowns are x and y of its gridpoints in turn.
        const int* square(Index group, std::size_t gridpoints) const
        {
            return &entry[4 * gridpoints * gridpoints * group];
        }
    };

    // Of the components of a gridpoint's unknowns, which are along x and y, or along rollers and across them.
    Vector2d turned(Index gridpoint, const Vector2d& xy) const
    {
        return directions_.empty() ? xy : Vector2d(directions_[gridpoint].transpose() * xy);
    }
    Vector2d turned_back(Index gridpoint, const Vector2d& components) const
    {
        return directions_.empty() ? components : Vector2d(directions_[gridpoint] * components);
    }

    void number_unknowns(const Assembly& assembly);
    void find_pattern(const Assembly& assembly);
    void fill_constant(const Assembly& assembly);
    // Calls a kind's add_stiffness or the like with what adds its blocks to the matrix.
    template <class Force, class Call>
    void add(Matrix& matrix, const Force& force, const Part& part, const Call& call) const;
    template <class Force, class Tangent>
    void add_product(const Force& force, Index group, const Tangent& tangent,
                     const Eigen::Ref<const VectorXd>& x, Eigen::Ref<VectorXd> y) const;

    Eigen::Index n_ = 0;
    std::vector<std::array<int, 2>>
        unknown_; // of each gridpoint's {x, y}, or {along, across} rollers; -1 fixed
    std::vector<Eigen::Matrix2d>
        directions_;  // of each gridpoint's unknowns, as columns; empty: no inclined rollers
    Matrix constant_; // of the kinds with a constant stiffness, with the entries of all in the pattern
    mechanics::OfEachForce<Part> parts_;
    Matrix factorised_;
    Factor factor_;
    UnsymmetricFactor yielding_factor_;
    bool has_pattern_of_yielding_ = false;
    Tangents factor_of_;
    bool has_factor_ = false;

    // What the numbering was made for, beside the groups that are there.
    std::vector<Vector2d> is_free_, along_;
    std::vector<std::array<Index, 2>> tied_;
};

} // namespace jointcreep::implicit
