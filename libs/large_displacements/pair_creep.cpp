// Creep of pairs of faces. What creeps along the normal and in shear is in series with the springs, as in joint/creep.hpp.
// With the pressure p and the closure e by creep of a place on the joint, each positive where it closes,
//     p = K (lead - gap),    the lead less by what e grows.
// During a step the springs have the stiffness 1 / (1 / K + C). The lead is first raised by C p, so that no pressure
// changes. Then what creeps under the pressure at the beginning is taken from it little by little, while rock moves. At
// the end the lead falls by C p again, with the pressure then: again no pressure changes. The same goes for shear, where
// the displacement by creep takes the place of the lead.
//
// Pressure and creep are linear along face a, as the lead is, by their values at the ends of the closed part. Where that
// part is short, they are nearly constant along the face: otherwise they would be far off at its ends.

#include "large_displacements/face_contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

constexpr double short_part = 0.25; // of face a

// The values at the ends of face a of what has these values at the ends of the closed part.
std::array<double, 2> at_ends_of_face(const FacePair& pair, const std::array<double, 2>& value)
{
    const double part = pair.on_a[1] - pair.on_a[0], middle = (pair.on_a[0] + pair.on_a[1]) / 2,
                 mean = (value[0] + value[1]) / 2;
    const double slope =
        (value[1] - value[0]) * (part > short_part ? 1 / part : part / (short_part * short_part));
    return {mean - slope * middle, mean + slope * (1 - middle)};
}

// Pressures at the ends of face a, and the shear traction [Pa].
std::array<double, 3> tractions_of(const FacePair& pair, const joint::Law& law)
{
    if (!pair.is_closed)
        return {};
    const double k_n = joint::k_n(law);
    const auto pressure = at_ends_of_face(pair, {k_n * pair.closing[0], k_n * pair.closing[1]});
    return {pressure[0], pressure[1], pair.tau};
}

constexpr int direction_of(int part) // of PairCreep: 0 normal, 1 shear
{
    return part == 2 ? 1 : 0;
}

bool are_alike(const Chain& one, const Chain& other)
{
    return one.spring == other.spring && one.units == other.units;
}

} // namespace

void FaceContacts::creep_by(std::vector<std::array<Chain, 2>> chains)
{
    chains_ = std::move(chains);
    for (std::array<Chain, 2>& of_law : chains_)
        for (Chain& chain : of_law)
            if (!creep::creeps(chain))
                chain.units.clear();
}

bool FaceContacts::law_creeps(std::size_t law) const
{
    return !chains_.empty() && !(chains_[law][0].units.empty() && chains_[law][1].units.empty());
}

std::size_t FaceContacts::creep_units(std::size_t law) const
{
    return chains_.empty() ? 0 : 2 * chains_[law][0].units.size() + chains_[law][1].units.size();
}

void FaceContacts::count_creep_from_here()
{
    for (FacePair& pair : pairs_)
        if (law_creeps(pair.law))
            pair.creep = {
                tractions_of(pair, laws_[pair.law]), std::vector<double>(creep_units(pair.law)), {}, {}};
}

// A pair that continues another one keeps its creep, if the same creeps. Its faces are others: it has the mean along
// them.
PairCreep FaceContacts::creep_slid_on_to(const FacePair& pair, const FacePair& before) const
{
    if (chains_.empty() || !are_alike(chains_[pair.law][0], chains_[before.law][0]) ||
        !are_alike(chains_[pair.law][1], chains_[before.law][1]))
        return {};
    PairCreep creep = before.creep;
    for (auto* const values : {&creep.reference, &creep.before, &creep.to_come})
        (*values)[0] = (*values)[1] = ((*values)[0] + (*values)[1]) / 2;
    const std::size_t n = chains_[pair.law][0].units.size();
    for (std::size_t u = 0; u < n && !creep.crept.empty(); ++u)
        creep.crept[u] = creep.crept[n + u] = (creep.crept[u] + creep.crept[n + u]) / 2;
    return creep;
}

void FaceContacts::swap_ends(PairCreep& creep, std::size_t law) const
{
    std::swap(creep.reference[0], creep.reference[1]);
    if (creep.crept.empty())
        return;
    const auto second = creep.crept.begin() + static_cast<std::ptrdiff_t>(chains_[law][0].units.size());
    std::swap_ranges(creep.crept.begin(), second, second);
}

Vector2d FaceContacts::crept(const FacePair& pair) const
{
    Vector2d sum(0, 0);
    if (pair.creep.crept.empty())
        return sum;
    const std::size_t n = chains_[pair.law][0].units.size();
    for (std::size_t u = 0; u < pair.creep.crept.size(); ++u)
        if (u < 2 * n)
            sum.x() -= pair.creep.crept[u] / 2;
        else
            sum.y() += pair.creep.crept[u];
    return sum;
}

void FaceContacts::begin_creep(CreepScheme scheme, double duration)
{
    const auto step_of = [&](const Chain& chain) {
        return chain.units.empty() ? creep::StepWeights{{}, 0, chain.spring, 0}
                                   : creep::step_of(chain, scheme, duration);
    };
    steps_.clear();
    for (const auto& [normal, shear] : chains_)
        steps_.push_back({step_of(normal), step_of(shear)});
    for (FacePair& pair : pairs_) {
        if (!pair.is_known || !law_creeps(pair.law))
            continue;
        PairCreep& creep = pair.creep;
        creep.crept.resize(creep_units(pair.law), 0.0);
        creep.before = tractions_of(pair, laws_[pair.law]);
        std::size_t unit = 0;
        for (int part = 0; part < 3; ++part) {
            const creep::StepWeights& step = steps_[pair.law][direction_of(part)];
            const double force = creep.before[part] - creep.reference[part];
            creep.to_come[part] = 0;
            for (const creep::StepWeights::OfUnit& weights : step.units)
                creep.to_come[part] +=
                    (1 - weights.decay) * creep.crept[unit++] - (weights.first + weights.last) * force;
            if (part < 2)
                pair.lead[part] += step.compliance * creep.before[part];
        }
    }
    own_laws_ = laws_;
    for (std::size_t law = 0; law < chains_.size(); ++law)
        for (int direction = 0; direction < 2; ++direction)
            if (!chains_[law][direction].units.empty())
                (direction == 0 ? joint::k_n(laws_[law]) : joint::k_s(laws_[law])) =
                    steps_[law][direction].acting_stiffness;
    crept_share_ = 0;
}

void FaceContacts::creep_to(double share)
{
    const double by = share - std::exchange(crept_share_, share);
    double most = 0;
    for (FacePair& pair : pairs_) {
        if (!pair.is_known)
            continue;
        for (int part = 0; part < 3; ++part)
            pair.creeps[part] = by * pair.creep.to_come[part];
        for (int end = 0; end < 2; ++end) {
            pair.lead[end] += pair.creeps[end];
            most = std::max(most, pair.creeps[end]);
        }
    }
    raised_ += most;
}

double FaceContacts::end_creep()
{
    double error = 0;
    for (FacePair& pair : pairs_) {
        if (!pair.is_known || !law_creeps(pair.law))
            continue;
        PairCreep& creep = pair.creep;
        creep.crept.resize(creep_units(pair.law), 0.0);
        const std::array<double, 3> now = tractions_of(pair, laws_[pair.law]);
        std::size_t unit = 0;
        for (int part = 0; part < 3; ++part) {
            const creep::StepWeights& step = steps_[pair.law][direction_of(part)];
            for (const creep::StepWeights::OfUnit& weights : step.units) {
                double& crept = creep.crept[unit++];
                crept = weights.decay * crept + weights.first * (creep.before[part] - creep.reference[part]) +
                        weights.last * (now[part] - creep.reference[part]);
            }
            if (part < 2)
                pair.lead[part] -= step.compliance * now[part];
            error = std::max(error, step.doubt * std::abs(now[part] - creep.before[part]));
        }
        creep.before = creep.to_come = {};
    }
    leave_creep();
    return error;
}

void FaceContacts::leave_creep()
{
    laws_ = own_laws_;
    for (FacePair& pair : pairs_)
        pair.creeps = {};
}

} // namespace jointcreep::large_displacements
