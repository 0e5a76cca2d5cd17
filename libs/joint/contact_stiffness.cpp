#include "joint/contact_stiffness.hpp"

namespace jointcreep::joint
{

Tangent tangent_of_response(const Contacts& contacts, std::size_t c, const State& start)
{
    const Vector2d by_opening = respond(contacts, c, start, {.spring = {1, 0}}).traction,
                   by_shear = respond(contacts, c, start, {.spring = {0, 1}}).traction;
    return {by_opening.x(), by_shear.y(), by_opening.y(), by_shear.x()};
}

std::vector<Tangent> tangents_of_responses(const Contacts& contacts, const ContactsState& start)
{
    std::vector<Tangent> tangents(contacts.law.size());
    for (const Index c : present(contacts))
        tangents[c] = tangent_of_response(contacts, c, start.state[c]);
    return tangents;
}

std::vector<Tangent> without_zeros(const Contacts& contacts, std::vector<Tangent> tangents, double soft)
{
    for (std::size_t c = 0; c < tangents.size(); ++c) {
        const double normal = k_n(contacts.law[c]), shear = k_s(contacts.law[c]);
        if (tangents[c].normal == 0)
            tangents[c].normal = soft * normal;
        if (tangents[c].shear == 0)
            tangents[c].shear = soft * (shear > 0 ? shear : normal);
    }
    return tangents;
}

Eigen::Matrix2d stiffness_of(const Contacts& contacts, std::size_t c, const Tangent& tangent)
{
    const Vector2d &normal = contacts.normal[c], shear = along(normal);
    return contacts.length[c] *
           (tangent.normal * normal * normal.transpose() + tangent.shear * shear * shear.transpose() +
            tangent.friction * shear * normal.transpose() + tangent.dilation * normal * shear.transpose());
}

Vector2d force_change(const Contacts& contacts, std::size_t c, const Tangent& tangent,
                      const Vector2d& relative_displacement)
{
    const Vector2d &normal = contacts.normal[c], shear = along(normal);
    const Vector2d change =
        tangent.times({normal.dot(relative_displacement), shear.dot(relative_displacement)});
    return contacts.length[c] * (change.x() * normal + change.y() * shear);
}

std::vector<Index> present(const Contacts& contacts)
{
    std::vector<Index> there;
    for (std::size_t c = 0; c < contacts.status.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed)
            there.push_back(static_cast<Index>(c));
    return there;
}

Tangent tangent_of_springs(const Contacts& contacts, std::size_t c, double soft)
{
    const Slopes law = slopes(contacts.law[c], contacts.state[c], contacts.traction[c].x());
    const bool sticks = contacts.status[c] == ContactStatus::stuck && law.k_s > 0;
    return {law.k_n * (contacts.status[c] == ContactStatus::open ? soft : 1.0),
            (law.k_s > 0 ? law.k_s : law.k_n) * (sticks ? 1.0 : soft), 0, 0};
}

} // namespace jointcreep::joint
