#include "joint/strength_factor.hpp"

#include <cmath>

namespace jointcreep::joint
{

EquivalentJoints with_strength_divided(EquivalentJoints joints, double factor)
{
    for (std::vector<double>* strength :
         {&joints.cohesion, &joints.tensile_strength, &joints.residual_cohesion})
        for (double& value : *strength)
            value /= factor;
    for (std::vector<double>* angle :
         {&joints.friction_angle, &joints.dilation_angle, &joints.residual_friction_angle})
        for (double& value : *angle)
            value = std::atan(std::tan(value) / factor);
    return joints;
}

} // namespace jointcreep::joint
