#include "rock/zone_changes.hpp"

namespace jointcreep::rock
{

namespace
{

// Stress at a stress point by elasticity of stiffness {C11, C12, C33} at the displacements of all gridpoints [Pa].
Vector3d stress_by(const Zones& zones, std::size_t z, std::span<const Vector2d> displacement,
                   const Vector3d& stiffness)
{
    const Vector3d strain = strain_at(zones, z, displacement), &c = stiffness;
    return {c[0] * strain[0] + c[1] * strain[1], c[1] * strain[0] + c[0] * strain[1], c[2] * strain[2]};
}

void add_by_shear_modulus(const Zones& zones, const ZoneChanges& changes, std::size_t z,
                          std::span<const Vector2d> displacement, Vector3d& stress)
{
    if (changes.shear_modulus[z] != 0)
        stress += stress_by(zones, z, displacement, changes.shear_modulus[z] * Vector3d(4. / 3, -2. / 3, 1));
}

// Adds the forces of zones with these stresses [Pa] to the forces on gridpoints [N/m].
void add_forces_of(const Zones& zones, const std::vector<Vector3d>& stress, std::vector<Vector2d>& force)
{
    for (std::size_t z = 0; z < zones.area.size(); ++z) {
        if (!zones.is_present[z])
            continue;
        const Vector3d& s = stress[z];
        for (int i = 0; i < zones.gridpoints_of_zone; ++i) {
            const Vector2d& gradient = zones.gradients(z)[i];
            force[zones.gridpoints(z)[i]] -=
                zones.area[z] * Vector2d(s[0] * gradient.x() + s[2] * gradient.y(),
                                         s[2] * gradient.x() + s[1] * gradient.y());
        }
    }
}

} // namespace

void check_sensitivities(const Zones& /*zones*/, const Scene& scene)
{
    for (const Rock& rock : scene.rocks)
        if (rock.law != RockLaw::elastic)
            throw input_error(
                "sensitivities are those of elastic rock; expected law = \"elastic\" of [[rock]] \"" +
                rock.name + "\"");
}

ZoneChanges changed_by(const Zones& zones, Scaled scaled, const Scene& /*scene*/, const Mesh& /*mesh*/)
{
    const std::size_t n = zones.area.size();
    const std::vector<Vector3d> none(n, Vector3d::Zero());
    ZoneChanges changes{.initial_stress = none, .stress = none, .shear_modulus = std::vector<double>(n, 0.0)};
    if (scaled.quantity == Scaled::horizontal_stress)
        for (std::size_t z = 0; z < n; ++z)
            changes.initial_stress[z].x() = zones.initial_stress[z].x();
    return changes;
}

void add_forces(const Zones& zones, const ZoneChanges& changes, std::vector<Vector2d>& force)
{
    add_forces_of(zones, changes.stress, force);
}

void add_forces_at_fixed_gridpoints(const Zones& zones, const ZoneChanges& changes,
                                    const ZonesState& /*start*/, std::span<const Vector2d> displacement,
                                    std::vector<Vector2d>& force)
{
    std::vector<Vector3d> stresses = changes.initial_stress;
    for (std::size_t z = 0; z < stresses.size(); ++z)
        add_by_shear_modulus(zones, changes, z, displacement, stresses[z]);
    add_forces_of(zones, stresses, force);
}

void take_response(const Zones& zones, const ZonesState& /*start*/, std::span<const Vector2d> displacement,
                   std::span<const Vector2d> displacement_change, ZoneChanges& changes)
{
    for (std::size_t z = 0; z < zones.area.size(); ++z) {
        changes.stress[z].setZero();
        if (!zones.is_present[z])
            continue;
        changes.stress[z] =
            changes.initial_stress[z] + stress_by(zones, z, displacement_change, zones.stiffness[z]);
        add_by_shear_modulus(zones, changes, z, displacement, changes.stress[z]);
    }
}

void start_changes_from_here(const Zones& /*zones*/, std::span<const Vector2d> /*displacement_change*/,
                             ZoneChanges& changes, ZonesState& /*start*/)
{
    changes.initial_stress = changes.stress;
}

} // namespace jointcreep::rock
