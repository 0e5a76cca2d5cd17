// What a factor scales: properties of joints, or the in-situ stress. Back analysis looks for such factors, and
// sensitivities are by their logarithms.

#pragma once

#include "model/statistics.hpp"

namespace jointcreep
{

struct Scaled {
    enum Quantity {
        kelvin_stiffness,  // E
        kelvin_viscosity,  // eta, of Kelvin units and Maxwell dashpots
        joint_stiffness,   // K, with E / K and eta / E kept
        horizontal_stress, // in situ: sigma_xx and its gradient
    };
    static constexpr int both = -1;
    static constexpr Index all = -1;

    Quantity quantity = kelvin_stiffness;
    // Of joints: of which springs.
    int direction = both; // 0 normal, 1 shear
    Index material = all; // into Scene::joint_materials, as EquivalentJoints::material

    constexpr Scaled() = default;
    constexpr Scaled(Quantity of, int in_direction = both, Index of_material = all)
        : quantity(of), direction(in_direction), material(of_material)
    {
    }
    bool is_of(int of_direction, Index of_material) const
    {
        return (direction == both || direction == of_direction) &&
               (material == all || material == of_material);
    }
    bool operator==(const Scaled&) const = default;
};

} // namespace jointcreep
