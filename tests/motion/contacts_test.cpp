// Contacts between two rows of faces, against closed forms.

#include "model/error.hpp"
#include "motion/contacts.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace jointcreep;
using Eigen::Vector2d;
using motion::Contacts;
using motion::Faces;

namespace
{

constexpr double k_n = 2e9, k_s = 5e8, friction = 0.5;

// Two polylines, each with its rock on the left; gridpoints are numbered one line after the other.
struct TwoLines {
    std::vector<Vector2d> place;
    Faces faces;

    TwoLines(const std::vector<Vector2d>& one, const std::vector<Vector2d>& other)
    {
        for (const auto* line : {&one, &other}) {
            const auto first = static_cast<Index>(place.size());
            place.insert(place.end(), line->begin(), line->end());
            for (Index i = 0; i + 1 < static_cast<Index>(line->size()); ++i) {
                faces.gridpoint.push_back({first + i, first + i + 1});
                faces.depth.push_back(1);
            }
        }
    }

    void turn(double angle)
    {
        for (Vector2d& p : place)
            p = Eigen::Rotation2Dd(angle) * p;
    }
};

Contacts contacts_of(const TwoLines& lines, const joint::Law& law = joint::Coulomb{k_n, k_s, 0, friction, 0})
{
    Contacts contacts({law});
    contacts.set_faces(lines.faces, {}, lines.place);
    return contacts;
}

std::vector<Vector2d> forces_of(const Contacts& contacts, std::size_t n)
{
    std::vector<Vector2d> force(n, Vector2d::Zero());
    contacts.add_forces(force, 1);
    return force;
}

// A lower row whose top runs from right to left, and an upper one whose bottom runs from left to right and
// lies `sunk` below it.
TwoLines rows(double sunk)
{
    return {{{4, 0}, {2.7, 0}, {1.9, 0}, {0.4, 0}, {0, 0}},
            {{0.25, -sunk}, {1, -sunk}, {2.2, -sunk}, {3.5, -sunk}}};
}

} // namespace

// Uniform closing gives uniform traction: every gridpoint has half of the loaded sides beside it, although
// none has a partner.
TEST(contacts, a_uniform_traction_passes_between_faces_that_do_not_match)
{
    for (const double angle : {0.0, 0.7, 2.5}) {
        const double sunk = 1e-4;
        TwoLines lines = rows(sunk);
        lines.turn(angle);
        Contacts contacts = contacts_of(lines);
        const std::vector<Vector2d> still(lines.place.size(), Vector2d::Zero());
        contacts.update(lines.place, still, 1, 0, 1);
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        const double sigma = k_n * sunk;
        const Vector2d up = Eigen::Rotation2Dd(angle) * Vector2d(0, 1);
        // Of the upper row, from 0.25 to 3.5, wholly on the lower one.
        const double upper[] = {0.375, 0.975, 1.25, 0.65};
        for (int i = 0; i < 4; ++i)
            EXPECT_LT((force[5 + i] - sigma * upper[i] * up).norm(), 1e-9 * sigma) << i << " at " << angle;
        // Of the lower one: 4 to 2.7 is loaded up to 3.5, 0.4 to 0 down to 0.25, linearly shared.
        const double right = 0.8 * 0.4 / 1.3, left = 0.15 * 0.075 / 0.4;
        const double lower[] = {right, 0.8 - right + 0.4, 0.4 + 0.75, 0.75 + 0.15 - left, left};
        for (int i = 0; i < 5; ++i)
            EXPECT_LT((force[i] + sigma * lower[i] * up).norm(), 1e-9 * sigma) << i << " at " << angle;
    }
}

TEST(contacts, forces_and_moments_balance)
{
    TwoLines lines = rows(1e-4);
    for (std::size_t g = 5; g < lines.place.size(); ++g) // tilted, so that a part is open
        lines.place[g].y() += 2e-4 * (lines.place[g].x() - 1.5);
    Contacts contacts = contacts_of(lines);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    contacts.update(lines.place, move, 1, 0, 1);
    for (std::size_t g = 5; g < lines.place.size(); ++g)
        lines.place[g] += move[g] = {3e-5, 0};
    contacts.update(lines.place, move, 1, 0, 1);
    const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
    Vector2d sum(0, 0);
    double moment = 0, largest = 0;
    for (std::size_t g = 0; g < force.size(); ++g) {
        sum += force[g];
        moment += lines.place[g].x() * force[g].y() - lines.place[g].y() * force[g].x();
        largest = std::max(largest, force[g].norm());
    }
    EXPECT_GT(largest, 1e4);
    EXPECT_LT(sum.norm(), 1e-12 * largest);
    EXPECT_LT(std::abs(moment), 1e-3 * largest); // the shear acts across the overlap, 3e-4 m
}

// Shear turns with the rock, and slips at its limit.
TEST(contacts, shear_goes_along_and_is_limited)
{
    for (const double angle : {0.0, 1.2}) {
        TwoLines lines = rows(1e-4);
        Contacts contacts = contacts_of(lines);
        std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
        contacts.update(lines.place, move, 1, 0, 1);
        const auto total = [&] {
            Vector2d sum(0, 0);
            const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
            for (std::size_t g = 5; g < force.size(); ++g)
                sum += force[g];
            return sum;
        };
        const double pressed = k_n * 1e-4 * 3.25, slid = 5e-5;
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {slid, 0};
        contacts.update(lines.place, move, 1, 0, 1);
        EXPECT_NEAR(total().x(), -k_s * slid * 3.25, 1e-4 * k_s * slid * 3.25);
        // Turned as a whole, in small steps as in a motion: the forces turn.
        for (int step = 0; step < 100; ++step) {
            const std::vector<Vector2d> before = lines.place;
            lines.turn(angle / 100);
            for (std::size_t g = 0; g < move.size(); ++g)
                move[g] = lines.place[g] - before[g];
            contacts.update(lines.place, move, 1, 0, 1);
        }
        const Vector2d turned = Eigen::Rotation2Dd(-angle) * total();
        EXPECT_NEAR(turned.x(), -k_s * slid * 3.25, 1e-3 * k_s * slid * 3.25) << angle;
        EXPECT_NEAR(turned.y(), pressed, 1e-9 * pressed) << angle;
        for (std::size_t g = 0; g < move.size(); ++g)
            move[g] = g < 5 ? Vector2d(0, 0) : Vector2d(Eigen::Rotation2Dd(angle) * Vector2d(1e-3, 0));
        for (std::size_t g = 0; g < move.size(); ++g)
            lines.place[g] += move[g];
        contacts.update(lines.place, move, 1, 0, 1);
        EXPECT_NEAR((Eigen::Rotation2Dd(-angle) * total()).x(), -friction * pressed, 1e-9 * pressed) << angle;
    }
}

// A corner of 90 degrees, d deep in a face, closes d cot t of one of its faces and d tan t of the other: the
// force is k d^2 (cot t + tan t) / 2 along the face's normal, wherever gridpoints of the face are.
TEST(contacts, a_corner_presses_along_the_normal_of_the_face)
{
    const double sunk = 1e-3;
    for (const double turn : {0.1, 0.7, 1.3})
        for (const double at : {0.3, 1.9, 1.9004, 2.0}) {
            const Vector2d corner(at, -sunk), one(std::cos(turn), std::sin(turn)), other(-one.y(), one.x());
            const TwoLines lines({{4, 0}, {2.7, 0}, {1.9, 0}, {-1, 0}},
                                 {corner + other, corner, corner + one});
            Contacts contacts = contacts_of(lines);
            const std::vector<Vector2d> still(lines.place.size(), Vector2d::Zero());
            contacts.update(lines.place, still, 1, 0, 1);
            const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
            const Vector2d sum = force[4] + force[5] + force[6];
            const double expected = k_n * sunk * sunk / 2 * (1 / std::tan(turn) + std::tan(turn));
            EXPECT_NEAR(sum.y(), expected, 1e-6 * expected) << turn << " at " << at;
            EXPECT_NEAR(sum.x(), 0, 1e-6 * expected) << turn << " at " << at;
        }
}

// What slides on keeps its shear and its closing on the next face.
TEST(contacts, history_goes_on_to_the_next_face)
{
    TwoLines lines({{4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, -1e-4}, {0.8, -1e-4}});
    Contacts contacts = contacts_of(lines);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    contacts.update(lines.place, move, 1, 0, 1);
    for (int step = 0; step < 300; ++step) {
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {0.01, 0};
        contacts.update(lines.place, move, 1, 0, 1);
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        const Vector2d sum = force[5] + force[6];
        const double pressed = k_n * 1e-4 * 0.6;
        EXPECT_NEAR(sum.y(), pressed, 1e-9 * pressed) << step;
        EXPECT_NEAR(sum.x(), -friction * pressed, 1e-9 * pressed) << step;
        double lost = 0;
        for (const motion::Pair& pair : contacts.pairs())
            lost += pair.friction;
        if (step > 0) {
            EXPECT_NEAR(lost, friction * pressed * 0.01, 2e-2 * friction * pressed * 0.01) << step;
        }
    }
    EXPECT_GT(contacts.searches(), 5);
}

TEST(contacts, faces_far_apart_are_not_sought_again_while_nothing_moves_far)
{
    TwoLines lines = rows(1e-4);
    Contacts contacts = contacts_of(lines);
    std::vector<Vector2d> move(lines.place.size(), Vector2d(1e-5, 0));
    for (int step = 0; step < 100; ++step) {
        for (std::size_t g = 0; g < move.size(); ++g)
            lines.place[g] += move[g];
        contacts.update(lines.place, move, 1, 0, 1);
    }
    EXPECT_EQ(contacts.searches(), 1);
}

// A mass falls flat on a row and jumps up again. With steps of 0.45 over the frequency what the first and the
// last step of the impact miss is of the order of 0.45^4 / 8 of its energy each, 1 percent together, wherever
// in a step it begins; with forces of the whole first and last step it would be 0.45^2 / 8 each, 5 percent.
TEST(contacts, an_impact_gives_back_what_it_took)
{
    const double dt = 1e-4, length = 3.25, mass = k_n * length * dt * dt / (0.45 * 0.45), speed = 3;
    for (double start = 0; start < 1; start += 0.05) {
        TwoLines lines = rows(-start * speed * dt);
        Contacts contacts = contacts_of(lines);
        std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
        double velocity = -speed;
        for (int step = 0; step < 20; ++step) {
            for (std::size_t g = 5; g < lines.place.size(); ++g)
                lines.place[g] += move[g] = {0, velocity * dt};
            contacts.update(lines.place, move, dt, 0, 1);
            const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
            for (std::size_t g = 5; g < lines.place.size(); ++g)
                velocity += force[g].y() / mass * dt;
        }
        EXPECT_NEAR(velocity * velocity, speed * speed, 0.01 * speed * speed) << start;
    }
}

// What dashpots take is the work of their forces, each force being the mean over a step.
TEST(contacts, what_is_damped_is_what_is_missing)
{
    const double dt = 1e-4, length = 3.25, mass = k_n * length * dt * dt / (0.2 * 0.2), speed = 3,
                 viscosity = 1e-4;
    TwoLines lines = rows(-0.5 * speed * dt);
    Contacts contacts = contacts_of(lines);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    double velocity = -speed, damped = 0;
    for (int step = 0; step < 40; ++step) {
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {0, velocity * dt};
        contacts.update(lines.place, move, dt, viscosity, 1);
        for (const motion::Pair& pair : contacts.pairs())
            damped += pair.damped;
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            velocity += force[g].y() / mass * dt;
    }
    const double lost = mass / 2 * (speed * speed - velocity * velocity);
    EXPECT_GT(lost, 0.1 * mass / 2 * speed * speed);
    EXPECT_NEAR(damped, lost,
                0.003 * mass / 2 * speed * speed); // 0.2^4 / 8 twice, and what ends within a step
}

// The first slip takes cohesion and friction down to what is left of them, on whatever face it goes on.
TEST(contacts, slip_weakens)
{
    TwoLines lines = rows(1e-4);
    const double pressed = k_n * 1e-4, cohesion = 5e4, left = 1e4, friction_left = 0.2;
    Contacts contacts({joint::Coulomb{k_n, k_s, cohesion, friction, 0, 0, true, left, friction_left}});
    std::vector<motion::Pair> bonded; // those that look at each other
    for (Index a = 0; a < 4; ++a)
        for (Index b = 4; b < 7; ++b)
            bonded.push_back({.a = a, .b = b, .is_known = true, .is_broken = false});
    contacts.set_faces(lines.faces, bonded, lines.place);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    const double peak = cohesion + friction * pressed, residual = left + friction_left * pressed;
    struct Step {
        double slid, tau;
    };
    for (const auto& [slid, tau] :
         {Step{0, 0}, Step{0.9 * peak / k_s, 0.9 * peak}, Step{0.2 * peak / k_s, residual},
          Step{0.3, residual}, Step{-0.1 * residual / k_s, 0.9 * residual}}) {
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {slid, 0};
        contacts.update(lines.place, move, 1, 0, 1);
        double sum = 0; // on the upper row
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        for (std::size_t g = 5; g < force.size(); ++g)
            sum -= force[g].x();
        // What slides on to the next face leaves its shear there: 1e-5 m at some ends of faces in the last
        // step.
        EXPECT_NEAR(sum, tau * 3.25, 5e-5 * peak * 3.25) << slid;
    }
}

// Barton and Bandis's law over a contact that closes evenly: its formulas times the length.
TEST(contacts, an_even_closing_presses_by_barton_and_bandiss_formulas)
{
    const joint::BartonBandis law{1e10, k_s, 2e-4, 0.5, 10, 1e8};
    const double p_at[] = {1e5, 5e6, 6e7, 2e8}, length = 3.25;
    for (const double p : p_at) {
        TwoLines lines = rows(law.closure(p));
        Contacts contacts = contacts_of(lines, law);
        std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
        contacts.update(lines.place, move, 1, 0, 1);
        EXPECT_NEAR(contacts.stiffest() / law.stiffness(p), 1, 1e-9);
        double stored = 0;
        for (const motion::Pair& pair : contacts.pairs())
            stored += pair.stored();
        EXPECT_NEAR(stored / (law.stored(p) * length), 1, 1e-9);
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {0.5, 0};
        contacts.update(lines.place, move, 1, 0, 1);
        Vector2d sum(0, 0);
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        for (std::size_t g = 5; g < force.size(); ++g)
            sum += force[g];
        EXPECT_NEAR(sum.y() / (p * length), 1, 1e-9) << p;
        EXPECT_NEAR(-sum.x() / std::min(law.strength(p) * length, k_s * 0.5 * length), 1, 1e-9) << p;
    }
}

// Wedged open, over a face 3 m long that goes from no closing to that at the pressure p: against the integral
// by a million points. Five points miss least where the curve is nearly straight.
TEST(contacts, an_uneven_closing_is_summed_up_at_five_points)
{
    const joint::BartonBandis law{1e10, k_s, 2e-4, 0.5, 10, 1e8};
    struct Case {
        double p, off; // [Pa], [-]
    };
    for (const auto& [p, off] : {Case{1e6, 1e-5}, Case{5e6, 1e-3}, Case{2e7, 2e-2}}) {
        const double deepest = law.closure(p);
        TwoLines lines({{4, 0}, {-1, 0}}, {{0, -deepest}, {3, 0}});
        Contacts contacts = contacts_of(lines, law);
        const std::vector<Vector2d> still(lines.place.size(), Vector2d::Zero());
        contacts.update(lines.place, still, 1, 0, 1);
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        double first = 0, second = 0;
        constexpr int n = 1000000;
        for (int i = 0; i < n; ++i) {
            const double at = (i + 0.5) / n, pressure = law.pressure(deepest * (1 - at));
            first += 3.0 / n * pressure * (1 - at);
            second += 3.0 / n * pressure * at;
        }
        EXPECT_NEAR(force[2].y() / first, 1, off) << p;
        EXPECT_NEAR(force[3].y() / second, 1, off) << p;
    }
}

// A corner that goes past another one, far below it, does not touch the face above: its side does.
TEST(contacts, faces_far_behind_do_not_touch)
{
    // Blocks side by side, 1e-3 m into each other, the upper edge of the right one 0.05 m below that of the
    // left one.
    const TwoLines lines({{-1, 1}, {-1, 0}, {0, 0}, {0, 1}, {-1, 1}},
                         {{-0.001, 0.95}, {-0.001, -0.05}, {1, -0.05}, {1, 0.95}, {-0.001, 0.95}});
    Contacts contacts = contacts_of(lines);
    const std::vector<Vector2d> still(lines.place.size(), Vector2d::Zero());
    contacts.update(lines.place, still, 1, 0, 1);
    for (const Vector2d& force : forces_of(contacts, lines.place.size()))
        EXPECT_EQ(force.y(), 0);
}

// However soft the joint: what sinks deeper than faces are sought (a quarter of the median face, here 0.2 m)
// goes on to press, down to half the depth of a zone, where it is refused.
TEST(contacts, what_sinks_deep_goes_on_to_press)
{
    TwoLines lines({{4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, 0}, {1, 0}, {1.8, 0}});
    Contacts contacts = contacts_of(lines);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    const auto sink = [&](double by) {
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {0, -by};
        contacts.update(lines.place, move, 1, 0, 1);
    };
    for (int step = 1; step < 50; ++step) {
        sink(0.01);
        double held = 0;
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        for (std::size_t g = 5; g < force.size(); ++g)
            held += force[g].y();
        const double expected = k_n * 0.01 * step * 1.6;
        EXPECT_NEAR(held, expected, 1e-9 * expected) << step;
    }
    EXPECT_GT(contacts.searches(), 3);
    EXPECT_THROW(sink(0.02), equilibrium_error);
}

// The same while it slides from face to face, and back; and where it came from outside within one step.
TEST(contacts, what_has_sunk_deep_slides_on)
{
    const double sunk = 0.3;
    TwoLines lines({{5, 0}, {4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, 0.01}, {0.8, 0.01}});
    Contacts contacts = contacts_of(lines);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    const auto go = [&](const Vector2d& way) {
        for (std::size_t g = 6; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = way;
        contacts.update(lines.place, move, 1, 0, 1);
    };
    go({0, -0.01 - sunk});
    const double pressed = k_n * sunk * 0.6;
    for (int step = 0; step < 900; ++step) {
        go({step < 450 ? 0.009 : -0.009, 0});
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        const Vector2d sum = force[6] + force[7];
        EXPECT_NEAR(sum.y(), pressed, 1e-9 * pressed) << step;
        EXPECT_LE(std::abs(sum.x()), friction * pressed * (1 + 1e-9)) << step;
    }
    EXPECT_GT(contacts.searches(), 10);
}

// A bond is not forgotten however far it stretches; where it tears it is gone.
TEST(contacts, bonds_stretch_beyond_the_skin)
{
    TwoLines lines({{2, 0}, {1, 0}, {0, 0}}, {{0, 0}, {1, 0}, {2, 0}});
    Contacts contacts({joint::Coulomb{k_n, k_s, 1e9, friction, 0.7 * k_n}});
    std::vector<motion::Pair> bonded;
    for (const auto& [a, b] : {std::pair(0, 3), std::pair(1, 2)})
        bonded.push_back({.a = a, .b = b, .is_known = true, .is_broken = false});
    contacts.set_faces(lines.faces, bonded, lines.place);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    for (int step = 1; step < 100; ++step) {
        for (std::size_t g = 3; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {0, 0.01};
        contacts.update(lines.place, move, 1, 0, 1);
        double held = 0;
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        for (std::size_t g = 3; g < force.size(); ++g)
            held -= force[g].y();
        const double stretched = 0.01 * step;
        EXPECT_NEAR(held, stretched < 0.7 ? k_n * stretched * 2 : 0.0, 1e-9 * k_n) << step;
    }
}
