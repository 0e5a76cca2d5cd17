// Tangents of contacts and their part of a stiffness matrix. They change often: whenever a contact opens, closes,
// sticks or slips.

#pragma once

#include "joint/contacts.hpp"
#include "model/signs.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <span>
#include <vector>

namespace jointcreep::joint
{

// Change of a contact's traction over change of its relative displacement [Pa/m]: {normal over normal, shear
// over shear, shear over normal, normal over shear}.
struct Tangent {
    double normal, shear, friction, dilation;

    bool operator==(const Tangent&) const = default;
    Tangent operator-(const Tangent& other) const
    {
        return {normal - other.normal, shear - other.shear, friction - other.friction,
                dilation - other.dilation};
    }
    // Without what makes the stiffness unsymmetric.
    Tangent symmetric() const { return {normal, shear, 0, 0}; }

    // Change of {normal, shear} traction [Pa] for one of the {normal, shear} relative displacement [m].
    Vector2d times(const Vector2d& relative) const
    {
        return {normal * relative.x() + dilation * relative.y(),
                shear * relative.y() + friction * relative.x()};
    }
};

// The tangent of the response to the present displacement from the state `start`; of all contacts, 0 for those that are
// removed.
Tangent tangent_of_response(const Contacts& contacts, std::size_t c, const State& start);
std::vector<Tangent> tangents_of_responses(const Contacts& contacts, const ContactsState& start);

// The tangents with the share `soft` of the springs wherever they have no stiffness.
std::vector<Tangent> without_zeros(const Contacts& contacts, std::vector<Tangent> tangents, double soft);

// Change of the force on side b by a change of the displacement of b minus that of a [Pa], and the change of that force
// [N/m] by a given one [m].
Eigen::Matrix2d stiffness_of(const Contacts& contacts, std::size_t c, const Tangent& tangent);
Vector2d force_change(const Contacts& contacts, std::size_t c, const Tangent& tangent,
                      const Vector2d& relative_displacement);

// The contacts that are there; each couples its two gridpoints.
std::vector<Index> present(const Contacts& contacts);
inline std::span<const Index> coupled_by(const Contacts& contacts, Index c)
{
    return contacts.gridpoint[c];
}

// Calls add(contact, i, j, block) with the stiffness between sides i and j of each contact that is `there` [Pa].
template <class Add>
void add_stiffness(const Contacts& contacts, const std::vector<Index>& there,
                   const std::vector<Tangent>& tangents, const Add& add)
{
    for (const Index c : there) {
        const Eigen::Matrix2d of_b = stiffness_of(contacts, c, tangents[c]);
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                add(c, i, j, i == j ? of_b : Eigen::Matrix2d(-of_b));
    }
}

// Calls add(side, force) with the change of the contact's force, to be overcome, where its sides move by move(side).
template <class Move, class Add>
void add_force_change(const Contacts& contacts, Index c, const Tangent& tangent, const Move& move,
                      const Add& add)
{
    const Vector2d force = force_change(contacts, c, tangent, move(1) - move(0));
    add(1, force);
    add(0, -force);
}

// The tangent of a contact's springs. An open contact keeps the share `soft` of both; one that slips, and a smooth
// joint, keeps that share of the shear spring.
Tangent tangent_of_springs(const Contacts& contacts, std::size_t c, double soft);

// The same as add_stiffness by these springs. Returns the stiffest one [Pa].
template <class Add>
double add_springs(const Contacts& contacts, double soft, const Add& add)
{
    const std::vector<Index> there = present(contacts);
    std::vector<Tangent> springs(contacts.law.size());
    double stiffest = 0;
    for (const Index c : there) {
        springs[c] = tangent_of_springs(contacts, c, soft);
        stiffest = std::max(stiffest, contacts.length[c] * std::max(springs[c].normal, springs[c].shear));
    }
    add_stiffness(contacts, there, springs, add);
    return stiffest;
}

} // namespace jointcreep::joint
