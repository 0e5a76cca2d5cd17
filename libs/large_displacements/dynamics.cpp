#include "large_displacements/dynamics.hpp"

#include "large_displacements/in_chunks.hpp"
#include "model/disjoint_sets.hpp"
#include "model/error.hpp"
#include "model/signs.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace jointcreep::large_displacements
{

using Eigen::Matrix2d;
using Eigen::Vector3d;

namespace
{

constexpr double safety = 0.9;      // of the largest stable step
constexpr double impacts = 4;       // steps are so much shorter for rigid bodies: what one step misses of an
                                    // impact's beginning is energy that is lost or gained
constexpr double at_rest = 1e-4;    // [m/s]
constexpr double most_strain = 0.5; // of a zone that yields [-]
constexpr double most_rounding = 1e-3; // of the mean force on a gridpoint
constexpr double slow = 0.01;          // below this speed everywhere, motion is stopped at its peaks [m/s]

// Adds to a sum of very many; what rounding leaves out comes with the next one (Kahan).
template <class Value>
void add(const Value& one, Value& sum, Value& lost)
{
    const Value with_lost = one + lost, before = sum;
    sum += with_lost;
    lost = with_lost - (sum - before);
}

Vector3d stress_of(const Vector3d& stiffness, const Vector3d& strain)
{
    return {stiffness[0] * strain[0] + stiffness[1] * strain[1],
            stiffness[1] * strain[0] + stiffness[0] * strain[1], stiffness[2] * strain[2]};
}

Matrix2d tensor(const Vector3d& stress)
{
    return (Matrix2d() << stress[0], stress[2], stress[2], stress[1]).finished();
}

// The stretch from the shape without stress in which Cauchy's stress is as given. In principal axes Biot's
// stress is Cauchy's times the other stretch.
Matrix2d stretch_for(const Vector3d& stiffness, const Vector3d& stress)
{
    const Eigen::SelfAdjointEigenSolver<Matrix2d> principal(tensor(stress));
    const Vector2d& cauchy = principal.eigenvalues();
    const Matrix2d elastic =
        (Matrix2d() << stiffness[0], stiffness[1], stiffness[1], stiffness[0]).finished();
    Vector2d stretch = Vector2d::Ones();
    for (int i = 0; i < 30; ++i)
        stretch =
            Vector2d::Ones() + elastic.inverse() * Vector2d(cauchy[0] * stretch[1], cauchy[1] * stretch[0]);
    return principal.eigenvectors() * stretch.asDiagonal() * principal.eigenvectors().transpose();
}

// F = rotation * stretch, by numbers of their own: what goes through matrices goes through memory.
struct Polar {
    double cos, sin;       // of the rotation
    double xx, xy, yx, yy; // of the stretch; xy and yx are the same but for rounding

    Matrix2d rotation() const { return (Matrix2d() << cos, -sin, sin, cos).finished(); }
    Matrix2d stretch() const { return (Matrix2d() << xx, xy, yx, yy).finished(); }
};

// Of a zone, from the inverse of its edges in the shape without stress.
inline Polar polar_of(const std::array<Index, 3>& g, const std::vector<Vector2d>& place,
                      const Matrix2d& inverse)
{
    const Vector2d one = place[g[1]] - place[g[0]], two = place[g[2]] - place[g[0]];
    const double xx = one.x() * inverse(0, 0) + two.x() * inverse(1, 0),
                 xy = one.x() * inverse(0, 1) + two.x() * inverse(1, 1),
                 yx = one.y() * inverse(0, 0) + two.y() * inverse(1, 0),
                 yy = one.y() * inverse(0, 1) + two.y() * inverse(1, 1);
    const double c = xx + yy, s = yx - xy, r = std::hypot(c, s), cos = c / r, sin = s / r;
    return {cos, sin, cos * xx + sin * yx, cos * xy + sin * yy, -sin * xx + cos * yx, -sin * xy + cos * yy};
}

// The part of R' P, P being the first Piola-Kirchhoff stress, that does no work on the stretch U but keeps
// Cauchy's stress symmetric: the skew W with W U + U W = U T - T U. None where Biot's stress T has the axes
// of U, as without plastic strain.
Matrix2d skew_part(const Matrix2d& stretch, const Matrix2d& stress)
{
    const double w = (stretch * stress - stress * stretch)(1, 0) / stretch.trace();
    return (Matrix2d() << 0, -w, w, 0).finished();
}

Matrix2d edges_of(const std::array<Index, 3>& g, const std::vector<Vector2d>& place)
{
    Matrix2d edges;
    edges << place[g[1]] - place[g[0]], place[g[2]] - place[g[0]];
    return edges;
}

} // namespace

Dynamics::Dynamics(mechanics::Assembly& rock, const Mesh& mesh, const std::vector<Index>& material,
                   std::vector<char> is_rigid, const joint::Law& found, const Settings& settings)
    : rock_(rock), mesh_(mesh), settings_(settings), contacts_({}), is_rigid_(std::move(is_rigid))
{
    // One law for every edge with contacts.
    std::vector<joint::Law> laws;
    std::vector<Index> material_of_law;
    law_of_edge_.assign(mesh.contact_edge.empty()
                            ? 0
                            : *std::max_element(mesh.contact_edge.begin(), mesh.contact_edge.end()) + 1,
                        0);
    std::vector<char> has_law(law_of_edge_.size(), 0);
    for (std::size_t c = 0; c < mesh.contact_edge.size(); ++c) {
        const Index e = mesh.contact_edge[c];
        if (!has_law[e]) {
            has_law[e] = 1;
            law_of_edge_[e] = laws.size();
            laws.push_back(rock.contacts.law[c]);
            material_of_law.push_back(material[c]);
        }
    }
    laws.push_back(found);
    low_ = high_ = mesh.gridpoint[0];
    for (const Vector2d& p : mesh.gridpoint) {
        low_ = low_.cwiseMin(p);
        high_ = high_.cwiseMax(p);
    }
    middle_ = (low_ + high_) / 2;
    contacts_ = FaceContacts(std::move(laws), std::move(material_of_law), middle_);

    origin_ = rock.position;
    for (Vector2d& p : origin_)
        p -= middle_;
    place_ = origin_;
    for (std::size_t g = 0; g < place_.size(); ++g)
        place_[g] += rock.displacement[g];
    velocity_.assign(place_.size(), Vector2d::Zero());
    for (std::size_t z = 0; z < rock.zones.gridpoint.size(); ++z) {
        const Vector3d& stiffness = rock.zones.stiffness[z];
        const Matrix2d stretch = stretch_for(stiffness, rock.zones.stress[z]);
        Zone zone;
        zone.gridpoint = rock.zones.gridpoint[z];
        zone.inverse = edges_of(zone.gridpoint, place_).inverse() * stretch;
        zone.area = rock.zones.area[z] / stretch.determinant();
        zone.stiffness = stiffness;
        zone.strain = {stretch(0, 0) - 1, stretch(1, 1) - 1, 2 * stretch(0, 1)};
        zones_.push_back(zone);
        if (rock.zones.yielding.empty() || rock.zones.yielding_number[z] < 0)
            continue;
        mechanics::YieldingZone yielding = rock.zones.yielding[rock.zones.yielding_number[z]];
        yielding.plastic.setZero(); // is in the shape without stress
        yielding.dissipated = 0;
        yielding.initial_zz = yielding.stress_zz - stiffness[1] * (zone.strain[0] + zone.strain[1]);
        yielding_.push_back({yielding, stress_of(stiffness, zone.strain)});
    }
    const Vector2d diagonal = Vector2d::Constant((high_ - low_).norm());
    low_ -= middle_ + diagonal;
    high_ += diagonal - middle_;
    find_ground();
    find_walls();
    start();
}

void Dynamics::start()
{
    released_.assign(place_.size(), Vector2d::Zero());
    lost_.assign(place_.size(), Vector2d::Zero());
    time_ = time_lost_ = 0;
    energy_ = {};
    starts_from_rest_ = true;
    has_moved_ = false;
    last_kinetic_ = 0;
    checks_in_balance_ = 0;
    last_contact_force_.clear();
    in_zones_ = {};
    corner_force_.assign(3 * zones_.size(), Vector2d::Zero());
    velocity_.assign(place_.size(), Vector2d::Zero());
    find_faces();
    find_bodies();
    find_time_step();
    find_forces(velocity_);
    if (contacts_.stiffest() > stiffest_allowed_)
        find_time_step();
    if (settings_.release > 0) // what is unbalanced now, the excavated rock has held
        for (std::size_t g = 0; g < place_.size(); ++g)
            released_[g] = -force_[g];
    find_forces(velocity_);
    stored_at_start_ = stored();
}

Dynamics::Yielding* Dynamics::yielding(std::size_t z)
{
    if (yielding_.empty() || rock_.zones.yielding_number[z] < 0)
        return nullptr;
    return &yielding_[rock_.zones.yielding_number[z]];
}

// The gridpoint that each one moves with: itself, but for those that are tied.
std::vector<Index> Dynamics::leaders() const
{
    std::vector<Index> leader(place_.size());
    std::iota(leader.begin(), leader.end(), 0);
    for (const auto& [follower, first] : rock_.tied)
        leader[follower] = first;
    return leader;
}

// The fixed ground that boundaries rest on through a joint, along all of them, whatever rock there is.
void Dynamics::find_ground()
{
    const mechanics::Contacts& contacts = rock_.contacts;
    std::map<Index, std::vector<std::size_t>> on_ground; // contacts of a gridpoint
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        const auto [a, b] = contacts.gridpoint[c];
        if (rock_.incidence.zone_start[a] == rock_.incidence.zone_start[a + 1])
            on_ground[b].push_back(c);
    }
    for (std::size_t s = 0; s < mesh_.side_gridpoint.size(); ++s) {
        auto [from, to] = mesh_.side_gridpoint[s];
        const auto& corners = mesh_.zone_gridpoint[mesh_.side_zone[s]];
        const auto first = std::find(corners.begin(), corners.end(), from) - corners.begin();
        if (corners[(first + 1) % 3] != to)
            std::swap(from, to);
        if (!on_ground.contains(from) || !on_ground.contains(to))
            continue;
        for (const std::size_t c : on_ground[from])
            for (const std::size_t d : on_ground[to])
                if (mesh_.contact_edge[c] == mesh_.contact_edge[d])
                    ground_.push_back({contacts.gridpoint[d][0], contacts.gridpoint[c][0]});
    }
}

// The laws of the joints that sides of zones and of the ground lie on, whatever rock there is.
void Dynamics::find_walls()
{
    std::map<std::array<Index, 2>, std::vector<std::size_t>> between; // gridpoints {lower, higher}
    for (std::size_t c = 0; c < mesh_.contact_gridpoint.size(); ++c) {
        const auto [a, b] = mesh_.contact_gridpoint[c];
        between[{std::min(a, b), std::max(a, b)}].push_back(c);
    }
    const auto contacts_of = [&](Index a, Index b) {
        const auto there = between.find({std::min(a, b), std::max(a, b)});
        return there == between.end() ? std::vector<std::size_t>() : there->second;
    };
    std::map<std::array<double, 4>, std::array<Index, 2>> side_at; // {from, to}
    const auto take = [&](Index from, Index to) {
        const Vector2d &p = mesh_.gridpoint[from], &q = mesh_.gridpoint[to];
        side_at[{p.x(), p.y(), q.x(), q.y()}] = {from, to};
        const auto opposite = side_at.find({q.x(), q.y(), p.x(), p.y()});
        if (opposite == side_at.end())
            return;
        // Both ends are on the edge; the tip of a joint has no contact.
        const Vector2d normal = normal_of(tangent_of(p, q));
        const std::vector<std::size_t> first = contacts_of(from, opposite->second[1]),
                                       second = contacts_of(to, opposite->second[0]);
        std::size_t best = 0;
        double most = 0;
        for (const auto& [some, others] : {std::pair(&first, &second), std::pair(&second, &first)})
            for (const std::size_t c : *some) {
                const bool is_at_both = std::ranges::any_of(
                    *others, [&](std::size_t d) { return mesh_.contact_edge[d] == mesh_.contact_edge[c]; });
                const double fits = std::abs(mesh_.contact_normal[c].dot(normal)) + (is_at_both ? 1 : 0);
                if (fits > most) {
                    most = fits;
                    best = c;
                }
            }
        if (most > 0)
            wall_law_[{from, to}] = wall_law_[opposite->second] = law_of_edge_[mesh_.contact_edge[best]];
    };
    for (const Zone& zone : zones_)
        for (int i = 0; i < 3; ++i)
            take(zone.gridpoint[i], zone.gridpoint[(i + 1) % 3]);
    for (const auto& [from, to] : ground_)
        take(from, to);
}

// The faces of what rock there is, and of the ground. Where both of two faces were not there before, a joint
// of the mesh between them makes them a pair; other pairs stay what they are.
void Dynamics::find_faces()
{
    std::vector<Index> leader = leaders();
    std::map<std::array<double, 2>, Index> ground_at; // every side has its own gridpoints there
    for (const auto& side : ground_)
        for (const Index g : side)
            leader[g] =
                ground_at.try_emplace({mesh_.gridpoint[g].x(), mesh_.gridpoint[g].y()}, g).first->second;

    std::map<std::array<Index, 2>, int> sides; // by leaders
    const auto key = [&](Index from, Index to) { return std::array<Index, 2>{leader[from], leader[to]}; };
    for (std::size_t z = 0; z < zones_.size(); ++z)
        if (rock_.zones.is_present[z])
            for (int i = 0; i < 3; ++i)
                ++sides[key(zones_[z].gridpoint[i], zones_[z].gridpoint[(i + 1) % 3])];
    Faces faces;
    std::vector<std::array<Index, 2>> of_mesh;
    std::map<std::array<Index, 2>, Index> face_of, face_before; // by gridpoints of the mesh
    for (std::size_t f = 0; f < face_of_mesh_.size(); ++f)
        face_before[face_of_mesh_[f]] = static_cast<Index>(f);
    zone_of_face_.clear();
    const auto add = [&](Index from, Index to, Index zone, double depth) {
        zone_of_face_.push_back(zone);
        face_of[{from, to}] = static_cast<Index>(of_mesh.size());
        of_mesh.push_back({from, to});
        faces.gridpoint.push_back(key(from, to));
        faces.depth.push_back(depth);
        const auto wall = wall_law_.find({from, to});
        faces.law.push_back(wall == wall_law_.end() ? contacts_.laws().size() - 1 : wall->second);
    };
    for (std::size_t z = 0; z < zones_.size(); ++z)
        if (rock_.zones.is_present[z])
            for (int i = 0; i < 3; ++i) {
                const Index from = zones_[z].gridpoint[i], to = zones_[z].gridpoint[(i + 1) % 3];
                if (!sides.contains(key(to, from)))
                    add(from, to, static_cast<Index>(z),
                        2 * rock_.zones.area[z] / (origin_[to] - origin_[from]).norm());
            }
    for (const auto& [from, to] : ground_)
        add(from, to, -1, (mesh_.gridpoint[to] - mesh_.gridpoint[from]).norm());

    std::vector<FacePair> known;
    for (const FacePair& pair : contacts_.pairs()) {
        const auto a = face_of.find(face_of_mesh_[pair.a]), b = face_of.find(face_of_mesh_[pair.b]);
        if (!pair.is_known || a == face_of.end() || b == face_of.end())
            continue;
        FacePair kept = pair;
        kept.a = a->second;
        kept.b = b->second;
        if (kept.a > kept.b) {
            std::swap(kept.a, kept.b);
            std::swap(kept.lead[0], kept.lead[1]);
        }
        known.push_back(kept);
    }

    const mechanics::Contacts& contacts = rock_.contacts;
    std::map<std::array<Index, 2>, std::vector<std::size_t>> between; // gridpoints {lower, higher}
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed) {
            const auto [a, b] = contacts.gridpoint[c];
            between[{std::min(a, b), std::max(a, b)}].push_back(c);
        }
    std::map<std::array<double, 4>, Index> new_at; // {from, to}, at the start
    for (std::size_t f = 0; f < of_mesh.size(); ++f) {
        const auto [from, to] = of_mesh[f];
        if (face_before.contains(of_mesh[f]))
            continue;
        const Vector2d &p = mesh_.gridpoint[from], &q = mesh_.gridpoint[to];
        new_at[{p.x(), p.y(), q.x(), q.y()}] = static_cast<Index>(f);
        const auto opposite = new_at.find({q.x(), q.y(), p.x(), p.y()});
        if (opposite == new_at.end())
            continue;
        FacePair pair{.a = opposite->second, .b = static_cast<Index>(f), .is_known = true};
        const Vector2d normal = normal_of(tangent_of(p, q));
        int n = 0;
        std::array<bool, 2> has_lead{};
        for (int end = 0; end < 2; ++end) {
            const Index a = of_mesh[pair.a][end], b = of_mesh[pair.b][1 - end];
            const auto there = between.find({std::min(a, b), std::max(a, b)});
            if (there == between.end())
                continue; // the tip of a joint
            const std::size_t c = *std::max_element(there->second.begin(), there->second.end(),
                                                    [&](std::size_t i, std::size_t j) {
                                                        return std::abs(contacts.normal[i].dot(normal)) <
                                                               std::abs(contacts.normal[j].dot(normal));
                                                    });
            pair.law = law_of_edge_[mesh_.contact_edge[c]];
            pair.lead[end] = contacts.offset[c].x() + contacts.state[c].dilation -
                             joint::opening(contacts.law[c], contacts.initial_traction[c].x());
            has_lead[end] = true;
            pair.tau += contacts.traction[c].y();
            pair.is_broken =
                n == 0 ? contacts.state[c].is_broken : pair.is_broken || contacts.state[c].is_broken;
            if (n == 0)
                pair.memory = contacts.state[c].memory;
            ++n;
        }
        if (n == 0)
            continue;
        if (!joint::is_linear(contacts_.laws()[pair.law]))
            pair.is_broken = true; // it never had bonds
        pair.tau /= n;
        for (int end = 0; end < 2; ++end)
            if (!has_lead[end])
                pair.lead[end] = pair.lead[1 - end];
        known.push_back(pair);
    }
    face_of_mesh_ = std::move(of_mesh);
    contacts_.set_faces(std::move(faces), std::move(known), place_);
}

void Dynamics::find_bodies()
{
    const std::vector<Index> leader = leaders();
    const std::vector<double> masses = lumped_masses(rock_);
    DisjointSets sets(place_.size());
    std::vector<char> is_of_body(place_.size(), 0);
    for (std::size_t z = 0; z < zones_.size(); ++z)
        if (is_rigid_[z] && rock_.zones.is_present[z])
            for (const Index g : zones_[z].gridpoint) {
                is_of_body[g] = 1;
                sets.join(g, zones_[z].gridpoint[0]);
            }
    for (const auto& [follower, first] : rock_.tied)
        if (is_of_body[follower] || is_of_body[first]) {
            sets.join(follower, first);
            is_of_body[follower] = 0; // goes with its leader
            is_of_body[first] = 1;
        }

    bodies_.clear();
    body_of_.assign(place_.size(), -1);
    std::map<Index, Index> number; // by root
    for (std::size_t g = 0; g < place_.size(); ++g) {
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
        body.centre += masses[g] * place_[g];
        body.is_free = body.is_free.cwiseMin(rock_.is_free[g]);
    }
    for (Body& body : bodies_) {
        body.centre /= body.mass;
        for (const Index g : body.gridpoint)
            body.arm.emplace_back(place_[g] - body.centre);
    }
    // Deformable rock that is bonded to a body is lumped into gridpoints that the two share.
    std::vector<double> lumped = masses;
    for (std::size_t z = 0; z < zones_.size(); ++z) {
        if (!is_rigid_[z] || !rock_.zones.is_present[z])
            continue;
        Body& body = bodies_[number.at(sets.root(zones_[z].gridpoint[0]))];
        Vector2d sum(0, 0);
        for (const Index g : zones_[z].gridpoint) {
            const Vector2d arm = place_[g] - body.centre;
            body.inertia += rock_.zones.mass[z] / 12 * arm.squaredNorm();
            sum += arm;
            lumped[leader[g]] -= rock_.zones.mass[z] / 3;
        }
        body.inertia += rock_.zones.mass[z] / 12 * sum.squaredNorm();
    }
    for (Body& body : bodies_)
        for (std::size_t k = 0; k < body.gridpoint.size(); ++k)
            body.inertia += std::max(0.0, lumped[body.gridpoint[k]]) * body.arm[k].squaredNorm();
}

// Force and moment about the centre [N/m], [N].
std::pair<Vector2d, double> Dynamics::load_on(const Body& body) const
{
    Vector2d force(0, 0);
    double moment = 0;
    for (const Index g : body.gridpoint) {
        const Vector2d arm = place_[g] - body.centre;
        force += force_[g];
        moment += arm.x() * force_[g].y() - arm.y() * force_[g].x();
    }
    if (!body.turns())
        moment = 0;
    return {force.cwiseProduct(body.is_free), moment};
}

// One step; returns the kinetic energy before it [J/m].
double Dynamics::move(Body& body, double keep, double gain)
{
    if (body.is_held())
        return 0;
    const auto [force, moment] = load_on(body);
    const Vector2d last = body.velocity;
    const double last_spin = body.spin;
    body.velocity = keep * body.velocity + gain / body.mass * force;
    body.spin = keep * body.spin + gain / body.inertia * moment;
    add<Vector2d>(dt_ * body.velocity, body.centre, body.lost);
    body.angle += dt_ * body.spin;
    const Eigen::Rotation2Dd turn(body.angle);
    for (std::size_t k = 0; k < body.gridpoint.size(); ++k) {
        const Index g = body.gridpoint[k];
        const Vector2d to = body.centre + turn * body.arm[k];
        move_[g] = to - place_[g];
        velocity_[g] = move_[g] / dt_;
        place_[g] = to;
    }
    return (body.mass * last.dot(body.velocity) + body.inertia * last_spin * body.spin) / 2;
}

// From the sums of the magnitudes of all blocks of the stiffness in a gridpoint's rows (Gershgorin), which
// turning does not change.
void Dynamics::find_time_step()
{
    std::vector<double> sums(place_.size(), 0.0);
    for (std::size_t z = 0; z < zones_.size(); ++z)
        if (deforms(z))
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    sums[zones_[z].gridpoint[i]] +=
                        rock_.zones.area[z] * stiffness_between(rock_.zones, z, i, j).norm();
    // Where joints grow stiffer as they close, with room for that.
    stiffest_allowed_ =
        contacts_.stiffens() ? mechanics::room_to_stiffen * contacts_.stiffest() : contacts_.stiffest();
    for (const auto& [from, to] : contacts_.faces().gridpoint)
        for (const Index g : {from, to})
            sums[g] += stiffest_allowed_ * (place_[to] - place_[from]).norm();
    for (const auto& [follower, leader] : rock_.tied)
        sums[leader] += sums[follower];
    const auto stiffest = std::max_element(sums.begin(), sums.end());
    stiffest_ = *stiffest;
    stiffest_gridpoint_ = static_cast<Index>(stiffest - sums.begin());

    inverse_mass_ = lumped_masses(rock_);
    double highest = 0; // frequency squared
    for (const Body& body : bodies_) {
        double sum = 0;
        for (std::size_t k = 0; k < body.gridpoint.size(); ++k) {
            sum += sums[body.gridpoint[k]] * (1 / body.mass + body.arm[k].squaredNorm() / body.inertia);
            inverse_mass_[body.gridpoint[k]] = 0; // moves with the body
        }
        if (!body.is_held())
            highest = std::max(highest, impacts * impacts * sum);
    }
    for (std::size_t g = 0; g < sums.size(); ++g)
        if (double& mass = inverse_mass_[g]; mass > 0) {
            highest = std::max(highest, sums[g] / mass);
            mass = 1 / mass;
        }
    // Stiffness damping shortens the stable step: (2 / w) (sqrt(1 + xi^2) - xi), xi = beta w / 2.
    const double xi = settings_.stiffness_damping * std::sqrt(highest) / 2;
    dt_ = highest == 0 ? 1e-3 // all rock is held
                       : safety * 2 / std::sqrt(highest) * (std::sqrt(1 + xi * xi) - xi);
}

// Of a step's time, by which the force at its beginning counts beside the velocity before: half of this step
// and half of the last one.
double Dynamics::first_half() const
{
    return starts_from_rest_ ? 0.5 : (last_dt_ + dt_) / (2 * dt_);
}

double Dynamics::release_factor() const
{
    return settings_.release > 0 ? std::max(0.0, 1 - time_ / settings_.release) : 0.0;
}

void Dynamics::find_forces(const std::vector<Vector2d>& move)
{
    for (const auto& [follower, leader] : rock_.tied)
        place_[follower] = place_[leader];
    const auto n_zones = static_cast<Index>(zones_.size());
    const double viscosity = settings_.stiffness_damping / dt_;
    const auto pull = [&](Index z, ZoneSums& sums) {
        if (!deforms(z))
            return;
        Zone& zone = zones_[z];
        const Polar polar = polar_of(zone.gridpoint, place_, zone.inverse);
        const Vector3d strain(polar.xx - 1, polar.yy - 1, 2 * polar.xy);
        Vector3d stress, held;
        Yielding* const yields = yielding(z);
        if (yields != nullptr) {
            const Vector3d last = yields->stress;
            yields->zone.dissipated = 0;
            stress = yielded(yields->zone, zone.stiffness, Vector3d::Zero(), last, strain);
            held = viscosity * (stress - last);
            yields->stress = stress;
            if (sums.torn < 0 && !(strain.cwiseAbs().maxCoeff() <= most_strain))
                sums.torn = z;
            sums.friction += zone.area * yields->zone.dissipated;
            sums.stored += zone.area * mechanics::stored(zone.stiffness, stress, yields->zone.stress_zz);
        } else {
            stress = stress_of(zone.stiffness, strain);
            held = viscosity * stress_of(zone.stiffness, strain - zone.strain);
            sums.stored += zone.area / 2 * stress.dot(strain);
        }
        sums.damped += zone.area / 2 * (zone.held + held).dot(strain - zone.strain); // as of contacts
        zone.held = held;
        zone.strain = strain;
        const Vector3d acting = stress + held;
        double xy = acting[2], yx = acting[2];
        if (yields != nullptr) {
            const double w = skew_part(polar.stretch(), tensor(acting))(1, 0);
            xy -= w;
            yx += w;
        }
        // First Piola-Kirchhoff stress, times the area.
        const double c = zone.area * polar.cos, s = zone.area * polar.sin;
        const Vector2d of_x(c * acting[0] - s * yx, s * acting[0] + c * yx),
            of_y(c * xy - s * acting[1], s * xy + c * acting[1]);
        const Vector2d one = zone.inverse(0, 0) * of_x + zone.inverse(0, 1) * of_y,
                       two = zone.inverse(1, 0) * of_x + zone.inverse(1, 1) * of_y;
        Vector2d* const force = corner_force_.data() + 3 * static_cast<std::ptrdiff_t>(z);
        force[0] = one + two;
        force[1] = -one;
        force[2] = -two;
    };
    const double lost_before = in_zones_.friction; // at the start
    in_zones_ = sum_in_chunks<ZoneSums>(n_zones, rock_.threads, pull);
    in_zones_.friction += lost_before;
    contacts_.update(place_, move, dt_, settings_.stiffness_damping, rock_.threads);
    const double held = release_factor();
    force_.resize(place_.size());
    const mechanics::Incidence& incidence = rock_.incidence;
    for_each(static_cast<Index>(place_.size()), rock_.threads, [&](Index g) {
        Vector2d force = rock_.load[g] + rock_.applied[g] + held * released_[g];
        for (Index k = incidence.zone_start[g]; k < incidence.zone_start[g + 1]; ++k)
            force += corner_force_[incidence.zone_corner[k]];
        force_[g] = force;
    });
    contacts_.add_forces(force_, rock_.threads);
    for (const auto& [follower, leader] : rock_.tied) {
        force_[leader] += force_[follower];
        force_[follower].setZero();
    }
}

double Dynamics::stored() const
{
    return in_zones_.stored + contacts_.energy().stored;
}

void Dynamics::step()
{
    const auto n = static_cast<Index>(place_.size());
    const double alpha = settings_.mass_damping;
    const double keep = (1 - alpha * dt_ / 2) / (1 + alpha * dt_ / 2);
    const double gain = first_half() * dt_ / (1 + alpha * dt_ / 2);
    const double held = release_factor();
    struct Moved {
        double kinetic = 0, damped = 0;
        double fastest = 0; // [m2/s2]
        Index fastest_gridpoint = -1;

        void see(const Vector2d& velocity, Index g)
        {
            if (velocity.squaredNorm() > fastest) {
                fastest = velocity.squaredNorm();
                fastest_gridpoint = g;
            }
        }
        void operator+=(const Moved& other)
        {
            kinetic += other.kinetic;
            damped += other.damped;
            if (other.fastest > fastest) {
                fastest = other.fastest;
                fastest_gridpoint = other.fastest_gridpoint;
            }
        }
    };
    move_.resize(n);
    Moved moved = sum_in_chunks<Moved>(n, rock_.threads, [&](Index g, Moved& some) {
        if (inverse_mass_[g] == 0) {
            move_[g].setZero();
            return;
        }
        Vector2d& v = velocity_[g];
        const Vector2d last = v;
        v = keep * v + gain * inverse_mass_[g] * force_[g].cwiseProduct(rock_.is_free[g]);
        const Vector2d now = starts_from_rest_ ? last : Vector2d((last + v) / 2);
        some.kinetic += last.dot(v) / (2 * inverse_mass_[g]);
        some.damped += alpha * dt_ * now.squaredNorm() / inverse_mass_[g];
        some.see(v, g);
        move_[g] = dt_ * v;
        add(move_[g], place_[g], lost_[g]);
    });
    moved +=
        sum_in_chunks<Moved>(static_cast<Index>(bodies_.size()), rock_.threads, [&](Index b, Moved& some) {
            const double before = move(bodies_[b], keep, gain);
            some.kinetic += before;
            some.damped += 2 * alpha * dt_ * before;
            for (const Index g : bodies_[b].gridpoint)
                some.see(velocity_[g], g);
        });
    const double kinetic = moved.kinetic;
    energy_.damped += moved.damped;
    if (moved.fastest_gridpoint >= 0)
        fastest_gridpoint_ = moved.fastest_gridpoint;
    // After a stop: from then on it is the product of this velocity and its opposite that counts as kinetic
    // energy (see energy()).
    if (starts_from_rest_ && time_ > 0)
        energy_.damped += half_step_energy();
    starts_from_rest_ = false;
    for (const auto& [follower, leader] : rock_.tied) {
        move_[follower] = move_[leader];
        velocity_[follower] = velocity_[leader];
    }
    fastest_ = std::sqrt(moved.fastest);
    has_moved_ = has_moved_ || fastest_ > slow;
    struct Work {
        double work = 0;
        bool is_gone = false; // outside

        void operator+=(const Work& other)
        {
            work += other.work;
            is_gone = is_gone || other.is_gone;
        }
    };
    const auto worked = sum_in_chunks<Work>(n, rock_.threads, [&](Index g, Work& some) {
        some.work += (rock_.load[g] + rock_.applied[g] + held * released_[g]).dot(move_[g]);
        if (!((place_[g].array() > low_.array()).all() && (place_[g].array() < high_.array()).all()))
            some.is_gone = true;
    });
    energy_.work += worked.work;
    if (!std::isfinite(fastest_) || !std::isfinite(kinetic))
        throw equilibrium_error("dynamic analysis: the velocity of rock is no number; it was at " +
                                shown(rock_.position[fastest_gridpoint_]));
    if (worked.is_gone)
        throw moves_on("rock has left the section, and is as far from it as the section is large");
    add(dt_, time_, time_lost_);
    last_dt_ = dt_;
    find_forces(move_);
    if (in_zones_.torn >= 0)
        throw equilibrium_error("dynamic analysis: rock that yields at " +
                                shown(Vector2d(middle_ + place_[zones_[in_zones_.torn].gridpoint[0]])) +
                                " is strained by more than " + shown(100 * most_strain) +
                                " percent, more than a zone can be");
    energy_.stored = stored() - stored_at_start_;
    energy_.damped += in_zones_.damped + contacts_.energy().damped;
    energy_.friction += in_zones_.friction + contacts_.energy().friction;
    in_zones_.friction = 0;
    // What is nearly at rest swings about it. Stopped where its kinetic energy is largest, it comes to rest;
    // what slides or falls has no such peak until it is no longer slow.
    if (fastest_ < slow && kinetic < last_kinetic_) {
        energy_.damped += energy().kinetic;
        for (Body& body : bodies_) {
            body.velocity.setZero();
            body.spin = 0;
        }
        last_kinetic_ = 0;
        velocity_.assign(n, Vector2d::Zero());
        starts_from_rest_ = true;
    } else
        last_kinetic_ = kinetic;
    if (contacts_.stiffest() > stiffest_allowed_)
        find_time_step();
}

void Dynamics::transfer(const Transfer& to, DynamicsState& kept)
{
    // All members, lest a new one is forgotten.
    auto& [rock, mesh, settings, contacts, bodies, is_rigid, body_of, zones, corner_force, yielding, place,
           velocity, move, force, released, lost, origin, middle, low, high, inverse_mass, law_of_edge,
           ground, wall_law, face_of_mesh, zone_of_face, dt, last_dt, time, time_lost, stiffest_allowed,
           starts_from_rest, has_moved, energy, stored_at_start, in_zones, last_kinetic, stiffest,
           largest_mean, ratio, force_change, fastest, fastest_gridpoint, stiffest_gridpoint,
           checks_in_balance, last_contact_force] = *this;
    to.values(origin, kept.origin);
    to.values(place, kept.place);
    for (std::size_t g = 0; g < origin.size(); ++g)
        rock.position[g] = middle + origin[g];
    std::vector<Eigen::Vector4d> inverse;
    for (const Zone& zone : zones)
        inverse.emplace_back(zone.inverse.reshaped());
    to.values(inverse, kept.inverse);
    for (std::size_t z = 0; z < zones.size(); ++z)
        zones[z].inverse = inverse[z].reshaped(2, 2);
    for (Zone& zone : zones)
        [[maybe_unused]] auto& [gridpoint, of_edges, area, stiffness, strain, held] = zone;
    to.values(zones, kept.area, &Zone::area);
    to.values(zones, kept.strain, &Zone::strain);
    for (Yielding& one : yielding)
        [[maybe_unused]] auto& [zone, stress] = one;
    const auto of_zone = [](auto member) {
        return [member](Yielding & one) -> auto&
        {
            return one.zone.*member;
        };
    };
    to.values(yielding, kept.plastic_strain, of_zone(&mechanics::YieldingZone::plastic));
    to.values(yielding, kept.initial_zz, of_zone(&mechanics::YieldingZone::initial_zz));
    to.values(yielding, kept.stress_zz, of_zone(&mechanics::YieldingZone::stress_zz));
    to.values(yielding, kept.stress, &Yielding::stress);
    to.size(face_of_mesh, kept.face);
    to.values(face_of_mesh, kept.face);
    contacts.transfer(to, kept);
    to.value(fastest, kept.fastest);
    to.value(ratio, kept.unbalanced_force_ratio);
    to.value(largest_mean, kept.largest_mean_force);
}

// Of the velocities as they are, half a step ago [J/m].
double Dynamics::half_step_energy() const
{
    auto sum =
        sum_in_chunks<double>(static_cast<Index>(place_.size()), rock_.threads, [&](Index g, double& some) {
            if (inverse_mass_[g] > 0)
                some += velocity_[g].squaredNorm() / (2 * inverse_mass_[g]);
        });
    for (const Body& body : bodies_)
        sum += (body.mass * body.velocity.squaredNorm() + body.inertia * body.spin * body.spin) / 2;
    return sum;
}

// Velocities are known half a step before and after now; with their product as the square, work of forces is
// kinetic energy to the last digit.
Energy Dynamics::energy() const
{
    Energy energy = energy_;
    const double alpha = settings_.mass_damping;
    const double keep = (1 - alpha * dt_ / 2) / (1 + alpha * dt_ / 2), gain = dt_ / (1 + alpha * dt_ / 2);
    energy.kinetic +=
        sum_in_chunks<double>(static_cast<Index>(place_.size()), rock_.threads, [&](Index g, double& some) {
            if (inverse_mass_[g] == 0)
                return;
            const Vector2d next =
                keep * velocity_[g] + gain * inverse_mass_[g] * force_[g].cwiseProduct(rock_.is_free[g]);
            some += velocity_[g].dot(next) / (2 * inverse_mass_[g]);
        });
    for (const Body& body : bodies_)
        if (!body.is_held()) {
            const auto [force, moment] = load_on(body);
            energy.kinetic +=
                (keep * body.mass * body.velocity.squaredNorm() + gain * body.velocity.dot(force) +
                 keep * body.inertia * body.spin * body.spin + gain * body.spin * moment) /
                2;
        }
    // A sum of what shear gains and loses as the length of a contact changes: without slip, rounding about 0.
    if (energy.friction < 0 &&
        -energy.friction < 1e-12 * std::max({energy.kinetic, std::abs(energy.work), energy.stored}))
        energy.friction = 0;
    return energy;
}

mechanics::no_equilibrium Dynamics::moves_on(const std::string& why) const
{
    mechanics::no_equilibrium error(why);
    error.moves_on = true;
    error.steps = check_every;
    error.seconds = check_every * dt_;
    for (const Vector2d& velocity : velocity_)
        error.motion.emplace_back(error.seconds * velocity);
    return error;
}

void Dynamics::count_from_here()
{
    origin_ = place_;
    for (std::size_t g = 0; g < place_.size(); ++g)
        rock_.position[g] = middle_ + place_[g];
    put_back();
}

bool Dynamics::is_at_rest()
{
    std::vector<Vector2d> contact_force(place_.size(), Vector2d::Zero());
    contacts_.add_forces(contact_force, rock_.threads);
    double largest = 0, sum = 0, farthest = 0, change = 0;
    Index n = 0;
    const mechanics::Incidence& incidence = rock_.incidence;
    for (std::size_t g = 0; g < place_.size(); ++g) {
        if (body_of_[g] < 0)
            largest = std::max(largest, force_[g].cwiseProduct(rock_.is_free[g]).norm());
        farthest = std::max(farthest, place_[g].norm());
        double all = rock_.load[g].norm() + rock_.applied[g].norm() + contact_force[g].norm();
        for (Index k = incidence.zone_start[g]; k < incidence.zone_start[g + 1]; ++k)
            all += corner_force_[incidence.zone_corner[k]].norm();
        if (all > 0) {
            sum += all;
            ++n;
        }
        if (!last_contact_force_.empty())
            change = std::max(change, (contact_force[g] - last_contact_force_[g]).norm());
    }
    for (const Body& body : bodies_)
        if (!body.is_held()) {
            const auto [force, moment] = load_on(body);
            largest =
                std::max({largest, force.norm(), std::abs(moment) / std::sqrt(body.inertia / body.mass)});
        }
    // Where forces are almost none, they are rounding errors of stiffness times place; no larger than these,
    // nothing bears anything. Dashpots multiply them by their time over that of a step: too much for zones
    // that are tiny, whose forces then say nothing.
    const double of_springs = 1e-15 * stiffest_ * farthest;
    const double rounding = of_springs * (1 + settings_.stiffness_damping / dt_);
    largest_mean_ = std::max(largest_mean_, n > 0 ? sum / n : 0.0);
    if (largest_mean_ > of_springs && rounding > most_rounding * largest_mean_) {
        const std::string where =
            "; what is stiffest is at " + shown(rock_.position[stiffest_gridpoint_]) + ": wanted ";
        if (of_springs > most_rounding * largest_mean_)
            throw equilibrium_error(
                "dynamic analysis: rounding errors of places, times stiffness, are not small beside the "
                "mean force on a gridpoint, " +
                shown(largest_mean_) + " N/m" + where + "more load, softer joints, or no zones so small");
        throw equilibrium_error(
            "dynamic analysis: a step takes " + shown(dt_) + " s, and what " +
            shown(settings_.stiffness_damping) +
            " s of stiffness damping makes of rounding errors is no longer small beside the "
            "forces" +
            where + "less damping there, or no zones so small");
    }
    const double mean = n > 0 ? std::max(sum / n, rounding / settings_.tolerance) : 1.0;
    ratio_ = largest / mean;
    const bool has_last = !last_contact_force_.empty();
    force_change_ = change / mean;
    last_contact_force_ = std::move(contact_force);
    const bool is_balanced = fastest_ <= at_rest && ratio_ <= settings_.tolerance && has_last &&
                             force_change_ <= settings_.tolerance && release_factor() == 0;
    checks_in_balance_ = is_balanced ? checks_in_balance_ + 1 : 0;
    return checks_in_balance_ >= 2;
}

std::vector<Touching> Dynamics::touching() const
{
    std::vector<Touching> found;
    for (const FacePair& pair : contacts_.pairs()) {
        if (!pair.is_closed)
            continue;
        const auto &a = contacts_.faces().gridpoint[pair.a], &b = contacts_.faces().gridpoint[pair.b];
        std::array<Vector2d, 2> between;
        for (int i = 0; i < 2; ++i)
            between[i] = middle_ + (place_[a[0]] + pair.on_a[i] * (place_[a[1]] - place_[a[0]]) +
                                    place_[b[0]] + pair.on_b[i] * (place_[b[1]] - place_[b[0]])) /
                                       2;
        found.push_back({{zone_of_face_[pair.a], zone_of_face_[pair.b]},
                         between,
                         pair.normal,
                         {pair.sigma, pair.tau},
                         -joint::opening(contacts_.laws()[pair.law], pair.sigma),
                         pair.is_slipping});
    }
    return found;
}

void Dynamics::put_back()
{
    for (std::size_t g = 0; g < place_.size(); ++g)
        rock_.displacement[g] = place_[g] - origin_[g];
    for (std::size_t z = 0; z < zones_.size(); ++z) {
        if (!rock_.zones.is_present[z])
            continue;
        if (is_rigid_[z]) {
            rock_.zones.stress[z].setZero(); // unknown
            continue;
        }
        const Zone& zone = zones_[z];
        const Polar polar = polar_of(zone.gridpoint, place_, zone.inverse);
        const Matrix2d rotation = polar.rotation(), stretch = polar.stretch();
        const Yielding* const yields = yielding(z);
        Matrix2d biot = tensor(yields != nullptr ? yields->stress : stress_of(zone.stiffness, zone.strain));
        if (yields != nullptr) {
            biot += skew_part(stretch, biot);
            const Eigen::Vector4d& p = yields->zone.plastic;
            const Matrix2d plastic = rotation * tensor({p[0], p[1], p[3] / 2}) * rotation.transpose();
            mechanics::YieldingZone& seen = rock_.zones.yielding[rock_.zones.yielding_number[z]];
            seen.plastic = {plastic(0, 0), plastic(1, 1), p[2], 2 * plastic(0, 1)};
            seen.stress_zz = yields->zone.stress_zz;
        }
        const Matrix2d stress = rotation * biot * stretch * rotation.transpose() / stretch.determinant();
        rock_.zones.stress[z] = {stress(0, 0), stress(1, 1), (stress(0, 1) + stress(1, 0)) / 2};
    }
    const std::vector<Index> leader = leaders();
    mechanics::Contacts& contacts = rock_.contacts;
    // What all pairs of faces that meet at two gridpoints bear, over their length: next to the pair that
    // faces each other there are others that overlap by what the joint has sheared.
    struct Borne {
        Vector2d force{0, 0};            // {normal, shear} [N/m]
        double length = 0, slipping = 0; // of all, and of what slips [m]
    };
    std::map<std::array<Index, 2>, Borne> borne; // by gridpoints {lower, higher}
    for (const FacePair& pair : contacts_.pairs())
        if (pair.is_closed && pair.length > 0)
            for (const Index a : face_of_mesh_[pair.a])
                for (const Index b : face_of_mesh_[pair.b]) {
                    Borne& there = borne[{std::min(a, b), std::max(a, b)}];
                    there.force += pair.length * Vector2d(pair.sigma, pair.tau);
                    there.length += pair.length;
                    there.slipping += pair.is_slipping ? pair.length : 0.0;
                }
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const auto [a, b] = contacts.gridpoint[c];
        const Vector2d relative = rock_.displacement[b] - rock_.displacement[a];
        contacts.relative_displacement[c] = {relative.dot(contacts.normal[c]),
                                             relative.dot(along(contacts.normal[c]))};
        const auto found = borne.find({std::min(a, b), std::max(a, b)});
        if (found == borne.end()) {
            if (leader[a] == leader[b]) // held together so far: as it was
                continue;
            contacts.traction[c].setZero();
            contacts.status[c] = ContactStatus::open;
            continue;
        }
        contacts.traction[c] = found->second.force / found->second.length;
        contacts.status[c] = 2 * found->second.slipping > found->second.length ? ContactStatus::slipping
                                                                               : ContactStatus::stuck;
    }
}

} // namespace jointcreep::large_displacements
