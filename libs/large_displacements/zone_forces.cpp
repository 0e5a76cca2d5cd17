#include "large_displacements/dynamics.hpp"
#include "large_displacements/in_chunks.hpp"
#include "model/error.hpp"

namespace jointcreep::large_displacements
{

// Corner forces and energies of all zones, at the present positions.
void Dynamics::find_zone_forces()
{
    if (!any_deforms_)
        return;
    const double viscosity = settings_.stiffness_damping / now_.dt;
    const double lost_before = in_zones_.friction; // at the start
    in_zones_ = sum_in_chunks<rock::ZoneSums>(
        static_cast<Index>(zones_.zone.size()), assembly_.threads, [&](Index z, rock::ZoneSums& sums) {
            if (deforms(z))
                find_force(assembly_.zones, zones_, z, now_.place, viscosity, sums);
        });
    in_zones_.friction += lost_before;
}

// Throws where the strain of yielding rock is too large.
void Dynamics::check_strain() const
{
    if (in_zones_.torn >= 0)
        throw equilibrium_error(
            "dynamic analysis: rock that yields at " +
            shown(Vector2d(middle_ + now_.place[assembly_.zones.gridpoints(in_zones_.torn)[0]])) +
            " is strained by more than " + shown(100 * rock::most_strain) +
            " percent, more than a zone can be");
}

} // namespace jointcreep::large_displacements
