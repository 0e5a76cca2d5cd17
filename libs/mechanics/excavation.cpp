#include "mechanics/excavation.hpp"

namespace jointcreep::mechanics
{

std::vector<Vector2d> excavate(Assembly& assembly, const Blocks& blocks, const Mesh& mesh,
                               const Loading& loading, Index stage)
{
    find_forces(assembly);
    std::vector<Vector2d> released = assembly.force;
    rock::Zones& zones = assembly.zones;
    joint::Contacts& contacts = assembly.contacts;
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (!zones.is_present[z] || blocks.block_stage[mesh.zone_block[zones.zone_of(z)]] != stage)
            continue;
        rock::add_weight(zones, z, -1, assembly.load);
        zones.is_present[z] = 0;
        zones.stress[z].setZero();
    }

    const auto has_no_rock = [&](Index g) {
        const Incidence& incidence = assembly.incidence;
        bool had_zones = false;
        for (Index k = incidence.zone_start[g]; k < incidence.zone_start[g + 1]; ++k) {
            if (zones.is_present[incidence.zone_corner[k] / zones.gridpoints_of_zone])
                return false;
            had_zones = true;
        }
        return had_zones; // gridpoints of the ground never have any
    };
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        const auto [a, b] = contacts.gridpoint[c];
        if (contacts.status[c] == ContactStatus::removed || (!has_no_rock(a) && !has_no_rock(b)))
            continue;
        contacts.force[c].setZero();
        contacts.traction[c].setZero();
        contacts.status[c] = ContactStatus::removed;
    }
    for (std::size_t g = 0; g < assembly.position.size(); ++g)
        if (has_no_rock(static_cast<Index>(g))) {
            assembly.load[g].setZero();
            assembly.is_free_untied[g].setZero();
        }
    const std::vector<Vector2d> was_free = assembly.is_free;
    part_ties(assembly, stage);
    loading.leave_removed(assembly);
    find_forces(assembly);
    for (std::size_t g = 0; g < released.size(); ++g) {
        if (has_no_rock(static_cast<Index>(g))) {
            released[g].setZero();
            continue;
        }
        // Where the tie to a fixed gridpoint ends, this force was in balance with the boundary.
        released[g] = (assembly.is_free[g].array() > was_free[g].array()).select(0, released[g]);
        released[g] -= assembly.force[g];
    }
    return released;
}

} // namespace jointcreep::mechanics
