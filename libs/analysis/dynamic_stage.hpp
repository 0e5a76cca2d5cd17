// A stage or a creep step with large displacements: a dynamic analysis until rest.

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

    // A creep step of that duration [s]: adds the creep displacements and finds the next equilibrium. False if blocks slide
    // or there is no equilibrium; then everything is as before. After it, end_creep() returns an estimate of the error [m];
    // then accept_creep() keeps the step, or undo_creep() goes back.
    bool creeps_to_rest(CreepScheme scheme, double duration);
    double end_creep();
    void accept_creep();
    void undo_creep();
    // The same until the time `end` [s], also if blocks slide. Records like a stage. Throws equilibrium_error if there is
    // no equilibrium.
    void creep_and_slide(CreepScheme scheme, double end);

    // Its part of a checkpoint.
    void transfer(const Transfer& to, Checkpoint& kept) { dynamics_.transfer(to, kept.dynamics); }

private:
    bool goes_on();
    void say();
    bool comes_to_rest(double until);
    void pass(Tape& tape);
    [[noreturn]] void give_up(const mechanics::no_equilibrium& error);
    void note_rest();
    void begin_records();
    bool moves_to_rest(double stop, bool is_recorded);
    void begin_creep(CreepScheme scheme, double duration);
    void record();
    void record_energy();
    double energy_error();
    void check_energy();

    Section& section_;
    const Watchers& watchers_;
    large_displacements::Dynamics dynamics_;
    double due_ = 0; // time of the next record [s]
    bool is_creeping_ = false;
    DynamicsState before_creep_; // at the beginning of a creep step
    // The energy balance of this dynamic analysis, at recorded moments [J/m].
    double largest_error_ = 0;
    double largest_energy_ = 0; // of its parts
};

} // namespace jointcreep::analysis
