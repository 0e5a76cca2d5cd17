#include "keys/refusals.hpp"

#include <algorithm>

namespace jointcreep::keys
{

void Refusals::end() const
{
    if (faults_.empty())
        return;
    constexpr std::size_t most_shown = 20;
    std::vector<Fault> faults = faults_;
    std::ranges::stable_sort(faults, {}, &Fault::line);
    std::string all;
    for (std::size_t i = 0; i < std::min(faults.size(), most_shown); ++i)
        all += (i ? "\n" : "") + faults[i].what;
    if (faults.size() > most_shown)
        all += "\nand " + std::to_string(faults.size() - most_shown) + " more";
    throw input_error(all);
}

} // namespace jointcreep::keys
