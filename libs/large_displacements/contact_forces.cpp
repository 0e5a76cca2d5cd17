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
constexpr double deepest_new =
    0.1; // the same where two faces come to touch; farther in, one lies behind the other, or has slid on

double depth_of(const FacePair& pair, const Faces& faces)
{
    return std::min(faces.depth[pair.a], faces.depth[pair.b]);
}

// Gaps at the ends of an overlap a step before [m], and how far the faces have slid since [m].
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

// Whether faces are too far in each other to have come to touch in this step.
bool is_deep(const FacePair& pair, const Overlap& found, const Faces& faces,
             const std::vector<Vector2d>& move)
{
    const auto before = gaps_before(pair, found, faces, move).gap;
    return std::min(found.sunk(), -std::min(before[0], before[1])) > deepest_new * depth_of(pair, faces);
}

// The part of an overlap that is closed.
struct ClosedPart {
    std::array<double, 2> closing;       // at its ends [m]
    std::array<double, 2> ends = {0, 1}; // as fractions of the overlap

    // Without bonds only what is pressed together.
    void leave_bonds()
    {
        const double zero = closing[0] / (closing[0] - closing[1]);
        if (closing[0] < 0)
            ends[0] = zero;
        else if (closing[1] < 0)
            ends[1] = zero;
        closing = {std::max(closing[0], 0.0), std::max(closing[1], 0.0)};
    }
};

// The force-displacement law of a contact in one step: forces, and what becomes of energy. Between two moments
// a force works as the mean of both: the constructor takes the first one's half. What dilation opens, neither
// springs nor dashpots do, and friction pays for it.
class ContactForce
{
public:
    ContactForce(FacePair& pair, const joint::Law& law, const Faces& faces, const Step& step)
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

    // No force any more. Where rock slides off an edge, what the normal springs have stored is lost, too.
    void open() { open(0); }
    void slide_off() { open(last_.pressed_in); }

    // The forces where faces overlap, with the closing at both ends of the overlap [m].
    void press(const Overlap& found, const std::array<double, 2>& closing)
    {
        ClosedPart part{closing};
        double in_bonds = 0; // what springs hold that is lost with the bonds, if they break now [J/m]
        if (!pair_.is_broken &&
            -joint::k_n(law_) * std::min(closing[0], closing[1]) > joint::tensile_strength(law_))
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
        const Shear shear = shear_of(at(found.gap, (part.ends[0] + part.ends[1]) / 2));
        const bool was_broken = pair_.is_broken;
        const bool weakens =
            !was_broken && joint::weakens_by_slip(law_) && std::abs(shear.trial) > closed.strength[0];
        if (weakens)
            in_bonds = break_bonds(part.closing, found.length);
        find_normal_force(closed, part.closing, was_broken);
        const double sheared = find_shear_force(shear, closed.strength[pair_.is_broken ? 1 : 0]);
        pair_.friction -= work_of_dilation_ + work_of_dilation();
        if (weakens)
            part.leave_bonds();
        pair_.pressed_in = weakens ? along_overlap(law_, pair_.state(), part.closing,
                                                   (part.ends[1] - part.ends[0]) * found.length)
                                         .stored
                                   : closed.stored;
        if (in_bonds > 0)
            pair_.friction += in_bonds - pair_.pressed_in;
        pair_.sheared_in = stored_in_shear(sheared);
    }

private:
    struct Last { // a step before, as in FacePair
        Vector2d normal;
        double length, tau, pressed_in, sheared_in;
        bool was_closed;
    };
    struct Shear {
        double slid;        // [m]
        double last;        // force a step before [N/m]
        double kept, trial; // force on what is still closed: before the slip, and if it is elastic [N/m]
    };

    // How far the two faces have moved apart in this step at an end of the closed part.
    Vector2d parted_at(int i) const { return at(move_b_, pair_.on_b[i]) - at(move_a_, pair_.on_a[i]); }

    double work_of_dilation() const // half of that of the present force [J/m]
    {
        return pair_.is_closed && pair_.raised > 0
                   ? -(pair_.force[0] + pair_.force[1]).dot(pair_.normal) * pair_.raised / 2
                   : 0.0;
    }

    double stored_in_shear(double force) const // [J/m]
    {
        const double k_s = joint::k_s(law_);
        return k_s > 0 && pair_.length > 0 ? force * force / (2 * k_s * pair_.length) : 0.0;
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

    void close(const Overlap& found, const ClosedPart& part)
    {
        pair_.is_closed = true;
        pair_.length = (part.ends[1] - part.ends[0]) * found.length;
        pair_.normal = found.normal();
        for (int i = 0; i < 2; ++i) {
            pair_.on_a[i] = at(found.on_a, part.ends[i]);
            pair_.on_b[i] = at(found.on_b, part.ends[i]);
        }
    }

    // `gap`: in the middle of the closed part [m].
    Shear shear_of(double gap) const
    {
        // Two points a gap apart that turn together move along each other, too; that is no slip.
        const Vector2d tangent = along(pair_.normal);
        const double turned =
            pair_.is_new || last_.length == 0 ? 0.0 : gap * (pair_.normal - last_.normal).dot(tangent);
        const double slid = (parted_at(0) + parted_at(1)).dot(tangent) / 2 - turned;
        // A part that opens takes along the shear that it has; one that closes has none yet.
        const double last = pair_.is_new ? 0.0 : last_.tau * last_.length;
        const double kept = last_.tau * (pair_.is_new ? pair_.length : std::min(last_.length, pair_.length));
        return {slid, last, kept, kept + joint::k_s(law_) * slid * pair_.length};
    }

    // In the step in which it closes, and in the one before it opens, a contact is closed for a part of the
    // time that its force acts. `deep`: its closing, `opened`: by how much it opened in this step [m].
    double part_of_time(double deep, double opened) const
    {
        if (!last_.was_closed && deep < -opened)
            return (1 - deep / opened) / 2;
        if (last_.was_closed && opened > 0) {
            const double next = opened + (opened - pair_.opened) * deep / (deep + opened); // as forces do
            if (next > deep)
                return (opened + deep) / (opened + next);
        }
        return 1;
    }

    // Forces on the ends that are as the traction between them.
    void find_normal_force(const joint::AlongOverlap& closed, const std::array<double, 2>& closing,
                           bool was_broken)
    {
        const std::array<double, 2> opening{parted_at(0).dot(pair_.normal), parted_at(1).dot(pair_.normal)};
        const double deep = (closing[0] + closing[1]) / 2,
                     opened = (opening[0] + opening[1]) / 2 - pair_.raised;
        const double acts = was_broken ? part_of_time(deep, opened) : 1.0;
        pair_.opened = opened;
        for (int i = 0; i < 2; ++i) {
            const double pressed = acts * closed.force_on_ends[i];
            double held = dashpots_ * closed.stiffness * pair_.length / 2 * (opening[i] - pair_.raised);
            if (was_broken)
                held = std::min(held, pressed);
            pair_.force[i] = (held - pressed) * pair_.normal;
            pair_.held[i] = held * pair_.normal;
        }
        pair_.sigma = pair_.length > 0 ? -closed.force / pair_.length : 0.0;
        pair_.stiffest = closed.stiffest;
    }

    // Within its limit [N/m]; what the joint remembers changes with it.
    double within_strength(const Shear& shear, double limit)
    {
        if (!joint::remembers(law_) || !(pair_.length > 0))
            return std::clamp(shear.trial, -limit, limit);
        joint::State state = pair_.state();
        const double tau =
            joint::shear(law_, state, shear.kept / pair_.length, shear.slid, limit / pair_.length);
        pair_.memory = state.memory;
        const double force = tau * pair_.length;
        return std::abs(force - shear.trial) <= 1e-12 * limit ? shear.trial : force; // but for rounding
    }

    // Adds it to the forces on the ends; returns it, without that of dashpots [N/m].
    double find_shear_force(const Shear& shear, double limit)
    {
        const double k_s = joint::k_s(law_), force = within_strength(shear, limit);
        pair_.is_slipping = force != shear.trial;
        if (!pair_.is_new)
            pair_.friction =
                last_.sheared_in - stored_in_shear(shear.kept) + (shear.last - shear.kept) / 2 * shear.slid;
        if (pair_.is_slipping && k_s > 0 && pair_.length > 0)
            pair_.friction += (shear.kept + force) / 2 * (shear.trial - force) / (k_s * pair_.length);
        pair_.is_new = false;
        pair_.tau = pair_.length > 0 ? force / pair_.length : 0.0;
        double held = 0;
        if (!pair_.is_slipping)
            held = std::clamp(force + dashpots_ * k_s * pair_.length * shear.slid, -limit, limit) - force;
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
    double work_of_dilation_; // as of the force a step before [J/m]
};

} // namespace

FaceContacts::Touch FaceContacts::find_force(FacePair& pair, const Step& step, bool may_close) const
{
    ContactForce force(pair, laws_[pair.law], faces_, step);
    const auto found = overlap_of(pair, faces_, shapes_, step.place);
    if (!found) {
        force.slide_off();
        return Touch::settled;
    }
    std::array<double, 2> closing{};
    for (int i = 0; i < 2; ++i)
        closing[i] = at(pair.lead, found->on_a[i]) - found->gap[i];
    const bool is_too_deep = found->sunk() > deepest * depth_of(pair, faces_), is_bonded = pair.is_bonded();
    // One that is not known yet may have a lead to inherit.
    const double most = std::max(closing[0], closing[1]) + (pair.is_known ? 0.0 : most_lead_);
    if (!pair.is_closed && !is_bonded &&
        (most <= 0 || (is_too_deep && is_deep(pair, *found, faces_, step.move)))) {
        force.open();
        return Touch::settled;
    }
    if (is_too_deep)
        return Touch::too_deep;
    if (!pair.is_closed && !is_bonded && !may_close)
        return Touch::comes_about;
    force.press(*found, closing);
    return Touch::settled;
}

// Takes what an open pair that comes to touch inherits; false if it stays open, as other faces touch there.
bool FaceContacts::comes_to_touch(FacePair& pair, const Overlap& found, const Step& step) const
{
    const auto sunk_of = [&](const FacePair& other) {
        const auto overlap = overlap_of(other, faces_, shapes_, step.place);
        return overlap ? overlap->sunk() : 0.0;
    };
    const FacePair* const before = contact_before(pair, found.normal(), step.place);
    if (is_deep(pair, found, faces_, step.move) &&
        (before == nullptr || found.sunk() > sunk_of(*before) + deepest_new * depth_of(pair, faces_)))
        return false; // another face behind
    if (before == nullptr && (found.is_behind() || (!pair.is_known && -found.sunk() >= pair.lead[0])))
        return false;
    if (before != nullptr && !pair.is_known) {
        // What slides on takes along what its joint remembers. A pair's sides may change places: a's first
        // end looks at b's second one, and `along` turns round with the normal twice over, so that the shear
        // traction keeps its sign. What was nearer than it is raised before it slid on to there, is raised no
        // farther than that.
        const double unraised = (before->lead[0] + before->lead[1]) / 2 - before->dilation;
        const Gaps last = gaps_before(pair, found, faces_, step.move);
        const double room =
            last.slid < found.length ? std::min(last.gap[0], last.gap[1]) - unraised : before->dilation;
        pair.dilation = std::max(pair.dilation, std::clamp(room, 0.0, before->dilation));
        pair.law = law_slid_on_to(pair, *before);
        pair.tau = before->tau;
        pair.memory = before->memory;
        pair.lead = {unraised + pair.dilation, unraised + pair.dilation};
    }
    pair.is_known = true;
    return true;
}

} // namespace jointcreep::large_displacements
