// Elastic rock in plane strain: its stiffness, and the deviatoric part of its stress. Stresses are {xx, yy, xy}; the
// deviatoric strains here are, too, with half of gamma_xy.

#pragma once

#include "model/chain.hpp"
#include "model/scene.hpp"

#include <Eigen/Core>

namespace jointcreep::rock
{

// Stress over strain {C11, C12, C33} [Pa].
using Elasticity = Eigen::Vector3d;

inline Elasticity elasticity_of(const Rock& rock)
{
    const double E = rock.youngs_modulus, nu = rock.poissons_ratio;
    const double factor = E / ((1 + nu) * (1 - 2 * nu));
    return {factor * (1 - nu), factor * nu, E / (2 * (1 + nu))};
}

// From bulk and shear modulus [Pa].
inline Elasticity elasticity_of(double bulk_modulus, double shear_modulus)
{
    return {bulk_modulus + shear_modulus * 4 / 3, bulk_modulus - shear_modulus * 2 / 3, shear_modulus};
}

inline double bulk_modulus(const Elasticity& c) // [Pa]
{
    return (c[0] + 2 * c[1]) / 3;
}

// Deviatoric stress over deviatoric strain [Pa].
inline double twice_shear_modulus(const Rock& rock)
{
    return rock.youngs_modulus / (1 + rock.poissons_ratio);
}

// Deviatoric stress is 2 G times the strain that has not crept.
inline Chain chain_of(const Rock& rock)
{
    Chain chain{twice_shear_modulus(rock), {}};
    if (rock.kelvin)
        chain.units.push_back({2 * rock.kelvin->modulus, 2 * rock.kelvin->viscosity});
    if (rock.maxwell_viscosity)
        chain.units.push_back({0, 2 * *rock.maxwell_viscosity});
    return chain;
}

// The deviatoric part of a change of stress [Pa], during which the deviatoric strain `offset` has crept [-]. Plane
// strain leaves the stress across the section to be found: with t the volume strain,
// sxx + syy = 2 (B + G / 3) t - 2 G (offset_xx + offset_yy).
inline Eigen::Vector3d deviatoric(double bulk_modulus, double shear_modulus, const Eigen::Vector3d& offset,
                                  const Eigen::Vector3d& change)
{
    const double volume_strain = (change[0] + change[1] + 2 * shear_modulus * (offset[0] + offset[1])) /
                                 (2 * (bulk_modulus + shear_modulus / 3));
    const double mean = bulk_modulus * volume_strain;
    return {change[0] - mean, change[1] - mean, change[2]};
}

// Its change with the shear modulus, the offset and the stress `now`.
inline Eigen::Vector3d change_of_deviatoric(double bulk_modulus, double modulus, double modulus_change,
                                            const Eigen::Vector3d& offset,
                                            const Eigen::Vector3d& offset_change, const Eigen::Vector3d& now,
                                            const Eigen::Vector3d& now_change)
{
    // The derivative by the modulus is the mean stress, B t.
    const double mean = now[0] - deviatoric(bulk_modulus, modulus, offset, now)[0];
    const double mean_change =
        (bulk_modulus * (offset[0] + offset[1]) - mean / 3) / (bulk_modulus + modulus / 3) * modulus_change;
    return deviatoric(bulk_modulus, modulus, offset_change, now_change) -
           Eigen::Vector3d(mean_change, mean_change, 0);
}

} // namespace jointcreep::rock
