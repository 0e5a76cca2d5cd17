// Implicit equilibrium: Newton's method over the contacts' states, in place of dynamic relaxation.
//
// As long as no contact changes its state, the assembly is linear: one factor of its stiffness K serves many equilibria.
// Each correction solves K du = unbalanced force by GCR, preconditioned with the last factor. The factor is renewed when
// that costs less than more iterations with the old one. Contacts follow the same law as in dynamic relaxation. Each
// correction computes them from their state at the start of the equilibrium (backward Euler; joint/active_contacts.hpp).
//
// Rock that yields is also computed from its state at the start. Then K has the consistent tangents of zones. It is not
// symmetric if the flow rule is not associated, and it is factorised for each correction. If Newton's method finds no
// equilibrium, gridpoints move against dashpots: to an equilibrium, or until displacements are too large
// (implicit/flow.cpp).
//
// The energy balance is that of backward Euler, too: slip is at the final traction. Energy that is neither stored nor
// dissipated counts as damped. So the sum holds by definition; created_energy is checked in its place.

#pragma once

#include "implicit/krylov.hpp"
#include "implicit/stiffness.hpp"
#include "mechanics/failure.hpp"

#include <optional>
#include <string>

namespace jointcreep::implicit
{

// Energy that the laws of rock and joints cannot have given in an equilibrium found by the implicit engine [J/m]; 0 where
// there is none. A spring whose force changes from f0 to f1 on a straight path du takes the work f1 du. It stores less,
// because its energy E is convex: f1 du - (E1 - E0) >= 0. This holds for every spring, also where it slips, yields or lets
// go, and therefore for the section, with the unbalanced forces F1 at the end [N/m]:
//
//     0 <= damped - F1 du
//
// It does not hold of contacts that close: the force where they touch is not known from the start.
double created_energy(const Assembly& assembly, const mechanics::State& start, double damped);

class Solver
{
public:
    // Moves the assembly to equilibrium: the unbalanced force ratio is at most the tolerance, and one more
    // correction would change no contact force by more than the tolerance times the mean force on a
    // gridpoint. A state that is in balance already is left as it is, after 0 steps. `guess` is how far
    // gridpoints may be expected to move [m]; none, or a bad one, costs time only.
    //
    // Nothing if it finds no equilibrium; reason() says why. The assembly is then as it was: bonds that broke in
    // this search are whole again.
    std::optional<mechanics::Convergence> equilibrate(Assembly& assembly, const Equilibrium& settings,
                                                      const std::vector<Vector2d>& guess = {});
    const std::string& reason() const { return reason_; }
    // Is told of every correction.
    void tell(mechanics::SearchObserver observer) { observer_ = std::move(observer); }
    // Set if it has found none because displacements of rock that yields grow without bound. The assembly is then
    // not as it was, but as it moves.
    const std::optional<mechanics::no_equilibrium>& collapse() const { return collapse_; }

    // Forgets the factor and solutions: the next equilibrium is found as by a new solver.
    void forget() { stiffness_.forget_factor(); }

    // After equilibrate(), at the same stiffnesses: the x with K x = right, with K from the given tangents. Uses the
    // last factor, which is renewed where it is too far off. Empty if K has no inverse.
    VectorXd solve_linear(const Assembly& assembly, const Tangents& tangents, const VectorXd& right);
    const Stiffness& stiffness() const { return stiffness_; }

    // What the last equilibrium, or the search for it, has cost.
    Index corrections() const { return corrections_; }
    Index factorisations() const { return factorisations_; }
    Index solves() const { return solves_; } // back-substitutions

private:
    using State = mechanics::State; // where an equilibrium starts from
    double evaluate(Assembly& assembly, const State& start);
    VectorXd correction(const Assembly& assembly, const State& start, const VectorXd& force, double enough,
                        double kept_share);
    struct Advance {
        double merit;        // where it ends
        double failed_share; // the smallest share of the correction that brought forces no nearer to balance;
                             // 0 if none
    };
    // How a search goes.
    struct Course {
        double merit = 0, least_merit = 0;
        double kept_share = 0; // of their springs, by open and slipping contacts in a correction
        int since_least = 0, leaps = 0;
    };
    bool get_past(Assembly& assembly, const State& start, const std::vector<Vector2d>& from,
                  const VectorXd& correction_made, const Advance& advance, double enough, Course& course);
    bool is_usable(const VectorXd& correction);
    bool is_too_far(const Assembly& assembly, const Equilibrium& settings);
    Advance go_along(Assembly& assembly, const State& start, const VectorXd& correction, double merit);
    void prepare(const Assembly& assembly);
    bool converge(Assembly& assembly, const State& start, const Equilibrium& settings, int most_corrections,
                  mechanics::Convergence& convergence);
    void restore_bonds(Assembly& assembly, const State& start, const Equilibrium& settings,
                       mechanics::Convergence& convergence);
    bool is_at_rest(const Assembly& assembly, const State& start, double mean_force, double tolerance,
                    mechanics::Convergence& convergence);
    bool flow_to_rest(Assembly& assembly, const State& start, const Equilibrium& settings,
                      mechanics::Convergence& convergence);
    double force_change(const Assembly& assembly, const State& start, const VectorXd& displacement) const;
    Tangents tangents(const Assembly& assembly, const State& start, double soft) const;
    void take(const Assembly& assembly, const State& start, bool first);
    void report(mechanics::Convergence& convergence, double unbalanced_force_ratio) const;
    bool break_bonds(const Assembly& assembly, const State& start);
    bool mend_bonds(const Assembly& assembly);

    mechanics::SearchObserver observer_;
    Stiffness stiffness_;
    KrylovSpace space_{24};        // of the stiffness
    Tangents acting_;              // with these tangents
    KrylovSpace linear_space_{24}; // of solve_linear
    std::optional<Tangents> linear_;
    mechanics::ActiveForces active_;
    VectorXd scale_;         // of forces: the stiffness against which they act [Pa]
    double stiffest_ = 0;    // row sum [Pa]
    Index unsupported_ = -1; // gridpoint of rock without support though forces balance; -1: none
    double too_far_ = 0;     // largest displacement in a search for equilibrium [m]
    VectorXd force_;         // unbalanced, at the last evaluation
    VectorXd dashpots_;      // over the time of a step, added to the stiffness [Pa]; or empty
    std::optional<mechanics::no_equilibrium> collapse_;
    Index corrections_ = 0, factorisations_ = 0, solves_ = 0;
    std::string reason_;
};

} // namespace jointcreep::implicit
