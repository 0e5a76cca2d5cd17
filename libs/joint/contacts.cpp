#include "joint/contacts.hpp"

#include "model/signs.hpp"

#include <algorithm>
#include <numeric>

namespace jointcreep::joint
{

namespace
{

// The normal traction of the spring where the sides of a contact are this far apart [m]; of an open one the tension that
// it would have.
double spring_tension(const Contacts& contacts, std::size_t c, double apart)
{
    return normal_traction(contacts.law[c], contacts.initial_traction[c].x(),
                           apart - contacts.offset[c].x() - contacts.state[c].dilation);
}

// Slopes of a contact at displacements of which its traction need not know yet.
Slopes slopes_at(std::span<const Vector2d> displacement, const Contacts& contacts, std::size_t c)
{
    double traction = contacts.traction[c].x();
    if (stiffens(contacts.law[c])) {
        const auto [a, b] = contacts.gridpoint[c];
        traction = spring_tension(contacts, c, (displacement[b] - displacement[a]).dot(contacts.normal[c]));
    }
    return slopes(contacts.law[c], contacts.state[c], traction);
}

} // namespace

ContactsState state_of(const Contacts& contacts)
{
    return {contacts.offset, contacts.traction, contacts.relative_displacement, contacts.state,
            contacts.status};
}

void go_back(Contacts& contacts, const ContactsState& state)
{
    contacts.offset = state.offset;
    contacts.traction = state.traction;
    contacts.relative_displacement = state.relative_displacement;
    contacts.state = state.state;
    contacts.status = state.status;
}

Contacts contacts_of(const Scene& scene, const EquivalentJoints& joints, const Mesh& mesh)
{
    Contacts contacts;
    const std::size_t n = mesh.contact_edge.size();
    contacts.gridpoint = mesh.contact_gridpoint;
    contacts.edge = mesh.contact_edge;
    contacts.normal = mesh.contact_normal;
    contacts.length = mesh.contact_length;
    for (std::size_t c = 0; c < n; ++c) {
        const Index e = mesh.contact_edge[c];
        contacts.law.push_back(law_of(joints, static_cast<std::size_t>(e)));
        if (!joints.material.empty())
            contacts.material.push_back(joints.material[static_cast<std::size_t>(e)]);
        const Eigen::Vector3d stress = scene.in_situ_stress.at(mesh.contact_centre[c]);
        const Vector2d normal = mesh.contact_normal[c], tangent = along(normal);
        const Vector2d pull(stress[0] * normal.x() + stress[2] * normal.y(),
                            stress[2] * normal.x() + stress[1] * normal.y());
        contacts.initial_traction.emplace_back(pull.dot(normal), pull.dot(tangent));
    }
    contacts.state.resize(n);
    contacts.offset.assign(n, Vector2d::Zero());
    contacts.traction = contacts.initial_traction;
    contacts.relative_displacement.assign(n, Vector2d::Zero());
    contacts.status.assign(n, ContactStatus::stuck);
    contacts.work.assign(n, 0.0);
    return contacts;
}

void find_incidence(Contacts& contacts, std::size_t n_gridpoints)
{
    std::vector<Index> gridpoint; // of each side
    for (const auto& [a, b] : contacts.gridpoint)
        gridpoint.insert(gridpoint.end(), {a, b});
    contacts.sides = grouped(gridpoint, n_gridpoints);
    contacts.force.assign(contacts.gridpoint.size(), Vector2d::Zero());
}

void find_forces_in_team(Contacts& contacts, std::span<const Vector2d> displacement, double damping,
                         bool /*forces_alone*/)
{
    const auto n = static_cast<Index>(contacts.gridpoint.size());
    const Vector2d* u = displacement.data();
#pragma omp for schedule(static) nowait
    for (Index c = 0; c < n; ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const auto [a, b] = contacts.gridpoint[c];
        const Vector2d normal = contacts.normal[c], tangent = along(normal);
        const Vector2d apart = u[b] - u[a], relative_displacement(apart.dot(normal), apart.dot(tangent));
        const Vector2d sprung = relative_displacement - contacts.offset[c];
        const Response response =
            respond(contacts.law[c], contacts.state[c], contacts.initial_traction[c].x(),
                    contacts.initial_traction[c].y(), sprung.x(), sprung.y());
        const Vector2d traction(response.sigma_n, response.tau), last = contacts.traction[c];
        const double length = contacts.length[c];
        contacts.work[c] +=
            length / 2 * (last + traction).dot(relative_displacement - contacts.relative_displacement[c]);
        contacts.relative_displacement[c] = relative_displacement;
        contacts.traction[c] = traction;
        contacts.status[c] = response.status;
        Vector2d acting = traction;
        if (damping > 0 && response.status == ContactStatus::stuck)
            acting += damping * (traction - last); // dashpots; none if it slips or is open
        contacts.force[c] = length * (acting.x() * normal + acting.y() * tangent);
    }
}

double opening_of(const Contacts& contacts, std::size_t c)
{
    return opening(contacts.law[c], contacts.initial_traction[c].x()) +
           contacts.relative_displacement[c].x() - contacts.offset[c].x() - contacts.state[c].dilation;
}

ContactResponse respond(const Contacts& contacts, std::size_t c, const State& start, const ContactChange& by)
{
    if (contacts.status[c] == ContactStatus::removed)
        return {Vector2d::Zero(), by.slip, by.dilation, by.memory};
    const Law& law = contacts.law[c];
    const Vector2d &initial = contacts.initial_traction[c],
                   stretch = contacts.relative_displacement[c] - contacts.offset[c];
    StateOf<Dual> state{{start.slip, by.slip},
                        {start.dilation, by.dilation},
                        contacts.state[c].is_broken,
                        {Dual(start.memory[0], by.memory[0]), Dual(start.memory[1], by.memory[1]),
                         Dual(start.memory[2], by.memory[2])}};
    const auto found = with_derivatives(
        law, Dual(k_n(law), by.stiffness.x()), Dual(k_s(law), by.stiffness.y()), [&](const auto& one) {
            return respond(one, state, Dual(initial.x(), by.initial_traction.x()),
                           Dual(initial.y(), by.initial_traction.y()), Dual(stretch.x(), by.spring.x()),
                           Dual(stretch.y(), by.spring.y()));
        });
    return {{found.sigma_n.slope, found.tau.slope},
            state.slip.slope,
            state.dilation.slope,
            {state.memory[0].slope, state.memory[1].slope, state.memory[2].slope}};
}

void add_row_sums(const Contacts& contacts, std::span<const Vector2d> displacement,
                  std::vector<Vector2d>& sums)
{
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const Vector2d n = contacts.normal[c].cwiseAbs(), t(n.y(), n.x());
        const Slopes law = slopes_at(displacement, contacts, c);
        const double k_n = (stiffens(contacts.law[c]) ? room_to_stiffen : 1) * law.k_n;
        const Vector2d row =
            2 * contacts.length[c] * (k_n * n * (n.x() + n.y()) + law.k_s * t * (t.x() + t.y()));
        for (const Index g : contacts.gridpoint[c])
            sums[g] += row;
    }
}

double stored_energy(const Contacts& contacts)
{
    double energy = 0;
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed)
            energy += contacts.length[c] *
                      stored(contacts.law[c], contacts.traction[c].x(), contacts.traction[c].y());
    return energy;
}

double returned_energy(const Contacts& contacts, const ContactsState& start)
{
    double energy = 0;
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        const State &now = contacts.state[c], &before = start.state[c];
        if (contacts.status[c] == ContactStatus::removed || contacts.status[c] == ContactStatus::open ||
            (now.slip == before.slip && now.dilation == before.dilation))
            continue;
        const double sigma_n = contacts.traction[c].x(), tau = contacts.traction[c].y();
        const Slopes spring = slopes(contacts.law[c], now, sigma_n);
        energy += contacts.length[c] *
                  (stored(contacts.law[c], sigma_n + spring.k_n * (now.dilation - before.dilation),
                          tau + spring.k_s * (now.slip - before.slip)) -
                   stored(contacts.law[c], sigma_n, tau));
    }
    return energy;
}

std::vector<Stiffening> stiffening_of(const Contacts& contacts, std::span<const Vector2d> displacement)
{
    std::vector<Stiffening> found;
    for (std::size_t c = 0; c < contacts.law.size(); ++c)
        if (stiffens(contacts.law[c]) && contacts.status[c] != ContactStatus::removed)
            found.push_back({c, room_to_stiffen * slopes_at(displacement, contacts, c).k_n});
    return found;
}

bool are_beyond(const Contacts& contacts, std::span<const Vector2d> displacement,
                const std::vector<Stiffening>& stiffening)
{
    return std::ranges::any_of(stiffening, [&](const Stiffening& one) {
        return slopes_at(displacement, contacts, one.contact).k_n > one.most;
    });
}

void pass(Tape& tape, std::vector<Stiffening>& stiffening)
{
    for (Stiffening& one : stiffening)
        tape(one.most);
}

void begin_search(Contacts& contacts, bool /*damps_stiffness*/)
{
    std::fill(contacts.work.begin(), contacts.work.end(), 0.0);
    contacts.stored_before = stored_energy(contacts);
}

double dissipated(const Contacts& contacts)
{
    return contacts.stored_before + std::accumulate(contacts.work.begin(), contacts.work.end(), 0.0) -
           stored_energy(contacts);
}

double dissipated(const Contacts& contacts, const ContactsState& start)
{
    double energy = 0;
    for (std::size_t c = 0; c < contacts.status.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed)
            energy += contacts.length[c] *
                      (contacts.traction[c].y() * (contacts.state[c].slip - start.state[c].slip) +
                       contacts.traction[c].x() * (contacts.state[c].dilation - start.state[c].dilation));
    return energy;
}

void join(const Contacts& contacts, DisjointSets& gridpoints)
{
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed)
            gridpoints.join(contacts.gridpoint[c][0], contacts.gridpoint[c][1]);
}

void remove_at(Contacts& contacts, const std::vector<char>& lost_a_side)
{
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed || !lost_a_side[contacts.edge[c]])
            continue;
        contacts.force[c].setZero();
        contacts.traction[c].setZero();
        contacts.status[c] = ContactStatus::removed;
    }
}

double slip_beside_springs(const Contacts& contacts, std::size_t c)
{
    const double stiffness = k_s(contacts.law[c]);
    return stiffness > 0 ? contacts.relative_displacement[c].y() - contacts.offset[c].y() -
                               (contacts.traction[c].y() - contacts.initial_traction[c].y()) / stiffness
                         : 0.0;
}

bool is_finite(const Contacts& contacts)
{
    return std::ranges::all_of(contacts.traction,
                               [](const Vector2d& traction) { return traction.allFinite(); });
}

double penetration(const Contacts& contacts)
{
    double deepest = 0;
    for (std::size_t c = 0; c < contacts.status.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const double of_springs = contacts.status[c] == ContactStatus::open
                                      ? 0.0
                                      : opening(contacts.law[c], contacts.traction[c].x());
        deepest = std::max(deepest, of_springs - opening_of(contacts, c));
    }
    return deepest;
}

void start_from_here(Contacts& contacts)
{
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        // The gap of an open contact is kept as this tension.
        const double normal = spring_tension(contacts, c, contacts.relative_displacement[c].x());
        contacts.initial_traction[c] = {normal, contacts.traction[c].y()};
        contacts.offset[c].setZero();
    }
    forget_slip(contacts.state);
}

void forget_slip(std::vector<State>& states)
{
    for (State& state : states)
        state.slip = state.dilation = 0;
}

void record_state(const Contacts& contacts, States& states)
{
    const std::vector<State>& remembered =
        contacts.state_by_faces.empty() ? contacts.state : contacts.state_by_faces;
    const bool is_first = states.time.size() <= 1;
    states.initial_gap.resize(contacts.gridpoint.size());
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        states.traction.push_back(contacts.traction[c]);
        states.relative_displacement.push_back(contacts.relative_displacement[c]);
        states.contact_status.push_back(static_cast<Index>(contacts.status[c]));
        states.slip.push_back(remembered[c].slip);
        states.dilation.push_back(remembered[c].dilation);
        states.bond_broken.push_back(remembered[c].is_broken ? 1 : 0);
        states.crept.push_back(contacts.offset[c]);
        if (is_first) // a bonded contact in tension is closed
            states.initial_gap[c] =
                contacts.status[c] == ContactStatus::open
                    ? std::max(0.0, opening(contacts.law[c], contacts.initial_traction[c].x()))
                    : 0.0;
    }
}

void transfer(const Transfer& to, Contacts& contacts, Checkpoint& kept)
{
    to.values(contacts.status, kept.contact_status);
    to.values(contacts.traction, kept.traction);
    to.values(contacts.initial_traction, kept.initial_traction);
    to.values(contacts.relative_displacement, kept.relative_displacement);
    to.values(contacts.offset, kept.offset);
    to.values(contacts.state, kept.slip, &State::slip);
    to.values(contacts.state, kept.dilation, &State::dilation);
    to.values(contacts.state, kept.is_broken, &State::is_broken);
    const auto memory = [](std::size_t i) { return [i](State& one) -> double& { return one.memory[i]; }; };
    to.values(contacts.state, kept.first_memory, memory(0));
    to.values(contacts.state, kept.second_memory, memory(1));
    to.values(contacts.state, kept.third_memory, memory(2));
}

void pass(Tape& tape, Contacts& contacts)
{
    const auto pass_states = [&](std::vector<State>& states) {
        for (State& one : states)
            tape(one.slip, one.dilation, one.is_broken, one.memory);
    };
    pass_states(contacts.state);
    tape(contacts.traction, contacts.relative_displacement, contacts.status, contacts.work);
    const std::size_t by_faces = tape.size(contacts.state_by_faces.size());
    Tape::check(by_faces == 0 || by_faces == contacts.state.size());
    contacts.state_by_faces.resize(by_faces);
    pass_states(contacts.state_by_faces);
}

} // namespace jointcreep::joint
