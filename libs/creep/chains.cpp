#include "creep/chains.hpp"

#include <algorithm>

namespace jointcreep::creep
{

bool creeps(const Chain& chain)
{
    return chain.spring > 0 && !chain.units.empty();
}

Index number_of(const Chain& chain, std::vector<Chain>& chains)
{
    if (!creeps(chain))
        return -1;
    const auto found = std::find(chains.begin(), chains.end(), chain);
    const auto number = static_cast<Index>(found - chains.begin());
    if (found == chains.end())
        chains.push_back(chain);
    return number;
}

double fastest_rate(const std::vector<Chain>& chains)
{
    double fastest = 0;
    for (const Chain& chain : chains)
        fastest = std::max(fastest, relaxation_rate(chain));
    return fastest;
}

std::vector<StepWeights> steps_of(const std::vector<Chain>& chains, CreepScheme scheme, double duration)
{
    std::vector<StepWeights> steps;
    for (const Chain& chain : chains)
        steps.push_back(step_of(chain, scheme, duration));
    return steps;
}

StepChanges step_changes(const std::vector<Chain>& chains, std::vector<Chain> chain_change,
                         CreepScheme scheme, double duration, double duration_change)
{
    StepChanges changes{std::move(chain_change), steps_of(chains, scheme, duration), {}};
    for (std::size_t i = 0; i < chains.size(); ++i)
        changes.step_change.push_back(
            change_of_step(chains[i], changes.chain_change[i], scheme, duration, duration_change));
    return changes;
}

} // namespace jointcreep::creep
