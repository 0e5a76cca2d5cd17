// The kinds of force on gridpoints, and the one list of them. A new kind is one more member of ByForce, one line in
// for_each_force, and one word in each of the lists of types below.
//
// A kind has, in its own folder, the functions that are called with it; rock/zones.hpp and joint/contacts.hpp say what
// they do:
//   find_incidence, find_forces_in_team, add_force_on, add_magnitudes_on, reported_forces, add_row_sums, stiffening_of,
//   are_beyond, stored_energy, returned_energy, begin_search, dissipated, yields, hold_yield, is_within_strength,
//   is_finite, pass, state_of, go_back, start_from_here, transfer, record_state, join, remove_at.
// rock/zone_stiffness.hpp and joint/contact_stiffness.hpp have its Tangent, and
//   present, coupled_by, add_stiffness, add_springs, without_zeros; with a constant stiffness constants and
//   add_constant_stiffness, without one add_force_change.
// What it does in a search for equilibrium by tangents is in rock/active_zones.hpp and joint/active_contacts.hpp. What
// creeps of it is in rock/creep.hpp and joint/creep.hpp; its derivatives by factors (check_sensitivities, changed_by,
// take_response, ...) are in rock/zone_changes.hpp, joint/contact_changes.hpp, and for creep in the two
// creep_changes.hpp.

#pragma once

#include "joint/active_contacts.hpp"
#include "joint/contact_stiffness.hpp"
#include "joint/contacts.hpp"
#include "joint/creep.hpp"
#include "joint/creep_changes.hpp"
#include "rock/active_zones.hpp"
#include "rock/creep.hpp"
#include "rock/creep_changes.hpp"
#include "rock/zone_stiffness.hpp"
#include "rock/zones.hpp"

#include <vector>

namespace jointcreep::mechanics
{

// Something of each kind of force.
template <class OfZones, class OfContacts>
struct ByForce {
    OfZones zones{};
    OfContacts contacts{};

    bool operator==(const ByForce&) const = default;
};

// Each kind in turn, always in this order: call(forces.zones, other.zones, ...).
template <class Call, class... Of>
void for_each_force(const Call& call, Of&&... of)
{
    call(of.zones...);
    call(of.contacts...);
}

using Forces = ByForce<rock::Zones, joint::Contacts>;
using ForcesState = ByForce<rock::ZonesState, joint::ContactsState>;
using Tangents = ByForce<std::vector<rock::Tangent>, std::vector<joint::Tangent>>;
using Stiffening = ByForce<std::vector<rock::Stiffening>, std::vector<joint::Stiffening>>;
using ActiveForces = ByForce<rock::ActiveZones, joint::ActiveContacts>;
using CreepingForces = ByForce<rock::CreepingZones, joint::CreepingContacts>;
using Changes = ByForce<rock::ZoneChanges, joint::ContactChanges>;
using CreepChanges = ByForce<rock::CreepingZoneChanges, joint::CreepingContactChanges>;
template <class T>
using OfEachForce = ByForce<T, T>;

} // namespace jointcreep::mechanics
