// How long a step may last in which open contacts close, by what one contact does.

#include "joint/closing.hpp"
#include "model/error.hpp"

#include <gtest/gtest.h>

namespace closing_test
{

using namespace jointcreep;
using Eigen::Vector2d;
using joint::Closing;

namespace
{

constexpr double k_n = 1e9, tolerance = 1e-5;

// Contacts alone, put where a test wants them; the gap is what opens beyond touching [m].
struct Gaps {
    mechanics::Assembly rock;

    explicit Gaps(std::size_t n = 1)
    {
        joint::Contacts& contacts = rock.contacts;
        contacts.law.assign(n, joint::Coulomb{k_n, 1e9, 0, 0.6, 0});
        contacts.initial_traction.assign(n, {-1e6, 0});
        contacts.offset.assign(n, {2e-4, 0}); // crept
        contacts.relative_displacement.resize(n);
        contacts.state.resize(n);
        contacts.status.resize(n);
    }
    void put(double gap, double shear, std::size_t c = 0)
    {
        rock.contacts.relative_displacement[c] = {gap + 1e6 / k_n + 2e-4, shear};
        rock.contacts.status[c] = gap > 0 ? ContactStatus::open : ContactStatus::stuck;
    }
};

} // namespace

TEST(closing, without_any_a_step_may_last)
{
    Gaps gaps(3);
    gaps.put(-1e-4, 0, 0); // closed before and after
    gaps.put(1e-3, 0, 1);  // open before and after
    gaps.put(-1e-4, 0, 2); // opens
    Closing closing(tolerance);
    closing.start(gaps.rock.contacts);
    gaps.put(-2e-4, 1, 0);
    gaps.put(1e-6, 1, 1);
    gaps.put(1e-4, 1, 2);
    EXPECT_EQ(closing.longest_step(gaps.rock.contacts, 8), 8);
}

// A gap of 1 mm that closes by 0.1 mm/s while it shears by 0.05 mm/s touches after 10 s.
TEST(closing, is_foreseen_by_the_rate_of_the_step_before)
{
    Gaps gaps;
    gaps.put(1.5e-3, 0);
    Closing closing(tolerance);
    closing.start(gaps.rock.contacts);
    gaps.put(1e-3, 2.5e-4);
    EXPECT_EQ(closing.longest_step(gaps.rock.contacts, 5), 5);
    closing.finish(gaps.rock.contacts, 5);

    closing.start(gaps.rock.contacts);
    gaps.put(-1e-5, 2.5e-4); // touching and stuck: as if it had not sheared
    EXPECT_NEAR(closing.longest_step(gaps.rock.contacts, 20), 0.99 * 10, 1e-9);
    gaps.put(-1e-5, 2.5e-4);
    EXPECT_NEAR(closing.longest_step(gaps.rock.contacts, 9.9), 0.9 * 9.9 * 1e-3 / 1.01e-3, 1e-9);
    gaps.put(1e-5, 7.5e-4);
    EXPECT_EQ(closing.longest_step(gaps.rock.contacts, 8.82), 8.82);
    closing.finish(gaps.rock.contacts, 8.82);

    // What is left of the gap shears by less than the tolerance.
    closing.start(gaps.rock.contacts);
    gaps.put(-1e-5, 7.5e-4);
    EXPECT_EQ(closing.longest_step(gaps.rock.contacts, 20), 20);
}

TEST(closing, is_sought_halfway_where_no_rate_is_known)
{
    Gaps gaps;
    gaps.put(1e-3, 0);
    Closing closing(tolerance);
    closing.start(gaps.rock.contacts);
    gaps.put(-1e-3, 1e-3); // as far below: it touches in the middle of the step, or before
    EXPECT_NEAR(closing.longest_step(gaps.rock.contacts, 8), 0.99 * 2, 1e-9);
    // A sudden change of loads makes it forget.
    gaps.put(5e-4, 0);
    closing.finish(gaps.rock.contacts, 1);
    closing.start_afresh();
    gaps.put(1e-3, 0);
    closing.start(gaps.rock.contacts);
    gaps.put(-1e-3, 1e-3);
    EXPECT_NEAR(closing.longest_step(gaps.rock.contacts, 8), 0.99 * 2, 1e-9);
}

TEST(closing, that_does_not_shear_does_not_matter)
{
    Gaps gaps;
    gaps.put(1e-3, 4e-3);
    Closing closing(tolerance);
    closing.start(gaps.rock.contacts);
    gaps.put(-1e-3, 4e-3 + 0.9 * tolerance);
    EXPECT_EQ(closing.longest_step(gaps.rock.contacts, 8), 8);
}

TEST(closing, the_first_of_several_decides_and_removed_ones_do_not)
{
    Gaps gaps(3);
    for (std::size_t c = 0; c < 3; ++c)
        gaps.put(1e-3 * static_cast<double>(c + 1), 0, c);
    Closing closing(tolerance);
    closing.start(gaps.rock.contacts);
    for (std::size_t c = 0; c < 3; ++c)
        gaps.put(-1e-3, 1e-2, c);
    const double all = closing.longest_step(gaps.rock.contacts, 8);
    EXPECT_NEAR(all, 0.99 * 8 * 0.25, 1e-9);
    closing.start(gaps.rock.contacts); // from there nothing is open
    EXPECT_EQ(closing.longest_step(gaps.rock.contacts, 8), 8);

    for (std::size_t c = 0; c < 3; ++c)
        gaps.put(1e-3 * static_cast<double>(c + 1), 0, c);
    closing.start(gaps.rock.contacts);
    for (std::size_t c = 0; c < 3; ++c)
        gaps.put(-1e-3, 1e-2, c);
    gaps.rock.contacts.status[0] = ContactStatus::removed;
    EXPECT_NEAR(closing.longest_step(gaps.rock.contacts, 8), 0.99 * 8 * 2 / 3 / 2, 1e-9);
}

// Whatever is asked, each step is shorter than the one before: the search ends.
TEST(closing, steps_become_shorter_at_every_cut)
{
    Gaps gaps;
    gaps.put(1e-3, 0);
    Closing closing(tolerance);
    closing.start(gaps.rock.contacts);
    double step = 100;
    int cuts = 0;
    for (;; ++cuts) {
        gaps.put(-1e-9, 1); // as if it had hardly touched
        const double longest = closing.longest_step(gaps.rock.contacts, step);
        if (longest == step || cuts == 400)
            break;
        ASSERT_LT(longest, 0.995 * step);
        step = longest;
        if (step < 1e-7)
            break;
    }
    EXPECT_LT(cuts, 400);
}

// Another run that continues between two steps foresees the same.
TEST(closing, rates_are_in_checkpoints)
{
    Gaps gaps;
    gaps.put(1.5e-3, 0);
    Closing closing(tolerance), continued(tolerance);
    closing.start(gaps.rock.contacts);
    gaps.put(1e-3, 2.5e-4);
    closing.finish(gaps.rock.contacts, 5);
    Checkpoint kept;
    kept.contact_status = {static_cast<Index>(ContactStatus::open)};
    closing.transfer(Transfer(Transfer::Way::keep), kept);
    continued.transfer(Transfer(Transfer::Way::restore), kept);
    for (Closing* one : {&closing, &continued}) {
        one->start(gaps.rock.contacts);
        gaps.put(-1e-5, 2.5e-4);
        EXPECT_NEAR(one->longest_step(gaps.rock.contacts, 20), 0.99 * 10, 1e-9);
        gaps.put(1e-3, 2.5e-4);
    }
    kept.opening_rate.emplace_back(0, 0);
    EXPECT_THROW(continued.transfer(Transfer(Transfer::Way::restore), kept), input_error);
}

} // namespace closing_test
