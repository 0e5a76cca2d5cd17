#include "mechanics/failure.hpp"

#include "model/disjoint_sets.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>

namespace jointcreep::mechanics
{

namespace
{

constexpr double is_moving = 0.1; // of the fastest block's displacement
constexpr std::size_t most_shown = 5;

// The blocks' present rock.
struct Rock {
    std::vector<double> area;           // 0 once a block is removed [m2]
    std::vector<Vector2d> centre;       // at the start [m]
    std::vector<Vector2d> displacement; // mean [m]
};

Rock rock_of(const Mesh& mesh, const Assembly& assembly, const std::vector<Vector2d>& displacement)
{
    const auto n =
        static_cast<std::size_t>(1 + *std::max_element(mesh.zone_block.begin(), mesh.zone_block.end()));
    Rock rock{std::vector<double>(n, 0), std::vector<Vector2d>(n, Vector2d::Zero()),
              std::vector<Vector2d>(n, Vector2d::Zero())};
    const rock::Zones& zones = assembly.zones;
    for (std::size_t z = 0; z < zones.size(); ++z) { // stress points, three of which are a quadratic zone
        if (!zones.is_present[z])
            continue;
        const auto b = static_cast<std::size_t>(mesh.zone_block[zones.zone_of(z)]);
        const double third = zones.area[z] / 3;
        rock.area[b] += 3 * third;
        for (const Index g : zones.gridpoints(z).first(3)) {
            rock.centre[b] += third * assembly.position[g];
            if (!displacement.empty())
                rock.displacement[b] += third * displacement[g];
        }
    }
    for (std::size_t b = 0; b < n; ++b)
        if (rock.area[b] > 0) {
            rock.centre[b] /= rock.area[b];
            rock.displacement[b] /= rock.area[b];
        }
    return rock;
}

void add(Failure& failure, const Rock& rock, std::size_t block)
{
    failure.block.push_back(static_cast<Index>(block));
    failure.place.push_back(rock.centre[block]);
    failure.motion.push_back(rock.displacement[block]);
}

} // namespace

Failure failure_of(const no_equilibrium& error, const Mesh& mesh, const Assembly& assembly)
{
    Failure failure;
    failure.reason = error.what();
    failure.moves_on = error.moves_on ? 1 : 0;
    failure.steps = error.steps;
    failure.seconds = error.seconds;
    if (error.motion.empty())
        return failure;
    const Rock rock = rock_of(mesh, assembly, error.motion);
    std::vector<std::size_t> blocks(rock.area.size());
    std::iota(blocks.begin(), blocks.end(), 0);
    std::stable_sort(blocks.begin(), blocks.end(), [&](std::size_t a, std::size_t b) {
        return rock.displacement[a].norm() > rock.displacement[b].norm();
    });
    for (const std::size_t b : blocks)
        if (rock.displacement[b].norm() > is_moving * rock.displacement[blocks[0]].norm())
            add(failure, rock, b);
    return failure;
}

Failure failure_of_unsupported(const Mesh& mesh, const Assembly& assembly)
{
    // Bodies of rock: gridpoints joined by zones, ties and contacts that are not removed.
    DisjointSets sets(assembly.position.size());
    for_each_force([&](const auto& one) { join(one, sets); }, assembly);
    for (const auto& [a, b] : assembly.tied)
        sets.join(a, b);

    struct Body {
        Vector2d resultant = Vector2d::Zero(), free = Vector2d::Ones(); // [N/m], 1 or 0
        Vector2d along = Vector2d::Zero();                              // of rollers it is on, unit vector
        double magnitudes = 0;                                          // [N/m]
    };
    std::vector<Body> bodies(assembly.position.size());
    for (std::size_t g = 0; g < bodies.size(); ++g) {
        Body& body = bodies[sets.root(static_cast<Index>(g))];
        body.resultant += assembly.load[g] + assembly.applied[g];
        body.magnitudes += assembly.load[g].norm() + assembly.applied[g].norm();
        body.free = body.free.cwiseMin(assembly.is_free[g]);
        if (!is_on_rollers(assembly, g))
            continue;
        if (body.along.isZero(0))
            body.along = assembly.along[g];
        if (!body.along.isApprox(assembly.along[g], 1e-6) && !body.along.isApprox(-assembly.along[g], 1e-6))
            body.free.setZero();
    }

    const Rock rock = rock_of(mesh, assembly, {});
    std::vector<char> is_unsupported(rock.area.size(), 0);
    for (std::size_t z = 0; z < mesh.zone_gridpoint.size(); ++z) {
        const Body& body = bodies[sets.root(mesh.zone_gridpoint[z][0])];
        Vector2d push = body.resultant.cwiseProduct(body.free);
        if (!body.along.isZero(0)) // on rollers; fixed in x or y as well, it does not move
            push = body.free.minCoeff() == 0 ? Vector2d(0, 0) : Vector2d(body.along.dot(push) * body.along);
        if (assembly.zones.is_present[assembly.zones.first_point_of(z)] &&
            push.lpNorm<Eigen::Infinity>() > 1e-9 * body.magnitudes)
            is_unsupported[mesh.zone_block[z]] = 1;
    }
    Failure failure;
    for (std::size_t b = 0; b < is_unsupported.size(); ++b)
        if (is_unsupported[b])
            add(failure, rock, b);
    return failure;
}

std::string shown_blocks(const Failure& failure)
{
    std::string text;
    for (std::size_t i = 0; i < std::min(most_shown, failure.block.size()); ++i) {
        text += (i == 0 ? "block " : "; block ") + std::to_string(failure.block[i]) + " at " +
                shown(failure.place[i]);
        if (failure.steps > 0) {
            std::array<char, 64> by{};
            std::snprintf(by.data(), by.size(), " by [%.3g, %.3g] m", failure.motion[i].x(),
                          failure.motion[i].y());
            text += by.data();
        }
    }
    if (failure.block.size() > most_shown)
        text += "; and " + std::to_string(failure.block.size() - most_shown) + " more";
    return text;
}

} // namespace jointcreep::mechanics
