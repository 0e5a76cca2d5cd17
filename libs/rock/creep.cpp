#include "rock/creep.hpp"

#include "rock/elasticity.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::rock
{

namespace
{

// The magnitude of a deviatoric tensor {xx, yy, xy}, its zz being -(xx + yy).
double magnitude(const Vector3d& t)
{
    const double zz = t[0] + t[1];
    return std::sqrt(t[0] * t[0] + t[1] * t[1] + zz * zz + 2 * t[2] * t[2]);
}

} // namespace

CreepingZones::CreepingZones(const Zones& zones, const Scene& scene, const Network& network,
                             const EquivalentJoints& /*joints*/, const Mesh& mesh)
{
    std::vector<Index> of_rock;
    for (const Rock& rock : scene.rocks)
        of_rock.push_back(creep::number_of(chain_of(rock), chains_));
    std::size_t units = 0;
    for (std::size_t z = 0; z < zones.size(); ++z) {
        const Index block = mesh.zone_block[zones.zone_of(z)];
        const Index chain = of_rock[network.blocks.block_rock[block]];
        if (chain < 0)
            continue;
        shears_.push_back(
            {static_cast<Index>(z), chain, units, bulk_modulus(zones.stiffness[z]), zones.initial_stress[z]});
        units += chains_[chain].units.size();
    }
    crept_.assign(units, Vector3d::Zero());
}

creep::StepLimit CreepingZones::longest_stable_step(const Scene& scene, const Network& /*network*/,
                                                    const EquivalentJoints& /*joints*/)
{
    creep::StepLimit limit;
    for (const Rock& rock : scene.rocks)
        creep::lower(limit, chain_of(rock), [&] { return "rock \"" + rock.name + "\""; });
    return limit;
}

void CreepingZones::set(Zones& zones, const Shear& shear, double shear_modulus, const Vector3d& offset)
{
    zones.stiffness[shear.zone] = elasticity_of(shear.bulk_modulus, shear_modulus);
    zones.initial_stress[shear.zone] = shear.reference - 2 * shear_modulus * offset;
}

Vector3d CreepingZones::crept(const Shear& shear) const
{
    Vector3d sum(0, 0, 0);
    for (std::size_t u = 0; u < chains_[shear.chain].units.size(); ++u)
        sum += crept_[shear.first_unit + u];
    return sum;
}

void CreepingZones::begin(Zones& zones, CreepScheme scheme, double duration)
{
    steps_ = creep::steps_of(chains_, scheme, duration);
    for (Shear& shear : shears_) {
        if (!zones.is_present[shear.zone])
            continue;
        if (!is_under_way_)
            shear.before = deviatoric(shear.bulk_modulus, chains_[shear.chain].spring / 2, crept(shear),
                                      zones.stress[shear.zone] - shear.reference);
        const creep::StepWeights& step = steps_[shear.chain];
        shear.offset.setZero();
        for (std::size_t u = 0; u < step.units.size(); ++u)
            shear.offset +=
                step.units[u].decay * crept_[shear.first_unit + u] + step.units[u].first * shear.before;
        set(zones, shear, step.acting_stiffness / 2, shear.offset);
    }
    is_under_way_ = true;
}

double CreepingZones::end(Zones& zones)
{
    double error = 0;
    for (const Shear& shear : shears_) {
        if (!zones.is_present[shear.zone])
            continue;
        const creep::StepWeights& step = steps_[shear.chain];
        const Vector3d after = deviatoric(shear.bulk_modulus, step.acting_stiffness / 2, shear.offset,
                                          zones.stress[shear.zone] - shear.reference);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            Vector3d& strain = crept_[shear.first_unit + u];
            strain = step.units[u].decay * strain + step.units[u].first * shear.before +
                     step.units[u].last * after;
        }
        const double size = std::sqrt(2 * zones.area[shear.zone]);
        error = std::max(error, step.doubt * magnitude(after - shear.before) * size);
    }
    cancel(zones);
    return error;
}

void CreepingZones::cancel(Zones& zones)
{
    for (const Shear& shear : shears_)
        set(zones, shear, chains_[shear.chain].spring / 2, crept(shear));
    is_under_way_ = false;
}

void CreepingZones::transfer(const Transfer& to, Checkpoint& kept)
{
    // The scene has the rest, and begin() computes again what else shears need.
    to.values(shears_, kept.rock_reference, &Shear::reference);
    to.values(crept_, kept.rock_crept);
}

} // namespace jointcreep::rock
