// Guards of a run: what must hold of every equilibrium and of every recorded state, however it was found. A run with a
// state that does not keep to one ends there, as one without equilibrium does: with the states before it.

#pragma once

#include "analysis/section.hpp"
#include "analysis/watcher.hpp"

#include <string>

namespace jointcreep::analysis
{

// How far a state is off.
struct GuardedState {
    bool is_finite = true;   // displacements, stresses and tractions
    double area_error = 0;   // of the present zones of a block, over the block's area [-]
    double weight_error = 0; // of loads against the weight of present zones, over that of all zones [-]
    double penetration = 0;  // of contacts, beyond normal stress over normal stiffness [m]
};
GuardedState guarded_state(const Section& section);

// Energy that is missing or too much in the balance of an equilibrium, or has no source, over the sum of its terms [-].
// What is stored is a small difference of all that is `stored` [J/m]; its rounding does not count.
double energy_error(const mechanics::Convergence& convergence, double stored);

// What is not kept to, in words; empty if all is.
std::string broken_guard(const GuardedState& state, double size_of_section);
std::string broken_guard(double unbalanced_force_ratio, double energy_error, double tolerance);

class Guards : public Watcher
{
public:
    explicit Guards(Section& section) : section_(section) {}

    void equilibrium_ends(double /*still_applied*/) override { check_equilibrium(); }
    void step_ends(const Step&) override { check_equilibrium(); }
    void state_is_due(const std::string& event) override;

private:
    void check_equilibrium();
    void end_if(const std::string& broken);

    Section& section_;
};

} // namespace jointcreep::analysis
