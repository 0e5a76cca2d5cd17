// Creep of rock. It creeps in shear only, the volume stays elastic: as joints do (joint/creep.hpp), with deviatoric
// stress and strain in place of traction and displacement, and 2 G in place of K.

#pragma once

#include "creep/chains.hpp"
#include "rock/zones.hpp"

namespace jointcreep::rock
{

class CreepingZones
{
public:
    CreepingZones() = default;
    // Zones have long crept under their present stresses: creep counts from there. Call it right after
    // start_from_here().
    CreepingZones(const Zones& zones, const Scene& scene, const Network& network,
                  const EquivalentJoints& joints, const Mesh& mesh);

    // The longest stable step of the published scheme in all rocks.
    static creep::StepLimit longest_stable_step(const Scene& scene, const Network& network,
                                                const EquivalentJoints& joints);

    bool creeps() const { return !shears_.empty(); }

    // As those of mechanics::Creep.
    void begin(Zones& zones, CreepScheme scheme, double duration);
    double end(Zones& zones);
    void cancel(Zones& zones);
    void transfer(const Transfer& to, Checkpoint& kept);

    // A stress point; tensors are deviatoric, {xx, yy, xy}.
    struct Shear {
        Index zone;
        Index chain;              // into chains()
        std::size_t first_unit;   // into crept()
        double bulk_modulus;      // [Pa]
        Vector3d reference;       // stress at zero displacement from which creep counts, not deviatoric
        Vector3d before{0, 0, 0}; // deviatoric stress since then, at the step's start [Pa]
        Vector3d offset{0, 0, 0}; // strain during the step [-]
    };
    const std::vector<Chain>& chains() const { return chains_; } // each once
    const std::vector<Shear>& shears() const { return shears_; }
    const std::vector<Vector3d>& crept() const { return crept_; } // strain of every unit [-]

private:
    static void set(Zones& zones, const Shear& shear, double shear_modulus, const Vector3d& offset);
    Vector3d crept(const Shear& shear) const;

    std::vector<Chain> chains_;
    std::vector<creep::StepWeights> steps_; // of the chains
    std::vector<Shear> shears_;
    std::vector<Vector3d> crept_;
    bool is_under_way_ = false;
};

} // namespace jointcreep::rock
