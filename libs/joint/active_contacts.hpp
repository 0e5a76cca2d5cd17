// The status of each contact during a search of the implicit engine: sticking, slipping forward or backward, or open.
// Each status has its tangent stiffness. rock/active_zones.hpp has the same functions for rock that yields.
//
// Every correction computes contacts from their states at the start of the search (backward Euler). A contact that slips
// forward can slip backward only after a correction in which it sticks. A bond that breaks for the second time in a search
// stays broken until its end, and so does a bond that prevents convergence. (If bonds broke and healed again and again,
// the search might not converge.) After the search, contacts that are closed in equilibrium get their bonds back.

#pragma once

#include "joint/contact_stiffness.hpp"

#include <vector>

namespace jointcreep::joint
{

class ActiveContacts
{
public:
    // Before a search: no bond has broken in it. What contacts did last is kept.
    void begin(const Contacts& contacts);

    // Sets the contacts to their states at the start, but for bonds that have broken in the search.
    void restart(Contacts& contacts, const ContactsState& start) const;

    // Takes over the present status of contacts. Unless this is the `first` time, a contact that reverses its slip sticks
    // first.
    void take(const Contacts& contacts, const ContactsState& start, bool first);

    // Tangents for the status of contacts. Open and slipping contacts keep the share `soft` of their springs. The
    // displacement is not used: contacts have their own.
    std::vector<Tangent> tangents(const Contacts& contacts, std::span<const Vector2d> displacement,
                                  const ContactsState& start, double soft) const;

    // The largest change of a contact's force that these displacements of gridpoints [m] would bring [N/m].
    double largest_force_change(const Contacts& contacts, const ContactsState& start,
                                std::span<const Vector2d> displacement) const;

    // Breaks the bonds of contacts that have opened, closed or weakened since take(). True if any bond breaks.
    bool break_bonds(const Contacts& contacts, const ContactsState& start);

    // Restores the bonds of contacts that opened during the search and are closed now. Their next opening breaks them
    // for good. True if that changes forces.
    bool mend_bonds(const Contacts& contacts);

    // Goes back to the broken bonds of `before`, where mended ones find no equilibrium.
    void break_again(const ActiveContacts& before) { breaks_ = before.breaks_; }

private:
    enum class Active : char { open, stuck, slips_forward, slips_backward };

    static Active active(const Contacts& contacts, std::size_t c);
    Tangent tangent(const Contacts& contacts, std::size_t c, const State& start, double soft) const;

    std::vector<Active> active_;
    std::vector<char> breaks_;    // bonds that have broken in the search
    std::vector<char> openings_;  // how often in it
    std::vector<char> is_broken_; // of the state, at the last take()
};

} // namespace jointcreep::joint
