#include "joint/strength_factor.hpp"

#include <cmath>

namespace jointcreep::joint
{

namespace
{

void divide_tangent(double& angle, double factor)
{
    angle = std::atan(std::tan(angle) / factor);
}

} // namespace

EquivalentJoints with_strength_divided(EquivalentJoints joints, double factor)
{
    for (std::vector<double>* strength :
         {&joints.cohesion, &joints.tensile_strength, &joints.residual_cohesion})
        for (double& value : *strength)
            value /= factor;
    for (std::vector<double>* angle : {&joints.dilation_angle, &joints.residual_friction_angle})
        for (double& value : *angle)
            divide_tangent(value, factor);
    for (std::size_t e = 0; e < joints.friction_angle.size(); ++e)
        if (joints.law[e] != static_cast<Index>(JointLaw::barton_bandis))
            divide_tangent(joints.friction_angle[e], factor);
    joints.strength_divisor *= factor;
    return joints;
}

Scene with_strength_divided(Scene scene, double factor)
{
    for (Rock& rock : scene.rocks) {
        if (rock.strength) {
            rock.strength->cohesion /= factor;
            rock.strength->tensile_strength /= factor;
            divide_tangent(rock.strength->friction_angle, factor);
        }
        divide_tangent(rock.dilation_angle, factor);
    }
    for (JointMaterial& material : scene.joint_materials) {
        if (material.walls)
            material.walls->strength_divisor *= factor;
        else
            divide_tangent(material.friction_angle, factor);
        if (material.residual)
            divide_tangent(material.residual->friction_angle, factor);
    }
    return scene;
}

} // namespace jointcreep::joint
