#include "joint/moving_contact.hpp"
#include "large_displacements/face_contacts.hpp"
#include "large_displacements/face_overlap.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

constexpr double deepest = 0.5; // overlap over the depth of the thinner zone, at most
// The same where two faces come to touch; farther in, one lies behind the other, or has slid on.
constexpr double deepest_new = 0.1;
// Overlap over the length of the shorter face, at most, of faces of which one just slides on to the other.
constexpr double touching = 0.01;

double depth_of(const FacePair& pair, const Faces& faces)
{
    return std::min(faces.depth[pair.a], faces.depth[pair.b]);
}

// Gaps at the ends of an overlap one step ago [m], and the slide of the faces since then [m].
struct Gaps {
    std::array<double, 2> gap;
    double slid;
};

Gaps gaps_before(const FacePair& pair, const Overlap& found, const Faces& faces,
                 const std::vector<Vector2d>& move)
{
    const auto move_a = ends_of(faces.gridpoint[pair.a], move),
               move_b = ends_of(faces.gridpoint[pair.b], move);
    Gaps before{found.gap, 0};
    for (int i = 0; i < 2; ++i) {
        const Vector2d parted = at(move_b, found.on_b[i]) - at(move_a, found.on_a[i]);
        before.gap[i] -= parted.dot(found.normal());
        before.slid = std::max(before.slid, std::abs(parted.dot(found.tangent)));
    }
    return before;
}

// Whether the overlap is too deep for faces that touch first in this step.
bool is_deep(const FacePair& pair, const Overlap& found, const Faces& faces,
             const std::vector<Vector2d>& move)
{
    const auto before = gaps_before(pair, found, faces, move).gap;
    return std::min(found.sunk(), -std::min(before[0], before[1])) > deepest_new * depth_of(pair, faces);
}

// A contact in one step: the closed part of its faces and its motion, the forces of its joint
// (joint/moving_contact.hpp), and its energies. Between two moments, a force does work as the mean of both; the
// constructor adds the half of the first moment. Opening by dilation does not count for springs and dashpots; its work
// is subtracted from friction.
class ContactForce
{
public:
    ContactForce(FacePair& pair, const joint::Law& law, const Faces& faces, const TimeStep& step)
        : pair_(pair), law_(law), move_a_(ends_of(faces.gridpoint[pair.a], step.move)),
          move_b_(ends_of(faces.gridpoint[pair.b], step.move)),
          dashpots_(step.viscosity / step.dt), last_{pair.normal,     pair.length,     pair.tau,
                                                     pair.pressed_in, pair.sheared_in, pair.is_closed}
    {
        pair.is_slipping = false;
        pair.friction = pair.damped = 0;
        for (int i = 0; i < 2; ++i)
            pair.damped += pair.held[i].dot(parted_at(i) - pair.raised * pair.normal) / 2;
        work_of_dilation_ = work_of_dilation();
        pair.held = {Vector2d::Zero(), Vector2d::Zero()};
        pair.pressed_in = pair.sheared_in = 0;
    }

    // Sets the forces to 0. If rock slides off an edge, the energy of the normal springs is lost, too.
    void open() { open(0); }
    void slide_off() { open(last_.pressed_in); }

    // The forces where faces overlap, with the closing at both ends of the overlap [m].
    void press(const Overlap& found, const std::array<double, 2>& closing)
    {
        joint::ClosedPart part{closing};
        double in_bonds = 0; // energy of the springs lost with the bonds, if they break now [J/m]
        if (!pair_.is_broken && joint::breaks(law_, closing))
            in_bonds = break_bonds(closing, found.length);
        if (pair_.is_broken) {
            if (std::max(closing[0], closing[1]) <= 0) {
                open(in_bonds);
                return;
            }
            part.leave_bonds();
        }
        close(found, part);
        const joint::AlongOverlap closed = along_overlap(law_, pair_.state(), part.closing, pair_.length);
        const joint::ShearMove shear = shear_move(at(found.gap, (part.ends[0] + part.ends[1]) / 2));
        const bool was_broken = pair_.is_broken;
        const bool weakens = joint::breaks_by_slip(law_, was_broken, shear.trial, closed.strength[0]);
        if (weakens)
            in_bonds = break_bonds(part.closing, found.length);
        find_normal_force(closed, part, was_broken);
        const double sheared = find_shear_force(shear, closed.strength[pair_.is_broken ? 1 : 0]);
        pair_.friction -= work_of_dilation_ + work_of_dilation() + work_of_creep();
        if (weakens)
            part.leave_bonds();
        pair_.pressed_in = weakens ? along_overlap(law_, pair_.state(), part.closing,
                                                   (part.ends[1] - part.ends[0]) * found.length)
                                         .stored
                                   : closed.stored;
        if (in_bonds > 0)
            pair_.friction += in_bonds - pair_.pressed_in;
        pair_.sheared_in = joint::stored_in_shear(law_, sheared, pair_.length);
    }

private:
    struct Last { // a step before, as in FacePair
        Vector2d normal;
        double length, tau, pressed_in, sheared_in;
        bool was_closed;
    };

    // Relative displacement of the two faces in this step, at an end of the closed part.
    Vector2d parted_at(int i) const { return at(move_b_, pair_.on_b[i]) - at(move_a_, pair_.on_a[i]); }

    double work_of_dilation() const // by half the present force [J/m]
    {
        return pair_.is_closed && pair_.raised > 0
                   ? -(pair_.force[0] + pair_.force[1]).dot(pair_.normal) * pair_.raised / 2
                   : 0.0;
    }

    // What the springs gain by creep in this step; it is mostly below 0 [J/m].
    double work_of_creep() const
    {
        double work = pair_.tau * pair_.length * pair_.creeps[2];
        for (int i = 0; i < 2; ++i)
            work += (pair_.held[i] - pair_.force[i]).dot(pair_.normal) *
                    at(std::array{pair_.creeps[0], pair_.creeps[1]}, pair_.on_a[i]);
        return work;
    }

    void open(double lost)
    {
        pair_.friction = last_.sheared_in - work_of_dilation_;
        pair_.is_closed = false;
        if (pair_.is_known)
            pair_.is_broken = true;
        pair_.tau = pair_.length = pair_.sigma = 0;
        pair_.friction += lost;
    }

    double break_bonds(const std::array<double, 2>& closing, double length)
    {
        pair_.is_broken = true;
        return along_overlap(law_, pair_.state(), closing, length).stored;
    }

    void close(const Overlap& found, const joint::ClosedPart& part)
    {
        pair_.is_closed = true;
        pair_.length = (part.ends[1] - part.ends[0]) * found.length;
        pair_.normal = found.normal();
        for (int i = 0; i < 2; ++i) {
            pair_.on_a[i] = at(found.on_a, part.ends[i]);
            pair_.on_b[i] = at(found.on_b, part.ends[i]);
        }
        pair_.closing = part.closing;
    }

    // `gap`: in the middle of the closed part [m].
    joint::ShearMove shear_move(double gap) const
    {
        // Two points with a gap between them move along each other if both faces rotate together; that is no slip.
        const Vector2d tangent = along(pair_.normal);
        const double turned =
            pair_.is_new || last_.length == 0 ? 0.0 : gap * (pair_.normal - last_.normal).dot(tangent);
        const double slid = (parted_at(0) + parted_at(1)).dot(tangent) / 2 - turned + pair_.creeps[2];
        return pair_.is_new ? joint::first_shear_move(law_, last_.tau, pair_.length, slid)
                            : joint::shear_move(law_, last_.tau, last_.length, pair_.length, slid);
    }

    // Forces on the ends, by the traction between them.
    void find_normal_force(const joint::AlongOverlap& closed, const joint::ClosedPart& part, bool was_broken)
    {
        const joint::NormalMove move{{parted_at(0).dot(pair_.normal), parted_at(1).dot(pair_.normal)},
                                     pair_.raised,
                                     pair_.opened,
                                     last_.was_closed};
        const joint::NormalForce force =
            joint::normal_force(closed, part, pair_.length, move, dashpots_, !was_broken);
        pair_.opened = move.opened();
        for (int i = 0; i < 2; ++i) {
            pair_.force[i] = (force.held[i] - force.pressed[i]) * pair_.normal;
            pair_.held[i] = force.held[i] * pair_.normal;
        }
        pair_.sigma = pair_.length > 0 ? -closed.force / pair_.length : 0.0;
        pair_.stiffest = closed.stiffest;
    }

    // Adds the shear force to the forces on the ends; returns it without the dashpots [N/m].
    double find_shear_force(const joint::ShearMove& move, double limit)
    {
        joint::State state = pair_.state();
        const double force = joint::shear_force(law_, state, move, limit),
                     held = joint::shear_held(law_, move, force, limit, dashpots_);
        pair_.memory = state.memory;
        pair_.is_slipping = force != move.trial;
        if (!pair_.is_new)
            pair_.friction = joint::taken_by_opening(law_, move, last_.sheared_in);
        pair_.friction += joint::taken_by_slip(law_, move, force);
        pair_.is_new = false;
        pair_.tau = pair_.length > 0 ? force / pair_.length : 0.0;
        const Vector2d tangent = along(pair_.normal);
        for (int i = 0; i < 2; ++i) {
            pair_.force[i] += (force + held) / 2 * tangent;
            pair_.held[i] += held / 2 * tangent;
            pair_.damped += pair_.held[i].dot(parted_at(i) - pair_.raised * pair_.normal) / 2;
        }
        return force;
    }

    FacePair& pair_;
    const joint::Law& law_;
    std::array<Vector2d, 2> move_a_, move_b_; // of the ends of the faces in this step [m]
    double dashpots_;                         // over springs, by displacements in this step [-]
    Last last_;
    double work_of_dilation_; // by half the force a step before [J/m]
};

} // namespace

FaceContacts::Touch FaceContacts::find_force(FacePair& pair, const TimeStep& step, Decision decision) const
{
    const auto found = overlap_of(pair, faces_, shapes_, step.place);
    const bool is_bonded = pair.is_bonded();
    if (found && found->is_behind() && pair.is_closed && !is_bonded && decision == Decision::none)
        return Touch::may_end;
    ContactForce force(pair, laws_[pair.law], faces_, step);
    if (!found || decision == Decision::ends) {
        force.slide_off();
        return Touch::settled;
    }
    std::array<double, 2> closing{};
    for (int i = 0; i < 2; ++i)
        closing[i] = at(pair.lead, found->on_a[i]) - found->gap[i];
    const bool is_too_deep = found->sunk() > deepest * depth_of(pair, faces_);
    // A pair that has not touched yet may inherit a lead.
    const double most = std::max(closing[0], closing[1]) + (pair.is_known ? 0.0 : most_lead_);
    if (!pair.is_closed && !is_bonded &&
        (most <= 0 || (is_too_deep && is_deep(pair, *found, faces_, step.move)))) {
        force.open();
        return Touch::settled;
    }
    if (is_too_deep)
        return Touch::too_deep;
    if (!pair.is_closed && !is_bonded && decision == Decision::none)
        return Touch::comes_about;
    force.press(*found, closing);
    return Touch::settled;
}

// Whether an overlap is of faces behind others that touch. If it continues the contact `before`, it is about as deep:
// deeper by the length of the overlap at most.
bool FaceContacts::lies_behind(const Overlap& found, const FacePair* before, const TimeStep& step) const
{
    if (!found.is_behind() || before == nullptr)
        return found.is_behind();
    const auto other = overlap_of(*before, faces_, shapes_, step.place);
    return found.least_sunk > (other ? other->sunk() : 0.0) + found.whole;
}

// Sets the inherited state of an open pair that comes to touch. Returns false if it stays open, because other faces
// touch there.
bool FaceContacts::comes_to_touch(FacePair& pair, const Overlap& found, const TimeStep& step) const
{
    const auto sunk_of = [&](const FacePair& other) {
        const auto overlap = overlap_of(other, faces_, shapes_, step.place);
        return overlap ? overlap->sunk() : 0.0;
    };
    const FacePair* const before = contact_before(pair, found.normal(), step.place);
    if (is_deep(pair, found, faces_, step.move) &&
        (before == nullptr || found.sunk() > sunk_of(*before) + deepest_new * depth_of(pair, faces_)))
        return false; // another face behind
    if (lies_behind(found, before, step) ||
        (before == nullptr && !pair.is_known && -found.sunk() >= pair.lead[0]))
        return false;
    if (before != nullptr && !pair.is_known) {
        // A face that slides on to the next one keeps the memory of its joint. The sides of the pair may change places:
        // the first end of a is then at the second end of b. `along` reverses twice with the normal, so the shear
        // traction keeps its sign. The inherited dilation is at most the gap one step ago, less the lead without
        // dilation. So is the lead, if the faces have faced each other over some length without a force, as beside a
        // corner that is pressed in: no force appears at once.
        const double unraised = (before->lead[0] + before->lead[1]) / 2 - before->dilation;
        const Gaps last = gaps_before(pair, found, faces_, step.move);
        const double gap = std::min(last.gap[0], last.gap[1]), faced = found.length - last.slid;
        const double shorter = std::min(shapes_[pair.a].length, shapes_[pair.b].length);
        pair.dilation = std::max(
            pair.dilation, std::clamp(faced > 0 ? gap - unraised : before->dilation, 0.0, before->dilation));
        pair.law = law_slid_on_to(pair, *before);
        pair.tau = before->tau;
        pair.memory = before->memory;
        pair.creep = creep_slid_on_to(pair, *before);
        const double lead =
            (faced > touching * shorter ? std::min(unraised, std::max(0.0, gap)) : unraised) + pair.dilation;
        pair.lead = {lead, lead};
    }
    pair.is_known = true;
    return true;
}

} // namespace jointcreep::large_displacements
