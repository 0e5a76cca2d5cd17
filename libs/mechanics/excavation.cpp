#include "mechanics/excavation.hpp"

namespace jointcreep::mechanics
{

std::vector<Vector2d> excavate(Assembly& assembly, const Blocks& blocks, const Mesh& mesh, Index stage)
{
    find_forces(assembly);
    Zones& zones = assembly.zones;
    Contacts& contacts = assembly.contacts;
    std::vector<Vector2d> released(assembly.position.size(), Vector2d::Zero());
    for (std::size_t z = 0; z < zones.gridpoint.size(); ++z) {
        if (!zones.is_present[z] || blocks.block_stage[mesh.zone_block[z]] != stage)
            continue;
        for (int i = 0; i < 3; ++i) {
            const Vector2d weight(0, -zones.weight[z] / 3);
            const Index g = zones.gridpoint[z][i];
            released[g] += assembly.zone_force[z][i] + weight;
            assembly.load[g] -= weight;
            assembly.zone_force[z][i].setZero();
        }
        zones.is_present[z] = 0;
        zones.stress[z].setZero();
    }

    const auto is_gone = [&](Index g) {
        const Incidence& incidence = assembly.incidence;
        bool had_zones = false;
        for (Index k = incidence.zone_start[g]; k < incidence.zone_start[g + 1]; ++k) {
            if (zones.is_present[incidence.zone_corner[k] / 3])
                return false;
            had_zones = true;
        }
        return had_zones; // gridpoints of the ground have none, ever
    };
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const auto [a, b] = contacts.gridpoint[c];
        if (!is_gone(a) && !is_gone(b))
            continue;
        released[a] += assembly.contact_force[c];
        released[b] -= assembly.contact_force[c];
        assembly.contact_force[c].setZero();
        contacts.traction[c].setZero();
        contacts.status[c] = ContactStatus::removed;
    }
    for (std::size_t g = 0; g < assembly.position.size(); ++g)
        if (is_gone(static_cast<Index>(g))) {
            released[g].setZero();
            assembly.load[g].setZero();
            assembly.is_free[g].setZero();
        }
    return released;
}

} // namespace jointcreep::mechanics
