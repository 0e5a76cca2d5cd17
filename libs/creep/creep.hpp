// Creep of joints and rock, with any engine: one equilibrium per step, whatever the scheme (creep/scheme.hpp).
//
// What creeps sits in series with the springs of contacts, and with the shear stiffness of zones. During a
// step both ends of it are taken into account at once: the springs act with a lower stiffness K_t and from an
// offset o that are known beforehand, such that the traction F of the equilibrium at the step's end is
//     F = F_init + K (u - slip - d) = F_init + K_t (u - slip - o),     d = o + C (F - F_init),
// with d the creep displacement at the end and 1 / K_t = 1 / K + C. Slip and opening follow from the
// contact's own law; where it is open F is 0, and what creeps continues to relax. Rock creeps in shear only:
// deviatoric stress and strain in place of traction and displacement, 2 G in place of K, the volume elastic.

#pragma once

#include "creep/scheme.hpp"
#include "mechanics/assembly.hpp"

namespace jointcreep::creep
{

class Creep
{
public:
    // Contacts and zones have long crept under their present tractions and stresses: creep counts from there.
    // To be called right after start_from_here().
    Creep(const Scene& scene, const Network& network, const EquivalentJoints& joints, const Mesh& mesh,
          const mechanics::Assembly& assembly);

    bool anything_creeps() const { return !springs_.empty() || !shears_.empty(); }

    // The largest relaxation_rate [1/s]; 0 if nothing creeps.
    double fastest_rate() const;

    // Gives contacts and zones the stiffness and offset they act with during a step of `duration` [s] from
    // the present state, in which loads change or not; the caller then finds the equilibrium at its end. May be called
    // again instead of end(), with another duration: nothing has changed that is not the assembly's.
    void begin(double duration, mechanics::Assembly& assembly, bool loads_change = false);

    // Lets creep follow the tractions and stresses of that equilibrium, and gives contacts and zones their
    // own stiffnesses back, with the offset crept so far: tractions and stresses stay what they are. Returns
    // an estimate of the error of the step [m]: how far the creep displacement of any contact, or of a zone
    // over its size, would be off if the force had changed in a straight line (linear force: as fitted).
    double end(mechanics::Assembly& assembly);

    // Gives them back without a step.
    void cancel(mechanics::Assembly& assembly);

    // What differs from a new Creep of the same section between steps.
    void transfer(const Transfer& to, Checkpoint& kept);

    using Vector3d = Eigen::Vector3d;

    // One direction of a contact.
    struct Spring {
        Index contact;
        int direction;          // 0 normal, 1 shear
        Index chain;            // into chains_
        std::size_t first_unit; // into crept_
        double reference;       // traction from which creep counts [Pa]
        double before = 0;      // traction since then, at the step's start [Pa]
        double offset = 0;      // during the step [m]
    };
    // A zone; tensors are deviatoric, {xx, yy, xy}.
    struct Shear {
        Index zone;
        Index chain;
        std::size_t first_unit;   // into crept_strain_
        double bulk_modulus;      // [Pa]
        Vector3d reference;       // stress at zero displacement from which creep counts, not deviatoric
        Vector3d before{0, 0, 0}; // deviatoric stress since then, at the step's start [Pa]
        Vector3d offset{0, 0, 0}; // strain during the step [-]
    };

    // For sensitivities.
    CreepScheme scheme() const { return scheme_of_step_; } // of the present step; not automatic
    const std::vector<Chain>& chains() const { return chains_; }
    const std::vector<Spring>& springs() const { return springs_; }
    const std::vector<Shear>& shears() const { return shears_; }
    const std::vector<double>& crept_displacement() const { return crept_; }
    const std::vector<Vector3d>& crept_strain() const { return crept_strain_; }

private:
    Index number_of(const Chain& chain); // among chains_
    static void set(mechanics::Assembly& assembly, const Spring& spring, double stiffness, double offset);
    static void set(mechanics::Assembly& assembly, const Shear& shear, double shear_modulus,
                    const Vector3d& offset);
    double crept(const Spring& spring) const;
    Vector3d crept(const Shear& shear) const;

    CreepScheme scheme_ = CreepScheme::automatic; // of the scene
    CreepScheme scheme_of_step_ = CreepScheme::fitted;
    std::vector<Chain> chains_;      // each once
    std::vector<StepWeights> steps_; // of the chains
    std::vector<Spring> springs_;
    std::vector<Shear> shears_;
    std::vector<double> crept_;          // displacement of every unit of springs_ [m]
    std::vector<Vector3d> crept_strain_; // of every unit of shears_
    bool is_under_way_ = false;
};

// The longest stable step [s] of the published scheme, and what sets it: a joint's edge, or a rock. Infinite,
// -1 and -1 if nothing does.
struct StepLimit {
    double step;
    Index edge = -1;
    Index rock = -1; // into Scene::rocks
};
StepLimit longest_step(const EquivalentJoints& joints, const std::vector<Rock>& rocks = {});

} // namespace jointcreep::creep
