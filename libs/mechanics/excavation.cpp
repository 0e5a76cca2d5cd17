#include "mechanics/excavation.hpp"

#include <algorithm>

namespace jointcreep::mechanics
{
namespace
{

// 1 for an edge beside rock of the stage, else 0.
std::vector<char> edges_that_lose_a_side(const Blocks& blocks, Index stage)
{
    std::vector<char> found;
    for (const auto& sides : blocks.edge_block)
        found.push_back(std::ranges::any_of(
            sides, [&](Index block) { return block >= 0 && blocks.block_stage[block] == stage; }));
    return found;
}

} // namespace

std::vector<Vector2d> excavate(Assembly& assembly, const Blocks& blocks, const Mesh& mesh,
                               const Loading& loading, Index stage)
{
    find_forces(assembly);
    std::vector<Vector2d> released = assembly.force;
    const rock::Zones& zones = assembly.zones;
    std::vector<char> is_removed(zones.size(), 0); // stress points
    for (std::size_t z = 0; z < zones.size(); ++z)
        is_removed[z] =
            zones.is_present[z] && blocks.block_stage[mesh.zone_block[zones.zone_of(z)]] == stage ? 1 : 0;
    const std::size_t gridpoints = assembly.position.size();
    const std::vector<Vector2d> was_fixed = loading.fixed(gridpoints, zones.is_present);
    rock::excavate(assembly.zones, is_removed, assembly.load);
    const std::vector<Vector2d> fixed = loading.fixed(gridpoints, zones.is_present);

    std::vector<char> is_gone(gridpoints, 0); // those of the ground never had rock
    for (std::size_t g = 0; g < gridpoints; ++g)
        if (rock::has_lost_rock(zones, static_cast<Index>(g))) {
            is_gone[g] = 1;
            assembly.load[g].setZero();
            assembly.is_free_untied[g].setZero();
        } else
            assembly.is_free_untied[g] += was_fixed[g] - fixed[g]; // with the last rock on its boundary
    const std::vector<char> lost_a_side = edges_that_lose_a_side(blocks, stage);
    for_each_force([&](auto& one) { remove_at(one, lost_a_side); }, assembly);
    const std::vector<Vector2d> was_free = assembly.is_free, was_along = assembly.along;
    part_ties(assembly, stage);
    loading.leave_removed(assembly);
    find_forces(assembly);
    for (std::size_t g = 0; g < released.size(); ++g) {
        if (is_gone[g]) {
            released[g].setZero();
            continue;
        }
        // Where the tie to a fixed gridpoint ends, or a boundary, this force was in balance with the boundary.
        released[g] = (assembly.is_free[g].array() > was_free[g].array()).select(0, released[g]);
        if (!was_along.empty() && was_along[g] != assembly.along[g])
            released[g] = was_along[g].dot(released[g]) * was_along[g];
        released[g] -= assembly.force[g];
    }
    return released;
}

} // namespace jointcreep::mechanics
