// What zones do in a search for equilibrium that goes by tangents: straight from their states at the start of the
// search to those at its end. joint/active_contacts.hpp has the same functions; zones have no bonds.

#pragma once

#include "rock/zone_stiffness.hpp"

#include <span>
#include <vector>

namespace jointcreep::rock
{

class ActiveZones
{
public:
    void begin(const Zones&) {}

    // Sets zones that yield to their states at the start.
    void restart(Zones& zones, const ZonesState& start) const
    {
        if (yields(zones))
            go_back(zones, start);
    }

    void take(const Zones&, const ZonesState& /*start*/, bool /*first*/) {}

    // None where rock is elastic: its stiffness is constant.
    std::vector<Tangent> tangents(const Zones& zones, std::span<const Vector2d> displacement,
                                  const ZonesState& start, double /*soft*/) const
    {
        return yields(zones) ? tangents_of(zones, displacement, start) : std::vector<Tangent>();
    }

    // Of contacts only.
    double largest_force_change(const Zones&, const ZonesState& /*start*/,
                                std::span<const Vector2d> /*displacement*/) const
    {
        return 0;
    }

    bool break_bonds(const Zones&, const ZonesState& /*start*/) { return false; }
    bool mend_bonds(const Zones&) { return false; }
    void break_again(const ActiveZones&) {}
};

} // namespace jointcreep::rock
