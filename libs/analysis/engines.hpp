// Equilibrium of a section by its engine: the implicit engine, dynamic relaxation, or, chosen automatically,
// the first and, where that fails, the second.

#pragma once

#include "analysis/section.hpp"
#include "analysis/step_recorder.hpp"

namespace jointcreep::analysis
{

class Engines
{
public:
    Engines(Section& section, StepRecorder& step_history) : section_(section), step_recorder_(step_history)
    {
        implicit_.tell(tell_);
    }

    // Equilibrium at `time` since start [s]; messages and the step history have that time. What was found is
    // in Section::settled. Throws equilibrium_error where there is none.
    void settle(double time);

    // Equilibrium by the implicit engine, unless only dynamic relaxation is asked for; false if it finds none nearby.
    // `guess` is how far gridpoints may be expected to move [m], or empty.
    bool settles_nearby(const std::vector<Vector2d>& guess);

    // Equilibrium by dynamic relaxation, after the implicit engine has found none, unless only that is asked for.
    void settle_by_relaxation(double time);

    // Forgets what earlier searches have taught, which speeds up the next ones and changes their last digits. Dynamic
    // relaxation does that, too.
    void forget()
    {
        implicit_.forget();
        has_learnt_ = false;
    }
    bool has_learnt() const { return has_learnt_; }

    // Throws equilibrium_error that names rock without support, which falls without end.
    void check_supported();

    implicit::Solver& implicit_engine() { return implicit_; } // with its last factor

private:
    mechanics::Convergence relax(double time);

    Section& section_;
    StepRecorder& step_recorder_;
    mechanics::SearchObserver tell_ = [this](const mechanics::Convergence& so_far) {
        section_.say_search(so_far);
    };
    implicit::Solver implicit_;
    bool has_learnt_ = false;
};

} // namespace jointcreep::analysis
