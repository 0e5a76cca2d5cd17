// A stage with large displacements: a dynamic analysis until rest.

#pragma once

#include "analysis/section.hpp"
#include "analysis/watcher.hpp"
#include "large_displacements/dynamics.hpp"

namespace jointcreep::analysis
{

class DynamicStage
{
public:
    // To be made after the in-situ equilibrium.
    DynamicStage(Section& section, const Watchers& watchers);

    // In situ: contacts between faces differ a little from those between gridpoints, so their equilibrium is found
    // first. Displacements count from there.
    void settle_in_situ();

    // After a stage's rock is removed: the dynamic analysis until equilibrium, recorded every so many seconds, with
    // a row and a state at equilibrium. That of the last stage ends at the time that the scene asks for, too. Throws
    // equilibrium_error where there is no equilibrium; the result has the last state.
    void run(bool is_last);

    // What a checkpoint keeps of it.
    void transfer(const Transfer& to, Checkpoint& kept) { dynamics_.transfer(to, kept.dynamics); }

private:
    bool goes_on();
    void say();
    bool comes_to_rest(double until);
    void pass(Tape& tape);
    [[noreturn]] void give_up(const mechanics::no_equilibrium& error);
    void note_rest();
    void record();
    void record_energy();
    void check_energy();

    Section& section_;
    const Watchers& watchers_;
    large_displacements::Dynamics dynamics_;
    double due_ = 0; // time of the next record [s]
    // The energy balance of this dynamic analysis, at recorded moments [J/m].
    double largest_error_ = 0;
    double largest_energy_ = 0; // of its parts
};

} // namespace jointcreep::analysis
