// Creep at one contact that sticks, slips, opens and closes: the state that a step's stiffness and offset
// lead to is the one that the joint's own stiffness and the new creep displacement hold.

#include "joints.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace contact_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

constexpr double K_n = 6.9e8, K_s = 2.8e8;

EquivalentJoints joint_material(double k_s = K_s)
{
    EquivalentJoints joints = joints_of({Chain{K_n, {{4.8e8, 5e9}, {0, 9e10}}}});
    joints.shear_stiffness = {k_s};
    joints.shear_kelvin_stiffness = {1e8};
    joints.shear_kelvin_viscosity = {3e8};
    return joints;
}

// A joint that lies flat, its lower side held, its upper one put where a test wants it.
struct Contact {
    mechanics::Assembly rock;
    Mesh mesh;

    explicit Contact(const EquivalentJoints& joints, const Vector2d& traction, double gap = 0)
    {
        mesh.contact_edge = {0};
        rock.position = {{0, 0}, {0, 0}};
        rock.displacement.assign(2, {0, 0});
        rock.is_free = {{0, 0}, {1, 1}};
        rock.load.assign(2, {0, 0});
        rock.applied = rock.force = rock.load;
        joint::Contacts& contacts = rock.contacts;
        contacts.gridpoint = {{0, 1}};
        find_incidence(rock);
        contacts.normal = {{0, 1}};
        contacts.length = {1};
        contacts.law = {joint::Coulomb{joints.normal_stiffness[0], joints.shear_stiffness[0], 0, .7, 0}};
        contacts.state.resize(1);
        contacts.initial_traction = {traction};
        contacts.traction = {traction};
        contacts.offset = contacts.relative_displacement = {{0, 0}};
        contacts.status = {ContactStatus::stuck};
        contacts.work = {0};
        rock.displacement[1].y() = gap;
        start_from_here(rock);
    }

    mechanics::Creep creep(const EquivalentJoints& joints, CreepScheme scheme) const
    {
        return {creeping(scheme), {}, joints, mesh, rock};
    }
    void move(double opening, double shear)
    {
        rock.displacement[1] = {shear, opening}; // the tangent is {1, 0}
        find_forces(rock);
    }
    Vector2d traction() const { return rock.contacts.traction[0]; }
    ContactStatus status() const { return rock.contacts.status[0]; }
};

double between(double least, double most)
{
    return least + (most - least) * *rc::gen::inRange(0, 1 << 20) / static_cast<double>(1 << 20);
}

} // namespace

RC_GTEST_PROP(contact, ends_a_step_as_it_was_found, ())
{
    const CreepScheme scheme = *rc::gen::elementOf(all_schemes);
    const EquivalentJoints joints = joint_material();
    const bool open_in_situ = *rc::gen::inRange(0, 4) == 0;
    Contact contact(joints, {between(-2e6, 0), between(-4e5, 4e5)}, open_in_situ ? .01 : 0);
    mechanics::Creep creep = contact.creep(joints, scheme);
    for (int i = 0; i < 6; ++i) {
        contact.move(between(-4e-3, 4e-3) - (open_in_situ ? .01 : 0), between(-4e-3, 4e-3)); // a stage
        creep.begin(between(.01, 100), contact.rock);
        contact.move(between(-4e-3, 4e-3) - (open_in_situ ? .01 : 0), between(-4e-3, 4e-3));
        const Vector2d traction = contact.traction();
        const ContactStatus status = contact.status();
        RC_ASSERT(creep.end(contact.rock) >= 0);
        RC_ASSERT(joint::k_n(contact.rock.contacts.law[0]) == K_n &&
                  joint::k_s(contact.rock.contacts.law[0]) == K_s);
        find_forces(contact.rock);
        RC_ASSERT((contact.traction() - traction).cwiseAbs().maxCoeff() < 1e-8 * 1e6);
        RC_ASSERT(contact.status() == status);
        if (status == ContactStatus::open)
            RC_ASSERT(contact.traction() == Vector2d(0, 0));
    }
}

RC_GTEST_PROP(contact, may_begin_again_with_another_duration, ())
{
    const CreepScheme scheme = *rc::gen::elementOf(all_schemes);
    const EquivalentJoints joints = joint_material();
    Contact contact(joints, {-1e6, 0});
    mechanics::Creep creep = contact.creep(joints, scheme);
    contact.move(5e-4, 3e-4);
    creep.begin(3, contact.rock);
    contact.move(6e-4, 4e-4);
    creep.end(contact.rock);
    find_forces(contact.rock);

    Contact straight = contact;
    mechanics::Creep other = creep;
    const mechanics::Assembly before = contact.rock;
    creep.begin(50, contact.rock);
    contact.move(between(-1e-3, 1e-3), between(-1e-3, 1e-3));
    const bool cancelled = *rc::gen::inRange(0, 2) == 0;
    if (cancelled) {
        creep.cancel(contact.rock);
        RC_ASSERT(contact.rock.contacts.offset[0] == before.contacts.offset[0]);
        RC_ASSERT(joint::k_n(contact.rock.contacts.law[0]) == K_n &&
                  joint::k_s(contact.rock.contacts.law[0]) == K_s);
    }
    contact.rock.contacts.state = before.contacts.state;
    if (cancelled)
        contact.rock.contacts.traction = before.contacts.traction;
    creep.begin(5, contact.rock);
    other.begin(5, straight.rock);
    contact.move(7e-4, 6e-4);
    straight.move(7e-4, 6e-4);
    RC_ASSERT(creep.end(contact.rock) == other.end(straight.rock));
    RC_ASSERT(contact.traction() == straight.traction());
    RC_ASSERT(contact.rock.contacts.offset[0] == straight.rock.contacts.offset[0]);
}

TEST(contact, unchanged_traction_does_not_creep)
{
    const EquivalentJoints joints = joint_material();
    for (const CreepScheme scheme : all_schemes) {
        Contact contact(joints, {-1e6, 2e5});
        mechanics::Creep creep = contact.creep(joints, scheme);
        EXPECT_TRUE(creep.anything_creeps());
        creep.begin(1e6, contact.rock);
        contact.move(0, 0);
        EXPECT_LT(creep.end(contact.rock), 1e-18);
        EXPECT_LT(contact.rock.contacts.offset[0].norm(), 1e-18);
        EXPECT_EQ(contact.traction(), Vector2d(-1e6, 2e5));
    }
}

// F - F_0 = -F_0 on an open joint: a Kelvin unit tends to -F_0 / E, a Maxwell dashpot flows on.
TEST(contact, an_open_joint_goes_on_relaxing)
{
    EquivalentJoints joints = joint_material();
    joints.normal_maxwell_viscosity = {0};
    for (const CreepScheme scheme : all_schemes) {
        Contact contact(joints, {-2e6, 0});
        mechanics::Creep creep = contact.creep(joints, scheme);
        contact.move(.02, 0);
        EXPECT_EQ(contact.status(), ContactStatus::open);
        for (int i = 0; i < 2; ++i) {
            creep.begin(1e4, contact.rock);
            contact.move(.02, 0);
            creep.end(contact.rock);
        }
        EXPECT_NEAR(contact.rock.contacts.offset[0].x(), 2e6 / 4.8e8, 1e-12);
    }
}

// What was open in situ bore nothing, so it does not creep until it closes.
TEST(contact, one_that_is_open_in_situ_creeps_once_it_has_closed)
{
    const EquivalentJoints joints = joint_material();
    Contact contact(joints, {0, 0}, .01);
    EXPECT_EQ(contact.status(), ContactStatus::open);
    mechanics::Creep creep = contact.creep(joints, CreepScheme::fitted);
    creep.begin(100, contact.rock);
    contact.move(0, 0);
    creep.end(contact.rock);
    EXPECT_NEAR(contact.rock.contacts.offset[0].x(), 0, 1e-15);
    creep.begin(10, contact.rock);
    contact.move(-.012, 0);
    creep.end(contact.rock);
    EXPECT_LT(contact.traction().x(), 0);
    EXPECT_LT(contact.rock.contacts.offset[0].x(), 0);
    find_forces(contact.rock);
    EXPECT_NEAR(contact.traction().x(), K_n * (-.012 + .01 - contact.rock.contacts.offset[0].x()), 1e-3);
}

TEST(contact, a_smooth_joint_bears_no_shear_and_creeps_along_the_normal_alone)
{
    const EquivalentJoints joints = joint_material(0);
    Contact contact(joints, {-1e6, 0});
    mechanics::Creep creep = contact.creep(joints, CreepScheme::fitted);
    creep.begin(10, contact.rock);
    EXPECT_EQ(joint::k_s(contact.rock.contacts.law[0]), 0);
    contact.move(-1e-3, 1e-3);
    creep.end(contact.rock);
    EXPECT_EQ(contact.rock.contacts.offset[0].y(), 0);
    EXPECT_LT(contact.rock.contacts.offset[0].x(), 0);
}

TEST(contact, a_removed_one_is_left_alone)
{
    const EquivalentJoints joints = joint_material();
    Contact contact(joints, {-1e6, 0});
    mechanics::Creep creep = contact.creep(joints, CreepScheme::fitted);
    contact.rock.contacts.status[0] = ContactStatus::removed;
    contact.rock.contacts.traction[0] = {-5e6, 0};
    creep.begin(10, contact.rock);
    EXPECT_EQ(creep.end(contact.rock), 0);
    EXPECT_EQ(contact.rock.contacts.offset[0], Vector2d(0, 0));
}

TEST(contact, nothing_creeps_without_creep_in_the_scene)
{
    const EquivalentJoints joints = joint_material();
    const Contact contact(joints, {-1e6, 0});
    EXPECT_FALSE(mechanics::Creep({}, {}, joints, contact.mesh, contact.rock).anything_creeps());
    EXPECT_EQ(mechanics::Creep({}, {}, joints, contact.mesh, contact.rock).fastest_rate(), 0);
    EXPECT_NEAR(contact.creep(joints, CreepScheme::fitted).fastest_rate(),
                creep::relaxation_rate({K_s, {{1e8, 3e8}}}), 1e-12);
}

} // namespace contact_test
