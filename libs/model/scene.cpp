#include "model/scene.hpp"

#include <algorithm>

namespace jointcreep
{

double InSituStress::depth_of(const Eigen::Vector2d& place) const
{
    if (ground.empty())
        return elevation - place.y();
    const auto after = std::find_if(ground.begin(), ground.end(),
                                    [&](const Eigen::Vector2d& corner) { return corner.x() > place.x(); });
    if (after == ground.begin() || after == ground.end())
        return (after == ground.begin() ? ground.front() : ground.back()).y() - place.y();
    const Eigen::Vector2d before = *(after - 1), run = *after - before;
    return before.y() + run.y() * (place.x() - before.x()) / run.x() - place.y();
}

Eigen::Vector3d InSituStress::at(const Eigen::Vector2d& place) const
{
    const double depth = depth_of(place);
    if (profile.empty())
        return {-(compression_xx + gradient_xx * depth), -(compression_yy + gradient_yy * depth),
                shear_xy + gradient_xy * depth};
    const auto deeper = std::find_if(profile.begin() + 1, profile.end() - 1,
                                     [&](const Level& level) { return level.depth > depth; });
    const Level &low = *deeper, &high = *(deeper - 1);
    const double part = (depth - high.depth) / (low.depth - high.depth);
    const auto between = [part](double above, double below) { return above + (below - above) * part; };
    return {-between(high.compression_xx, low.compression_xx),
            -between(high.compression_yy, low.compression_yy), between(high.shear_xy, low.shear_xy)};
}

void InSituStress::multiply_horizontal(double factor)
{
    compression_xx *= factor;
    gradient_xx *= factor;
    for (Level& level : profile)
        level.compression_xx *= factor;
}

bool Scene::has_rock_that_yields() const
{
    return std::ranges::any_of(rocks, [](const Rock& one) { return one.law == RockLaw::mohr_coulomb; });
}

bool Scene::zones_are_quadratic() const
{
    if (asks_for_quadratic_zones)
        return *asks_for_quadratic_zones;
    const bool is_implicit =
        equilibrium.engine != EngineChoice::relaxation && equilibrium.masses != Masses::real;
    return is_implicit && !large_displacements &&
           (has_rock_that_yields() || (joint_sets.empty() && mapped.empty()));
}

} // namespace jointcreep
