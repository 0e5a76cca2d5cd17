// The loads of the outline, put on an assembly.

#pragma once

#include "boundary/loads.hpp"
#include "mechanics/assembly.hpp"

namespace jointcreep::mechanics
{

class Loading : public boundary::Loads
{
public:
    using Loads::Loads;

    // Puts on the tractions and displacements of `time` since start [s], in place of those before.
    void apply(Assembly& assembly, double time);

    // Removes tractions from sides whose rock has been removed.
    void leave_removed(Assembly& assembly) const;

private:
    double time_ = 0;
};

} // namespace jointcreep::mechanics
