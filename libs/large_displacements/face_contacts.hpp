// Contacts between faces of moving blocks: contacts are detected anew as blocks slide, turn and fall.
//
// A face is a side of a zone with no rock in front of it. A contact is a pair of faces that face each other. Along
// their overlap the joint closes linearly. Its springs (stiffness per area) are integrated over the closed part: linear
// springs exactly, those of Barton and Bandis's law at five points. So gridpoints of the two faces need not match, and
// a uniform traction stays uniform after any slide. A corner in a face is a contact with a short closed part.
//
// The plane of a contact is that of the face into which a corner of the other one sinks. Where two corners meet, within
// a hundredth of the shorter face, the plane turns smoothly from one face to the other.
//
// A pair whose faces are everywhere deeper in each other than they overlap carries no load: the corner between them is
// in the other block by way of another face, and is pushed back by that one. The exception is a pair that continues
// another one, about as deep.
//
// closing = lead - gap. The lead is the closing of a contact between faces without a gap: that under the in-situ
// stress, plus dilation since. It belongs to a pair of faces. When a face slides on to the next one, the new pair
// inherits it. The shear traction is a stress along the contact, so it rotates with the contact.
//
// A contact keeps the law of its joint while both faces were walls of joints of the same material. Otherwise it has the
// law of new contacts, as any two faces that were not in contact. So the law does not depend on which face is taken as
// sliding. Filling and bonds of a joint do not apply between two walls that never were in contact.
//
// Slip raises a joint that dilates: it adds to the lead. The amount is the same along the whole joint, since its walls
// are rigid beside its springs. The joint is all pairs between the same two straight sides of outlines. The amount does
// the same work as the dilation of each pair by its own slip: the mean of tan(psi) |slip|, weighted by pressure. It is
// computed together with the slip, as in joint/coulomb.hpp.

#pragma once

#include "creep/scheme.hpp"
#include "mechanics/assembly.hpp"

#include <array>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

using mechanics::Vector2d;

// Faces have their rock on the left. Consecutive faces share a gridpoint.
struct Faces {
    std::vector<std::array<Index, 2>> gridpoint;
    std::vector<double> depth;      // of the zone behind it [m]
    std::vector<std::size_t> law{}; // of the joint whose wall it was; else that of new contacts
};

// Creep of a pair: along the normal at the first and at the second end of a, and in shear. Pressure and closure are
// positive.
struct PairCreep {
    std::array<double, 3> reference{}; // traction from which creep counts [Pa]
    std::vector<double> crept{}; // of each unit: of the first end, the second, shear; empty if all are 0 [m]
    // In a creep step: the traction at its beginning [Pa], and what is added to the leads and to the slide in all [m].
    std::array<double, 3> before{}, to_come{};
};

// The state of a pair of faces that may touch.
struct FacePair {
    Index a, b; // faces, a < b
    std::size_t law = 0;
    std::array<double, 2> lead{0, 0}; // closing without a gap, at the first and the second end of a [m]
    double dilation = 0;              // part of the lead [m]
    double tau = 0;                   // along(normal from a to b), on a [Pa]
    bool is_known = false;            // has touched since the pair was found
    bool is_new = true;               // has not carried a force yet
    bool is_closed = false;           // over some of its length
    bool is_broken = true;            // has no cohesion and no tensile strength (any more)
    std::array<double, 3> memory{};   // of the law, as in joint::State
    bool is_slipping = false;
    PairCreep creep{};

    // At present, if closed: the ends of the closed part, as fractions of a and of b, the force on a there, and the
    // mean normal traction.
    std::array<double, 2> on_a{}, on_b{};
    std::array<Vector2d, 2> force{Vector2d(0, 0), Vector2d(0, 0)};
    Vector2d normal{0, 0};                                        // from a to b
    std::array<double, 2> closing{};                              // at the ends of the closed part [m]
    std::array<double, 3> creeps{};                               // of creep.to_come, in this step [m]
    double raised = 0;                                            // of the dilation, in the last step [m]
    double opened = 0;                                            // in the last step, without dilation [m]
    double length = 0, sigma = 0;                                 // [m], [Pa]
    double stiffest = 0;                                          // of its normal springs [Pa/m]
    std::array<Vector2d, 2> held{Vector2d(0, 0), Vector2d(0, 0)}; // part of the force by dashpots [N/m]
    double pressed_in = 0, sheared_in = 0;                        // energy of the springs [J/m]
    double friction = 0, damped = 0;                              // in the last step [J/m]

    void raise(double by)
    {
        dilation += by;
        for (double& end : lead)
            end += by;
    }
    bool is_bonded() const { return is_known && !is_broken; }
    // Shares of a force on a at an end of the closed part, and of the opposite one on b: on the gridpoints of a, then
    // of b [N/m].
    std::array<Vector2d, 4> on_gridpoints(int end, const Vector2d& force_on_a) const
    {
        return {(1 - on_a[end]) * force_on_a, on_a[end] * force_on_a, -(1 - on_b[end]) * force_on_a,
                -on_b[end] * force_on_a};
    }
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
    std::array<double, 2> sharp{1, 1}; // of its ends: 0 where the outline is straight, 1 at a corner
};

// A time step; forces are computed at its end.
struct TimeStep {
    const std::vector<Vector2d>& place; // of gridpoints, at its end [m]
    const std::vector<Vector2d>& move;  // their displacements in it [m]
    double dt;                          // [s]
    double viscosity;                   // of dashpots over their springs [s]
};

struct Overlap; // of two faces: face_overlap.hpp

// Energies of pairs [J/m].
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
    // `laws`: the laws of pairs; the last one is for new contacts. `material`: the joint material numbers of the other
    // laws. Positions count from `origin` [m].
    explicit FaceContacts(std::vector<joint::Law> laws, std::vector<Index> material = {},
                          const Vector2d& origin = Vector2d::Zero());

    // Replaces the faces. Of the earlier pairs only `known` are kept, in any order. Faces without laws are walls of no
    // joint.
    void set_faces(Faces faces, std::vector<FacePair> known, const std::vector<Vector2d>& place);

    // Tractions and forces of all pairs after gridpoints have moved by `move` to `place` [m] within `dt` [s]: of
    // springs, and of dashpots of `viscosity` times the springs [s]. Throws equilibrium_error if two faces overlap too
    // much for a valid force.
    void update(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move, double dt,
                double viscosity, int threads);

    // Adds the forces of the last update to those on gridpoints [N/m].
    void add_forces(std::vector<Vector2d>& force, int threads) const;
    // Adds the part of them that dashpots have.
    void add_forces_of_dashpots(std::vector<Vector2d>& force) const;

    // Energies of all pairs, at the last update.
    const PairEnergy& energy() const { return energy_; }

    // Creep. `chains`: what creeps along the normal and in shear, of each law.
    void creep_by(std::vector<std::array<Chain, 2>> chains);
    // Pairs have long crept under their present tractions: creep counts from there.
    void count_creep_from_here();
    // Begins a creep step of a duration [s] after an update; no traction changes. Then the next updates add a `share`
    // of what creeps, up to 1, and at equilibrium the step ends. end_creep() returns an estimate of the error, as
    // mechanics::Creep::end() does. leave_creep() only gives the laws their own stiffnesses back.
    void begin_creep(CreepScheme scheme, double duration);
    void creep_to(double share);
    double end_creep();
    void leave_creep();
    // For a pair whose two faces change places.
    void swap_ends(PairCreep& creep, std::size_t law) const;
    // Mean {opening, shear} of a pair by creep [m].
    Vector2d crept(const FacePair& pair) const;

    // State for checkpoints, beside set_faces() with the known pairs, and update().
    void transfer(const Transfer& to, DynamicsState& kept);

    // What updates change, all of it.
    void pass(Tape& tape);

    const Faces& faces() const { return faces_; }
    const std::vector<FacePair>& pairs() const { return pairs_; }
    const std::vector<joint::Law>& laws() const { return laws_; }
    // The stiffest spring: of open pairs, and in the last update [Pa/m].
    double stiffest() const { return stiffest_; }
    bool stiffens() const { return stiffens_; }
    // Number of searches for pairs that may touch.
    Index searches() const { return searches_; }

private:
    struct Sum;
    // Result for a pair in a step: done; overlap too deep for a valid force; or undecided, which depends on other pairs:
    // the pair may begin to touch, or its contact may end because its faces lie behind each other.
    enum class Touch { settled, too_deep, comes_about, may_end };
    enum class Decision { none, touches, ends };

    // Search for pairs that may touch: contact_detection.cpp.
    void find_corners(const std::vector<Vector2d>& place);
    void seek(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move);
    std::vector<std::pair<Index, Index>> find_reach(const std::vector<Vector2d>& place);
    void take_pairs(const std::vector<std::pair<Index, Index>>& near);
    void list_pairs();
    void find_joints(const std::vector<Vector2d>& place);
    void find_active();
    double distance_to_touch(const FacePair& pair, double most_lead) const;
    void find_touched();
    const FacePair* contact_before(const FacePair& pair, const Vector2d& normal,
                                   const std::vector<Vector2d>& place) const;
    std::size_t law_slid_on_to(const FacePair& pair, const FacePair& before) const;

    // Dilation of joints: joint_dilation.cpp.
    void dilate(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move);

    // Creep: pair_creep.cpp.
    bool law_creeps(std::size_t law) const;
    std::size_t creep_units(std::size_t law) const; // of both ends and shear
    PairCreep creep_slid_on_to(const FacePair& pair, const FacePair& before) const;

    // The force of a pair: contact_forces.cpp.
    Touch find_force(FacePair& pair, const TimeStep& step, Decision decision) const;
    bool lies_behind(const Overlap& found, const FacePair* before, const TimeStep& step) const;
    bool comes_to_touch(FacePair& pair, const Overlap& found, const TimeStep& step) const;

    // Of all pairs.
    void find_shapes(const std::vector<Vector2d>& place, int threads);
    double farthest_since_search(const std::vector<Vector2d>& place, int threads) const;
    Sum find_forces(const TimeStep& step, int threads);
    void find_forces_of_undecided(const TimeStep& step, Sum& sum);
    void take_forces(Index active);

    std::vector<joint::Law> laws_;
    std::vector<Index> material_; // of laws; -1 of new contacts
    Vector2d origin_;
    std::vector<std::array<Chain, 2>> chains_;             // of laws; without units if nothing creeps
    std::vector<std::array<creep::StepWeights, 2>> steps_; // of these
    std::vector<joint::Law> own_laws_;                     // in a creep step: with their own springs
    double crept_share_ = 0;                               // of the creep step, so far [-]
    bool stiffens_ = false;                                // whether any law stiffens as it closes
    bool dilates_ = false;                                 // whether any law dilates
    double stiffest_open_ = 0, stiffest_ = 0;              // [Pa/m]
    Faces faces_;
    std::vector<FaceShape> shapes_;
    std::vector<FacePair> pairs_;             // in order of {a, b}
    std::vector<std::vector<Index>> of_face_; // pairs of each face
    std::vector<Index> side_;                 // of each face: the lowest one of its straight side
    std::vector<std::vector<Index>> joints_;  // pairs between the same two sides, if any law dilates
    std::vector<Index> active_;               // pairs that may carry a load before the next search
    std::vector<double> clearance_;           // displacement of gridpoints before they can [m]
    std::vector<Touch> touch_;                // of pairs in this update: settled, or still to be decided
    // The gridpoints of active pairs, and the forces added to each of them [N/m]: by each corner of each pair, its
    // shares of the two forces.
    std::vector<Index> touched_, touched_start_;
    std::vector<std::array<Vector2d, 2>> corner_force_;
    std::vector<Index> corner_place_; // of the corners of each active pair, 0 and 1 of a, 2 and 3 of b, in it
    std::vector<Vector2d> sought_at_; // positions at the last search for pairs
    double farthest_ = 0;             // largest distance of a gridpoint from there since [m]
    double raised_ = 0;               // largest dilation of a joint since [m]
    std::vector<double> reach_;       // of faces, then [m]
    double skin_ = 0;                 // faces within this distance are pairs [m]
    bool is_sought_ = false;          // since the last update
    double most_lead_ = 0;            // of closed pairs [m]
    PairEnergy energy_;
    Index searches_ = 0;
};

} // namespace jointcreep::large_displacements
