// What contacts do in a search for equilibrium: tangents beside the law's response, turning round, breaking of bonds.

#include "joint/active_contacts.hpp"

#include "any_law.hpp"
#include "one_contact.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace active_contacts_test
{

using namespace jointcreep;
using namespace jointcreep::joint;
using namespace jointcreep::test;

namespace
{

Law bonded()
{
    return Coulomb{.k_n = 1e9, .k_s = 1e9, .cohesion = 1e6, .tan_phi = 0.5, .tensile_strength = 1e5};
}

// A search that begins with a contact, and its state then.
struct Search {
    Contacts contacts;
    ContactsState start;
    ActiveContacts active;
};
Search begun(const Contacts& contacts)
{
    Search search{contacts, state_of(contacts), {}};
    search.active.begin(contacts);
    search.active.take(contacts, search.start, true);
    return search;
}

} // namespace

// What they do now has the tangent of the response, for every law; the other tangents are of springs and of slip.
RC_GTEST_PROP(active_contacts, have_the_tangent_of_the_response, ())
{
    const Law law = some_law(any_in(0, places()));
    Contacts contacts = contact(law, {0, 1}, {-1e6 - 1e3 * any_in(0, 2000), any_number(2e5)});
    const ContactsState start = state_of(contacts);
    ActiveContacts active;
    active.begin(contacts);
    part(contacts, {any_number(1e-3), any_number(3e-3)});
    RC_PRE(contacts.state[0].is_broken == start.state[0].is_broken);
    active.take(contacts, start, true);
    const Tangent of = active.tangents(contacts, {}, start, 0)[0],
                  wanted = tangent_of_response(contacts, 0, start.state[0]);
    const double size = 1e-6 * slopes(law, contacts.state[0], contacts.traction[0].x()).k_n;
    RC_CLASSIFY(contacts.status[0] == ContactStatus::slipping, "slips");
    RC_ASSERT(std::abs(of.normal - wanted.normal) <= size);
    RC_ASSERT(std::abs(of.shear - wanted.shear) <= size);
    RC_ASSERT(std::abs(of.friction - wanted.friction) <= size);
    RC_ASSERT(std::abs(of.dilation - wanted.dilation) <= size);
}

TEST(active_contacts, slide_back_only_after_they_have_stuck)
{
    Contacts contacts = contact(bonded(), {0, 1}, {-1e6, 0});
    const ContactsState start = state_of(contacts);
    ActiveContacts active;
    active.begin(contacts);
    const auto shear = [&] { return active.tangents(contacts, {}, start, 0)[0].friction; };
    part(contacts, {0, 5e-3});
    active.take(contacts, start, true);
    EXPECT_LT(shear(), 0); // more pressure, more shear
    active.restart(contacts, start);
    part(contacts, {0, -5e-3});
    active.take(contacts, start, false);
    EXPECT_EQ(shear(), 0);
    active.take(contacts, start, false);
    EXPECT_GT(shear(), 0);
}

TEST(active_contacts, break_bonds_that_open_twice)
{
    auto [contacts, start, active] = begun(contact(bonded(), {0, 1}, {-1e6, 0}));
    for (int opening = 0; opening < 2; ++opening) {
        active.restart(contacts, start);
        EXPECT_FALSE(contacts.state[0].is_broken);
        part(contacts, {2e-3, 0});
        EXPECT_EQ(contacts.status[0], ContactStatus::open);
        active.take(contacts, start, false);
        active.restart(contacts, start);
        if (opening == 0) {
            part(contacts, {0, 0});
            active.take(contacts, start, false);
        }
    }
    EXPECT_TRUE(contacts.state[0].is_broken);
    part(contacts, {0, 0});
    EXPECT_FALSE(
        active.mend_bonds(contacts)); // closed again, and its bond mended; no force changes as it sticks
    active.restart(contacts, start);
    EXPECT_FALSE(contacts.state[0].is_broken);
}

TEST(active_contacts, break_bonds_that_hinder)
{
    auto [contacts, start, active] = begun(contact(bonded(), {0, 1}, {-1e6, 0}));
    EXPECT_FALSE(active.break_bonds(contacts, start));
    part(contacts, {2e-3, 0});
    EXPECT_TRUE(active.break_bonds(contacts, start));
    EXPECT_FALSE(active.break_bonds(contacts, start)); // once
    const ActiveContacts before = active;
    part(contacts, {0, 9e-4});
    active.mend_bonds(contacts);
    active.restart(contacts, start);
    EXPECT_FALSE(contacts.state[0].is_broken);
    active.break_again(before);
    active.restart(contacts, start);
    EXPECT_TRUE(contacts.state[0].is_broken);
}

// A joint with tensile strength alone has a bond, too.
TEST(active_contacts, break_bonds_without_cohesion)
{
    Coulomb law = std::get<Coulomb>(bonded());
    law.cohesion = 0;
    auto [contacts, start, active] = begun(contact(law, {0, 1}, {-1e6, 0}));
    part(contacts, {2e-3, 0});
    EXPECT_TRUE(active.break_bonds(contacts, start));
    law.tensile_strength = 0;
    auto [loose, loose_start, loose_active] = begun(contact(law, {0, 1}, {-1e6, 0}));
    part(loose, {2e-3, 0});
    EXPECT_FALSE(loose_active.break_bonds(loose, loose_start));
}

// The factor needs some stiffness where there is no shear spring, also of a law with a memory.
TEST(active_contacts, smooth_joints_keep_a_share)
{
    Coulomb law = std::get<Coulomb>(bonded());
    WearingDilation with_memory{};
    law.k_s = 0;
    with_memory.k_n = law.k_n;
    for (const Law& smooth : {Law(law), Law(with_memory)}) {
        const auto [contacts, start, active] = begun(contact(smooth, {0, 1}, {-1e6, 0}));
        EXPECT_EQ(active.tangents(contacts, {}, start, 1e-6)[0].shear, 1e3);
    }
}

} // namespace active_contacts_test
