// Sensitivities of an analysis: derivatives of displacements, tractions, slip and creep by a parameter, a factor. They are
// computed along with the analysis by direct differentiation. Each equilibrium r(u, p) = 0 gives
//     K du/dp = -dr/dp ,     K the tangent stiffness, from the factor that found the equilibrium.
// The states that contacts and creep continue with are differentiated by the formulas that made them.
//
// Each kind of force has its own derivatives (mechanics/forces.hpp).
// At the border between two branches of a joint law there are two derivatives; this computes one of them. Where a creep
// step ends because a contact closes, the derivative of that moment is included. Left out: changes of the lengths of
// steps chosen by their error, and changes of loads in the cut part of a step.
//
// Parameters are factors. Sensitivities are by their logarithms: du/dp at p = 1.

#pragma once

#include "implicit/equilibrium.hpp"
#include "joint/closing.hpp"
#include "mechanics/creep.hpp"
#include "model/scaled.hpp"

#include <vector>

namespace jointcreep::sensitivity
{

using Eigen::Vector2d;

// The scene's joints and in-situ stress times a factor.
void scale(EquivalentJoints& joints, InSituStress& stress, Scaled scaled, double factor);

class Sensitivity
{
public:
    // Start from an assembly before its in-situ equilibrium.
    Sensitivity(std::vector<Scaled> parameters, const Scene& scene, const Mesh& mesh,
                const mechanics::Assembly& assembly);

    // After an equilibrium; `held` is the share of the last stage's forces that still act, `time` [s] is for messages.
    // Throws equilibrium_error where other parameters have no equilibrium nearby: rock that is fixed by slipping
    // contacts only.
    void settle(const mechanics::Assembly& assembly, implicit::Solver& engine, double time, double held = 0);

    // Before mechanics::start_from_here.
    void start_from_here(const mechanics::Assembly& assembly);
    // After it, with what creeps.
    void start_creep(const mechanics::Creep& creep);

    // Before a step, with the assembly's own stiffnesses.
    void start_step(const mechanics::Assembly& assembly);
    // The step is shortened: by a share, or to the moment at which a contact closes, after the equilibrium at the end
    // of `duration` [s].
    void shorten(double share);
    void cut(const joint::Closing::Cut& cut, const mechanics::Creep& creep, double duration,
             const mechanics::Assembly& assembly, implicit::Solver& engine, double time);
    // The step is accepted; `is_whole`: to the end that it was planned to have.
    void finish_step(const joint::Closing& closing, double duration, bool is_whole,
                     const mechanics::Assembly& assembly);
    // After a sudden change of loads.
    void start_afresh();

    // Before Creep::end, at the equilibrium of a step of `duration` [s].
    void creep_step(const mechanics::Creep& creep, double duration, const mechanics::Assembly& assembly,
                    implicit::Solver& engine, double time);

    // Before and after a stage's rock is excavated.
    void before_excavation(const mechanics::Assembly& assembly);
    void after_excavation(const mechanics::Assembly& assembly);

    std::size_t size() const { return parameters_.size(); }
    // Derivatives for each gridpoint, per unit of the parameter's logarithm [m].
    const std::vector<Vector2d>& displacement(std::size_t parameter) const
    {
        return changes_[parameter].displacement;
    }

private:
    // Per unit of the logarithm.
    struct Change {
        std::vector<Vector2d> displacement; // of gridpoints [m]
        std::vector<Vector2d> released;     // forces on them that a stage releases [N/m]
        mechanics::Changes forces;
        mechanics::CreepChanges creep;
        // For joint::Closing, and times.
        std::vector<double> opening_before, opening, rate; // contacts
        double now = 0, duration = 0;                      // [s]
    };

    static double opening(const mechanics::Assembly& assembly, const Change& change, std::size_t c);
    static void find_openings(const mechanics::Assembly& assembly, Change& change);
    // Forces on gridpoints: now, and at fixed displacements [N/m].
    static std::vector<Vector2d> forces(const mechanics::Assembly& assembly, const Change& change);
    std::vector<Vector2d> forces_at_fixed_gridpoints(const mechanics::Assembly& assembly,
                                                     const Change& change) const;

    std::vector<Scaled> parameters_;
    std::vector<Change> changes_;  // of the parameters
    mechanics::ForcesState start_; // at the last equilibrium's start; then at its end
};

} // namespace jointcreep::sensitivity
