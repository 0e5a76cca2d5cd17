// The tangent stiffness of an assembly, sparse, and a Cholesky factor of something close to it.
//
// Unknowns are the displacements of gridpoints that are free; gridpoints tied to another share its unknowns.
// The tangent is K = sum over zones + sum over contacts, the latter by what each contact does now (Tangent).
// A contact that slips couples its shear traction to its normal displacement, and, if it dilates, its normal
// traction to its shear displacement: then K is not symmetric. The factor is
// one of the symmetric part in which open and slipping contacts keep a small part of their springs, so that
// it exists also where K is singular; it preconditions, and only its nearness to K decides how many
// iterations a solution takes.

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
using joint::Tangent;
using mechanics::Assembly;
using mechanics::Vector2d;

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

    // The solution of K x = right where rock yields: K with these tangents of contacts and, from `start`, of zones, not
    // symmetric, and factorised for this one; with `dashpots` on its diagonal [Pa], or none if empty. Empty if K has no inverse.
    VectorXd solve_yielding(const Assembly& assembly, const std::vector<Tangent>& tangents,
                            const std::vector<rock::YieldingZone>& start, const VectorXd& dashpots,
                            const VectorXd& right);

    // K x with the tangents given, one for each contact.
    VectorXd times(const Assembly& assembly, const std::vector<Tangent>& tangents, const VectorXd& x) const;

    // What changes when the tangents go from `before` to `after`: the contacts, with the difference; and the
    // unknowns that these contacts couple.
    struct Change {
        std::vector<std::pair<Index, Tangent>> contacts;
        std::vector<int> unknowns;
    };
    Change change(const Assembly& assembly, const std::vector<Tangent>& before,
                  const std::vector<Tangent>& after) const;

    // Adds the contact's part of K x to y.
    void add_contact(const Assembly& assembly, Index contact, const Tangent& tangent,
                     const Eigen::Ref<const VectorXd>& x, Eigen::Ref<VectorXd> y) const;

    // Factorises with these tangents; false if the matrix has no Cholesky factor. This, follow() and solve() throw
    // std::bad_alloc where memory is short: a matrix that does not fit is not one without a factor.
    bool factorise(const Assembly& assembly, const std::vector<Tangent>& tangents);
    VectorXd solve(const VectorXd& right) const;
    bool has_factor() const { return has_factor_; }
    void forget_factor() { has_factor_ = has_pattern_of_yielding_ = false; }
    bool has_factor_of(const std::vector<Tangent>& tangents) const
    {
        return has_factor_ && tangents == factor_of_;
    }

private:
    using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
#ifdef JOINTCREEP_CHOLMOD
    using Factor = Eigen::CholmodDecomposition<Matrix, Eigen::Lower>;
    using UnsymmetricFactor = Eigen::UmfPackLU<Matrix>;
#else
    using Factor = Eigen::SimplicialLLT<Matrix, Eigen::Lower>;
    using UnsymmetricFactor = Eigen::SparseLU<Matrix>;
#endif

    void number_unknowns(const Assembly& assembly);
    void find_pattern(const Assembly& assembly);
    void fill_zones(const Assembly& assembly);
    template <class Block>
    void add_zones(Matrix& matrix, const rock::Zones& zones, const Block& block) const;
    template <class Block>
    void add_contacts(Matrix& matrix, const Block& block) const;

    Eigen::Index n_ = 0;
    std::vector<std::array<int, 2>> unknown_; // of each gridpoint's {x, y}; -1 fixed
    Matrix zones_;                            // of the zones alone, with all contacts' entries in the pattern
    std::vector<int> zone_entry_; // where the square of each zone goes in zones_, row by row; -1 nowhere
    std::vector<std::array<int, 16>> contact_entry_; // where a contact's 4 x 4 goes
    std::vector<Index> present_contact_;
    Matrix factorised_;
    Factor factor_;
    UnsymmetricFactor yielding_factor_;
    bool has_pattern_of_yielding_ = false;
    std::vector<Tangent> factor_of_;
    bool has_factor_ = false;

    // What the numbering was made for.
    std::vector<char> is_present_;
    std::vector<Vector2d> is_free_;
    std::vector<std::array<Index, 2>> tied_;
    std::vector<mechanics::Vector3d> zone_stiffness_;
};

} // namespace jointcreep::implicit
