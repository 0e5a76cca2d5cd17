// Sensitivities of an analysis: what displacements, tractions, slip and creep change by, to first order, when
// a parameter does. Found along with the analysis by direct differentiation: each equilibrium r(u, p) = 0
// gives
//     K du/dp = -dr/dp ,     K the tangent stiffness, from the factor that found the equilibrium,
// and the states that contacts and creep go on with are differentiated by the formulas that made them.
//
// Contacts are differentiated by the joint law itself, in dual numbers (joint/dual.hpp), on the branch that they
// are on: at the border between two branches there are two derivatives, and this is one of them. Where a creep step ends
// because a contact closes, a parameter moves that moment, too. Steps chosen by their error are taken as long
// as they are. Where loads change during a step that is cut, what they change by until then is left out.
//
// Parameters are factors, and sensitivities those to their logarithms: du/dp at p = 1.

#pragma once

#include "creep/closing.hpp"
#include "creep/creep.hpp"
#include "implicit/equilibrium.hpp"
#include "joint/law.hpp"

#include <vector>

namespace jointcreep::sensitivity
{

using Eigen::Vector2d, Eigen::Vector3d;

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
    // What the assembly's arrays of the same names change by, per unit of the logarithm.
    struct Change {
        std::vector<Vector2d> displacement, released;
        std::vector<Vector2d> stiffness, initial_traction, offset, traction;
        std::vector<double> slip, dilation;
        std::vector<std::array<double, 3>> memory; // of joint::State
        std::vector<Vector3d> initial_stress, stress;
        std::vector<double> shear_modulus; // zones
        // Of creep::Creep.
        std::vector<double> reference, before, crept;                        // springs; springs; units
        std::vector<Vector3d> reference_stress, before_stress, crept_strain; // zones; zones; units
        // Of creep::Closing, and times.
        std::vector<double> opening_before, opening, rate; // contacts
        double now = 0, duration = 0;                      // [s]
    };

    creep::Chain change_of(const creep::Chain& chain, Parameter parameter) const;
    static double opening(const mechanics::Assembly& assembly, const Change& change, std::size_t c);
    // Forces on gridpoints, as settled; or before, at displacements as they are.
    std::vector<Vector2d> forces(const mechanics::Assembly& assembly, const Change& change,
                                 bool is_settled) const;
    joint::ContactResponse response(const mechanics::Assembly& assembly, const Change& change, std::size_t c,
                                    bool with_displacement) const;
    Vector3d stress(const mechanics::Assembly& assembly, const Change& change, std::size_t z,
                    bool with_displacement) const;

    std::vector<Parameter> parameters_;
    std::vector<Change> changes_;     // of the parameters
    std::vector<joint::State> start_; // of contacts, at the last equilibrium's start; then at its end
};

} // namespace jointcreep::sensitivity
