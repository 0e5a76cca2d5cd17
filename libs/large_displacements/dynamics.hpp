// Dynamic analysis with large displacements: Newton's law for gridpoints, with large displacements and rotations, until
// rest.
//
// Zones are libs/rock/moving_zones, joints libs/large_displacements/face_contacts. Masses are real. Velocities are half
// a time step behind displacements.

#pragma once

#include "joint/chain.hpp"
#include "large_displacements/face_contacts.hpp"
#include "mechanics/failure.hpp"
#include "model/network.hpp"
#include "rock/moving_zones.hpp"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

// Energies since the start of a dynamic analysis [J/m]: work = kinetic + stored + friction + damped, within the error
// of time steps.
struct Energy {
    double work = 0; // of weight, tractions on the outline and forces of excavated rock
    double kinetic = 0;
    double stored = 0;   // by zones and contacts, since the start
    double friction = 0; // lost to slip, yield and creep
    double damped = 0;   // by dashpots, and by stops at peaks of kinetic energy

    double error() const { return work - kinetic - stored - friction - damped; }
};

// Two zones whose faces touch now, or are bonded.
struct Touching {
    std::array<Index, 2> zone;       // a and b; -1 the ground
    std::array<Vector2d, 2> between; // the ends of the closed part [m]
    Vector2d normal;                 // from a to b
    Vector2d traction;               // {normal, shear}, of the springs [Pa]
    double closing;                  // mean [m]
    bool is_slipping;
};

struct Settings {
    double stiffness_damping = 0; // dashpots of zones and closed contacts over their springs [s]
    double mass_damping = 0;      // force over mass and velocity [1/s]
    double release = 0;           // time in which the forces of excavated rock go to 0 [s]
    double tolerance = 1e-5;      // of the unbalanced force ratio at rest [-]
};

// The moving section. The displacements of its assembly count from the start. Takes the state of zones and contacts
// from the assembly, and returns displacements, stresses and contacts to it.
class Dynamics
{
public:
    // `material`: the number of the joint material of each contact of the mesh. `found`: the law of contacts that form.
    // Zones of rigid rock form bodies that do not deform.
    Dynamics(mechanics::Assembly& assembly, const Mesh& mesh, const std::vector<Index>& material,
             std::vector<char> is_rigid, const joint::Law& found, const Settings& settings);

    // Starts again after an excavation, or with new loads. The unbalanced forces then go to 0 within the time of
    // release.
    void start();

    // Joints creep: those of the mesh by their own constants, new contacts by these {normal, shear}. Under the present
    // tractions they have long crept once count_from_here() is called.
    void creep_by(const EquivalentJoints& joints, const std::array<Chain, 2>& of_new_contacts);

    // Starts a creep step of a duration [s]. What creeps is added within the time of release, which must be above 0. At
    // rest the step ends; returned is an estimate of its error [m].
    void begin_creep(CreepScheme scheme, double duration);
    double end_creep();
    // Gives joints their own stiffnesses back without that; the state is then of no use but to be replaced.
    void leave_creep();

    // Whether rock moves fast, after what creeps has been added.
    bool slides() const;

    // State that a new analysis of the same section does not have; call it between analyses. start() sets the rest.
    void transfer(const Transfer& to, DynamicsState& kept);

    // What steps change, all of it.
    void pass(Tape& tape);

    // Makes the present positions the reference of displacements.
    void count_from_here();

    // One time step. Throws no_equilibrium if rock has left the section by more than its diagonal; equilibrium_error if
    // faces overlap too much, if the strain of yielding rock is too large, or if positions are not finite.
    void step();

    // The error that rock keeps moving, with its present motion.
    mechanics::no_equilibrium moves_on(const std::string& why) const;

    // Whether everything is at rest: forces are in balance to the tolerance, with those of dashpots and without, now and
    // at the last check. Call it every `check_every` steps. Throws equilibrium_error if forces are mostly rounding
    // errors.
    static constexpr Index check_every = 50;
    bool is_at_rest();

    double time() const { return now_.time; } // since the start of this dynamic analysis [s]
    double dt() const { return now_.dt; }     // [s]
    Energy energy() const;
    double unbalanced_force_ratio() const { return now_.ratio; }
    double contact_force_change() const { return now_.force_change; }
    double fastest() const { return now_.fastest; } // [m/s]
    // Whether it has been faster than the limit for stops at peaks, since the start of this dynamic analysis.
    bool has_moved() const { return now_.has_moved; }
    std::vector<Touching> touching() const;

    // Returns displacements, stresses and contacts of the mesh to the assembly. A contact of the mesh is open if its
    // two faces no longer touch.
    void put_back();

private:
    // Rigid rock: gridpoints connected by zones of rigid rock.
    struct Body {
        std::vector<Index> gridpoint; // leaders of ties
        std::vector<Vector2d> arm;    // of each from the centre, before the body has turned [m]
        double mass = 0, inertia = 0; // [kg/m], [kg m]
        Vector2d centre{0, 0}, velocity{0, 0};
        Vector2d lost{0, 0};        // rounding error of the centre, so far [m]
        double angle = 0, spin = 0; // [rad], [rad/s]
        Vector2d is_free{1, 1};     // {x, y}: 0 where any of its gridpoints is fixed
        // A body with a fixed gridpoint does not turn.
        bool turns() const { return is_free.minCoeff() > 0; }
        bool is_held() const { return is_free.maxCoeff() == 0; }
    };

    // Rock that deforms, hangs together and is not fixed: turning_pieces.cpp.
    struct Piece {
        std::vector<Index> gridpoint; // leaders of ties
        double share = 1;             // of the rock's own moment of inertia in that of the lumped masses [-]
    };
    // How a piece turns now, about its centre.
    struct Turn {
        Vector2d centre{0, 0};           // [m]
        double momentum = 0, moment = 0; // of lumped masses and their velocities [kg m/s]; of forces [N]
        double b = 0, g = 0;             // of the mass matrix and of its inverse [1/(kg m)]
    };
    static Vector2d rotation(const Vector2d& arm) { return {-arm.y(), arm.x()}; } // by an angle of 1
    void find_pieces();
    Turn turn_of(const Piece& piece) const;
    std::vector<Turn> turns() const;
    double frequency_with(const Piece& piece, double highest, double impacts,
                          const std::vector<double>& sums_of_contacts) const;
    void leave_stiff_pieces(double highest, double impacts, const std::vector<double>& sums_of_contacts);

    // Steps and energy: dynamics.cpp.
    struct MovedRock;
    struct Work;
    struct Leap;
    struct Balance;
    void make_contacts(const std::vector<Index>& material, const joint::Law& found);
    std::vector<Index> leaders() const;
    std::vector<double> contact_sums() const;
    std::vector<double> stiffness_sums(const std::vector<double>& of_contacts) const;
    void find_time_step(bool begins = false);
    double first_half() const;
    Leap leap(double first_half_of_step) const;
    MovedRock move_rock();
    Work work_of_loads(double held) const;
    void find_forces(const std::vector<Vector2d>& move);
    double energy_of_rounding() const;
    void stop_at_peak(double kinetic);
    double release_factor() const;
    double half_step_energy() const;
    double stored() const;
    std::vector<Vector2d> forces_of_dashpots() const;
    double largest_of(const std::vector<Vector2d>& force) const;
    Balance balance(const std::vector<Vector2d>& contact_force) const;
    void check_rounding(double of_springs, double rounding) const;

    // Zones that deform: zone_forces.cpp.
    bool deforms(std::size_t z) const { return assembly_.zones.is_present[z] && !is_rigid_[z]; }
    void find_zone_forces();
    void check_strain() const;

    // Rock that does not deform: rigid_bodies.cpp.
    void find_bodies();
    void find_inertia(const std::vector<double>& masses);
    double move(Body& body, double keep, double gain);
    std::pair<Vector2d, double> load_on(const Body& body, const std::vector<Vector2d>& on_gridpoints) const;
    void put_back_forces();

    // Faces and their laws: faces_of_rock.cpp.
    void find_ground();
    void find_walls();
    void find_faces();
    Faces faces_now(std::vector<std::array<Index, 2>>& of_mesh);
    std::vector<FacePair> known_pairs(const std::vector<std::array<Index, 2>>& of_mesh) const;
    void add_pairs_on_joints(const std::vector<std::array<Index, 2>>& of_mesh,
                             std::vector<FacePair>& known) const;
    std::optional<FacePair>
    pair_on_joint(Index f, Index g, const std::vector<std::array<Index, 2>>& of_mesh,
                  const std::map<std::array<Index, 2>, std::vector<std::size_t>>& between) const;

    // Results for the assembly: dynamics_state.cpp.
    struct Carried;
    std::map<std::array<Index, 2>, Carried> carried_by_pairs() const;
    void put_back_contacts();

    // What steps change, beside contacts, bodies and zones. Positions count from the section's middle: their rounding
    // errors must not depend on where the section is.
    struct Movement {
        std::vector<Vector2d> place, velocity, force; // of gridpoints [m], [m/s], [N/m]
        std::vector<Vector2d> lost;                   // rounding errors of positions, so far [m]
        std::vector<double> inverse_mass;             // 0 if of excavated rock only, or of a body [m/kg]
        double dt = 0, last_dt = 0, time = 0, time_lost = 0; // [s]
        double stiffest_allowed = 0; // spring of a contact, by the present step [Pa/m]
        bool starts_from_rest = true, has_moved = false;
        double last_kinetic = 0; // energy [J/m]
        double stiffest = 0;     // row sum [Pa]
        double largest_mean = 0; // force on a gridpoint, so far [N/m]
        double ratio = 0;        // unbalanced force over mean force [-]
        double force_change = 0; // of contacts over the mean force, since the last check [-]
        double fastest = 0;      // [m/s]
        Index fastest_gridpoint = 0, stiffest_gridpoint = 0, checks_in_balance = 0;
        std::vector<Vector2d> last_contact_force; // at the last check [N/m]; empty before
        Energy energy;

        void pass(Tape& tape);
    };

    mechanics::Assembly& assembly_;
    const Mesh& mesh_;
    Settings settings_;
    FaceContacts contacts_;
    std::vector<Body> bodies_;
    std::vector<char> is_rigid_; // zones
    bool any_deforms_ = false;   // of the present zones
    std::vector<Index> body_of_; // of gridpoints; -1 none
    std::vector<Piece> pieces_;
    std::vector<Index> piece_of_; // of gridpoints; -1 none
    rock::MovingZones zones_;     // of the assembly
    rock::ZoneSums in_zones_;
    Movement now_;
    std::vector<Vector2d> move_;     // in this step [m]
    std::vector<Vector2d> released_; // forces of excavated rock, which fade [N/m]
    std::vector<Vector2d> origin_;   // reference of displacements [m]
    double stored_at_start_ = 0;     // [J/m]
    bool is_creeping_ = false;       // in a creep step
    Vector2d middle_;                // of the section, where it is [m]
    Vector2d low_, high_;            // of the section and its diagonal all round [m]
    std::vector<std::size_t> law_of_edge_;
    std::vector<std::array<Index, 2>> ground_;             // its faces, by gridpoints of the mesh
    std::map<std::array<Index, 2>, std::size_t> wall_law_; // of sides on a joint, by gridpoints of the mesh
    std::vector<std::array<Index, 2>> face_of_mesh_; // the contacts' faces, by gridpoints before leaders
    std::vector<Index> zone_of_face_;                // -1 of the ground
};

} // namespace jointcreep::large_displacements
