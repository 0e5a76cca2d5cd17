#include "joint/contact_changes.hpp"

#include "model/error.hpp"
#include "model/signs.hpp"

#include <string>

namespace jointcreep::joint
{

namespace
{

// Displacement of b minus that of a.
Vector2d apart(const Contacts& contacts, std::span<const Vector2d> displacement, std::size_t c)
{
    const auto [a, b] = contacts.gridpoint[c];
    return displacement[b] - displacement[a];
}

// `spring`: change of the stretch of its springs [m].
ContactResponse response(const Contacts& contacts, const ContactChanges& changes, const State& start,
                         const Vector2d& spring, std::size_t c)
{
    return respond(contacts, c, start,
                   {changes.stiffness[c], changes.initial_traction[c], spring, changes.slip[c],
                    changes.dilation[c], changes.memory[c]});
}

// Adds the forces of contacts with these tractions {normal, shear} [Pa] to the forces on gridpoints [N/m].
void add_forces_of(const Contacts& contacts, const std::vector<Vector2d>& traction,
                   std::vector<Vector2d>& force)
{
    for (std::size_t c = 0; c < contacts.length.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const Vector2d &normal = contacts.normal[c],
                       on_a =
                           contacts.length[c] * (traction[c].x() * normal + traction[c].y() * along(normal));
        force[contacts.gridpoint[c][0]] += on_a;
        force[contacts.gridpoint[c][1]] -= on_a;
    }
}

} // namespace

void check_sensitivities(const Contacts& contacts, const Scene& /*scene*/)
{
    for (const Law& law : contacts.law)
        if (const LawInfo& info = laws()[law.index()]; !info.no_sensitivities.empty()) {
            const std::string joints = std::string(info.name) + " joints";
            throw input_error("no sensitivities of " + joints + ": " + std::string(info.no_sensitivities) +
                              "; expected a scene without " + joints);
        }
}

ContactChanges changed_by(const Contacts& contacts, Scaled scaled, const Scene& scene, const Mesh& mesh)
{
    const std::size_t n = contacts.law.size();
    const std::vector<Vector2d> none(n, Vector2d::Zero());
    ContactChanges changes{.stiffness = none,
                           .initial_traction = none,
                           .traction = none,
                           .offset = none,
                           .slip = std::vector<double>(n, 0.0),
                           .dilation = std::vector<double>(n, 0.0),
                           .memory = std::vector<std::array<double, 3>>(n)};
    for (std::size_t c = 0; c < n; ++c) {
        const Index material = contacts.material.empty() ? 0 : contacts.material[c];
        if (scaled.quantity == Scaled::joint_stiffness)
            changes.stiffness[c] = {scaled.is_of(0, material) ? k_n(contacts.law[c]) : 0.0,
                                    scaled.is_of(1, material) ? k_s(contacts.law[c]) : 0.0};
        if (scaled.quantity == Scaled::horizontal_stress) {
            const double sigma_xx = scene.in_situ_stress.at(mesh.contact_centre[c]).x();
            const Vector2d &normal = contacts.normal[c], tangent = along(normal);
            changes.initial_traction[c] = sigma_xx * normal.x() * Vector2d(normal.x(), tangent.x());
        }
    }
    return changes;
}

void take_response(const Contacts& contacts, const ContactsState& start,
                   std::span<const Vector2d> /*displacement*/, std::span<const Vector2d> displacement_change,
                   ContactChanges& changes)
{
    for (std::size_t c = 0; c < contacts.law.size(); ++c) {
        const Vector2d &normal = contacts.normal[c], moved = apart(contacts, displacement_change, c);
        const Vector2d spring = -changes.offset[c] + Vector2d(normal.dot(moved), along(normal).dot(moved));
        const ContactResponse found = response(contacts, changes, start.state[c], spring, c);
        changes.traction[c] = found.traction;
        changes.slip[c] = found.slip;
        changes.dilation[c] = found.dilation;
        changes.memory[c] = found.memory;
    }
}

void add_forces(const Contacts& contacts, const ContactChanges& changes, std::vector<Vector2d>& force)
{
    add_forces_of(contacts, changes.traction, force);
}

void add_forces_at_fixed_gridpoints(const Contacts& contacts, const ContactChanges& changes,
                                    const ContactsState& start, std::span<const Vector2d> /*displacement*/,
                                    std::vector<Vector2d>& force)
{
    std::vector<Vector2d> tractions;
    for (std::size_t c = 0; c < contacts.law.size(); ++c)
        tractions.push_back(response(contacts, changes, start.state[c], -changes.offset[c], c).traction);
    add_forces_of(contacts, tractions, force);
}

void start_changes_from_here(const Contacts& contacts, std::span<const Vector2d> displacement_change,
                             ContactChanges& changes, ContactsState& start)
{
    for (std::size_t c = 0; c < contacts.law.size(); ++c) {
        const Law& law = contacts.law[c];
        const Dual sigma_0(contacts.initial_traction[c].x(), changes.initial_traction[c].x()),
            u(contacts.relative_displacement[c].x() - contacts.offset[c].x() - contacts.state[c].dilation,
              contacts.normal[c].dot(apart(contacts, displacement_change, c)) - changes.offset[c].x() -
                  changes.dilation[c]);
        const double normal = with_derivatives(
            law, Dual(k_n(law), changes.stiffness[c].x()), Dual(k_s(law), changes.stiffness[c].y()),
            [&](const auto& one) { return normal_traction(one, sigma_0, u).slope; });
        changes.initial_traction[c] = {normal, changes.traction[c].y()};
        changes.slip[c] = changes.dilation[c] = 0;
    }
    forget_slip(start.state);
}

double change_of_opening(const Contacts& contacts, const ContactChanges& changes,
                         std::span<const Vector2d> displacement, std::size_t c)
{
    const Law& law = contacts.law[c];
    const double at_start =
        with_derivatives(law, Dual(k_n(law), changes.stiffness[c].x()), Dual(k_s(law)), [&](const auto& one) {
            return opening(one, Dual(contacts.initial_traction[c].x(), changes.initial_traction[c].x()))
                .slope;
        });
    return at_start + contacts.normal[c].dot(apart(contacts, displacement, c)) - changes.offset[c].x() -
           changes.dilation[c];
}

} // namespace jointcreep::joint
