// The state at a moment of an analysis, from which another run can continue with the same result.
//
// Such a moment is one at which the state here is all there is: what the implicit engine has learnt from earlier steps
// (a factor, solutions, a guess) is forgotten. In any run, with checkpoints or without, it is forgotten
//   - before the in-situ equilibrium and before every stage;
//   - after every equilibrium by dynamic relaxation;
//   - after every 50th creep step.
// Before the in-situ equilibrium, before every stage, and after something was forgotten between two creep steps or two
// increments of a stage, a run can continue.
//
// In the middle of a long search for equilibrium, the search's own state is added (model/tape.hpp). A run from there
// begins at the moment before, and computes again what leads to that search, but not the search.

#pragma once

#include "model/error.hpp"
#include "model/result.hpp"

#include <functional>
#include <type_traits>
#include <vector>

namespace jointcreep
{

// What a dynamic analysis with large displacements adds: among others pairs of faces that may touch.
struct DynamicsState {
    std::vector<Eigen::Vector2d> origin, place;  // of gridpoints: that displacements count from; now [m]
    std::vector<Eigen::Vector4d> inverse;        // of zones: of their edges without stress [1/m]
    std::vector<double> area;                    // of zones, without stress [m2]
    std::vector<Eigen::Vector3d> strain;         // of zones, Biot's {xx, yy, 2 xy} [-]
    std::vector<Eigen::Vector4d> plastic_strain; // of it, of zones that yield {xx, yy, zz, 2 xy} [-]
    std::vector<double> initial_zz, stress_zz; // of these: across the section, without stress in it; now [Pa]
    std::vector<Eigen::Vector3d> stress;       // of these, Biot's {xx, yy, xy} [Pa]
    std::vector<std::array<Index, 2>> face;    // gridpoints
    std::vector<std::array<Index, 2>> pair;    // faces
    std::vector<Index> law;                    // of the pair
    std::vector<double> first_lead, second_lead;                            // closure without gap [m]
    std::vector<double> dilation;                                           // part of the leads [m]
    std::vector<double> tau;                                                // [Pa]
    std::vector<Index> is_known, is_new, is_closed, is_broken;              // 0 or 1
    std::vector<double> first_memory, second_memory, third_memory;          // of the law [SI]
    std::vector<Eigen::Vector2d> normal;                                    // [-]
    std::vector<double> length;                                             // [m]
    std::vector<double> first_reference, second_reference, shear_reference; // of creep [Pa]
    std::vector<double> pair_crept;             // of each unit: at both ends along the normal, in shear [m]
    std::vector<double> pressed_in, sheared_in; // by springs [J/m]
    double fastest = 0;                         // in the last dynamic analysis [m/s]
    double unbalanced_force_ratio = 0;          // at its end [-]
    double largest_mean_force = 0;              // on a gridpoint, so far [N/m]
};

struct Checkpoint {
    Index is_in_situ = 0; // 1: before the in-situ equilibrium; then only `search` counts
    double time = 0;      // since start [s]
    Index stage = 0;      // to be excavated next

    // Gridpoints.
    std::vector<Eigen::Vector2d> displacement; // [m]
    std::vector<Eigen::Vector2d> is_free;      // 1 or 0 in {x, y}, but for ties [-]
    std::vector<Eigen::Vector2d> load;         // [N/m]
    std::vector<Eigen::Vector2d> force;        // unbalanced [N/m]
    Index unloaded = 0;                        // of `released`: what acts no more, in finest increments
    std::vector<Eigen::Vector2d> released;     // force of rock excavated in this stage, within it [N/m]
    Index increment = 0;                       // the next one, in finest increments

    // Zones.
    std::vector<Index> zone_present;
    std::vector<Eigen::Vector3d> stress, initial_stress; // [Pa]
    // {C11, C12, C33}: creep leaves it as it was, but for rounding [Pa].
    std::vector<Eigen::Vector3d> stiffness;
    std::vector<Eigen::Vector4d> plastic_strain; // of zones that yield {xx, yy, zz, 2 xy} [-]
    std::vector<double> stress_zz, initial_zz;   // of these [Pa]

    // Contacts; {normal, shear}.
    std::vector<Index> contact_status;
    std::vector<Eigen::Vector2d> traction, initial_traction;    // [Pa]
    std::vector<Eigen::Vector2d> relative_displacement, offset; // [m]
    std::vector<double> slip, dilation;                         // [m]
    std::vector<Eigen::Vector2d> opening_rate;                  // of {opening, shear}, of open ones [m/s]
    std::vector<Index> is_broken;
    // Of laws that remember more (their headers say what) [SI].
    std::vector<double> first_memory, second_memory, third_memory;

    // Creep: a direction of a contact, and its units; a zone, and its units.
    std::vector<double> reference;               // [Pa]
    std::vector<double> crept;                   // [m]
    std::vector<Eigen::Vector3d> rock_reference; // [Pa]
    std::vector<Eigen::Vector3d> rock_crept;     // [-]
    double creep_step = 0;                       // wanted next, 0 without creep [s]

    // What has been counted.
    Index steps_since_record = 0;   // solver steps
    double solver_time = 0;         // of dynamic relaxation [s]
    Index steps_since_state = 0;    // creep steps
    std::vector<Index> remark_kind; // the place in analysis::Findings::all
    std::vector<std::string> remark;
    std::vector<Index> remark_count;

    DynamicsState dynamics;

    // A search for equilibrium under way, which may be none.
    Index search_number = 0;    // of searches that are kept, since this moment
    std::vector<double> search; // its state (model/tape.hpp)
};

// Copies state into a checkpoint, or back from it. So a list of the state is written once, for both.
class Transfer
{
public:
    enum class Way { keep, restore };
    explicit Transfer(Way way) : restores_(way == Way::restore) {}
    bool restores() const { return restores_; }

    template <class Live, class Kept>
    void value(Live& live, Kept& kept) const
    {
        if (restores_)
            live = static_cast<Live>(kept);
        else
            kept = static_cast<Kept>(live); // NOLINT(bugprone-signed-char-misuse): flags are 0 and 1
    }

    // Of every item, or of a member of it.
    template <class Live, class Kept, class Member = std::identity>
    void values(std::vector<Live>& live, std::vector<Kept>& kept, Member member = {}) const
    {
        if (!restores_)
            kept.resize(live.size());
        else if (kept.size() != live.size())
            throw input_error("the state kept is that of another section");
        for (std::size_t i = 0; i < live.size(); ++i)
            value(std::invoke(member, live[i]), kept[i]);
    }

    // For lists that are not as long in every run.
    template <class Live, class Kept>
    void size(std::vector<Live>& live, const std::vector<Kept>& kept) const
    {
        if (restores_)
            live.resize(kept.size());
    }

private:
    bool restores_;
};

} // namespace jointcreep
