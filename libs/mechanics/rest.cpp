#include "mechanics/rest.hpp"

#include "model/disjoint_sets.hpp"

#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>

namespace jointcreep::mechanics
{

namespace
{

using Eigen::Vector3d;

constexpr double soft = 1e-9; // share of their springs that contacts without load keep

// Connected rock as a rigid body: it moves by {x, y, rotation times radius}.
struct Body {
    Index first = -1; // gridpoint
    Vector2d middle{0, 0};
    double radius = 0;                // farthest gridpoint from the middle [m]
    Vector3d unbalanced{0, 0, 0};     // force, moment over radius [N/m]
    double loads = 0, gridpoints = 0; // sum of magnitudes of weight and tractions [N/m]; count

    // Displacements of a place by unit movements of the body.
    Eigen::Matrix<double, 2, 3> moves(const Vector2d& place) const
    {
        const Vector2d arm = (place - middle) / radius;
        return (Eigen::Matrix<double, 2, 3>() << 1, 0, -arm.y(), 0, 1, arm.x()).finished();
    }
};

// Whether no gridpoint has an unbalanced force above a share of its own load: then no body has one either.
bool is_plain(const Assembly& assembly, double share, double rounding)
{
    const double n = static_cast<double>(assembly.force.size());
    for (std::size_t g = 0; g < assembly.force.size(); ++g)
        if (const double force = free_part(assembly, g, assembly.force[g]).norm();
            n * force > rounding && force > share * (assembly.load[g] + assembly.applied[g]).norm())
            return false;
    return true;
}

// The bodies, and for each gridpoint the number of its body.
std::vector<Body> bodies_of(const Assembly& assembly, std::vector<Index>& body_of)
{
    const std::size_t n = assembly.position.size();
    DisjointSets sets(n);
    join(assembly.zones, sets);
    for (const auto& [follower, leader] : assembly.tied)
        sets.join(follower, leader);

    std::vector<Body> bodies;
    std::vector<Index> number(n, -1); // by root
    body_of.assign(n, -1);
    for (std::size_t g = 0; g < n; ++g) {
        if (!has_rock(assembly.zones, static_cast<Index>(g)))
            continue;
        Index& of_root = number[sets.root(static_cast<Index>(g))];
        if (of_root < 0) {
            of_root = static_cast<Index>(bodies.size());
            bodies.push_back({.first = static_cast<Index>(g)});
        }
        body_of[g] = of_root;
        bodies[of_root].middle += assembly.position[g];
        ++bodies[of_root].gridpoints;
    }
    for (Body& body : bodies)
        body.middle /= body.gridpoints;
    for (std::size_t g = 0; g < n; ++g)
        if (body_of[g] >= 0) {
            Body& body = bodies[body_of[g]];
            body.radius = std::max(body.radius, (assembly.position[g] - body.middle).norm());
        }
    for (std::size_t g = 0; g < n; ++g)
        if (body_of[g] >= 0) {
            Body& body = bodies[body_of[g]];
            body.unbalanced +=
                body.moves(assembly.position[g]).transpose() * free_part(assembly, g, assembly.force[g]);
            body.loads += (assembly.load[g] + assembly.applied[g]).norm();
        }
    return bodies;
}

// Stiffness of rigid bodies, on springs between them and on fixed gridpoints.
Eigen::SparseMatrix<double> stiffness_of(const Assembly& assembly, const std::vector<Body>& bodies,
                                         const std::vector<Index>& body_of)
{
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](Index p, Index q, const Eigen::Matrix3d& block) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                entries.emplace_back(3 * p + i, 3 * q + j, block(i, j));
    };
    double stiffest = 0; // [Pa]
    for_each_force(
        [&](const auto& one) {
            const auto add_spring = [&](Index group, int i, int j, const Eigen::Matrix2d& spring) {
                const Index a = coupled_by(one, group)[i], b = coupled_by(one, group)[j];
                if (body_of[a] >= 0 && body_of[b] >= 0)
                    add(body_of[a], body_of[b],
                        bodies[body_of[a]].moves(assembly.position[a]).transpose() * spring *
                            bodies[body_of[b]].moves(assembly.position[b]));
            };
            stiffest = std::max(stiffest, add_springs(one, soft, add_spring));
        },
        assembly);
    const double firm = stiffest > 0 ? stiffest : 1.0;
    for (std::size_t g = 0; g < body_of.size(); ++g)
        if (body_of[g] >= 0 && (assembly.is_free[g].minCoeff() == 0 || is_on_rollers(assembly, g))) {
            const Eigen::Matrix<double, 2, 3> moves = bodies[body_of[g]].moves(assembly.position[g]);
            Eigen::Matrix<double, 2, 3> fixed = moves; // the part of the moves that supports prevent
            for (int i = 0; i < 3; ++i)
                fixed.col(i) -= free_part(assembly, g, moves.col(i));
            add(body_of[g], body_of[g], firm * moves.transpose() * fixed);
        }
    // A tiny stiffness for all: bodies without support move out of all bounds, and the others as before.
    for (Eigen::Index i = 0; i < 3 * static_cast<Eigen::Index>(bodies.size()); ++i)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1e-14 * firm);
    Eigen::SparseMatrix<double> stiffness(3 * static_cast<Eigen::Index>(bodies.size()),
                                          3 * static_cast<Eigen::Index>(bodies.size()));
    stiffness.setFromTriplets(entries.begin(), entries.end());
    return stiffness;
}

} // namespace

double enough(double tolerance)
{
    return std::min(1000 * tolerance, 0.1);
}

RemainingDisplacement largest_remaining_displacement(const Assembly& assembly, double share, double rounding)
{
    RemainingDisplacement largest;
    if (is_plain(assembly, share, rounding))
        return largest;
    std::vector<Index> body_of;
    const std::vector<Body> bodies = bodies_of(assembly, body_of);
    Eigen::VectorXd push = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(bodies.size()));
    for (std::size_t p = 0; p < bodies.size(); ++p)
        if (const double force = bodies[p].unbalanced.norm();
            bodies[p].loads > 0 && force > share * bodies[p].loads && force > rounding)
            push.segment<3>(3 * static_cast<Eigen::Index>(p)) = bodies[p].unbalanced;
    if (push.isZero(0))
        return largest;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(stiffness_of(assembly, bodies, body_of));
    const Eigen::VectorXd displacement = factor.solve(push);
    for (std::size_t p = 0; p < bodies.size(); ++p)
        if (const double moved = displacement.segment<3>(3 * static_cast<Eigen::Index>(p)).norm();
            !(moved <= largest.displacement))
            largest = {std::isfinite(moved) ? moved : size_of(assembly), bodies[p].first};
    return largest;
}

} // namespace jointcreep::mechanics
