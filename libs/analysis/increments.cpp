#include "analysis/increments.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::analysis
{

namespace
{

double share_of(double difference, double size)
{
    return size > 0 ? difference / size : difference > 0 ? 1.0 : 0.0;
}

} // namespace

double change_between(const Result& coarser, const Result& finer)
{
    const std::size_t n_coarser = coarser.states.time.size(), n_finer = finer.states.time.size();
    const std::size_t compared = n_coarser == n_finer ? n_finer : 1;
    const std::size_t gridpoints = finer.mesh.gridpoint.size(), contacts = finer.mesh.contact_length.size();
    double off = 0, largest = 0;
    Eigen::Array2d traction_off(0, 0), traction_change(0, 0); // {normal, shear}, squares
    for (std::size_t back = 1; back <= compared; ++back) {
        const std::size_t one = n_coarser - back, other = n_finer - back;
        for (std::size_t g = 0; g < gridpoints; ++g) {
            const auto& u = finer.states.displacement[other * gridpoints + g];
            off = std::max(off, (coarser.states.displacement[one * gridpoints + g] - u).norm());
            largest = std::max(largest, u.norm());
        }
        for (std::size_t c = 0; c < contacts; ++c) {
            const auto& t = finer.states.traction[other * contacts + c];
            const double length = finer.mesh.contact_length[c];
            traction_off += length * (coarser.states.traction[one * contacts + c] - t).array().square();
            traction_change += length * (t - finer.states.traction[c]).array().square();
        }
    }
    double change = share_of(off, largest);
    for (int i = 0; i < 2; ++i)
        change =
            std::max(change, share_of(std::sqrt(traction_off[i]),
                                      std::sqrt(std::max(traction_change[i], 0.01 * traction_change.sum()))));
    return change;
}

} // namespace jointcreep::analysis
