#include "creep/creep.hpp"

#include "joint/chain.hpp"
#include "rock/elasticity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace jointcreep::creep
{

namespace
{

// A smooth joint has no shear traction that could creep.
bool creeps(const Chain& chain)
{
    return chain.spring > 0 && !chain.units.empty();
}

// The magnitude of a deviatoric tensor {xx, yy, xy}, its zz being -(xx + yy).
double magnitude(const Eigen::Vector3d& t)
{
    const double zz = t[0] + t[1];
    return std::sqrt(t[0] * t[0] + t[1] * t[1] + zz * zz + 2 * t[2] * t[2]);
}

} // namespace

Creep::Creep(const Scene& scene, const Network& network, const EquivalentJoints& joints, const Mesh& mesh,
             const mechanics::Assembly& assembly)
{
    if (!scene.creep)
        return;
    scheme_ = scene.creep->scheme;
    std::map<Index, std::array<Index, 2>> of_edge; // chains
    std::size_t units = 0;
    for (std::size_t c = 0; c < mesh.contact_edge.size(); ++c) {
        const auto [found, is_new] = of_edge.try_emplace(mesh.contact_edge[c]);
        for (int i = 0; i < 2; ++i) {
            if (is_new)
                found->second[i] = number_of(joint::chain_of(joints, mesh.contact_edge[c], i));
            const Index chain = found->second[i];
            if (chain < 0)
                continue;
            springs_.push_back({static_cast<Index>(c), i, chain, units, assembly.contacts.traction[c][i]});
            units += chains_[chain].units.size();
        }
    }
    crept_.assign(units, 0.0);

    std::vector<Index> of_rock;
    for (const Rock& rock : scene.rocks)
        of_rock.push_back(number_of(rock::chain_of(rock)));
    units = 0;
    for (std::size_t z = 0; z < assembly.zones.size(); ++z) {
        const Index block = mesh.zone_block[assembly.zones.zone_of(z)];
        const Index chain = of_rock[network.blocks.block_rock[block]];
        if (chain < 0)
            continue;
        shears_.push_back({static_cast<Index>(z), chain, units,
                           rock::bulk_modulus(assembly.zones.stiffness[z]),
                           assembly.zones.initial_stress[z]});
        units += chains_[chain].units.size();
    }
    crept_strain_.assign(units, Vector3d::Zero());
}

Index Creep::number_of(const Chain& chain)
{
    if (!creeps(chain))
        return -1;
    const auto found = std::find(chains_.begin(), chains_.end(), chain);
    const auto number = static_cast<Index>(found - chains_.begin());
    if (found == chains_.end())
        chains_.push_back(chain);
    return number;
}

double Creep::fastest_rate() const
{
    double fastest = 0;
    for (const Chain& chain : chains_)
        fastest = std::max(fastest, relaxation_rate(chain));
    return fastest;
}

void Creep::set(mechanics::Assembly& assembly, const Spring& spring, double stiffness, double offset)
{
    joint::Law& law = assembly.contacts.law[spring.contact];
    (spring.direction == 0 ? joint::k_n(law) : joint::k_s(law)) = stiffness;
    assembly.contacts.offset[spring.contact][spring.direction] = offset;
}

void Creep::set(mechanics::Assembly& assembly, const Shear& shear, double shear_modulus,
                const Vector3d& offset)
{
    assembly.zones.stiffness[shear.zone] = rock::elasticity_of(shear.bulk_modulus, shear_modulus);
    assembly.zones.initial_stress[shear.zone] = shear.reference - 2 * shear_modulus * offset;
}

double Creep::crept(const Spring& spring) const
{
    double sum = 0;
    for (std::size_t u = 0; u < chains_[spring.chain].units.size(); ++u)
        sum += crept_[spring.first_unit + u];
    return sum;
}

Eigen::Vector3d Creep::crept(const Shear& shear) const
{
    Vector3d sum(0, 0, 0);
    for (std::size_t u = 0; u < chains_[shear.chain].units.size(); ++u)
        sum += crept_strain_[shear.first_unit + u];
    return sum;
}

void Creep::begin(double duration, mechanics::Assembly& assembly, bool loads_change)
{
    scheme_of_step_ = creep::scheme_of_step(scheme_, loads_change);
    steps_.clear();
    for (const Chain& chain : chains_)
        steps_.push_back(step_of(chain, scheme_of_step_, duration));

    const joint::Contacts& contacts = assembly.contacts;
    for (Spring& spring : springs_) {
        if (contacts.status[spring.contact] == ContactStatus::removed)
            continue;
        if (!is_under_way_)
            spring.before = contacts.traction[spring.contact][spring.direction] - spring.reference;
        const StepWeights& step = steps_[spring.chain];
        // Where a contact is open in situ its spring would carry `initial`, not the reference, 0.
        const double initial = contacts.initial_traction[spring.contact][spring.direction];
        spring.offset = step.compliance * (initial - spring.reference);
        for (std::size_t u = 0; u < step.units.size(); ++u)
            spring.offset +=
                step.units[u].decay * crept_[spring.first_unit + u] + step.units[u].first * spring.before;
        set(assembly, spring, step.acting_stiffness, spring.offset);
    }

    for (Shear& shear : shears_) {
        if (!assembly.zones.is_present[shear.zone])
            continue;
        if (!is_under_way_)
            shear.before = rock::deviatoric(shear.bulk_modulus, chains_[shear.chain].spring / 2, crept(shear),
                                            assembly.zones.stress[shear.zone] - shear.reference);
        const StepWeights& step = steps_[shear.chain];
        shear.offset.setZero();
        for (std::size_t u = 0; u < step.units.size(); ++u)
            shear.offset += step.units[u].decay * crept_strain_[shear.first_unit + u] +
                            step.units[u].first * shear.before;
        set(assembly, shear, step.acting_stiffness / 2, shear.offset);
    }
    is_under_way_ = true;
}

double Creep::end(mechanics::Assembly& assembly)
{
    double error = 0;
    const joint::Contacts& contacts = assembly.contacts;
    for (const Spring& spring : springs_) {
        if (contacts.status[spring.contact] == ContactStatus::removed)
            continue;
        const StepWeights& step = steps_[spring.chain];
        const double after = contacts.traction[spring.contact][spring.direction] - spring.reference;
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            double& displacement = crept_[spring.first_unit + u];
            displacement = step.units[u].decay * displacement + step.units[u].first * spring.before +
                           step.units[u].last * after;
        }
        error = std::max(error, step.doubt * std::abs(after - spring.before));
    }
    for (const Shear& shear : shears_) {
        if (!assembly.zones.is_present[shear.zone])
            continue;
        const StepWeights& step = steps_[shear.chain];
        const Vector3d after = rock::deviatoric(shear.bulk_modulus, step.acting_stiffness / 2, shear.offset,
                                                assembly.zones.stress[shear.zone] - shear.reference);
        for (std::size_t u = 0; u < step.units.size(); ++u) {
            Vector3d& strain = crept_strain_[shear.first_unit + u];
            strain = step.units[u].decay * strain + step.units[u].first * shear.before +
                     step.units[u].last * after;
        }
        const double size = std::sqrt(2 * assembly.zones.area[shear.zone]);
        error = std::max(error, step.doubt * magnitude(after - shear.before) * size);
    }
    cancel(assembly);
    return error;
}

void Creep::cancel(mechanics::Assembly& assembly)
{
    for (const Spring& spring : springs_)
        set(assembly, spring, chains_[spring.chain].spring, crept(spring));
    for (const Shear& shear : shears_)
        set(assembly, shear, chains_[shear.chain].spring / 2, crept(shear));
    is_under_way_ = false;
}

void Creep::transfer(const Transfer& to, Checkpoint& kept)
{
    // The scene has the rest, and begin() computes again what else springs and shears need.
    to.values(springs_, kept.reference, &Spring::reference);
    to.values(crept_, kept.crept);
    to.values(shears_, kept.rock_reference, &Shear::reference);
    to.values(crept_strain_, kept.rock_crept);
}

StepLimit longest_step(const EquivalentJoints& joints, const std::vector<Rock>& rocks)
{
    StepLimit limit{std::numeric_limits<double>::infinity()};
    const auto consider = [&limit](const Chain& chain, Index edge, Index rock) {
        if (!creeps(chain) || is_stable(chain, limit.step))
            return;
        if (const double step = longest_stable_step(chain); step < limit.step)
            limit = {step, edge, rock};
    };
    for (std::size_t e = 0; e < joints.normal_stiffness.size(); ++e)
        for (const int direction : {0, 1})
            consider(joint::chain_of(joints, e, direction), static_cast<Index>(e), -1);
    for (std::size_t r = 0; r < rocks.size(); ++r)
        consider(rock::chain_of(rocks[r]), -1, static_cast<Index>(r));
    return limit;
}

} // namespace jointcreep::creep
