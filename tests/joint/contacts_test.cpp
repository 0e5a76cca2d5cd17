// Contacts: springs worked out by hand, forces in balance, tangents and energies of any law.

#include "joint/contact_changes.hpp"
#include "joint/contact_stiffness.hpp"

#include "any_law.hpp"
#include "one_contact.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

namespace contacts_test
{

using namespace jointcreep;
using namespace jointcreep::joint;
using namespace jointcreep::test;

namespace
{

Vector2d any_direction()
{
    const double angle = any_number(std::numbers::pi);
    return {std::cos(angle), std::sin(angle)};
}

const Coulomb firm{4e9, 1e9, 1e12, 0.5, 1e12};

} // namespace

TEST(contacts, pull_as_their_springs_say)
{
    Contacts level = contact(firm);
    part(level, {1e-4, 2e-4});
    EXPECT_LT((level.traction[0] - Vector2d(4e5, 2e5)).norm(), 1e-3); // it opens: tension
    EXPECT_LT((level.force[0] - 2.5 * Vector2d(2e5, 4e5)).norm(), 1e-2);
    EXPECT_EQ(level.status[0], ContactStatus::stuck);

    Contacts dipping = contact(firm, {0.6, 0.8}, {-1e6, 3e5}); // its tangent is {0.8, -0.6}
    part(dipping, {1e-4, -1e-4});
    EXPECT_LT((dipping.traction[0] - Vector2d(-6e5, 2e5)).norm(), 1e-3);
    EXPECT_LT((dipping.force[0] - 2.5 * Vector2d(-3.6e5 + 1.6e5, -4.8e5 - 1.2e5)).norm(), 1e-2);

    dipping.offset[0] = {1e-4, -2e-4}; // crept: the springs are as long as before it moved, and shorter
    part(dipping, {1e-4, -1e-4});
    EXPECT_LT((dipping.traction[0] - Vector2d(-1e6, 4e5)).norm(), 1e-3);
}

TEST(contacts, slip_and_open_within_their_strength)
{
    Contacts rough = contact(Coulomb{4e9, 1e9, 0, 0.5, 0}, {0, 1}, {-1e6, 0});
    part(rough, {1e-4, 1e-3});
    EXPECT_LT((rough.traction[0] - Vector2d(-6e5, 3e5)).norm(), 1e-3);
    EXPECT_EQ(rough.status[0], ContactStatus::slipping);
    EXPECT_NEAR(rough.state[0].slip, 1e-3 - 3e5 / 1e9, 1e-12);
    part(rough, {3e-4, 1e-3});
    EXPECT_EQ(rough.traction[0], Vector2d(0, 0));
    EXPECT_EQ(rough.force[0], Vector2d(0, 0));
    EXPECT_EQ(rough.status[0], ContactStatus::open);
}

// Dashpots: as much of the traction's change again, where it sticks.
TEST(contacts, damp_what_sticks)
{
    Contacts rough = contact(Coulomb{4e9, 1e9, 0, 0.5, 0}, {0, 1}, {-1e6, 0});
    part(rough, {1e-4, 2e-4}, 0.5);
    EXPECT_LT((rough.traction[0] - Vector2d(-6e5, 2e5)).norm(), 1e-3);
    EXPECT_LT((rough.force[0] - 2.5 * Vector2d(2e5 + 1e5, -6e5 + 2e5)).norm(), 1e-2);
    part(rough, {1e-4, 1e-3}, 0.5);
    EXPECT_LT((rough.force[0] - 2.5 * Vector2d(3e5, -6e5)).norm(), 1e-2);
}

TEST(contacts, removed_ones_do_nothing)
{
    Contacts contacts = contact(firm, {0, 1}, {-1e6, 0});
    contacts.status[0] = ContactStatus::removed;
    contacts.traction[0] = {0, 0};
    part(contacts, {1e-4, 2e-4});
    EXPECT_EQ(contacts.force[0], Vector2d(0, 0));
    EXPECT_EQ(contacts.work[0], 0);
    EXPECT_EQ(stored_energy(contacts), 0);
    std::vector<Vector2d> sums(2, Vector2d::Zero());
    add_row_sums(contacts, parted(contacts, contacts.relative_displacement[0]), sums);
    EXPECT_EQ(sums, std::vector<Vector2d>(2, Vector2d::Zero()));
    const ContactResponse none =
        respond(contacts, 0, {}, {.spring = {1, 1}, .slip = 2, .dilation = 3, .memory = {4, 5, 6}});
    EXPECT_EQ(none.traction, Vector2d(0, 0));
    EXPECT_EQ(none.slip, 2);
    EXPECT_EQ(none.dilation, 3);
    EXPECT_EQ(none.memory, (std::array<double, 3>{4, 5, 6}));
}

// The in-situ stress on planes of any dip, at the contact's centre.
TEST(contacts, start_with_the_stress_in_situ)
{
    Scene scene;
    scene.in_situ_stress = {.elevation = 10, .compression_xx = 2e6, .shear_xy = 5e5, .gradient_yy = 3e5};
    EquivalentJoints joints;
    for (const Parameter& parameter : all_parameters())
        parameter.in(joints).assign(1, parameter.name == "normal_stiffness" ? 3e9 : 0.0);
    joints.law.assign(1, 0);
    Mesh mesh;
    const double h = std::numbers::sqrt2 / 2;
    mesh.contact_normal = {{0, 1}, {1, 0}, {h, h}};
    mesh.contact_gridpoint.assign(3, {0, 1});
    mesh.contact_edge.assign(3, 0);
    mesh.contact_length.assign(3, 1.5);
    mesh.contact_centre = {{4, 0}, {4, 5}, {4, 0}}; // at depths of 10 m, 5 m and 10 m
    const Contacts contacts = contacts_of(scene, joints, mesh);
    EXPECT_EQ(contacts.initial_traction[0], Vector2d(-3e6, 5e5));                 // its tangent is {1, 0}
    EXPECT_EQ(contacts.initial_traction[1], Vector2d(-2e6, -5e5));                // its tangent is {0, -1}
    EXPECT_LT((contacts.initial_traction[2] - Vector2d(-2e6, 5e5)).norm(), 1e-3); // {h, -h}
    EXPECT_EQ(contacts.traction, contacts.initial_traction);
    EXPECT_EQ(k_n(contacts.law[2]), 3e9);
}

// By the springs of now: on a level joint k_s along x and k_n along y, twice, for a moves against b. Only joints that
// stiffen as they close get room for that.
TEST(contacts, row_sums_have_room_where_a_joint_stiffens)
{
    for (Index place = 0; place < places(); ++place) {
        const Law law = some_law(place);
        Contacts level = contact(law, {0, 1}, {-1e6, 0});
        std::vector<Vector2d> sums(2, Vector2d(1, 1));
        add_row_sums(level, parted(level, {0, 0}), sums);
        const double k = slopes(law, {}, -1e6).k_n * (stiffens(law) ? room_to_stiffen : 1);
        for (const Vector2d& sum : sums)
            EXPECT_LT((sum - Vector2d(1 + 5 * 5e8, 1 + 5 * k)).norm(), 1e-6 * k) << laws()[place].name;
    }
}

// What one side is pulled by, the other one is, too, the other way; and sides may change places.
RC_GTEST_PROP(contacts, action_is_reaction, ())
{
    const Law law = some_law(any_in(0, places()));
    const Vector2d normal = any_direction(), initial(-1e6, any_number(2e5)),
                   by(any_number(1e-3), any_number(3e-3));
    Contacts contacts = contact(law, normal, initial), other = contact(law, -normal, initial);
    part(contacts, by);
    part(other, by); // seen from side b
    std::vector<Vector2d> force(2, Vector2d(1, 2));
    add_forces(contacts, {.traction = contacts.traction}, force);
    const double rounding = 1e-9 * 2.5e6;
    RC_ASSERT((force[0] - Vector2d(1, 2) - contacts.force[0]).norm() < rounding);
    RC_ASSERT((force[1] - Vector2d(1, 2) + contacts.force[0]).norm() < rounding);
    RC_ASSERT((other.force[0] + contacts.force[0]).norm() < rounding);
    RC_ASSERT(std::abs(contacts.force[0].dot(normal) - 2.5 * contacts.traction[0].x()) < rounding);
}

// The tangent beside differences of forces, by a displacement in any direction, on the branch that all are on.
RC_GTEST_PROP(contacts, tangents_are_those_of_forces, ())
{
    const Law law = some_law(any_in(0, places()));
    Contacts before = contact(law, any_direction(), {-1e6, 1e5});
    before.offset[0] = {any_number(1e-4), any_number(1e-4)};
    if (*rc::gen::arbitrary<bool>())
        part(before, {0, 1.2345e-3}); // something to remember
    const Vector2d at(any_number(8e-4), any_number(3e-3)), by(any_number(1), any_number(1));
    const double step = 1e-9;
    const auto moved = [&](double way) {
        Contacts contacts = before;
        part(contacts, at + way * by);
        return contacts;
    };
    const Contacts low = moved(-step), now = moved(0), high = moved(step);
    RC_PRE(low.status == now.status && high.status == now.status);
    RC_PRE(low.state[0].is_broken == high.state[0].is_broken);
    const Tangent tangent = tangent_of_response(now, 0, before.state[0]);
    const Vector2d by_tangent = tangent.times(by), &n = now.normal[0],
                   wanted = 2.5 * (by_tangent.x() * n + by_tangent.y() * along(n)),
                   found = (high.force[0] - low.force[0]) / (2 * step);
    RC_ASSERT((found - wanted).norm() < 2.5 * 1e5);
}

// The response by duals beside differences, where all that it starts with changes. Creep has softened its springs: a
// continuously yielding joint has a kink where it begins to.
RC_GTEST_PROP(contacts, responses_follow_what_they_start_with, ())
{
    const Law law = some_law(any_in(0, places()));
    Contacts before = contact(law, any_direction(), {-1e6, 1e5});
    k_n(before.law[0]) *= 0.7;
    k_s(before.law[0]) *= 0.6;
    before.offset[0] = {any_number(1e-4), any_number(1e-4)};
    if (*rc::gen::arbitrary<bool>())
        part(before, {0, 1.2345e-3});
    const State start = before.state[0];
    const Vector2d at(any_number(8e-4), any_number(3e-3));
    ContactChange by{.stiffness = {any_number(1e9), any_number(5e8)},
                     .initial_traction = {any_number(1e6), any_number(1e6)},
                     .spring = {any_number(1e-3), any_number(1e-3)},
                     .slip = any_number(1e-3),
                     .dilation = any_number(1e-3)};
    for (int i = 0; i < 3; ++i)
        by.memory[i] = any_number(1) * start.memory[i];
    const double step = 1e-6;
    const auto changed = [&](double way) {
        Contacts contacts = before;
        k_n(contacts.law[0]) += way * by.stiffness.x();
        k_s(contacts.law[0]) += way * by.stiffness.y();
        contacts.initial_traction[0] += way * by.initial_traction;
        contacts.offset[0] -= way * by.spring;
        contacts.state[0].slip += way * by.slip;
        contacts.state[0].dilation += way * by.dilation;
        for (int i = 0; i < 3; ++i)
            contacts.state[0].memory[i] += way * by.memory[i];
        part(contacts, at);
        return contacts;
    };
    const Contacts low = changed(-step), now = changed(0), high = changed(step);
    RC_PRE(low.status == now.status && high.status == now.status);
    RC_PRE(low.state[0].is_broken == high.state[0].is_broken);
    const ContactResponse found = respond(now, 0, start, by);
    const auto slope = [&](const auto& of) { return (of(high) - of(low)) / (2 * step); };
    for (int i = 0; i < 2; ++i)
        RC_ASSERT(std::abs(found.traction[i] - slope([&](const Contacts& c) { return c.traction[0][i]; })) <
                  1e3);
    RC_ASSERT(std::abs(found.slip - slope([](const Contacts& c) { return c.state[0].slip; })) < 1e-6);
    RC_ASSERT(std::abs(found.dilation - slope([](const Contacts& c) { return c.state[0].dilation; })) < 1e-7);
    for (int i = 0; i < 3; ++i) {
        const double memory = slope([&](const Contacts& c) { return c.state[0].memory[i]; });
        RC_ASSERT(std::abs(found.memory[i] - memory) <
                  1e-4 * std::abs(now.state[0].memory[i]) + 1e-6 * std::abs(memory) + 1e-6);
    }
}

// Where nothing slips the work on a contact is what it stores, whatever the path. (A continuously yielding joint yields
// from the first shear on: it is opened and closed alone.)
RC_GTEST_PROP(contacts, store_the_work_done_on_them, ())
{
    const Law law = some_law(any_in(0, places()));
    const double shear = yields_from_the_first_shear(law) ? 0 : 1e-4;
    Contacts contacts = contact(law, any_direction(), {-1e6, shear > 0 ? any_number(1e5) : 0.0});
    Vector2d at(0, 0);
    for (int corner = 0; corner < 3; ++corner) {
        const Vector2d from = at;
        at = {any_number(4e-4), any_number(shear)};
        for (int i = 1; i <= 200; ++i) {
            part(contacts, from + i / 200.0 * (at - from));
            RC_ASSERT(contacts.status[0] == ContactStatus::stuck);
        }
        RC_ASSERT(std::abs(dissipated(contacts)) < 1e-5 * 2.5 * 1e6 * 4e-4);
    }
    begin_search(contacts, false);
    RC_ASSERT(dissipated(contacts) == 0);
}

// Where it sticks the row sums are no less than those of its tangent, also until it is room_to_stiffen times as stiff.
RC_GTEST_PROP(contacts, row_sums_bound_the_tangent, ())
{
    const Law law = some_law(any_in(0, places()));
    Contacts contacts = contact(law, any_direction(), {-1e6, 0});
    part(contacts, {any_number(4e-4), any_number(1e-4)});
    std::vector<Vector2d> sums(2, Vector2d::Zero());
    add_row_sums(contacts, parted(contacts, contacts.relative_displacement[0]), sums);
    const auto stiffness = [&] { return slopes(law, contacts.state[0], contacts.traction[0].x()).k_n; };
    const double k = stiffness();
    const State start = contacts.state[0];
    part(contacts, {any_number(4e-4), any_number(1e-4)});
    RC_PRE(contacts.status[0] == ContactStatus::stuck);
    RC_PRE(stiffness() <= room_to_stiffen * k);
    const Tangent tangent = tangent_of_response(contacts, 0, start);
    const Vector2d &n = contacts.normal[0], t = along(n);
    Eigen::Matrix2d block; // of the stiffness, between a gridpoint and itself; the other one has its opposite
    for (int i = 0; i < 2; ++i) {
        const Vector2d moved = Vector2d::Unit(i), by = tangent.times({n.dot(moved), t.dot(moved)});
        block.col(i) = 2.5 * (by.x() * n + by.y() * t);
    }
    const Vector2d rows = 2 * block.cwiseAbs().rowwise().sum();
    RC_ASSERT(sums[0] == sums[1]);
    RC_ASSERT((sums[0] - rows).minCoeff() > -1e-9 * rows.maxCoeff());
}

// The tractions stay, and it goes on as if it had not been: what opened closes where it did before.
RC_GTEST_PROP(contacts, go_on_as_before_once_they_start_from_here, ())
{
    const Law law = some_law(any_in(0, places()));
    Contacts kept = contact(law, any_direction(), {-1.000037e6, 1e5}); // no displacement just opens it
    kept.offset[0] = {any_number(1e-4), any_number(1e-4)};
    const Vector2d at(any_number(2e-3), any_number(3e-3));
    part(kept, at);
    Contacts contacts = kept;
    start_from_here(contacts);
    part(contacts, {0, 0});
    // A continuously yielding joint takes a reversal by less than 1e-4 of its strength for elastic. From where it starts
    // depends on what it takes so.
    const double rounding = (yields_from_the_first_shear(law) ? 1e-4 : 1e-6) * 1e6;
    RC_ASSERT((contacts.traction[0] - kept.traction[0]).norm() < rounding);
    RC_ASSERT(contacts.status[0] == kept.status[0]);
    RC_ASSERT(contacts.state[0].is_broken == kept.state[0].is_broken);
    for (int i = 0; i < 3; ++i) {
        const Vector2d by(any_number(2e-3), any_number(2e-3));
        part(contacts, by);
        part(kept, at + by);
        RC_ASSERT((contacts.traction[0] - kept.traction[0]).norm() < rounding);
        RC_ASSERT(contacts.status[0] == kept.status[0]);
    }
}

} // namespace contacts_test
