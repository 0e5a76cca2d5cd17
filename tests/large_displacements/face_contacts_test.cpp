// Contacts between two rows of faces, against closed forms.

#include "large_displacements/face_contacts.hpp"
#include "large_displacements/face_overlap.hpp"
#include "model/error.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace face_contacts_test
{

using namespace jointcreep;
using Eigen::Vector2d;
using large_displacements::FaceContacts;
using large_displacements::Faces;

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

FaceContacts contacts_of(const TwoLines& lines,
                         const joint::Law& law = joint::Coulomb{k_n, k_s, 0, friction, 0})
{
    FaceContacts contacts({law});
    contacts.set_faces(lines.faces, {}, lines.place);
    return contacts;
}

std::vector<Vector2d> forces_of(const FaceContacts& contacts, std::size_t n)
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

// Two corners beside each other come to overlap as one of them passes the other: from 0 on, though the gap between them has
// another length in each plane, and a joint that was closed before carries load across a gap.
TEST(face_contacts, two_corners_beside_each_other_overlap_from_zero_on)
{
    Faces faces;
    faces.gridpoint = {{0, 1}, {2, 3}};
    faces.depth = {1, 1};
    const double angle = 69 * std::numbers::pi / 180;
    const Vector2d along_b(-std::cos(angle), -std::sin(angle)), beside(0.0022, -0.0032);
    const std::vector<large_displacements::FaceShape> shapes{{{1, 0}, 8}, {along_b, 6}};
    const Vector2d passing = (Vector2d(1, 0) - along_b).normalized();
    const double step = 1e-5;
    double last = 0;
    int overlapping = 0;
    for (int i = -300; i < 1000; ++i) {
        const Vector2d corner = beside + i * step * passing;
        const std::vector<Vector2d> place{{0, 0}, {8, 0}, corner, corner + 6 * along_b};
        const auto found = large_displacements::overlap_of({.a = 0, .b = 1}, faces, shapes, place);
        const double length = found ? found->length : 0.0;
        EXPECT_LT(std::abs(length - last), 5 * step) << i;
        overlapping += length > 0 ? 1 : 0;
        last = length;
        if (found) {
            // Its ends are where they are said to be.
            for (int end = 0; end < 2; ++end) {
                const Vector2d on_a = large_displacements::at(std::array<Vector2d, 2>{place[0], place[1]},
                                                              found->on_a[end]),
                               on_b = large_displacements::at(std::array<Vector2d, 2>{place[2], place[3]},
                                                              found->on_b[end]);
                EXPECT_NEAR((on_b - on_a).dot(found->normal()), found->gap[end], 1e-12);
                EXPECT_NEAR((on_b - on_a).dot(found->tangent), 0, 1e-12);
            }
            EXPECT_GE(found->whole, found->length);
        }
    }
    EXPECT_GT(overlapping, 900);
    EXPECT_LT(overlapping, 1100);
}

// Uniform closing gives uniform traction: every gridpoint has half of the loaded sides beside it, although
// none has a partner.
TEST(face_contacts, a_uniform_traction_passes_between_faces_that_do_not_match)
{
    for (const double angle : {0.0, 0.7, 2.5}) {
        const double sunk = 1e-4;
        TwoLines lines = rows(sunk);
        lines.turn(angle);
        FaceContacts contacts = contacts_of(lines);
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

TEST(face_contacts, forces_and_moments_balance)
{
    TwoLines lines = rows(1e-4);
    for (std::size_t g = 5; g < lines.place.size(); ++g) // tilted, so that a part is open
        lines.place[g].y() += 2e-4 * (lines.place[g].x() - 1.5);
    FaceContacts contacts = contacts_of(lines);
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
TEST(face_contacts, shear_goes_along_and_is_limited)
{
    for (const double angle : {0.0, 1.2}) {
        TwoLines lines = rows(1e-4);
        FaceContacts contacts = contacts_of(lines);
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
        // Turned as a whole, in small steps as in a dynamic analysis: the forces turn.
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
TEST(face_contacts, a_corner_presses_along_the_normal_of_the_face)
{
    const double sunk = 1e-3;
    for (const double turn : {0.1, 0.7, 1.3})
        for (const double at : {0.3, 1.9, 1.9004, 2.0}) {
            const Vector2d corner(at, -sunk), one(std::cos(turn), std::sin(turn)), other(-one.y(), one.x());
            const TwoLines lines({{4, 0}, {2.7, 0}, {1.9, 0}, {-1, 0}},
                                 {corner + other, corner, corner + one});
            FaceContacts contacts = contacts_of(lines);
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
TEST(face_contacts, history_goes_on_to_the_next_face)
{
    TwoLines lines({{4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, -1e-4}, {0.8, -1e-4}});
    FaceContacts contacts = contacts_of(lines);
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
        for (const large_displacements::FacePair& pair : contacts.pairs())
            lost += pair.friction;
        if (step > 0) {
            EXPECT_NEAR(lost, friction * pressed * 0.01, 2e-2 * friction * pressed * 0.01) << step;
        }
    }
    EXPECT_GT(contacts.searches(), 5);
}

// The upper row has a corner on the lower one, pressed in by the lead of the flat face. The face beyond the corner rises,
// and starts without a force, whenever it is found: no energy appears.
TEST(face_contacts, a_face_beside_a_corner_that_is_pressed_in_starts_without_a_force)
{
    const double lead = 0.05;
    TwoLines lines({{4, 0}, {0, 0}}, {{0.5, 0}, {2, 0}, {3, 0.5}});
    large_displacements::FacePair flat{.a = 0, .b = 1};
    flat.lead = {lead, lead};
    flat.is_known = flat.is_closed = true;
    FaceContacts contacts({joint::Coulomb{k_n, k_s, 0, friction, 0}});
    contacts.set_faces(lines.faces, {flat}, lines.place);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    const double stored = k_n * lead * lead / 2 * 1.5;
    for (const double down : {0.0, 0.0, 1e-9, 0.0}) {
        for (std::size_t g = 2; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {0, -down};
        contacts.update(lines.place, move, 1, 0, 1);
        EXPECT_NEAR(contacts.energy().stored, stored, 1e-6 * stored);
        EXPECT_LT(forces_of(contacts, lines.place.size())[4].norm(), 1e-6 * k_n * lead);
    }
}

TEST(face_contacts, faces_far_apart_are_not_sought_again_while_nothing_moves_far)
{
    TwoLines lines = rows(1e-4);
    FaceContacts contacts = contacts_of(lines);
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
TEST(face_contacts, an_impact_gives_back_what_it_took)
{
    const double dt = 1e-4, length = 3.25, mass = k_n * length * dt * dt / (0.45 * 0.45), speed = 3;
    for (double start = 0; start < 1; start += 0.05) {
        TwoLines lines = rows(-start * speed * dt);
        FaceContacts contacts = contacts_of(lines);
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
TEST(face_contacts, what_is_damped_is_what_is_missing)
{
    const double dt = 1e-4, length = 3.25, mass = k_n * length * dt * dt / (0.2 * 0.2), speed = 3,
                 viscosity = 1e-4;
    TwoLines lines = rows(-0.5 * speed * dt);
    FaceContacts contacts = contacts_of(lines);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    double velocity = -speed, damped = 0;
    for (int step = 0; step < 40; ++step) {
        for (std::size_t g = 5; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = {0, velocity * dt};
        contacts.update(lines.place, move, dt, viscosity, 1);
        for (const large_displacements::FacePair& pair : contacts.pairs())
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
TEST(face_contacts, slip_weakens)
{
    TwoLines lines = rows(1e-4);
    const double pressed = k_n * 1e-4, cohesion = 5e4, left = 1e4, friction_left = 0.2;
    FaceContacts contacts({joint::Coulomb{k_n, k_s, cohesion, friction, 0, 0, true, left, friction_left}});
    std::vector<large_displacements::FacePair> bonded; // those that look at each other
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
TEST(face_contacts, an_even_closing_presses_by_barton_and_bandiss_formulas)
{
    const joint::BartonBandis law{1e10, k_s, 2e-4, 0.5, 10, 1e8};
    const double p_at[] = {1e5, 5e6, 6e7, 2e8}, length = 3.25;
    for (const double p : p_at) {
        TwoLines lines = rows(law.closure(p));
        FaceContacts contacts = contacts_of(lines, law);
        std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
        contacts.update(lines.place, move, 1, 0, 1);
        EXPECT_NEAR(contacts.stiffest() / law.stiffness(p), 1, 1e-9);
        double stored = 0;
        for (const large_displacements::FacePair& pair : contacts.pairs())
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
TEST(face_contacts, an_uneven_closing_is_summed_up_at_five_points)
{
    const joint::BartonBandis law{1e10, k_s, 2e-4, 0.5, 10, 1e8};
    struct Case {
        double p, off; // [Pa], [-]
    };
    for (const auto& [p, off] : {Case{1e6, 1e-5}, Case{5e6, 1e-3}, Case{2e7, 2e-2}}) {
        const double deepest = law.closure(p);
        TwoLines lines({{4, 0}, {-1, 0}}, {{0, -deepest}, {3, 0}});
        FaceContacts contacts = contacts_of(lines, law);
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
TEST(face_contacts, faces_far_behind_do_not_touch)
{
    // Blocks side by side, 1e-3 m into each other, the upper edge of the right one 0.05 m below that of the
    // left one.
    const TwoLines lines({{-1, 1}, {-1, 0}, {0, 0}, {0, 1}, {-1, 1}},
                         {{-0.001, 0.95}, {-0.001, -0.05}, {1, -0.05}, {1, 0.95}, {-0.001, 0.95}});
    FaceContacts contacts = contacts_of(lines);
    const std::vector<Vector2d> still(lines.place.size(), Vector2d::Zero());
    contacts.update(lines.place, still, 1, 0, 1);
    for (const Vector2d& force : forces_of(contacts, lines.place.size()))
        EXPECT_EQ(force.y(), 0);
}

// A block slides over a joint that crosses its plane and continues below it. It has sunk into the plane before, so its lower
// corner is a little below the upper edge of the rock beyond the joint. That is no step that would hold it: nothing but
// friction does, and the block at the start has four corners at one place.
TEST(face_contacts, a_corner_that_has_sunk_in_passes_a_joint_that_crosses)
{
    const double sunk = 1e-5;
    for (const double step : {1e-7, 1e-6, 1e-4}) {
        TwoLines lines({{0, -1}, {0, 0}, {-2, 0}},
                       {{2, 0}, {0, 0}, {0, -1}}); // the rock before the joint, and beyond it
        const TwoLines block({{-1, 1 - sunk}, {-1, -sunk}, {0, -sunk}, {0, 1 - sunk}}, {});
        const auto first = static_cast<Index>(lines.place.size());
        lines.place.insert(lines.place.end(), block.place.begin(), block.place.end());
        for (const auto& [from, to] : block.faces.gridpoint) {
            lines.faces.gridpoint.push_back({first + from, first + to});
            lines.faces.depth.push_back(1);
        }
        FaceContacts contacts = contacts_of(lines);
        std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
        contacts.update(lines.place, move, 1, 0, 1);
        const double pressed = k_n * sunk * 1;
        double slid = 0, most = 0;
        while (slid < 100 * step || slid < 10 * sunk) {
            for (auto g = static_cast<std::size_t>(first); g < lines.place.size(); ++g)
                lines.place[g] += move[g] = {step, 0};
            slid += step;
            contacts.update(lines.place, move, 1, 0, 1);
            Vector2d sum(0, 0);
            const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
            for (auto g = static_cast<std::size_t>(first); g < force.size(); ++g)
                sum += force[g];
            most = std::max(most, -sum.x());
            EXPECT_NEAR(sum.y(), pressed, 1e-3 * pressed) << slid;
        }
        // Beside friction: what the corner bears until it is as far on as it has sunk in.
        EXPECT_LT(most, friction * pressed + 1.01 * k_n * sunk * sunk) << step;
    }
}

// However soft the joint: what sinks deeper than faces are sought (a quarter of the median face, here 0.2 m)
// goes on to press, down to half the depth of a zone, where it is refused.
TEST(face_contacts, what_sinks_deep_goes_on_to_press)
{
    TwoLines lines({{4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, 0}, {1, 0}, {1.8, 0}});
    FaceContacts contacts = contacts_of(lines);
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
TEST(face_contacts, what_has_sunk_deep_slides_on)
{
    const double sunk = 0.3;
    TwoLines lines({{5, 0}, {4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, 0.01}, {0.8, 0.01}});
    FaceContacts contacts = contacts_of(lines);
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

// On the walls of joints of its own material it keeps its law, and finds one again; elsewhere it has that of
// new contacts.
TEST(face_contacts, what_slides_has_the_law_of_a_joint_of_which_both_faces_were_walls)
{
    const std::vector<double> tan_phi{0.1, 0.2, 0.3,
                                      0.4}; // two edges of a joint, another joint, new contacts
    std::vector<joint::Law> laws;
    for (const double one : tan_phi)
        laws.push_back(joint::Coulomb{k_n, k_s, 0, one, 0});
    TwoLines lines({{5, 0}, {4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, 0}, {0.8, 0}});
    lines.faces.law = {2, 1, 3, 1, 0, 0};
    const std::vector<double> expected{0.1, 0.1, 0.4, 0.2, 0.4}; // on the lower faces, from the left
    FaceContacts contacts(laws, {0, 0, 1});
    contacts.set_faces(lines.faces, {{.a = 4, .b = 5, .law = 0, .is_known = true}}, lines.place);
    std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
    const auto go = [&](const Vector2d& way) {
        for (std::size_t g = 6; g < lines.place.size(); ++g)
            lines.place[g] += move[g] = way;
        contacts.update(lines.place, move, 1, 0, 1);
    };
    const double sunk = 1e-3, pressed = k_n * sunk * 0.6;
    go({0, -sunk});
    std::vector<int> seen(expected.size(), 0);
    while (lines.place[7].x() < 4.9) {
        go({0.009, 0});
        const double left = lines.place[6].x(), on = std::floor(left);
        if (lines.place[7].x() > on + 1 || left < 0.25)
            continue; // on two faces, or not slipping yet
        const std::vector<Vector2d> force = forces_of(contacts, lines.place.size());
        const auto face = static_cast<std::size_t>(on);
        EXPECT_NEAR(-(force[6] + force[7]).x(), expected[face] * pressed, 1e-9 * pressed) << left;
        ++seen[face];
    }
    for (const int times : seen)
        EXPECT_GT(times, 5);
}

// A bond is not forgotten however far it stretches; where it tears it is gone.
TEST(face_contacts, bonds_stretch_beyond_the_skin)
{
    TwoLines lines({{2, 0}, {1, 0}, {0, 0}}, {{0, 0}, {1, 0}, {2, 0}});
    FaceContacts contacts({joint::Coulomb{k_n, k_s, 1e9, friction, 0.7 * k_n}});
    std::vector<large_displacements::FacePair> bonded;
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

namespace
{

constexpr double psi = 0.2; // its tangent

// Two rows that are moved by hand, and what becomes of the energy.
struct Dilatant {
    TwoLines lines;
    std::size_t lower; // gridpoints of the lower row
    FaceContacts contacts;
    std::vector<Vector2d> move, force;
    double work = 0, friction = 0, damped = 0; // of the contacts on the rows; lost [J/m]

    Dilatant(const TwoLines& rows, std::size_t lower_row, const joint::Law& law)
        : lines(rows), lower(lower_row), contacts({law}), move(rows.place.size(), Vector2d::Zero())
    {
        contacts.set_faces(lines.faces, {}, lines.place);
        contacts.update(lines.place, move, 1, 0, 1);
        force = forces_of(contacts, move.size());
    }
    template <class Way>
    void step(const Way& way, double viscosity = 0)
    {
        for (std::size_t g = 0; g < move.size(); ++g)
            lines.place[g] += move[g] = g < lower ? Vector2d(0, 0) : Vector2d(way(lines.place[g]));
        take(viscosity);
    }
    void take(double viscosity = 0)
    {
        contacts.update(lines.place, move, 1, viscosity, 1);
        const std::vector<Vector2d> now = forces_of(contacts, move.size());
        for (std::size_t g = 0; g < move.size(); ++g)
            work += (force[g] + now[g]).dot(move[g]) / 2;
        force = now;
        for (const large_displacements::FacePair& pair : contacts.pairs()) {
            friction += pair.friction;
            damped += pair.damped;
        }
    }
    double stored() const
    {
        double sum = 0;
        for (const large_displacements::FacePair& pair : contacts.pairs())
            sum += pair.stored();
        return sum;
    }
    Vector2d on_upper() const
    {
        Vector2d sum(0, 0);
        for (std::size_t g = lower; g < force.size(); ++g)
            sum += force[g];
        return sum;
    }
    // Of all pairs that touch.
    double dilation() const
    {
        double least = 1e9, most = -1e9;
        for (const large_displacements::FacePair& pair : contacts.pairs())
            if (pair.is_closed) {
                least = std::min(least, pair.dilation);
                most = std::max(most, pair.dilation);
            }
        EXPECT_EQ(least, most);
        return most;
    }
};

joint::Coulomb dilatant(double until = 0)
{
    return {k_n, k_s, 0, friction, 0, psi, false, 0, 0, until};
}

} // namespace

// Held at its height it is pressed by k_n tan(psi) slip, and bears friction of that, at once as in many
// steps; dilation ends, also within a step.
TEST(face_contacts, slip_raises_what_dilates)
{
    const double sunk = 1e-4, length = 3.25, slid = 2e-3;
    for (const double until : {0.0, 1e-3})
        for (const int steps : {1, 7, 1000}) {
            Dilatant rows_of(rows(sunk), 5, dilatant(until));
            const double start = rows_of.stored();
            for (int step = 0; step < steps; ++step)
                rows_of.step([&](const Vector2d&) { return Vector2d(slid / steps, 0); });
            const double elastic = friction * k_n * sunk / k_s;
            double slip = (slid - elastic) / (1 + k_n * friction * psi / k_s);
            double dilation = psi * slip;
            if (until > 0) {
                dilation = psi * until;
                slip = slid - friction * k_n * (sunk + dilation) / k_s;
                ASSERT_GT(slip, until);
            }
            const double sigma = k_n * (sunk + dilation);
            EXPECT_NEAR(rows_of.dilation() / dilation, 1, 2e-3) << steps; // the shear of what slides on
            EXPECT_NEAR(rows_of.on_upper().y() / (sigma * length), 1, 2e-3) << steps;
            EXPECT_NEAR(-rows_of.on_upper().x() / (friction * rows_of.on_upper().y()), 1, 1e-3) << steps;
            // Slip loses (tau - p tan(psi)) each, of friction p, while it dilates.
            const double while_it_does = dilation / psi, mean = k_n * (sunk + dilation / 2);
            const double lost = length * (mean * (friction - psi) * while_it_does +
                                          friction * sigma * (slip - while_it_does));
            if (steps == 1000) {
                EXPECT_NEAR(rows_of.friction / lost, 1, 3e-3) << until;
            }
            if (steps > 1) { // what one step takes from sticking to slipping is not its mean
                EXPECT_NEAR(rows_of.work + rows_of.stored() - start + rows_of.friction, 0,
                            steps == 1000 ? 1e-3 * lost : 0.1 * lost)
                    << until;
            }
        }
}

// One that is pressed unevenly, partly open, and tilts on its way.
TEST(face_contacts, all_of_a_joint_is_raised_by_one_amount)
{
    Dilatant tilted({{{4, 0}, {2.7, 0}, {1.9, 0}, {0.4, 0}, {-3, 0}},
                     {{0.25, -1e-3}, {1, -0.7e-3}, {2.2, -0.2e-3}, {3.5, 0.3e-3}}},
                    5, dilatant(0.5));
    const double start = tilted.stored();
    const int steps = 4000;
    // Per way, where it rises by 0.1 of it: k_n (tan(psi) slip - 0.1) presses, and its friction shears the
    // spring.
    const double stiffer = k_n * friction * psi / k_s, dilating = (psi + stiffer * 0.1) / (1 + stiffer);
    for (int step = 0; step < steps; ++step) {
        tilted.step(
            [&](const Vector2d& at) {
                return Vector2d(-1.0 / steps,
                                0.1 / steps + 5e-4 * std::sin(12.0 * step / steps) / steps * at.x());
            },
            1e-2);
        if (step % 100 == 0) {
            const double expected = std::min(dilating * step / steps, 0.5 * psi);
            EXPECT_NEAR(tilted.dilation(), expected, 0.01 * expected + 2e-4) << step;
        }
    }
    // It slid 1 m and rose by half of what it dilated in the first half of that, then by the rest.
    EXPECT_NEAR(tilted.dilation(), 0.5 * psi, 1e-12);
    EXPECT_GT(tilted.friction, 1e6);
    EXPECT_NEAR(tilted.work + tilted.stored() - start + tilted.friction + tilted.damped, 0,
                5e-3 * tilted.friction);
}

// What turns as a whole does not slip, also at the limit of its strength and raised far.
TEST(face_contacts, what_turns_does_not_dilate)
{
    Dilatant far(rows(1e-4), 5, dilatant());
    for (int step = 0; step < 1000; ++step)
        far.step([&](const Vector2d&) { return Vector2d(2e-4, 2e-4 * psi); });
    const double dilation = far.dilation(), shear = far.on_upper().x();
    EXPECT_NEAR(dilation, 0.2 * psi, 0.02 * psi);
    for (int step = 0; step < 1000; ++step) {
        const std::vector<Vector2d> before = far.lines.place;
        far.lines.turn(1e-3);
        for (std::size_t g = 0; g < far.move.size(); ++g)
            far.move[g] = far.lines.place[g] - before[g];
        far.take();
    }
    EXPECT_NEAR(far.dilation(), dilation, 1e-3 * dilation);
    EXPECT_NEAR((Eigen::Rotation2Dd(-1) * far.on_upper()).x() / shear, 1, 0.02);
}

// It goes on from face to face: rising by tan(psi) it bears the same all the way, to the end of dilation.
TEST(face_contacts, dilation_goes_on_to_the_next_face)
{
    const double sunk = 1e-4, until = 1.5;
    Dilatant slider({{{4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}}, {{0.2, -sunk}, {0.8, -sunk}}}, 5,
                    dilatant(until));
    const double elastic = friction * k_n * sunk / k_s;
    slider.step([&](const Vector2d&) { return Vector2d(elastic, 0); });
    double slid = 0;
    while (slid < 3) {
        const double way = std::min(3e-3, slid < until ? until - slid : 1.0);
        slider.step([&](const Vector2d&) { return Vector2d(way, slid < until - 1e-9 ? way * psi : 0.0); });
        slid += way;
        ASSERT_NEAR(slider.on_upper().y() / (k_n * sunk * 0.6), 1, 0.05) << slid;
        ASSERT_NEAR(-slider.on_upper().x() / (friction * k_n * sunk * 0.6), 1, 0.05) << slid;
        ASSERT_NEAR(slider.dilation(), psi * std::min(slid, until), 1e-5) << slid;
    }
}

// Raised by 0.06 m, lifted off and put down tilted where its faces have not touched: all of it touches as far
// up, and no energy comes from nowhere.
TEST(face_contacts, what_lands_beside_is_raised_as_its_joint_is)
{
    Dilatant slider({{{8, 0}, {7, 0}, {6, 0}, {5, 0}, {4, 0}, {3, 0}, {2, 0}, {1, 0}, {0, 0}},
                     {{0.2, -1e-4}, {1.2, -1e-4}, {2.2, -1e-4}}},
                    9, dilatant(0.3));
    for (int step = 0; step < 300; ++step)
        slider.step([&](const Vector2d&) { return Vector2d(1e-3, 1e-3 * psi); });
    for (int step = 0; step < 5; ++step) // to the end of dilation
        slider.step([&](const Vector2d&) { return Vector2d(1e-3, 0); });
    const double dilation = slider.dilation();
    EXPECT_NEAR(dilation, 0.3 * psi, 1e-12);
    const auto go = [&](int steps, const Vector2d& way, double turn) {
        for (int step = 0; step < steps; ++step)
            slider.step([&](const Vector2d& at) { return Vector2d(way.x(), way.y() + turn * at.x()); });
    };
    go(50, {0, 1e-4}, 0);
    EXPECT_EQ(slider.stored(), 0);
    go(200, {1e-2, 0}, 0);
    go(100, {0, 0}, 1e-4);
    slider.friction = slider.work = 0;
    double lowest = 1e9;
    for (int step = 0; step < 3000 && slider.stored() == 0; ++step) {
        go(1, {0, -1e-5}, 0);
        lowest = std::min(lowest, slider.lines.place[9].y());
    }
    EXPECT_NEAR(lowest, dilation, 2e-5); // the end that is lower touches there
    go(100, {0, -1e-5}, 0);
    EXPECT_NEAR(slider.dilation(), dilation, 1e-12);
    EXPECT_GT(slider.stored(), 10);
    EXPECT_NEAR(slider.work + slider.stored() + slider.friction, 0, 0.02 * slider.stored());
}

// Between walls that do not move, a joint of one Kelvin unit relaxes by the closed form, along the normal and in shear, whatever
// the step. When its upper wall slides on, so that its faces come to touch other ones, what has crept goes with it: the pressure
// stays, and creep goes on as if nothing had slid. What touches first has not crept.
TEST(face_contacts, creep_goes_with_a_contact_that_slides_on)
{
    const double E = 1e9, tau = 100, sunk = 1e-4, T = 30;
    const auto left = [&](double t) { // of the traction
        return (1 + k_n / E * std::exp(-(1 + k_n / E) * t / tau)) / (1 + k_n / E);
    };
    const Chain normal{k_n, {{E, E * tau}}}, shear{k_s, {}};
    for (const int steps : {1, 3}) {
        TwoLines lines({{4, 0}, {2.7, 0}, {1.9, 0}, {0.4, 0}, {-1, 0}},
                       {{0.25, 0}, {1, 0}, {2.2, 0}, {3.5, 0}});
        FaceContacts contacts({joint::Coulomb{k_n, k_s, 0, friction, 0}});
        contacts.creep_by({{normal, shear}});
        contacts.set_faces(lines.faces, {}, lines.place);
        std::vector<Vector2d> move(lines.place.size(), Vector2d::Zero());
        const auto go = [&](const Vector2d& way) {
            for (std::size_t g = 5; g < lines.place.size(); ++g)
                lines.place[g] += move[g] = way;
            contacts.update(lines.place, move, 1, 0, 1);
        };
        const auto pressure = [&] { // of all the upper row, 3.25 m long
            double sum = 0;
            for (std::size_t g = 5; g < lines.place.size(); ++g)
                sum += forces_of(contacts, lines.place.size())[g].y();
            return sum / 3.25;
        };
        const auto creep = [&](double duration) {
            for (int i = 0; i < steps; ++i) {
                contacts.begin_creep(CreepScheme::fitted, duration / steps);
                for (const double share : {0.3, 1.0}) {
                    contacts.creep_to(share);
                    go({0, 0});
                }
                contacts.end_creep();
                go({0, 0});
            }
        };
        go({0, 0});
        go({0, -sunk});
        contacts.count_creep_from_here();
        go({0, -sunk}); // creep counts from the pressure before
        const double own = k_n * sunk;
        EXPECT_NEAR(pressure(), 2 * own, 1e-9 * own);
        creep(T);
        EXPECT_NEAR(pressure(), own * (1 + left(T)), 1e-6 * own) << steps;
        for (int i = 0; i < 40; ++i)
            go({-0.01, 0}); // on to the next faces
        EXPECT_NEAR(pressure(), own * (1 + left(T)), 1e-6 * own) << steps;
        creep(T);
        EXPECT_NEAR(pressure(), own * (1 + left(2 * T)), 1e-6 * own) << steps;
        for (const double away : {1.0, -1.0}) // lost, and met anew
            for (int i = 0; i < 100; ++i)
                go({0, 0.05 * away});
        go({0, 0}); // it was closed for a part of the last step only
        EXPECT_NEAR(pressure(), 2 * own, 1e-6 * own) << steps;
    }
}

} // namespace face_contacts_test
