#include "sensitivity/sensitivity.hpp"

#include "model/error.hpp"
#include "model/signs.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::sensitivity
{

using mechanics::Assembly;

namespace
{

using joint::Dual;

} // namespace

void scale(EquivalentJoints& joints, InSituStress& stress, Parameter parameter, double factor)
{
    const auto times = [factor](auto&... lists) {
        const auto one = [factor](std::vector<double>& list) {
            for (double& value : list)
                value *= factor;
        };
        (one(lists), ...);
    };
    switch (parameter) {
    case Parameter::joint_stiffness:
        times(joints.normal_stiffness, joints.shear_stiffness, joints.normal_kelvin_stiffness,
              joints.shear_kelvin_stiffness);
        [[fallthrough]];
    case Parameter::kelvin_viscosity:
        times(joints.normal_kelvin_viscosity, joints.shear_kelvin_viscosity, joints.normal_maxwell_viscosity,
              joints.shear_maxwell_viscosity);
        break;
    case Parameter::kelvin_stiffness:
        times(joints.normal_kelvin_stiffness, joints.shear_kelvin_stiffness);
        break;
    case Parameter::horizontal_stress:
        stress.compression_xx *= factor;
        stress.gradient_xx *= factor;
        for (InSituStress::Level& level : stress.profile)
            level.compression_xx *= factor;
    }
}

Sensitivity::Sensitivity(std::vector<Parameter> parameters, const Scene& scene, const Mesh& mesh,
                         const Assembly& assembly)
    : parameters_(std::move(parameters))
{
    const joint::Contacts& contacts = assembly.contacts;
    for (const joint::Law& law : contacts.law)
        if (const joint::LawInfo& info = joint::laws()[law.index()]; !info.no_sensitivities.empty()) {
            const std::string joints = std::string(info.name) + " joints";
            throw input_error("no sensitivities of " + joints + ": " + std::string(info.no_sensitivities) +
                              "; wanted a scene without " + joints);
        }
    const std::size_t n = contacts.law.size(), zones = assembly.zones.area.size();
    start_.assign(n, {});
    const std::vector<Vector2d> no_gridpoints(assembly.position.size(), Vector2d::Zero()),
        no_contacts(n, Vector2d::Zero());
    const std::vector<Vector3d> no_zones(zones, Vector3d::Zero());
    for (const Parameter parameter : parameters_) {
        Change change{.displacement = no_gridpoints,
                      .released = no_gridpoints,
                      .stiffness = no_contacts,
                      .initial_traction = no_contacts,
                      .offset = no_contacts,
                      .traction = no_contacts,
                      .slip = std::vector<double>(n, 0.0),
                      .dilation = std::vector<double>(n, 0.0),
                      .memory = std::vector<std::array<double, 3>>(n),
                      .initial_stress = no_zones,
                      .stress = no_zones,
                      .shear_modulus = std::vector<double>(zones, 0.0),
                      .reference = {},
                      .before = {},
                      .crept = {},
                      .reference_stress = {},
                      .before_stress = {},
                      .crept_strain = {},
                      .opening_before = {},
                      .opening = std::vector<double>(n, 0.0),
                      .rate = std::vector<double>(n, 0.0)};
        if (parameter == Parameter::joint_stiffness)
            for (std::size_t c = 0; c < n; ++c)
                change.stiffness[c] = {joint::k_n(contacts.law[c]), joint::k_s(contacts.law[c])};
        if (parameter == Parameter::horizontal_stress) {
            for (std::size_t z = 0; z < zones; ++z)
                change.initial_stress[z].x() = assembly.zones.initial_stress[z].x();
            for (std::size_t c = 0; c < n; ++c) {
                const double stress = scene.in_situ_stress.at(mesh.contact_centre[c]).x();
                const Vector2d &normal = contacts.normal[c], tangent = along(normal);
                change.initial_traction[c] = stress * normal.x() * Vector2d(normal.x(), tangent.x());
            }
        }
        changes_.push_back(std::move(change));
    }
}

creep::Chain Sensitivity::change_of(const creep::Chain& chain, Parameter parameter) const
{
    const bool all = parameter == Parameter::joint_stiffness;
    creep::Chain change{all ? chain.spring : 0.0, {}};
    for (const creep::KelvinUnit& unit : chain.units)
        change.units.push_back({all || parameter == Parameter::kelvin_stiffness ? unit.stiffness : 0.0,
                                all || parameter == Parameter::kelvin_viscosity ? unit.viscosity : 0.0});
    return change;
}

joint::ContactResponse Sensitivity::response(const Assembly& assembly, const Change& change, std::size_t c,
                                             bool with_displacement) const
{
    Vector2d spring = -change.offset[c];
    if (with_displacement) {
        const auto [a, b] = assembly.contacts.gridpoint[c];
        const Vector2d apart = change.displacement[b] - change.displacement[a],
                       &normal = assembly.contacts.normal[c];
        spring += Vector2d(normal.dot(apart), along(normal).dot(apart));
    }
    return joint::respond(assembly.contacts, c, start_[c],
                          {change.stiffness[c], change.initial_traction[c], spring, change.slip[c],
                           change.dilation[c], change.memory[c]});
}

Vector3d Sensitivity::stress(const Assembly& assembly, const Change& change, std::size_t z,
                             bool with_displacement) const
{
    Vector3d sum = change.initial_stress[z];
    if (with_displacement)
        sum += rock::stress_by(assembly.zones, z, change.displacement, assembly.zones.stiffness[z]);
    if (change.shear_modulus[z] != 0) // the bulk modulus stays
        sum += rock::stress_by(assembly.zones, z, assembly.displacement,
                               change.shear_modulus[z] * Vector3d(4. / 3, -2. / 3, 1));
    return sum;
}

std::vector<Vector2d> Sensitivity::forces(const Assembly& assembly, const Change& change,
                                          bool is_settled) const
{
    std::vector<Vector2d> force(assembly.position.size(), Vector2d::Zero());
    for (std::size_t z = 0; z < assembly.zones.area.size(); ++z)
        if (assembly.zones.is_present[z])
            rock::add_force(assembly.zones, z,
                            is_settled ? change.stress[z] : stress(assembly, change, z, false), force);
    const joint::Contacts& contacts = assembly.contacts;
    for (std::size_t c = 0; c < contacts.length.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const Vector2d traction =
            is_settled ? change.traction[c] : response(assembly, change, c, false).traction;
        joint::add_force(contacts, c, traction, force);
    }
    for (const auto& [follower, leader] : assembly.tied) {
        force[leader] += force[follower];
        force[follower].setZero();
    }
    return force;
}

void Sensitivity::settle(const Assembly& assembly, implicit::Solver& engine, double time, double held)
{
    const joint::Contacts& contacts = assembly.contacts;
    const std::size_t n = contacts.law.size();
    std::vector<joint::Tangent> tangents(n);
    for (std::size_t c = 0; c < n; ++c)
        if (contacts.status[c] != ContactStatus::removed)
            tangents[c] = joint::tangent_of_response(contacts, c, start_[c]);
    for (Change& change : changes_) {
        std::vector<Vector2d> force = forces(assembly, change, false);
        if (held > 0)
            for (std::size_t g = 0; g < force.size(); ++g)
                force[g] += held * change.released[g];
        const implicit::Stiffness& stiffness = engine.stiffness();
        const implicit::VectorXd x =
            engine.solve_linear(assembly, tangents, stiffness.gathered(assembly, force));
        if (x.size() != stiffness.size())
            throw equilibrium_error("no sensitivities on day " + shown(time / unit::day) +
                                    ": some rock is held by slipping joints only");
        change.displacement.assign(force.size(), Vector2d::Zero());
        stiffness.add_to(change.displacement, x, 1);
        for (std::size_t c = 0; c < n; ++c) {
            const joint::ContactResponse found = response(assembly, change, c, true);
            change.traction[c] = found.traction;
            change.slip[c] = found.slip;
            change.dilation[c] = found.dilation;
            change.memory[c] = found.memory;
        }
        for (std::size_t z = 0; z < change.stress.size(); ++z)
            change.stress[z] =
                assembly.zones.is_present[z] ? stress(assembly, change, z, true) : Vector3d(Vector3d::Zero());
    }
    start_ = contacts.state;
}

void Sensitivity::start_from_here(const Assembly& assembly)
{
    const joint::Contacts& contacts = assembly.contacts;
    for (Change& change : changes_) {
        for (std::size_t c = 0; c < change.slip.size(); ++c) {
            const auto [a, b] = contacts.gridpoint[c];
            const Vector2d relative = change.displacement[b] - change.displacement[a];
            // As joint::start_from_here() has it.
            const Dual sigma_0(contacts.initial_traction[c].x(), change.initial_traction[c].x()),
                u(contacts.relative_displacement[c].x() - contacts.offset[c].x() - contacts.state[c].dilation,
                  contacts.normal[c].dot(relative) - change.offset[c].x() - change.dilation[c]);
            const double normal = joint::with_derivatives(
                contacts.law[c], Dual(joint::k_n(contacts.law[c]), change.stiffness[c].x()),
                Dual(joint::k_s(contacts.law[c]), change.stiffness[c].y()),
                [&](const auto& law) { return normal_traction(law, sigma_0, u).slope; });
            change.initial_traction[c] = {normal, change.traction[c].y()};
            change.slip[c] = change.dilation[c] = 0;
        }
        change.initial_stress = change.stress;
        change.displacement.assign(change.displacement.size(), Vector2d::Zero());
    }
    for (joint::State& state : start_)
        state.slip = state.dilation = 0;
}

void Sensitivity::start_creep(const creep::Creep& creep)
{
    for (Change& change : changes_) {
        change.reference.clear();
        for (const creep::Creep::Spring& spring : creep.springs())
            change.reference.push_back(change.traction[spring.contact][spring.direction]);
        change.before.assign(change.reference.size(), 0.0);
        change.crept.assign(creep.crept_displacement().size(), 0.0);
        change.reference_stress.clear();
        for (const creep::Creep::Shear& shear : creep.shears())
            change.reference_stress.push_back(change.initial_stress[shear.zone]);
        change.before_stress.assign(change.reference_stress.size(), Vector3d::Zero());
        change.crept_strain.assign(creep.crept_strain().size(), Vector3d::Zero());
    }
}

void Sensitivity::creep_step(const creep::Creep& creep, double duration, const Assembly& assembly,
                             implicit::Solver& engine, double time)
{
    const joint::Contacts& contacts = assembly.contacts;
    const auto& springs = creep.springs();
    const auto& shears = creep.shears();
    std::vector<creep::Step> steps;
    for (const creep::Chain& chain : creep.chains())
        steps.push_back(creep::step_of(chain, creep.scheme(), duration));
    // [parameter, chain]; those of rock change by the duration only.
    std::vector<std::vector<creep::Step>> step_changes, rock_changes;
    std::vector<std::vector<creep::Chain>> chain_changes;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
        const double by = changes_[p].duration;
        chain_changes.emplace_back();
        step_changes.emplace_back();
        rock_changes.emplace_back();
        for (const creep::Chain& chain : creep.chains()) {
            const creep::Chain change = change_of(chain, parameters_[p]);
            creep::Chain none = change;
            none.spring = 0;
            std::fill(none.units.begin(), none.units.end(), creep::KelvinUnit{0, 0});
            chain_changes[p].push_back(change);
            step_changes[p].push_back(creep::change_of_step(chain, change, creep.scheme(), duration, by));
            rock_changes[p].push_back(creep::change_of_step(chain, none, creep.scheme(), duration, by));
        }
    }
    const auto is_there = [&](const creep::Creep::Spring& spring) {
        return contacts.status[spring.contact] != ContactStatus::removed;
    };

    // The stiffnesses and offsets that contacts and zones act with during the step.
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        Change& change = changes_[p];
        for (std::size_t s = 0; s < springs.size(); ++s) {
            const creep::Creep::Spring& spring = springs[s];
            if (!is_there(spring))
                continue;
            const creep::Step &step = steps[spring.chain], &by = step_changes[p][spring.chain];
            const Index c = spring.contact;
            const int i = spring.direction;
            change.before[s] = change.traction[c][i] - change.reference[s];
            double offset = by.compliance * (contacts.initial_traction[c][i] - spring.reference) +
                            step.compliance * (change.initial_traction[c][i] - change.reference[s]);
            for (std::size_t u = 0; u < step.units.size(); ++u) {
                const std::size_t unit = spring.first_unit + u;
                offset += by.units[u].decay * creep.crept_displacement()[unit] +
                          step.units[u].decay * change.crept[unit] + by.units[u].first * spring.before +
                          step.units[u].first * change.before[s];
            }
            change.stiffness[c][i] = by.acting_stiffness;
            change.offset[c][i] = offset;
        }
        for (std::size_t s = 0; s < shears.size(); ++s) {
            const creep::Creep::Shear& shear = shears[s];
            if (!assembly.zones.is_present[shear.zone])
                continue;
            const creep::Step &step = steps[shear.chain], &by = rock_changes[p][shear.chain];
            Vector3d crept(0, 0, 0), offset(0, 0, 0);
            for (std::size_t u = 0; u < step.units.size(); ++u)
                crept += change.crept_strain[shear.first_unit + u];
            change.before_stress[s] =
                creep::Creep::deviatoric(shear.bulk_modulus, creep.chains()[shear.chain].spring / 2, crept,
                                         change.stress[shear.zone] - change.reference_stress[s]);
            for (std::size_t u = 0; u < step.units.size(); ++u)
                offset += step.units[u].decay * change.crept_strain[shear.first_unit + u] +
                          by.units[u].decay * creep.crept_strain()[shear.first_unit + u] +
                          step.units[u].first * change.before_stress[s] + by.units[u].first * shear.before;
            change.shear_modulus[shear.zone] = by.acting_stiffness / 2;
            change.initial_stress[shear.zone] = change.reference_stress[s] - step.acting_stiffness * offset -
                                                by.acting_stiffness * shear.offset;
        }
    }

    settle(assembly, engine, time);
    for (Change& change : changes_)
        for (std::size_t c = 0; c < change.opening.size(); ++c)
            change.opening[c] = opening(assembly, change, c);

    // Creep follows, and contacts and zones get their own stiffnesses back, with the offset crept so far.
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        Change& change = changes_[p];
        for (std::size_t s = 0; s < springs.size(); ++s) {
            const creep::Creep::Spring& spring = springs[s];
            const creep::Step &step = steps[spring.chain], &by = step_changes[p][spring.chain];
            const Index c = spring.contact;
            const int i = spring.direction;
            const double after = contacts.traction[c][i] - spring.reference,
                         after_change = change.traction[c][i] - change.reference[s];
            double offset = 0;
            for (std::size_t u = 0; u < step.units.size(); ++u) {
                double& crept = change.crept[spring.first_unit + u];
                if (is_there(spring))
                    crept = by.units[u].decay * creep.crept_displacement()[spring.first_unit + u] +
                            step.units[u].decay * crept + by.units[u].first * spring.before +
                            step.units[u].first * change.before[s] + by.units[u].last * after +
                            step.units[u].last * after_change;
                offset += crept;
            }
            change.stiffness[c][i] = chain_changes[p][spring.chain].spring;
            change.offset[c][i] = offset;
        }
        for (std::size_t s = 0; s < shears.size(); ++s) {
            const creep::Creep::Shear& shear = shears[s];
            if (!assembly.zones.is_present[shear.zone])
                continue;
            const creep::Step &step = steps[shear.chain], &by = rock_changes[p][shear.chain];
            const double bulk = shear.bulk_modulus, modulus = step.acting_stiffness / 2,
                         modulus_change = by.acting_stiffness / 2;
            const Vector3d now = assembly.zones.stress[shear.zone] - shear.reference;
            // initial stress = reference - 2 G_t offset
            const Vector3d offset = (change.reference_stress[s] - change.initial_stress[shear.zone] -
                                     2 * modulus_change * shear.offset) /
                                    (2 * modulus);
            Vector3d after_change = creep::Creep::deviatoric(
                bulk, modulus, offset, change.stress[shear.zone] - change.reference_stress[s]);
            const Vector3d after = creep::Creep::deviatoric(bulk, modulus, shear.offset, now);
            // deviatoric() depends on the modulus by its mean stress, B t.
            const double mean = now[0] - after[0];
            const double mean_change = (bulk * (shear.offset[0] + shear.offset[1]) - mean / 3) /
                                       (bulk + modulus / 3) * modulus_change;
            after_change -= Vector3d(mean_change, mean_change, 0);
            Vector3d crept(0, 0, 0);
            for (std::size_t u = 0; u < step.units.size(); ++u) {
                Vector3d& strain = change.crept_strain[shear.first_unit + u];
                strain = step.units[u].decay * strain +
                         by.units[u].decay * creep.crept_strain()[shear.first_unit + u] +
                         step.units[u].first * change.before_stress[s] + by.units[u].first * shear.before +
                         step.units[u].last * after_change + by.units[u].last * after;
                crept += strain;
            }
            change.shear_modulus[shear.zone] = 0;
            change.initial_stress[shear.zone] =
                change.reference_stress[s] - creep.chains()[shear.chain].spring * crept;
        }
    }
}

// How far a contact is open, or closed, as creep::Closing has it.
double Sensitivity::opening(const Assembly& assembly, const Change& change, std::size_t c)
{
    const auto [a, b] = assembly.contacts.gridpoint[c];
    const joint::Law& law = assembly.contacts.law[c];
    const double at_start = joint::with_derivatives(
        law, Dual(joint::k_n(law), change.stiffness[c].x()), Dual(joint::k_s(law)), [&](const auto& one) {
            return joint::opening(
                       one, Dual(assembly.contacts.initial_traction[c].x(), change.initial_traction[c].x()))
                .slope;
        });
    return at_start + assembly.contacts.normal[c].dot(change.displacement[b] - change.displacement[a]) -
           change.offset[c].x() - change.dilation[c];
}

void Sensitivity::start_step(const Assembly& assembly)
{
    for (Change& change : changes_) {
        for (std::size_t c = 0; c < change.opening.size(); ++c)
            change.opening[c] = opening(assembly, change, c);
        change.opening_before = change.opening;
        change.duration = -change.now; // up to a time that no parameter changes
    }
}

void Sensitivity::shorten(double share)
{
    for (Change& change : changes_)
        change.duration *= share;
}

void Sensitivity::cut(const creep::Closing::Cut& cut, const creep::Creep& creep, double duration,
                      const Assembly& assembly, implicit::Solver& engine, double time)
{
    if (cut.is_by_rate) {
        for (Change& change : changes_)
            change.duration =
                cut.share / cut.rate *
                (cut.opening / cut.rate * change.rate[cut.contact] - change.opening_before[cut.contact]);
        return;
    }
    Sensitivity trial = *this;
    trial.creep_step(creep, duration, assembly, engine, time);
    const double way = cut.opening - cut.closed;
    for (std::size_t p = 0; p < changes_.size(); ++p) {
        const double opening = changes_[p].opening_before[cut.contact],
                     closed = cut.closed < 0 ? trial.changes_[p].opening[cut.contact] : 0.0;
        changes_[p].duration = cut.share *
                               (changes_[p].duration * cut.opening +
                                duration * (cut.opening * closed - cut.closed * opening) / way) /
                               way;
    }
}

void Sensitivity::finish_step(const creep::Closing& closing, double duration, bool is_whole,
                              const Assembly& assembly)
{
    for (Change& change : changes_) {
        for (std::size_t c = 0; c < change.opening.size(); ++c) {
            change.rate[c] = 0;
            if (closing.was_open(c) && assembly.contacts.status[c] == ContactStatus::open)
                change.rate[c] = (opening(assembly, change, c) - change.opening_before[c] -
                                  closing.rate(c) * change.duration) /
                                 duration;
        }
        change.now = is_whole ? 0.0 : change.now + change.duration;
        change.duration = 0;
    }
}

void Sensitivity::start_afresh()
{
    for (Change& change : changes_)
        change.rate.assign(change.rate.size(), 0.0);
}

void Sensitivity::before_excavation(const Assembly& assembly)
{
    for (Change& change : changes_)
        change.released = forces(assembly, change, true);
}

void Sensitivity::after_excavation(const Assembly& assembly)
{
    for (Change& change : changes_) {
        const std::vector<Vector2d> left = forces(assembly, change, true);
        for (std::size_t g = 0; g < left.size(); ++g)
            change.released[g] -= left[g];
    }
}

} // namespace jointcreep::sensitivity
