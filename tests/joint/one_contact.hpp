// A single contact, pulled about by hand.

#pragma once

#include "joint/contacts.hpp"
#include "model/signs.hpp"

namespace jointcreep::test
{

using joint::Contacts;

// A contact of 2.5 m of gridpoint 0 on side a with gridpoint 1 on side b.
inline Contacts contact(const joint::Law& law, const Eigen::Vector2d& normal = {0, 1},
                        const Eigen::Vector2d& initial = {0, 0})
{
    Contacts one;
    one.gridpoint = {{0, 1}};
    one.normal = {normal};
    one.length = {2.5};
    one.law = {law};
    one.state = {joint::State{}};
    one.initial_traction = one.traction = {initial};
    one.offset = one.relative_displacement = {Eigen::Vector2d(0, 0)};
    one.status = {ContactStatus::stuck};
    one.work = {0};
    find_incidence(one, 2);
    begin_search(one, false);
    return one;
}

// Displacements of its gridpoints where side b has moved by {normal, shear} beside side a [m].
inline std::vector<Eigen::Vector2d> parted(const Contacts& contacts, const Eigen::Vector2d& by)
{
    const Eigen::Vector2d a(0.3, -0.2), normal = contacts.normal[0];
    return {a, a + by.x() * normal + by.y() * along(normal)};
}
// Its forces there.
inline void part(Contacts& contacts, const Eigen::Vector2d& by, double damping = 0)
{
    find_forces_in_team(contacts, parted(contacts, by), damping, false);
}

} // namespace jointcreep::test
