#include "analysis/safety.hpp"

#include "joint/strength_factor.hpp"
#include "model/error.hpp"

namespace jointcreep::analysis
{

Trial::Trial(const Scene& scene, const Network& network, const EquivalentJoints& joints, double factor,
             int threads, const Recording& recording, const Observer& observe)
    : factor_(factor), scene_(factor == 1 ? scene : joint::with_strength_divided(scene, factor)),
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

Ending Trial::ending() const
{
    if (message_.empty())
        return Ending::stands;
    return analysis_.result().failure.moves_on ? Ending::falls : Ending::undecided;
}

Bracket bracket_of(const std::function<Ending(double factor)>& trial, double width)
{
    constexpr double most = 64;
    Bracket found;
    const auto stands = [&](double factor) {
        const Ending ending = trial(factor);
        found.trials.factor.push_back(factor);
        found.trials.stands.push_back(ending == Ending::stands ? 1 : ending == Ending::falls ? 0 : -1);
        (ending == Ending::stands ? found.stands : found.not_above) = factor;
        return ending == Ending::stands;
    };
    if (stands(1))
        for (double factor = 2; factor <= most && stands(factor);)
            factor *= 2;
    else
        for (double factor = 0.5; factor >= 1 / most && !stands(factor);)
            factor /= 2;
    while (found.stands && found.not_above && *found.not_above - *found.stands > width * *found.stands)
        stands((*found.stands + *found.not_above) / 2);
    return found;
}

} // namespace jointcreep::analysis
