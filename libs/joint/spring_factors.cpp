#include "joint/spring_factors.hpp"

namespace jointcreep::joint
{

namespace
{

void multiply(double factor, auto&... lists)
{
    const auto one = [factor](std::vector<double>& list) {
        for (double& value : list)
            value *= factor;
    };
    (one(lists), ...);
}

} // namespace

void multiply_stiffness(EquivalentJoints& joints, double factor)
{
    multiply(factor, joints.normal_stiffness, joints.shear_stiffness);
    multiply_kelvin_stiffness(joints, factor);
    multiply_viscosity(joints, factor);
}

void multiply_kelvin_stiffness(EquivalentJoints& joints, double factor)
{
    multiply(factor, joints.normal_kelvin_stiffness, joints.shear_kelvin_stiffness);
}

void multiply_viscosity(EquivalentJoints& joints, double factor)
{
    multiply(factor, joints.normal_kelvin_viscosity, joints.shear_kelvin_viscosity,
             joints.normal_maxwell_viscosity, joints.shear_maxwell_viscosity);
}

} // namespace jointcreep::joint
