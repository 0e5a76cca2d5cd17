// Zones: exact for uniform strain, forces that are the slope of their energy, in balance, within their strength.

#include "rock/zone_changes.hpp"
#include "rock/zone_stiffness.hpp"

#include "model/signs.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numeric>

namespace zones_test
{

using namespace jointcreep;
using namespace jointcreep::rock;

namespace
{

using Displacements = std::vector<Vector2d>;

double any_number(double scale)
{
    return scale * (*rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-1000, 1001))) / 1000.0;
}

// E nu / ((1 + nu) (1 - 2 nu)), E / (2 (1 + nu))
const double lame = 2e9, shear = 3e9;
const Rock elastic{
    .name = "rock", .density = 2700, .youngs_modulus = 7.2e9, .poissons_ratio = 0.2, .strength = {}};

Rock yielding()
{
    Rock rock = elastic;
    rock.strength = {.cohesion = 1e6, .friction_angle = 0.6, .tensile_strength = 3e5};
    rock.dilation_angle = 0.2;
    rock.law = RockLaw::mohr_coulomb;
    return rock;
}

enum class Kind { constant_strain, quadratic };

Kind any_kind()
{
    return *rc::gen::element(Kind::constant_strain, Kind::quadratic);
}

// A rectangle of `nx` x `ny` cells of 2 m x 1.5 m, two zones each; what is inside is moved about by up to `uneven` [m].
struct Patch {
    Mesh mesh;
    Zones zones;
    double area;
    Vector2d end; // the corner across from the origin

    Patch(int nx, int ny, double uneven, Kind kind, const Rock& rock = elastic,
          const InSituStress& stress = {})
        : area(2.0 * nx * 1.5 * ny), end(2.0 * nx, 1.5 * ny)
    {
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i) {
                mesh.gridpoint.emplace_back(2.0 * i, 1.5 * j);
                if (uneven > 0 && i > 0 && i < nx && j > 0 && j < ny)
                    mesh.gridpoint.back() += Vector2d(any_number(uneven), any_number(uneven));
            }
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) {
                const Index g = j * (nx + 1) + i, above = g + nx + 1;
                mesh.zone_gridpoint.push_back({g, g + 1, above + 1});
                mesh.zone_gridpoint.push_back({g, above + 1, above});
            }
        mesh.zone_block.assign(mesh.zone_gridpoint.size(), 0);
        if (kind == Kind::quadratic)
            add_middles();
        Scene scene;
        scene.gravity = 9.81;
        scene.rocks = {rock};
        scene.in_situ_stress = stress;
        Network network;
        network.blocks.block_rock = {0};
        zones = zones_of(scene, network, mesh);
        find_incidence(zones, mesh.gridpoint.size());
    }

    void add_middles()
    {
        std::map<std::pair<Index, Index>, Index> of_side;
        for (const auto& corners : mesh.zone_gridpoint) {
            std::array<Index, 3> middle{};
            for (int i = 0; i < 3; ++i) {
                const Index a = corners[i], b = corners[(i + 1) % 3];
                const auto [found, is_new] =
                    of_side.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.gridpoint.size()));
                if (is_new)
                    mesh.gridpoint.push_back((mesh.gridpoint[a] + mesh.gridpoint[b]) / 2);
                middle[i] = found->second;
            }
            mesh.zone_middle.push_back(middle);
            for (int i = 0; i < 3; ++i)
                mesh.stress_point.push_back((4 * mesh.gridpoint[corners[i]] +
                                             mesh.gridpoint[corners[(i + 1) % 3]] +
                                             mesh.gridpoint[corners[(i + 2) % 3]]) /
                                            6);
        }
    }

    bool is_inside(std::size_t g) const
    {
        const Vector2d &p = mesh.gridpoint[g], corner = end;
        return p.minCoeff() > 0 && p.x() < corner.x() && p.y() < corner.y();
    }
    // On gridpoints [N/m].
    Displacements forces(const Displacements& displacement, double damping = 0)
    {
        find_forces_in_team(zones, displacement, damping, false);
        Displacements force(mesh.gridpoint.size(), Vector2d::Zero());
        for (std::size_t g = 0; g < force.size(); ++g)
            add_force_on(zones, static_cast<Index>(g), force[g]);
        return force;
    }
    Displacements any_displacements(double scale) const
    {
        Displacements displacement;
        for (std::size_t g = 0; g < mesh.gridpoint.size(); ++g)
            displacement.emplace_back(any_number(scale), any_number(scale));
        return displacement;
    }
};

InSituStress squeezed()
{
    return {
        .elevation = 3, .compression_xx = 1e6, .compression_yy = 2e6, .shear_xy = 2e5, .gradient_yy = 26487};
}

double work(const Displacements& force, const Displacements& by)
{
    return std::inner_product(force.begin(), force.end(), by.begin(), 0.0, std::plus<>(),
                              [](const Vector2d& f, const Vector2d& u) { return f.dot(u); });
}

} // namespace

// Hooke's law in plane strain, whatever the zones' shape; no force inside, none in all, and on the outline what the
// stress asks for: the sum of force times place is -area x stress.
RC_GTEST_PROP(zones, uniform_strain_gives_hookes_stress, ())
{
    Patch patch(4, 3, 0.4, any_kind());
    const double exx = any_number(1e-3), eyy = any_number(1e-3), gxy = any_number(1e-3),
                 turn = any_number(1e-3);
    Displacements displacement;
    for (const Vector2d& p : patch.mesh.gridpoint)
        displacement.emplace_back(0.1 + exx * p.x() + (gxy / 2 - turn) * p.y(),
                                  -0.2 + (gxy / 2 + turn) * p.x() + eyy * p.y());
    const Displacements force = patch.forces(displacement);
    const Vector3d exact(lame * (exx + eyy) + 2 * shear * exx, lame * (exx + eyy) + 2 * shear * eyy,
                         shear * gxy);
    for (const Vector3d& stress : patch.zones.stress)
        RC_ASSERT((stress - exact).norm() < 1e-10 * 1e10);
    Vector2d sum(0, 0);
    Eigen::Matrix2d virial = Eigen::Matrix2d::Zero(), wanted;
    wanted << exact[0], exact[2], exact[2], exact[1];
    for (std::size_t g = 0; g < force.size(); ++g) {
        if (patch.is_inside(g))
            RC_ASSERT(force[g].norm() < 10); // of 1e7
        sum += force[g];
        virial += force[g] * patch.mesh.gridpoint[g].transpose();
    }
    RC_ASSERT(sum.norm() < 10);
    RC_ASSERT((virial + patch.area * wanted).cwiseAbs().maxCoeff() < 1e-8 * patch.area * 1e7);
}

// Also under stress in situ, and where some zones are gone. The energy is quadratic: central differences are exact.
RC_GTEST_PROP(zones, forces_are_the_slope_of_stored_energy, ())
{
    Patch patch(4, 3, 0.4, any_kind(), elastic, squeezed());
    for (char& is_present : patch.zones.is_present)
        is_present = *rc::gen::weightedElement<char>({{5, 1}, {1, 0}});
    const Displacements at = patch.any_displacements(1e-3), by = patch.any_displacements(1e-3);
    const auto moved = [&](double way) {
        Displacements there = at;
        for (std::size_t g = 0; g < there.size(); ++g)
            there[g] += way * by[g];
        return patch.forces(there);
    };
    moved(1);
    const double high = stored_energy(patch.zones);
    moved(-1);
    const double low = stored_energy(patch.zones);
    const Displacements force = moved(0);
    RC_ASSERT(std::abs((high - low) / 2 + work(force, by)) < 1e-9 * (high + low));
}

// Newton's third law inside, and forces that go with displacements by the stiffness.
RC_GTEST_PROP(zones, stiffness_is_symmetric_and_gives_the_forces, ())
{
    Patch patch(2, 2, 0.4, any_kind());
    const Displacements displacement = patch.any_displacements(1e-3);
    Displacements wanted(displacement.size(), Vector2d::Zero());
    const int n = patch.zones.gridpoints_of_zone;
    constexpr double rounding = 1e-12; // of the largest block of the zone, or of all forces
    double all_forces = 0;
    for (std::size_t z = 0; z < patch.zones.area.size(); ++z) {
        const auto corner = patch.zones.gridpoints(z);
        double largest = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                largest = std::max(largest, stiffness_between(patch.zones, z, i, j).norm());
        Eigen::Matrix2d turned = Eigen::Matrix2d::Zero();
        double farthest = 0;
        for (int i = 0; i < n; ++i) {
            Eigen::Matrix2d moved = Eigen::Matrix2d::Zero();
            for (int j = 0; j < n; ++j) {
                const Eigen::Matrix2d block = stiffness_between(patch.zones, z, i, j);
                RC_ASSERT((block - stiffness_between(patch.zones, z, j, i).transpose()).norm() <
                          rounding * largest);
                moved += block;
                const Vector2d force = patch.zones.area[z] * block * displacement[corner[j]];
                wanted[corner[i]] -= force;
                all_forces += force.norm();
                turned.col(0) += block * normal_of(patch.mesh.gridpoint[corner[j]]);
                farthest = std::max(farthest, patch.mesh.gridpoint[corner[j]].norm());
            }
            RC_ASSERT(moved.norm() < rounding * largest); // all corners alike
            RC_ASSERT(turned.norm() < rounding * largest * farthest);
        }
    }
    const Displacements force = patch.forces(displacement);
    for (std::size_t g = 0; g < force.size(); ++g)
        RC_ASSERT((force[g] - wanted[g]).norm() < rounding * all_forces);
}

// They bound the force that displacements of 1 m give; of a zone alone, moved as the signs of a row, they are it.
RC_GTEST_PROP(zones, row_sums_bound_the_forces, ())
{
    Patch patch(3, 3, 0.4, any_kind());
    patch.zones.is_present[*rc::gen::inRange<std::size_t>(0, patch.zones.is_present.size())] = 0;
    Displacements sums(patch.mesh.gridpoint.size(), Vector2d::Zero());
    add_row_sums(patch.zones, sums, sums);
    const Displacements force = patch.forces(patch.any_displacements(1));
    for (std::size_t g = 0; g < force.size(); ++g)
        RC_ASSERT((sums[g] - force[g].cwiseAbs()).minCoeff() > -1e-6);

    patch.zones.is_present.assign(patch.zones.is_present.size(), 0);
    const std::size_t z = *rc::gen::inRange<std::size_t>(0, patch.zones.is_present.size());
    patch.zones.is_present[z] = 1;
    for (Vector2d& sum : sums)
        sum.setZero();
    add_row_sums(patch.zones, sums, sums);
    const auto corner = patch.zones.gridpoints(z);
    const int n = patch.zones.gridpoints_of_zone;
    for (int i = 0; i < n; ++i)
        for (int row = 0; row < 2; ++row) {
            Displacements signs(sums.size(), Vector2d::Zero());
            for (int j = 0; j < n; ++j)
                for (int column = 0; column < 2; ++column)
                    signs[corner[j]][column] =
                        stiffness_between(patch.zones, z, i, j)(row, column) < 0 ? -1 : 1;
            RC_ASSERT(std::abs(sums[corner[i]][row] + patch.forces(signs)[corner[i]][row]) < 1e-3);
        }
}

TEST(zones, masses_and_weights_sum_to_those_of_the_rock)
{
    Patch patch(4, 3, 0, Kind::constant_strain); // 8 m x 4.5 m
    EXPECT_NEAR(std::accumulate(patch.zones.weight.begin(), patch.zones.weight.end(), 0.0), 36 * 2700 * 9.81,
                1e-6);
    const auto mass = [&] {
        std::vector<double> all(patch.mesh.gridpoint.size(), 0.0);
        add_masses(patch.zones, all);
        return all;
    };
    std::vector<double> all = mass();
    EXPECT_NEAR(std::accumulate(all.begin(), all.end(), 0.0), 36 * 2700, 1e-6);
    EXPECT_NEAR(all[1], 1.5 * 2700 * 3 / 3, 1e-9); // three zones of 1.5 m2 each
    patch.zones.is_present[0] = 0;
    all = mass();
    EXPECT_NEAR(std::accumulate(all.begin(), all.end(), 0.0), 34.5 * 2700, 1e-6);
    EXPECT_NEAR(all[1], 1.5 * 2700 * 2 / 3, 1e-9);
}

// Quadratic zones: all of the mass, none of it negative; weight on the middles of sides, and with the stress that it makes
// no force inside.
TEST(zones, that_are_quadratic_weigh_as_much)
{
    Patch patch(4, 3, 0, Kind::quadratic, elastic, {.elevation = 4.5, .gradient_yy = 2700 * 9.81});
    std::vector<double> mass(patch.mesh.gridpoint.size(), 0.0);
    add_masses(patch.zones, mass);
    EXPECT_NEAR(std::accumulate(mass.begin(), mass.end(), 0.0), 36 * 2700, 1e-6);
    EXPECT_GT(*std::min_element(mass.begin(), mass.end()), 0);
    Displacements load(mass.size(), Vector2d::Zero());
    for (std::size_t z = 0; z < patch.zones.size(); ++z)
        add_weight(patch.zones, z, 1, load);
    EXPECT_EQ(load[0], Vector2d(0, 0)); // a corner
    const Displacements force = patch.forces(Displacements(mass.size(), Vector2d::Zero()));
    double sum = 0;
    for (std::size_t g = 0; g < force.size(); ++g) {
        sum += load[g].y();
        if (patch.is_inside(g)) {
            EXPECT_LT((force[g] + load[g]).norm(), 1e-6);
        }
    }
    EXPECT_NEAR(sum, -36 * 2700 * 9.81, 1e-6);
}

TEST(zones, start_with_the_stress_in_situ)
{
    Patch patch(1, 1, 0, Kind::constant_strain, elastic, squeezed()); // centroids at 0.5 m and 1 m
    EXPECT_LT((patch.zones.stress[0] - Vector3d(-1e6, -(2e6 + 2.5 * 26487), 2e5)).norm(), 1e-6);
    EXPECT_LT((patch.zones.stress[1] - Vector3d(-1e6, -(2e6 + 2 * 26487), 2e5)).norm(), 1e-6);
    EXPECT_NEAR(Patch(1, 1, 0, Kind::constant_strain, yielding(), squeezed()).zones.yielding[1].stress_zz,
                -(3e6 + 2 * 26487) / 2, 1e-6);
    const Displacements none(4, Vector2d::Zero());
    const Displacements force = patch.forces(none);
    EXPECT_NEAR(force[0].x() + force[2].x(), -1.5 * 1e6, 1e-3); // to the left; shear below and above cancels
}

// Forces are summed up in parts of many zones, each with slots of its own, so that threads do not meet: beside the plain
// sum.
TEST(zones, slots_give_the_same_sums)
{
    Patch patch(40, 30, 0, Kind::constant_strain, elastic, squeezed());
    const std::vector<Index>& start = patch.zones.slots.part_start;
    ASSERT_GT(start.size(), 3U);
    auto part = start.begin();
    for (auto slot = patch.zones.slots.of_zone.begin(); slot != patch.zones.slots.of_zone.end(); slot += 3) {
        part = *slot < *std::next(part) ? part : std::next(part);
        for (int i = 0; i < 3; ++i)
            ASSERT_TRUE(*part <= slot[i] && slot[i] < *std::next(part));
    }
    Displacements displacement, plain(patch.mesh.gridpoint.size(), Vector2d::Zero());
    for (const Vector2d& p : patch.mesh.gridpoint)
        displacement.push_back(1e-3 * Vector2d(std::sin(p.x() + 2 * p.y()), std::cos(3 * p.x() - p.y())));
    const Displacements force = patch.forces(displacement);
    add_forces(patch.zones, {.stress = patch.zones.stress}, plain);
    for (std::size_t g = 0; g < force.size(); ++g)
        EXPECT_LT((force[g] - plain[g]).norm(), 1e-2); // of 1e7
    std::vector<double> magnitudes(patch.mesh.gridpoint.size(), 0.0);
    for (std::size_t g = 0; g < force.size(); ++g) {
        add_magnitudes_on(patch.zones, static_cast<Index>(g), magnitudes[g]);
        EXPECT_GE(magnitudes[g], force[g].norm() * (1 - 1e-9));
    }
}

// Dashpots: as much of the stress's change again.
RC_GTEST_PROP(zones, damping_adds_a_share_of_the_change, ())
{
    Patch patch(2, 2, 0.4, any_kind(), elastic, squeezed());
    patch.zones.last_stress = patch.zones.stress;
    const Displacements first = patch.any_displacements(1e-3), second = patch.any_displacements(1e-3),
                        before = patch.forces(first), now = patch.forces(second);
    patch.forces(first, 0.3);
    const Displacements damped = patch.forces(second, 0.3);
    for (std::size_t g = 0; g < now.size(); ++g)
        RC_ASSERT((damped[g] - now[g] - 0.3 * (now[g] - before[g])).norm() < 1e-9 * 1e7);
}

// Along any path no zone is beyond its strength, and asked twice it changes nothing more.
RC_GTEST_PROP(zones, that_yield_stay_within_their_strength, ())
{
    Patch patch(3, 2, 0.4, any_kind(), yielding(), squeezed());
    for (int i = 0; i < 4; ++i) {
        const Displacements displacement = patch.any_displacements(2e-3), force = patch.forces(displacement);
        RC_ASSERT(weakest(patch.zones) == -1);
        for (std::size_t z = 0; z < patch.zones.yielding.size(); ++z) {
            const Vector3d& s = patch.zones.stress[z];
            const YieldingZone& zone = patch.zones.yielding[z];
            const Vector3d p = principal({s[0], s[1], s[2], zone.stress_zz});
            RC_ASSERT(zone.law.n_phi * p.maxCoeff() - p.minCoeff() - zone.law.shear < 1e-8 * 1e8);
            RC_ASSERT(p.maxCoeff() - zone.law.tension < 1e-8 * 1e8);
        }
        const double lost = dissipated(patch.zones);
        const Displacements again = patch.forces(displacement);
        for (std::size_t g = 0; g < force.size(); ++g)
            RC_ASSERT((again[g] - force[g]).norm() < 1e-9 * 1e7);
        RC_ASSERT(std::abs(dissipated(patch.zones) - lost) <= 1e-9 * std::abs(lost));
    }
}

// From the displacements of a yielding patch on, in a direction: the tangents of all stress points beside central
// differences of the forces. Where a point begins to yield within the step there is nothing to compare.
RC_GTEST_PROP(zones, tangent_at_yield_is_what_forces_change_by, ())
{
    Patch patch(2, 2, 0.4, any_kind(), yielding(), squeezed());
    const ZonesState start = state_of(patch.zones);
    const Displacements at = patch.any_displacements(2e-3), by = patch.any_displacements(1);
    const auto forces_at = [&](double way) {
        patch.zones.yielding = start.yielding;
        Displacements there = at;
        for (std::size_t g = 0; g < there.size(); ++g)
            there[g] += way * by[g];
        return patch.forces(there);
    };
    const auto differences = [&](double step) {
        Displacements high = forces_at(step);
        const Displacements low = forces_at(-step);
        for (std::size_t g = 0; g < high.size(); ++g)
            high[g] = (high[g] - low[g]) / (2 * step);
        return high;
    };
    const Displacements coarse = differences(2e-8), fine = differences(1e-8);
    Displacements change(at.size(), Vector2d::Zero());
    for (std::size_t z = 0; z < patch.zones.size(); ++z) {
        const Tangent tangent = tangent_at(patch.zones, z, at, start);
        const auto gridpoints = patch.zones.gridpoints(z);
        for (std::size_t i = 0; i < gridpoints.size(); ++i)
            for (std::size_t j = 0; j < gridpoints.size(); ++j)
                change[gridpoints[i]] -=
                    patch.zones.area[z] *
                    stiffness_between(patch.zones, z, static_cast<int>(i), static_cast<int>(j), tangent) *
                    by[gridpoints[j]];
    }
    for (std::size_t g = 0; g < at.size(); ++g) {
        RC_PRE((coarse[g] - fine[g]).norm() < 1e5); // of 1e10
        RC_ASSERT((change[g] - fine[g]).norm() < 1e6);
    }
}

// Work on rock that yields = what it stores + what it loses, in small steps.
TEST(zones, that_yield_account_for_their_work)
{
    Patch patch(2, 2, 0, Kind::constant_strain, yielding(), squeezed());
    Displacements displacement(patch.mesh.gridpoint.size(), Vector2d::Zero()),
        force = patch.forces(displacement);
    const double at_start = stored_energy(patch.zones);
    double done = 0, lost = 0;
    const int n = 2000;
    for (int i = 1; i <= n; ++i) {
        const Displacements last = displacement, before = force;
        const double t = 2.0 * i / n, way = 4e-3 * (t < 1 ? t : 2 - t); // there and back
        Displacements by;
        for (std::size_t g = 0; g < last.size(); ++g) {
            displacement[g] =
                way * Vector2d(std::sin(3.0 * static_cast<double>(g)), -patch.mesh.gridpoint[g].y());
            by.push_back(displacement[g] - last[g]);
        }
        force = patch.forces(displacement);
        done -= (work(before, by) + work(force, by)) / 2;
        EXPECT_GE(dissipated(patch.zones), lost);
        lost = dissipated(patch.zones);
    }
    EXPECT_GT(lost, 1e3);
    EXPECT_NEAR(done, stored_energy(patch.zones) - at_start + lost, 1e-6 * lost);
    begin_search(patch.zones, false);
    EXPECT_EQ(dissipated(patch.zones), 0);
}

// Held, it is elastic from the plastic strain it has; the zone that is farthest beyond its strength is found.
TEST(zones, that_hold_their_yield_are_elastic)
{
    Patch patch(2, 2, 0, Kind::constant_strain, yielding(), squeezed());
    Displacements displacement(9, Vector2d::Zero());
    patch.forces(displacement);
    patch.zones.holds_yield = true;
    displacement[8] = {4e-3, 4e-3}; // the upper right corner
    const Displacements far = patch.forces(displacement);
    const Index weak = weakest(patch.zones);
    EXPECT_TRUE(weak == 6 || weak == 7) << weak; // the two zones of its cell
    EXPECT_EQ(dissipated(patch.zones), 0);
    const Displacements none = patch.forces(Displacements(9, Vector2d::Zero()));
    displacement[8] /= 2;
    const Displacements middle = patch.forces(displacement);
    for (std::size_t g = 0; g < 9; ++g)
        EXPECT_LT((2 * middle[g] - far[g] - none[g]).norm(), 1e-2);
    patch.zones.is_present[6] = patch.zones.is_present[7] = 0;
    EXPECT_EQ(weakest(patch.zones), -1);
}

// The stresses stay, and it goes on as if it had not been: elastic or yielding.
RC_GTEST_PROP(zones, go_on_as_before_once_they_start_from_here, ())
{
    Patch patch(3, 2, 0.4, any_kind(), *rc::gen::arbitrary<bool>() ? yielding() : elastic, squeezed());
    const Displacements at = patch.any_displacements(1e-3), by = patch.any_displacements(1e-3),
                        none(at.size(), Vector2d::Zero());
    const Displacements force = patch.forces(at);
    Patch kept = patch;
    start_from_here(patch.zones);
    const Displacements again = patch.forces(none), on = patch.forces(by);
    Displacements there = at;
    for (std::size_t g = 0; g < there.size(); ++g)
        there[g] += by[g];
    const Displacements as_before = kept.forces(there);
    for (std::size_t g = 0; g < force.size(); ++g) {
        RC_ASSERT((again[g] - force[g]).norm() < 1e-9 * 1e7);
        RC_ASSERT((on[g] - as_before[g]).norm() < 1e-9 * 1e7);
    }
}

} // namespace zones_test
