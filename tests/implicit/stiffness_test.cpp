// The tangent against differences of forces, and its factor against the tangent.

#include "../mechanics/sections.hpp"

#include "implicit/stiffness.hpp"
#include "mechanics/excavation.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stiffness_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;
using Eigen::VectorXd;
using implicit::Stiffness;
using joint::Tangent;
using mechanics::Assembly;
using mechanics::Tangents;

constexpr double friction = 0.5; // [rad]

// Held below; two gridpoints face to face across a joint are tied, and a corner is removed if so asked.
Section plate(bool excavated)
{
    Scene scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
    scene.zone_size = 1.5;
    scene.boundaries = {{{0, 0}, {20, 0}, true, true, ""}, {{0, 0}, {0, 10}, true, false, ""}};
    scene.stages.push_back({"corner", 1, {{{15, 6}, {21, 6}, {21, 11}, {15, 11}}}});
    Joints joints;
    add_joint(joints, {-1, 3}, {21, 5});
    add_joint(joints, {6, -1}, {9, 11});
    add_joint(joints, {21, 2}, {11, 11});
    Section s = assembled(std::move(scene), joints, 5e9, 2e9, friction);
    if (excavated)
        mechanics::excavate(s.assembly, s.network.blocks, s.mesh, mechanics::Loading(s.scene, s.mesh), 0);
    const std::size_t middle = s.mesh.contact_gridpoint.size() / 3;
    s.assembly.ties.push_back({s.mesh.contact_gridpoint[middle], 1});
    mechanics::part_ties(s.assembly, -1);
    EXPECT_GE(s.assembly.tied.size(), 1u);
    return s;
}

// Every fourth contact is open, slips forward, slips backward, sticks. Returns what each then does.
std::vector<Tangent> excite(Assembly& assembly)
{
    joint::Contacts& contacts = assembly.contacts;
    std::vector<Tangent> tangents;
    const double tan_phi = std::tan(friction);
    for (std::size_t c = 0; c < contacts.status.size(); ++c) {
        auto& law = std::get<joint::Coulomb>(contacts.law[c]);
        const double k_n = law.k_n, k_s = law.k_s;
        const double tan_psi = law.tan_psi = c % 8 < 4 ? 0.0 : 0.14;
        const double k = k_n * k_s / (k_s + k_n * tan_phi * tan_psi); // k_n without dilation
        const std::array<Vector2d, 4> traction{Vector2d(1e6, 0), Vector2d(-1e6, 9e5), Vector2d(-1e6, -9e5),
                                               Vector2d(-1e6, 1e5)};
        const std::array<Tangent, 4> tangent{
            Tangent{0, 0, 0, 0}, Tangent{k, k * tan_phi * tan_psi, -k * tan_phi, -k * tan_psi},
            Tangent{k, k * tan_phi * tan_psi, k * tan_phi, k * tan_psi}, Tangent{k_n, k_s, 0, 0}};
        contacts.initial_traction[c] = traction[c % 4];
        tangents.push_back(tangent[c % 4]);
    }
    return tangents;
}

VectorXd random_vector(Eigen::Index n)
{
    std::mt19937 random(4);
    std::uniform_real_distribution<double> u(-1, 1);
    return VectorXd::NullaryExpr(n, [&] { return u(random); });
}

// The unbalanced force after a move from where the assembly is.
VectorXd force_at(const Stiffness& stiffness, Assembly assembly, const VectorXd& move, double factor)
{
    stiffness.add_to(assembly.displacement, move, factor);
    find_forces(assembly);
    return stiffness.gathered(assembly, assembly.force);
}

class stiffness : public testing::TestWithParam<bool>
{
};

TEST_P(stiffness, is_what_forces_change_by)
{
    Section s = plate(GetParam());
    const std::vector<Tangent> tangents = excite(s.assembly);
    Stiffness K;
    K.follow(s.assembly);
    ASSERT_GT(K.size(), 100);
    Assembly now = s.assembly;
    find_forces(now);
    std::map<ContactStatus, int> numbers;
    for (const ContactStatus status : now.contacts.status)
        ++numbers[status];
    EXPECT_EQ(numbers[ContactStatus::removed] > 0, GetParam());
    EXPECT_GT(numbers[ContactStatus::open], 3);
    EXPECT_GT(numbers[ContactStatus::slipping], 6);
    EXPECT_GT(numbers[ContactStatus::stuck], 3);

    const VectorXd x = random_vector(K.size());
    const double h = 1e-6; // moves of a micrometre change no contact's state, so forces are linear in them
    const VectorXd change = (force_at(K, s.assembly, x, -h) - force_at(K, s.assembly, x, h)) / (2 * h);
    const VectorXd product = K.times(s.assembly, {.contacts = tangents}, x);
    EXPECT_LT((product - change).norm(), 1e-7 * change.norm());
    // Without either coupling it would be something else.
    for (double Tangent::*const coupling : {&Tangent::friction, &Tangent::dilation}) {
        std::vector<Tangent> uncoupled = tangents;
        for (Tangent& t : uncoupled)
            t.*coupling = 0;
        EXPECT_GT((K.times(s.assembly, {.contacts = uncoupled}, x) - change).norm(), 1e-3 * change.norm());
    }
}

TEST_P(stiffness, moves_nothing_that_is_held_and_ties_together)
{
    Section s = plate(GetParam());
    Stiffness K;
    K.follow(s.assembly);
    const VectorXd x = random_vector(K.size());
    K.add_to(s.assembly.displacement, x, 1);
    std::set<Index> followers;
    for (const auto& [follower, leader] : s.assembly.tied) {
        EXPECT_EQ(s.assembly.displacement[follower], s.assembly.displacement[leader]);
        followers.insert(follower);
    }
    Eigen::Index moved = 0;
    for (std::size_t g = 0; g < s.assembly.position.size(); ++g)
        for (int i = 0; i < 2; ++i) {
            if (s.assembly.is_free[g][i] == 0)
                EXPECT_EQ(s.assembly.displacement[g][i], 0) << g;
            else if (followers.count(static_cast<Index>(g)) == 0)
                moved += s.assembly.displacement[g][i] != 0 ? 1 : 0;
        }
    EXPECT_EQ(moved, K.size());
}

TEST_P(stiffness, its_factor_solves_what_is_symmetric)
{
    Section s = plate(GetParam());
    Stiffness K;
    K.follow(s.assembly);
    EXPECT_FALSE(K.has_factor());
    const Tangents stuck{.contacts{s.assembly.contacts.law.size(), {5e9, 2e9, 0, 0}}};
    ASSERT_TRUE(K.factorise(s.assembly, stuck));
    const VectorXd x = random_vector(K.size());
    EXPECT_LT((K.solve(K.times(s.assembly, stuck, x)) - x).norm(), 1e-9 * x.norm());
}

INSTANTIATE_TEST_SUITE_P(before_and_after_excavation, stiffness, testing::Bool());

// What follow() looks at: rock that goes, ties that end, zones that creep. Contacts' springs may change
// without.
TEST(stiffness, follows_what_changes_and_keeps_its_factor_otherwise)
{
    Section s = plate(false);
    const Tangents stuck{.contacts{s.assembly.contacts.law.size(), {5e9, 2e9, 0, 0}}};
    Stiffness K;
    K.follow(s.assembly);
    K.factorise(s.assembly, stuck);
    const Eigen::Index size = K.size();
    joint::k_n(s.assembly.contacts.law[0]) *= 2;
    s.assembly.displacement[5] = {1, 1};
    K.follow(s.assembly);
    EXPECT_TRUE(K.has_factor());

    for (auto& moduli : s.assembly.zones.stiffness)
        moduli *= 0.5;
    K.follow(s.assembly);
    EXPECT_FALSE(K.has_factor());
    EXPECT_EQ(K.size(), size);
    const Tangents softer{.contacts{s.assembly.contacts.law.size(), {2.5e9, 1e9, 0, 0}}};
    const VectorXd x = random_vector(size);
    const VectorXd half = K.times(s.assembly, softer, x);
    ASSERT_TRUE(K.factorise(s.assembly, softer));
    EXPECT_LT((K.solve(half) - x).norm(), 1e-9 * x.norm());

    mechanics::part_ties(s.assembly, 1);
    EXPECT_TRUE(s.assembly.tied.empty());
    K.follow(s.assembly);
    EXPECT_FALSE(K.has_factor());
    EXPECT_EQ(K.size(), size + 2);

    mechanics::excavate(s.assembly, s.network.blocks, s.mesh, mechanics::Loading(s.scene, s.mesh), 0);
    K.follow(s.assembly);
    EXPECT_LT(K.size(), size);
    ASSERT_TRUE(K.factorise(s.assembly, stuck));
    const VectorXd y = random_vector(K.size());
    EXPECT_LT((K.solve(K.times(s.assembly, stuck, y)) - y).norm(), 1e-9 * y.norm());
}

TEST(stiffness, takes_no_more_threads_than_it_is_given)
{
    Section s = plate(false);
    Stiffness K;
    for (const int threads : {2, 1}) {
        s.assembly.threads = threads;
        K.follow(s.assembly);
        EXPECT_EQ(Eigen::nbThreads(), threads);
    }
}

TEST(stiffness, of_rock_that_all_is_held_is_empty)
{
    Section s = plate(false);
    for (Vector2d& free : s.assembly.is_free)
        free.setZero();
    Stiffness K;
    K.follow(s.assembly);
    EXPECT_EQ(K.size(), 0);
}

} // namespace stiffness_test
