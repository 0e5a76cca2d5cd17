#include "analysis/safety.hpp"

namespace jointcreep::analysis
{

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
