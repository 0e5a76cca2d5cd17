// Derivatives of creep of joints (joint/creep.hpp) by a factor, by the formulas with which creep follows tractions.
// Changes are of the first order, per unit of the factor's logarithm.

#pragma once

#include "joint/contact_changes.hpp"
#include "joint/creep.hpp"

namespace jointcreep::joint
{

// What the chains change by.
std::vector<Chain> chain_changes(const CreepingContacts& creeping, Scaled scaled);

class CreepingContactChanges
{
public:
    CreepingContactChanges() = default; // before anything creeps
    // After the constructor of CreepingContacts.
    CreepingContactChanges(const CreepingContacts& creeping, const ContactChanges& contacts);

    // Changes of the creep's begin() and end(). Call both after its begin() and the equilibrium at the step's end, and
    // before its end(). Between the two calls `changes` take the response.
    void begin(const CreepingContacts& creeping, const creep::StepChanges& steps, const Contacts& contacts,
               ContactChanges& changes);
    void end(const CreepingContacts& creeping, const creep::StepChanges& steps, const Contacts& contacts,
             ContactChanges& changes);

private:
    // Springs and their units: stresses as in CreepingContacts::Spring [Pa], and creep displacements [m].
    std::vector<double> reference_, before_, crept_;
};

} // namespace jointcreep::joint
