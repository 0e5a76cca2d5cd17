// The same rock, seen otherwise, comes to the same rest: turned, mirrored, numbered otherwise, in other
// units, by more threads. What is turned is the mesh, so that nothing but the solver can make a difference.

#include "../mechanics/sections.hpp"

#include "model/error.hpp"
#include "relaxation/relax.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace invariance_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using mechanics::Assembly;

namespace
{

const Equilibrium settings{.tolerance = 1e-8, .unloading_increments = 1, .most_steps = 200000};

// 20 m x 10 m of jointed rock, held at its base; some thousand zones, so that they are in several parts.
const Section& plate()
{
    static const Section section_of_it = [] {
        Scene scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
        scene.zone_size = 0.5;
        scene.boundaries = {{.from = {0, 0}, .to = {20, 0}, .fix_x = true, .fix_y = true}};
        Joints joints;
        add_joint(joints, {-1, 3}, {21, 5});
        add_joint(joints, {6, -1}, {9, 11});
        add_joint(joints, {21, 2}, {11, 11});
        return assembled(std::move(scene), joints, 5e9, 2e9, 0.8);
    }();
    return section_of_it;
}

// At rest under a weight of {x, y} [N/m3]; `change` is made before.
Assembly at_rest(
    const Mesh& mesh, const Vector2d& weight, const std::function<void(Assembly&)>& change = [](Assembly&) {})
{
    const Section& s = plate();
    Assembly rock = mechanics::assemble(s.scene, s.network, s.equivalent, mesh);
    for (std::size_t z = 0; z < rock.zones.area.size(); ++z)
        for (const Index g : rock.zones.gridpoints(z))
            rock.load[g] += rock.zones.area[z] / 3 * weight;
    change(rock);
    relaxation::relax(rock, settings);
    return rock;
}

const Vector2d weight(-12e3, -26e3);

void bond(Assembly& rock)
{
    for (joint::Coulomb& law : coulomb(rock.contacts.law))
        law.cohesion = law.tensile_strength = 1e12;
}

const Assembly& reference()
{
    static const Assembly rock = at_rest(plate().mesh, weight);
    return rock;
}

double farthest(const Assembly& rock)
{
    return mechanics::largest_move(std::vector<Vector2d>(rock.displacement.size(), Vector2d::Zero()),
                                   rock.displacement)
        .first;
}

// The plate under a linear map.
Mesh mapped(const Matrix2d& map)
{
    Mesh mesh = plate().mesh;
    for (auto* points : {&mesh.gridpoint, &mesh.contact_normal, &mesh.contact_centre})
        for (Vector2d& point : *points)
            point = map * point;
    if (map.determinant() < 0)
        for (auto& corners : mesh.zone_gridpoint)
            std::swap(corners[1], corners[2]); // counter-clockwise again
    return mesh;
}

void expect_mapped(const Matrix2d& map, const Assembly& rock, const Assembly& unmapped)
{
    std::vector<Vector2d> back;
    for (const Vector2d& u : rock.displacement)
        back.push_back(map.transpose() * u);
    EXPECT_LT(mechanics::largest_move(unmapped.displacement, back).first, 1e-6 * farthest(unmapped));
    const double sign = map.determinant(); // a mirror turns shear round
    double largest = 0, apart = 0;
    for (std::size_t c = 0; c < rock.contacts.traction.size(); ++c) {
        const Vector2d traction = unmapped.contacts.traction[c];
        largest = std::max(largest, traction.norm());
        apart =
            std::max(apart, (rock.contacts.traction[c] - Vector2d(traction.x(), sign * traction.y())).norm());
    }
    EXPECT_LT(apart, 1e-6 * largest);
}

Matrix2d turned_by(double angle)
{
    Matrix2d rotation;
    rotation << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    return rotation;
}

} // namespace

// Only then do the others say anything.
TEST(invariance, the_plate_slips_opens_and_has_several_parts)
{
    const Assembly& rock = reference();
    EXPECT_GT(farthest(rock), 1e-5);
    EXPECT_GT(rock.zones.slots.part_start.size(), 3);
    EXPECT_GT(mechanics::chunks_of(rock), 2);
    EXPECT_GT(std::ranges::count(rock.contacts.status, ContactStatus::slipping), 3);
    EXPECT_GT(std::ranges::count(rock.contacts.status, ContactStatus::open), 0);
}

// A quarter turn, or several, changes no scaled mass.
TEST(invariance, turned_by_quarters)
{
    for (const int quarters : {1, 2, 3}) {
        const Matrix2d rotation = turned_by(quarters * std::numbers::pi / 2);
        expect_mapped(rotation, at_rest(mapped(rotation), rotation * weight), reference());
    }
}

// Another turn does, as masses are scaled by the larger of the row sums in x and y. The displacement until
// rest is another one then, and slip remembers it, by some 1e-4 here; so the joints are bonded, and hold
// whatever comes.
TEST(invariance, turned)
{
    const Assembly bonded = at_rest(plate().mesh, weight, bond);
    for (const double angle : {0.3, 2.0, 4.5}) {
        const Matrix2d rotation = turned_by(angle);
        expect_mapped(rotation, at_rest(mapped(rotation), rotation * weight, bond), bonded);
    }
}

TEST(invariance, mirrored)
{
    for (const Vector2d& mirror : {Vector2d(-1, 1), Vector2d(1, -1)}) {
        const Matrix2d map = mirror.asDiagonal();
        expect_mapped(map, at_rest(mapped(map), map * weight), reference());
    }
}

// Zones, contacts and gridpoints counted backwards: sums in another order, so the same to rounding.
TEST(invariance, numbered_otherwise)
{
    Mesh mesh = plate().mesh;
    const auto last = static_cast<Index>(mesh.gridpoint.size()) - 1;
    std::ranges::reverse(mesh.gridpoint);
    std::ranges::reverse(mesh.gridpoint_fixed);
    std::ranges::reverse(mesh.zone_gridpoint);
    std::ranges::reverse(mesh.zone_block);
    for (auto& corners : mesh.zone_gridpoint)
        corners = {last - corners[1], last - corners[2], last - corners[0]};
    std::ranges::reverse(mesh.contact_gridpoint);
    for (auto& sides : mesh.contact_gridpoint)
        sides = {last - sides[0], last - sides[1]};
    std::ranges::reverse(mesh.contact_edge);
    std::ranges::reverse(mesh.contact_normal);
    std::ranges::reverse(mesh.contact_length);
    std::ranges::reverse(mesh.contact_centre);
    Assembly rock = at_rest(mesh, weight);
    std::ranges::reverse(rock.displacement);
    EXPECT_LT(mechanics::largest_move(reference().displacement, rock.displacement).first,
              1e-6 * farthest(reference()));
}

// Lengths 4 times as large, joints as much softer: displacements are 4 times as large, to the last bit, as 4
// is a power of 2. And forces in a unit of 1/1024 N are 1024 times as many.
TEST(invariance, other_units)
{
    const Assembly longer = at_rest(mapped(4 * Matrix2d::Identity()), weight / 4, [](Assembly& rock) {
        for (Vector2d& normal : rock.contacts.normal)
            normal /= 4;
        for (double& length : rock.contacts.length)
            length *= 4;
        for (joint::Coulomb& law : coulomb(rock.contacts.law)) {
            law.k_n /= 4;
            law.k_s /= 4;
        }
    });
    const Assembly smaller = at_rest(plate().mesh, 1024 * weight, [](Assembly& rock) {
        for (mechanics::Vector3d& moduli : rock.zones.stiffness)
            moduli *= 1024;
        for (joint::Coulomb& law : coulomb(rock.contacts.law)) {
            law.k_n *= 1024;
            law.k_s *= 1024;
        }
    });
    std::vector<Vector2d> quarter;
    for (const Vector2d& u : longer.displacement)
        quarter.push_back(u / 4);
    EXPECT_EQ(quarter, reference().displacement);
    EXPECT_EQ(smaller.displacement, reference().displacement);
    EXPECT_EQ(longer.contacts.traction, reference().contacts.traction);
}

// On the way already.
TEST(invariance, the_same_bits_for_any_number_of_threads)
{
    const auto after_100_steps = [](int threads, Damping damping) {
        Assembly rock = mechanics::assemble(plate().scene, plate().network, plate().equivalent, plate().mesh);
        for (std::size_t g = 0; g < rock.load.size(); ++g)
            rock.load[g] = weight;
        rock.threads = threads;
        Equilibrium impatient = settings;
        impatient.most_steps = 100;
        impatient.damping = damping;
        EXPECT_THROW(relaxation::relax(rock, impatient), equilibrium_error);
        return rock;
    };
    for (const Damping damping : {Damping::adaptive, Damping::kinetic, Damping::local}) {
        SCOPED_TRACE(static_cast<int>(damping));
        const Assembly alone = after_100_steps(1, damping);
        EXPECT_GT(farthest(alone), 0);
        for (const int threads : {2, 3}) {
            const Assembly rock = after_100_steps(threads, damping);
            EXPECT_EQ(rock.displacement, alone.displacement);
            EXPECT_EQ(rock.force, alone.force);
            EXPECT_EQ(rock.zones.stress, alone.zones.stress);
            EXPECT_EQ(rock.contacts.traction, alone.contacts.traction);
            EXPECT_EQ(balance_of(rock).mean, balance_of(alone).mean);
        }
    }
}

// Zones and contacts pull at each other and at nothing else: what the base holds is the weight.
TEST(invariance, the_base_holds_the_weight)
{
    const Assembly& rock = reference();
    Vector2d load = Vector2d::Zero(), held = Vector2d::Zero(), inside = Vector2d::Zero();
    double magnitudes = 0;
    for (std::size_t g = 0; g < rock.load.size(); ++g) {
        load += rock.load[g];
        held += rock.force[g].cwiseProduct(Vector2d(1, 1) - rock.is_free[g]);
        inside += rock.force[g] - rock.load[g];
        magnitudes += rock.load[g].norm();
    }
    EXPECT_LT(inside.norm(), 1e-12 * magnitudes * 100); // rounding of stresses that are larger than the load
    EXPECT_LT((held - load).norm(), 1e-6 * load.norm());
}

} // namespace invariance_test
