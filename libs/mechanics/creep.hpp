// Creep of every kind of force that has it, with any engine: one equilibrium per step, whatever the scheme
// (creep/scheme.hpp).

#pragma once

#include "creep/chains.hpp"
#include "mechanics/assembly.hpp"

namespace jointcreep::mechanics
{

class Creep
{
public:
    // Forces have long been what they are: creep counts from there. Call it right after start_from_here().
    Creep(const Scene& scene, const Network& network, const EquivalentJoints& joints, const Mesh& mesh,
          const Assembly& assembly);

    bool anything_creeps() const;

    // The largest creep::relaxation_rate [1/s]; 0 if nothing creeps.
    double fastest_rate() const;

    // Gives forces the stiffness and offset they act with during a step of `duration` [s] from the present state, in
    // which loads change or not; the caller then finds the equilibrium at its end. May be called again instead of
    // end(), with another duration: nothing has changed that is not the assembly's.
    void begin(double duration, Assembly& assembly, bool loads_change = false);

    // Lets creep follow that equilibrium, and gives forces their own stiffnesses back, with the offset crept so far:
    // tractions and stresses stay what they are. Returns an estimate of the error of the step [m]: how far the creep
    // displacement of any contact, or of a zone over its size, would be off if the force had changed in a straight line
    // (linear force: as fitted).
    double end(Assembly& assembly);

    // Gives them back without a step.
    void cancel(Assembly& assembly);

    // What differs from a new Creep of the same section between steps.
    void transfer(const Transfer& to, Checkpoint& kept);

    CreepScheme scheme() const { return scheme_of_step_; } // of the present step; not automatic
    const CreepingForces& forces() const { return forces_; }

private:
    CreepScheme scheme_ = CreepScheme::automatic; // of the scene
    CreepScheme scheme_of_step_ = CreepScheme::fitted;
    CreepingForces forces_;
};

// The longest stable step of the published scheme, and what sets it.
creep::StepLimit longest_stable_step(const Scene& scene, const Network& network,
                                     const EquivalentJoints& joints);

} // namespace jointcreep::mechanics
