#include "large_displacements/dynamics.hpp"
#include "large_displacements/kahan.hpp"
#include "model/disjoint_sets.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

// Bodies of rigid rock: gridpoints connected by its zones and by ties.
void Dynamics::find_bodies()
{
    const std::vector<double> masses = lumped_masses(assembly_);
    DisjointSets sets(now_.place.size());
    std::vector<char> is_of_body(now_.place.size(), 0);
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        if (is_rigid_[z] && assembly_.zones.is_present[z])
            for (const Index g : assembly_.zones.gridpoints(z)) {
                is_of_body[g] = 1;
                sets.join(g, assembly_.zones.gridpoints(z)[0]);
            }
    for (const auto& [follower, first] : assembly_.tied)
        if (is_of_body[follower] || is_of_body[first]) {
            sets.join(follower, first);
            is_of_body[follower] = 0; // moves with its leader
            is_of_body[first] = 1;
        }

    bodies_.clear();
    body_of_.assign(now_.place.size(), -1);
    std::map<Index, Index> number; // by root
    for (std::size_t g = 0; g < now_.place.size(); ++g) {
        if (!is_of_body[g])
            continue;
        const auto [found, is_new] =
            number.try_emplace(sets.root(static_cast<Index>(g)), static_cast<Index>(bodies_.size()));
        if (is_new)
            bodies_.emplace_back();
        Body& body = bodies_[found->second];
        body_of_[g] = found->second;
        body.gridpoint.push_back(static_cast<Index>(g));
        body.mass += masses[g];
        body.centre += masses[g] * now_.place[g];
        body.is_free = body.is_free.cwiseMin(assembly_.is_free[g]);
    }
    for (Body& body : bodies_) {
        body.centre /= body.mass;
        for (const Index g : body.gridpoint)
            body.arm.emplace_back(now_.place[g] - body.centre);
    }
    find_inertia(masses);
}

// Mass and inertia of bodies about their centres. Deformable rock bonded to a body is lumped into their common
// gridpoints. `masses`: of gridpoints [kg/m].
void Dynamics::find_inertia(const std::vector<double>& masses)
{
    const std::vector<Index> leader = leaders();
    std::vector<double> lumped = masses;
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z) {
        if (!is_rigid_[z] || !assembly_.zones.is_present[z])
            continue;
        Body& body = bodies_[body_of_[leader[assembly_.zones.gridpoints(z)[0]]]];
        Vector2d sum(0, 0);
        for (const Index g : assembly_.zones.gridpoints(z)) {
            const Vector2d arm = now_.place[g] - body.centre;
            body.inertia += assembly_.zones.mass[z] / 12 * arm.squaredNorm();
            sum += arm;
            lumped[leader[g]] -= assembly_.zones.mass[z] / 3;
        }
        body.inertia += assembly_.zones.mass[z] / 12 * sum.squaredNorm();
    }
    for (Body& body : bodies_)
        for (std::size_t k = 0; k < body.gridpoint.size(); ++k)
            body.inertia += std::max(0.0, lumped[body.gridpoint[k]]) * body.arm[k].squaredNorm();
}

// Force [N/m] and moment about the centre [N] on a body, of these forces on gridpoints [N/m].
std::pair<Vector2d, double> Dynamics::load_on(const Body& body,
                                              const std::vector<Vector2d>& on_gridpoints) const
{
    Vector2d force(0, 0);
    double moment = 0;
    for (const Index g : body.gridpoint) {
        const Vector2d arm = now_.place[g] - body.centre;
        force += on_gridpoints[g];
        moment += arm.x() * on_gridpoints[g].y() - arm.y() * on_gridpoints[g].x();
    }
    if (!body.turns())
        moment = 0;
    return {force.cwiseProduct(body.is_free), moment};
}

// One time step; returns the kinetic energy before it [J/m].
double Dynamics::move(Body& body, double keep, double gain)
{
    if (body.is_held())
        return 0;
    const auto [force, moment] = load_on(body, now_.force);
    const Vector2d last = body.velocity;
    const double last_spin = body.spin;
    body.velocity = keep * body.velocity + gain / body.mass * force;
    body.spin = keep * body.spin + gain / body.inertia * moment;
    add<Vector2d>(now_.dt * body.velocity, body.centre, body.lost);
    body.angle += now_.dt * body.spin;
    const Eigen::Rotation2Dd turn(body.angle);
    for (std::size_t k = 0; k < body.gridpoint.size(); ++k) {
        const Index g = body.gridpoint[k];
        const Vector2d to = body.centre + turn * body.arm[k];
        move_[g] = to - now_.place[g];
        now_.velocity[g] = move_[g] / now_.dt;
        now_.place[g] = to;
    }
    return (body.mass * last.dot(body.velocity) + body.inertia * last_spin * body.spin) / 2;
}

// In a direction in which a body is fixed, its load goes to its fixed gridpoints, in equal parts.
void Dynamics::put_back_forces()
{
    assembly_.force = now_.force;
    for (const Body& body : bodies_)
        for (int i = 0; i < 2; ++i) {
            if (body.is_free[i] > 0)
                continue;
            double force = 0, held = 0;
            for (const Index g : body.gridpoint) {
                force += now_.force[g][i];
                held += 1 - assembly_.is_free[g][i];
            }
            for (const Index g : body.gridpoint)
                assembly_.force[g][i] = (1 - assembly_.is_free[g][i]) * force / held;
        }
}

} // namespace jointcreep::large_displacements
