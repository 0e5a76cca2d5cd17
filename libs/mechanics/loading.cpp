#include "mechanics/loading.hpp"

namespace jointcreep::mechanics
{

void Loading::apply(Assembly& assembly, double time)
{
    time_ = time;
    leave_removed(assembly);
    displace(assembly.displacement, assembly.zones.is_present, time);
    // What follows has its place from the one it is tied to.
    for (const auto& [follower, leader] : assembly.tied)
        for (int i = 0; i < 2; ++i)
            if (assembly.is_free_untied[follower][i] == 0 && assembly.is_free_untied[leader][i] > 0)
                assembly.displacement[leader][i] = assembly.displacement[follower][i];
}

void Loading::leave_removed(Assembly& assembly) const
{
    assembly.applied.assign(assembly.applied.size(), Vector2d::Zero());
    add_forces(assembly.applied, assembly.zones.is_present, time_);
}

} // namespace jointcreep::mechanics
