#include "joint/active_contacts.hpp"

#include <algorithm>

namespace jointcreep::joint
{

namespace
{

constexpr char mended = 100; // more openings than a search can count

// Tangent of a contact that slips by Coulomb's strength. The flow rule leaves k_n k_s / (k_s + k_n tan(phi) tan(psi))
// of the normal stiffness.
Tangent tangent_of_slip(const Slopes& law, bool forward, double soft)
{
    const double dilatant = law.k_n * law.tan_phi * law.tan_psi;
    const double k = law.k_s > 0 && dilatant > 0 ? law.k_n * law.k_s / (law.k_s + dilatant) : law.k_n;
    const double sliding = (1 - soft) * (forward ? -k : k);
    const double tan_psi = law.k_s > 0 ? law.tan_psi : 0;
    const double soft_shear = soft * (law.k_s > 0 ? law.k_s : law.k_n);
    return {k + soft * (law.k_n - k), soft_shear + (1 - soft) * k * law.tan_phi * tan_psi,
            sliding * law.tan_phi, sliding * tan_psi};
}

} // namespace

void ActiveContacts::begin(const Contacts& contacts)
{
    const std::size_t n = contacts.state.size();
    active_.resize(n, Active::stuck);
    breaks_.assign(n, 0);
    is_broken_.assign(n, 0);
    openings_.assign(n, 0);
}

void ActiveContacts::restart(Contacts& contacts, const ContactsState& start) const
{
    contacts.state = start.state;
    for (std::size_t c = 0; c < breaks_.size(); ++c)
        if (breaks_[c])
            contacts.state[c].is_broken = true;
}

ActiveContacts::Active ActiveContacts::active(const Contacts& contacts, std::size_t c)
{
    switch (contacts.status[c]) {
    case ContactStatus::open:
    case ContactStatus::removed:
        return Active::open;
    case ContactStatus::slipping:
        return contacts.traction[c].y() > 0 ? Active::slips_forward : Active::slips_backward;
    case ContactStatus::stuck:
        break;
    }
    return Active::stuck;
}

void ActiveContacts::take(const Contacts& contacts, const ContactsState& start, bool first)
{
    for (std::size_t c = 0; c < active_.size(); ++c) {
        const Active now = active(contacts, c);
        const bool turns_round = (now == Active::slips_forward && active_[c] == Active::slips_backward) ||
                                 (now == Active::slips_backward && active_[c] == Active::slips_forward);
        const bool breaks = weakens_by_slip(contacts.law[c])
                                ? contacts.state[c].is_broken && !is_broken_[c]
                                : now == Active::open && active_[c] != Active::open;
        if (!first && breaks && !start.state[c].is_broken && !breaks_[c] && ++openings_[c] >= 2)
            breaks_[c] = 1;
        active_[c] = turns_round && !first ? Active::stuck : now;
        is_broken_[c] = contacts.state[c].is_broken;
    }
}

Tangent ActiveContacts::tangent(const Contacts& contacts, std::size_t c, const State& start,
                                double soft) const
{
    const Slopes law = slopes(contacts.law[c], contacts.state[c], contacts.traction[c].x());
    const double soft_shear = soft * (law.k_s > 0 ? law.k_s : law.k_n); // a smooth joint has no shear spring
    const bool slips = contacts.status[c] == ContactStatus::slipping;
    if (remembers(contacts.law[c]) && active_[c] != Active::open && slips == (active_[c] != Active::stuck)) {
        const double kept = slips ? soft : 0;
        const Tangent found = tangent_of_response(contacts, c, start);
        return {found.normal + kept * (law.k_n - found.normal),
                law.k_s > 0 ? found.shear + kept * (law.k_s - found.shear) : soft_shear,
                (1 - kept) * found.friction, (1 - kept) * found.dilation};
    }
    switch (active_[c]) {
    case Active::open:
        return {soft * law.k_n, soft_shear, 0, 0};
    case Active::stuck:
        return {law.k_n, law.k_s > 0 ? law.k_s : soft_shear, 0, 0};
    case Active::slips_forward:
    case Active::slips_backward:
        break;
    }
    return tangent_of_slip(law, active_[c] == Active::slips_forward, soft);
}

std::vector<Tangent> ActiveContacts::tangents(const Contacts& contacts,
                                              std::span<const Vector2d> /*displacement*/,
                                              const ContactsState& start, double soft) const
{
    std::vector<Tangent> all(active_.size());
    for (std::size_t c = 0; c < all.size(); ++c)
        all[c] = tangent(contacts, c, start.state[c], soft);
    return all;
}

double ActiveContacts::largest_force_change(const Contacts& contacts, const ContactsState& start,
                                            std::span<const Vector2d> displacement) const
{
    double largest = 0;
    for (std::size_t c = 0; c < active_.size(); ++c) {
        const auto& [a, b] = contacts.gridpoint[c];
        const Tangent acting = tangent(contacts, c, start.state[c], 0);
        largest =
            std::max(largest, force_change(contacts, c, acting, displacement[b] - displacement[a]).norm());
    }
    return largest;
}

bool ActiveContacts::break_bonds(const Contacts& contacts, const ContactsState& start)
{
    bool breaks = false;
    for (std::size_t c = 0; c < breaks_.size(); ++c) {
        const Law& law = contacts.law[c];
        const bool is_open = contacts.status[c] == ContactStatus::open;
        const bool changes = weakens_by_slip(law) ? contacts.state[c].is_broken != (is_broken_[c] != 0)
                                                  : is_open != (active_[c] == Active::open) &&
                                                        (cohesion(law) > 0 || tensile_strength(law) > 0);
        if (contacts.status[c] != ContactStatus::removed && changes && !breaks_[c] &&
            !start.state[c].is_broken) {
            breaks_[c] = 1;
            breaks = true;
        }
    }
    return breaks;
}

bool ActiveContacts::mend_bonds(const Contacts& contacts)
{
    bool changes = false;
    for (std::size_t c = 0; c < breaks_.size(); ++c)
        if (breaks_[c] && openings_[c] < mended && contacts.status[c] != ContactStatus::open) {
            breaks_[c] = 0;
            openings_[c] = mended; // the next opening is the last
            changes = changes || contacts.status[c] == ContactStatus::slipping;
        }
    return changes;
}

} // namespace jointcreep::joint
