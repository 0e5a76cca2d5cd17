// Creep of joints. In each direction of a contact what creeps is in series with the spring. During a step the spring
// acts with a lower stiffness K_t and from an offset o that are known beforehand, such that the traction F of the
// equilibrium at the step's end is
//     F = F_init + K (u - slip - d) = F_init + K_t (u - slip - o),     d = o + C (F - F_init),
// with d the creep displacement at the end and 1 / K_t = 1 / K + C. Slip and opening follow from the contact's own
// law; where it is open F is 0, and what creeps continues to relax.

#pragma once

#include "creep/chains.hpp"
#include "joint/contacts.hpp"

namespace jointcreep::joint
{

class CreepingContacts
{
public:
    CreepingContacts() = default;
    // Contacts have long crept under their present tractions: creep counts from there. Call it right after
    // start_from_here().
    CreepingContacts(const Contacts& contacts, const Scene& scene, const Network& network,
                     const EquivalentJoints& joints, const Mesh& mesh);

    // The longest stable step of the published scheme on all edges.
    static creep::StepLimit longest_stable_step(const Scene& scene, const Network& network,
                                                const EquivalentJoints& joints);

    bool creeps() const { return !springs_.empty(); }

    // As those of mechanics::Creep.
    void begin(Contacts& contacts, CreepScheme scheme, double duration);
    double end(Contacts& contacts);
    void cancel(Contacts& contacts);
    void transfer(const Transfer& to, Checkpoint& kept);

    // One direction of a contact.
    struct Spring {
        Index contact;
        int direction;          // 0 normal, 1 shear
        Index chain;            // into chains()
        std::size_t first_unit; // into crept()
        double reference;       // traction from which creep counts [Pa]
        double before = 0;      // traction since then, at the step's start [Pa]
        double offset = 0;      // during the step [m]
    };
    const std::vector<Chain>& chains() const { return chains_; } // each once
    const std::vector<Spring>& springs() const { return springs_; }
    const std::vector<double>& crept() const { return crept_; } // displacement of every unit [m]

private:
    static void set(Contacts& contacts, const Spring& spring, double stiffness, double offset);
    double crept(const Spring& spring) const;

    std::vector<Chain> chains_;
    std::vector<creep::StepWeights> steps_; // of the chains
    std::vector<Spring> springs_;
    std::vector<double> crept_;
    bool is_under_way_ = false;
};

} // namespace jointcreep::joint
