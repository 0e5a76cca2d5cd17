#include "analysis/safety.hpp"

#include "joint/strength_factor.hpp"
#include "model/error.hpp"
#include "rock/strength_factor.hpp"

#include <limits>

namespace jointcreep::analysis
{

namespace
{

// The scene with strengths divided by a factor, and a limit of displacement.
Scene trial_of(Scene scene, double factor, double most_displacement)
{
    if (factor != 1) {
        scene.rocks = rock::with_strength_divided(std::move(scene.rocks), factor);
        scene.joint_materials = joint::with_strength_divided(std::move(scene.joint_materials), factor);
    }
    scene.equilibrium.largest_displacement = most_displacement;
    return scene;
}

} // namespace

Trial::Trial(const Scene& scene, const Network& network, const EquivalentJoints& joints, double factor,
             double most_displacement, int threads, const Recording& recording, const Observer& observe)
    : factor_(factor), scene_(trial_of(scene, factor, most_displacement)),
      joints_(factor == 1 ? joints : joint::with_strength_divided(joints, factor)),
      analysis_(scene_, network, joints_, threads, recording, observe)
{
}

void Trial::run()
{
    try {
        analysis_.run();
    } catch (const equilibrium_error& error) {
        message_ = error.what();
    }
}

void Trial::go_on(Result so_far, Checkpoint kept)
{
    try {
        analysis_.go_on(std::move(so_far), std::move(kept));
    } catch (const equilibrium_error& error) {
        message_ = error.what();
    }
}

Outcome Trial::outcome() const
{
    const Ending ending = message_.empty()                           ? Ending::stands
                          : analysis_.result().failure.moves_on != 0 ? Ending::falls
                                                                     : Ending::undecided;
    return {ending, analysis_.largest_displacement(), rock::largest_plastic_strain(analysis_.rock().zones)};
}

Outcome outcome_of(const Safety& trials, std::size_t i)
{
    const Ending ending = trials.stands[i] > 0    ? Ending::stands
                          : trials.stands[i] == 0 ? Ending::falls
                                                  : Ending::undecided;
    return {ending, trials.largest_displacement[i], trials.largest_plastic_strain[i]};
}

Bracket bracket_of(const RunWith& run_with, double width, double runs_away)
{
    constexpr double most = 64;
    Bracket found;
    double limit = std::numeric_limits<double>::infinity(); // of displacement [m]
    const auto stands = [&](double factor) {
        const Outcome outcome = run_with(factor, limit, found.trials);
        const bool stood = outcome.ending == Ending::stands;
        found.trials.factor.push_back(factor);
        found.trials.stands.push_back(stood ? 1 : outcome.ending == Ending::falls ? 0 : -1);
        found.trials.largest_displacement.push_back(outcome.largest_displacement);
        found.trials.largest_plastic_strain.push_back(outcome.largest_plastic_strain);
        (stood ? found.stands : found.not_above) = factor;
        return stood;
    };
    if (!stands(1 / most))
        return found;
    if (const double firm = found.trials.largest_displacement[0]; firm > 0)
        limit = runs_away * firm;
    if (stands(1))
        for (double factor = 2; factor <= most && stands(factor);)
            factor *= 2;
    else
        for (double factor = 0.5; factor > 1 / most && !stands(factor);)
            factor /= 2;
    while (found.stands && found.not_above && *found.not_above - *found.stands > width * *found.stands)
        stands((*found.stands + *found.not_above) / 2);
    return found;
}

} // namespace jointcreep::analysis
