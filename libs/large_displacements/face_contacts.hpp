// Contacts between faces of rock that move: what touches what is found anew as blocks slide, turn and fall.
//
// A face is one side of a zone with no rock before it. A contact is a pair of faces that look at each other:
// on the length that they overlap, the joint closes linearly, and its springs (stiffness per area) are
// integrated over the part that is closed: linear ones exactly, those of Barton and Bandis's law at five
// points. So gridpoints of the two faces need not match: a uniform traction stays uniform however far they
// have slid. A corner that presses into a face is the same with a short closed part.
//
// The plane of a contact is that of the face into which a corner of the other one sinks. Within a hundredth
// of the shorter face about two ends that meet, it turns smoothly from one face to the other (corner to
// corner).
//
// Closing is counted from the closing of the in-situ joint, `lead`, which stays with a pair of faces, and
// goes on to the next face when one slides along. The shear traction is kept as a stress along the contact
// and so turns with it.
//
// What slides keeps to the law of its joint as long as both faces were walls of joints of one material.
// Beyond, the contact is one that comes about, as between any two faces that were not: which of the two
// slides is the same to it, and of two walls that never lay on each other neither one's filling and bonds say
// anything.
//
// Slip raises a joint that dilates, by adding to the closing: by one amount all along the joint, which is all
// pairs between the same two straight sides of outlines, as its walls are rigid beside its springs. This
// amount is such that it takes the work that the slip of each pair would give it by itself: the mean of
// tan(psi) |slip|, weighted by pressure. It is found at once with the slip, as in joint/coulomb.hpp.

#pragma once

#include "mechanics/assembly.hpp"

#include <array>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

using mechanics::Vector2d;

// Faces run with their rock on the left. Faces that follow each other share a gridpoint.
struct Faces {
    std::vector<std::array<Index, 2>> gridpoint;
    std::vector<double> depth;      // of the zone behind it [m]
    std::vector<std::size_t> law{}; // of the joint whose wall it was; that of new contacts where of none
};

// What two faces that may touch remember.
struct FacePair {
    Index a, b; // faces, a < b
    std::size_t law = 0;
    std::array<double, 2> lead{0, 0}; // closing without a gap, at the first and the second end of a [m]
    double dilation = 0;              // in the lead [m]
    double tau = 0;                   // along(normal from a to b), on a [Pa]
    bool is_known = false;            // has touched since the two came near
    bool is_new = true;               // has not carried a force yet
    bool is_closed = false;           // over some of its length
    bool is_broken = true;            // has no cohesion and no tensile strength (any more)
    std::array<double, 3> memory{};   // of the law, as in joint::State
    bool is_slipping = false;

    // Now, if closed: the ends of the closed part, as fractions of a and of b, the force on a there, and the
    // mean normal traction.
    std::array<double, 2> on_a{}, on_b{};
    std::array<Vector2d, 2> force{};
    Vector2d normal{0, 0};                 // from a to b
    double raised = 0;                     // of the dilation, in the last step [m]
    double opened = 0;                     // in the last step, dilation aside [m]
    double length = 0, sigma = 0;          // [m], [Pa]
    double stiffest = 0;                   // of its normal springs [Pa/m]
    std::array<Vector2d, 2> held{};        // of the force, what dashpots add [N/m]
    double pressed_in = 0, sheared_in = 0; // what the springs hold [J/m]
    double friction = 0, damped = 0;       // in the last step [J/m]

    void raise(double by)
    {
        dilation += by;
        for (double& end : lead)
            end += by;
    }
    bool is_bonded() const { return is_known && !is_broken; }
    joint::State state() const
    {
        return {.slip = 0, .dilation = dilation, .is_broken = is_broken, .memory = memory};
    }
    double stored() const { return pressed_in + sheared_in; }
};

// A face as it is now.
struct FaceShape {
    Vector2d along;                    // unit, from its first end to its second
    double length;                     // [m]
    std::array<double, 2> sharp{1, 1}; // of its ends: 0 where the outline runs on straight, 1 a corner
};

// A step of time, at whose end forces are found.
struct Step {
    const std::vector<Vector2d>& place; // of gridpoints, at its end [m]
    const std::vector<Vector2d>& move;  // their displacements in it [m]
    double dt;                          // [s]
    double viscosity;                   // of dashpots over their springs [s]
};

struct Overlap; // of two faces: face_overlap.hpp

// Of pairs [J/m].
struct PairEnergy {
    double stored = 0;               // now
    double friction = 0, damped = 0; // in the last step

    void operator+=(const PairEnergy& other)
    {
        stored += other.stored;
        friction += other.friction;
        damped += other.damped;
    }
};

class FaceContacts
{
public:
    // `laws`: those of the pairs; new contacts have the last one. `material`: numbers of what the joints of
    // the others are made of. Places are counted from `origin` [m].
    explicit FaceContacts(std::vector<joint::Law> laws, std::vector<Index> material = {},
                          const Vector2d& origin = Vector2d::Zero());

    // Takes these faces instead; pairs of before are forgotten but for `known`, in any order. Faces without
    // laws are walls of no joint.
    void set_faces(Faces faces, std::vector<FacePair> known, const std::vector<Vector2d>& place);

    // Tractions and forces of all pairs after gridpoints have moved by `move` to `place` [m] within `dt` [s]:
    // springs, and dashpots of `viscosity` times the springs [s]. Throws equilibrium_error where two faces
    // overlap too much for this to have a meaning.
    void update(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move, double dt,
                double viscosity, int threads);

    // Adds the forces of the last update to those on gridpoints [N/m].
    void add_forces(std::vector<Vector2d>& force, int threads) const;

    // Of all pairs, at the last update.
    const PairEnergy& energy() const { return energy_; }

    // What set_faces(), with what is known of before, and update() need.
    void transfer(const Transfer& to, DynamicsState& kept);

    const Faces& faces() const { return faces_; }
    const std::vector<FacePair>& pairs() const { return pairs_; }
    const std::vector<joint::Law>& laws() const { return laws_; }
    // Of any spring: while nothing closes, and in the last update [Pa/m].
    double stiffest() const { return stiffest_; }
    bool stiffens() const { return stiffens_; }
    // How often what may touch was sought.
    Index searches() const { return searches_; }

private:
    struct Sum;
    // What a pair does in a step: no more, overlaps too much for its force to have a meaning, or comes to touch.
    enum class Touch { settled, too_deep, comes_about };

    // Which faces may touch: contact_detection.cpp.
    void find_corners(const std::vector<Vector2d>& place);
    void seek(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move);
    std::vector<std::pair<Index, Index>> find_reach(const std::vector<Vector2d>& place);
    void take_pairs(const std::vector<std::pair<Index, Index>>& near);
    void find_joints(const std::vector<Vector2d>& place);
    void find_active();
    double way_to_touch(const FacePair& pair, double most_lead) const;
    void find_touched();
    const FacePair* contact_before(const FacePair& pair, const Vector2d& normal,
                                   const std::vector<Vector2d>& place) const;
    std::size_t law_slid_on_to(const FacePair& pair, const FacePair& before) const;

    // Dilation of joints: joint_dilation.cpp.
    void dilate(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move);

    // The force of a pair: contact_forces.cpp.
    Touch find_force(FacePair& pair, const Step& step, bool may_close) const;
    bool comes_to_touch(FacePair& pair, const Overlap& found, const Step& step) const;

    // Of all pairs.
    void find_shapes(const std::vector<Vector2d>& place, int threads);
    double farthest_since_search(const std::vector<Vector2d>& place, int threads) const;
    Sum find_forces(const Step& step, int threads);
    void find_forces_of_new(const Step& step, Sum& sum);
    void take_forces(Index active);

    std::vector<joint::Law> laws_;
    std::vector<Index> material_; // of laws; -1 of new contacts
    Vector2d origin_;
    bool stiffens_ = false;                   // as it closes, by any law
    bool dilates_ = false;                    // by any law
    double stiffest_open_ = 0, stiffest_ = 0; // [Pa/m]
    Faces faces_;
    std::vector<FaceShape> shapes_;
    std::vector<FacePair> pairs_;             // in order of {a, b}
    std::vector<std::vector<Index>> of_face_; // pairs of each face
    std::vector<Index> side_;                 // of each face: the lowest one of its straight side
    std::vector<std::vector<Index>> joints_;  // pairs between the same two sides, if any law dilates
    std::vector<Index> active_;               // pairs that may carry a load before the next search
    std::vector<double> way_to_;              // how far gridpoints go before they can [m]
    std::vector<char> closes_;                // pairs that may in this update
    // Of active pairs the gridpoints, and what is added to each of them [N/m]: by each corner of each pair
    // its shares of the two forces.
    std::vector<Index> touched_, touched_start_;
    std::vector<std::array<Vector2d, 2>> corner_force_;
    std::vector<Index> corner_place_; // of the corners of each active pair, 0 and 1 of a, 2 and 3 of b, in it
    std::vector<Vector2d> sought_at_; // places when pairs were sought last
    double farthest_ = 0;             // that a gridpoint has been from there since [m]
    double raised_ = 0;               // by the joint that has dilated most, since [m]
    std::vector<double> reach_;       // of faces, then [m]
    double skin_ = 0;                 // faces come within this of each other are pairs [m]
    bool is_sought_ = false;          // since the last update
    double most_lead_ = 0;            // of closed pairs [m]
    PairEnergy energy_;
    Index searches_ = 0;
};

} // namespace jointcreep::large_displacements
