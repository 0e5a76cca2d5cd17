// Sensitivities of an analysis: what displacements, tractions, slip and creep change by, to first order, when
// a parameter does. Found along with the analysis by direct differentiation: each equilibrium r(u, p) = 0
// gives
//     K du/dp = -dr/dp ,     K the tangent stiffness, from the factor that found the equilibrium,
// and the states that contacts and creep go on with are differentiated by the formulas that made them.
//
// What contacts, zones and creep change by is theirs: joint/contact_changes.hpp, rock/zone_changes.hpp,
// creep/creep_changes.hpp. At the border between two branches of a joint law there are two derivatives, and this is one of
// them. Where a creep step ends
// because a contact closes, a parameter moves that moment, too. Steps chosen by their error are taken as long
// as they are. Where loads change during a step that is cut, what they change by until then is left out.
//
// Parameters are factors, and sensitivities those to their logarithms: du/dp at p = 1.

#pragma once

#include "creep/closing.hpp"
#include "creep/creep_changes.hpp"
#include "implicit/equilibrium.hpp"
#include "joint/contact_changes.hpp"
#include "rock/zone_changes.hpp"

#include <vector>

namespace jointcreep::sensitivity
{

using Eigen::Vector2d;

// Factors on what all joints have, in normal and shear direction alike.
enum class Parameter {
    kelvin_stiffness,  // E
    kelvin_viscosity,  // eta, of Kelvin units and Maxwell dashpots
    joint_stiffness,   // K, with E / K and eta / E kept
    horizontal_stress, // in situ: sigma_xx and its gradient
};

// The joints and the in-situ stress times a factor.
void scale(EquivalentJoints& joints, InSituStress& stress, Parameter parameter, double factor);

class Sensitivity
{
public:
    // Of an assembly before its in-situ equilibrium.
    Sensitivity(std::vector<Parameter> parameters, const Scene& scene, const Mesh& mesh,
                const mechanics::Assembly& assembly);

    // After an equilibrium in which `held` is the share of the last stage's forces that still act; `time` [s]
    // is for messages. Throws equilibrium_error where there is none nearby for other parameters: rock that
    // only slip holds.
    void settle(const mechanics::Assembly& assembly, implicit::Solver& engine, double time, double held = 0);

    // Before mechanics::start_from_here.
    void start_from_here(const mechanics::Assembly& assembly);
    // After that, with what creeps.
    void start_creep(const creep::Creep& creep);

    // Before a step, with the assembly's own stiffnesses.
    void start_step(const mechanics::Assembly& assembly);
    // The step will be shorter: by a share, or to where a contact closes, after the equilibrium at the end of
    // `duration` [s].
    void shorten(double share);
    void cut(const creep::Closing::Cut& cut, const creep::Creep& creep, double duration,
             const mechanics::Assembly& assembly, implicit::Solver& engine, double time);
    // It stands, up to where it was to end if it `is_whole`.
    void finish_step(const creep::Closing& closing, double duration, bool is_whole,
                     const mechanics::Assembly& assembly);
    // After a sudden change of loads.
    void start_afresh();

    // Before Creep::end, at the equilibrium of a step of `duration` [s].
    void creep_step(const creep::Creep& creep, double duration, const mechanics::Assembly& assembly,
                    implicit::Solver& engine, double time);

    // Before and after a stage's rock is taken away.
    void before_excavation(const mechanics::Assembly& assembly);
    void after_excavation(const mechanics::Assembly& assembly);

    std::size_t size() const { return parameters_.size(); }
    // Of every gridpoint, per unit of the parameter's logarithm [m].
    const std::vector<Vector2d>& displacement(std::size_t parameter) const
    {
        return changes_[parameter].displacement;
    }

private:
    // Per unit of the logarithm.
    struct Change {
        std::vector<Vector2d> displacement,
            released; // of gridpoints: [m], forces that a stage releases [N/m]
        joint::ContactChanges contacts;
        rock::ZoneChanges zones;
        creep::CreepChanges creep;
        // Of creep::Closing, and times.
        std::vector<double> opening_before, opening, rate; // contacts
        double now = 0, duration = 0;                      // [s]
    };

    static double opening(const mechanics::Assembly& assembly, const Change& change, std::size_t c);
    static void find_openings(const mechanics::Assembly& assembly, Change& change);
    // Forces on gridpoints: now, and if all stayed where they are [N/m].
    static std::vector<Vector2d> forces(const mechanics::Assembly& assembly, const Change& change);
    std::vector<Vector2d> forces_at_fixed_gridpoints(const mechanics::Assembly& assembly,
                                                     const Change& change) const;

    std::vector<Parameter> parameters_;
    std::vector<Change> changes_;     // of the parameters
    std::vector<joint::State> start_; // of contacts, at the last equilibrium's start; then at its end
};

} // namespace jointcreep::sensitivity
