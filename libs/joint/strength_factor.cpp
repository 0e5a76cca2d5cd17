#include "joint/strength_factor.hpp"

#include "joint/law.hpp"
#include "model/strength_factor.hpp"

namespace jointcreep::joint
{

namespace
{

void divide(double& value, const Parameter& parameter, double factor)
{
    switch (parameter.with_strength_divided) {
    case WithStrengthDivided::same:
        break;
    case WithStrengthDivided::value:
        value /= factor;
        break;
    case WithStrengthDivided::tangent:
        divide_tangent(value, factor);
        break;
    }
}

} // namespace

EquivalentJoints with_strength_divided(EquivalentJoints joints, double factor)
{
    for (std::size_t law = 0; law < laws().size(); ++law)
        for (const Parameter& parameter : laws()[law].parameters) {
            if (parameter.with_strength_divided == WithStrengthDivided::same)
                continue;
            std::vector<double>& values = parameter.in(joints);
            for (std::size_t e = 0; e < values.size(); ++e)
                if (joints.law[e] == static_cast<Index>(law))
                    divide(values[e], parameter, factor);
        }
    joints.strength_divisor *= factor;
    return joints;
}

std::vector<JointMaterial> with_strength_divided(std::vector<JointMaterial> materials, double factor)
{
    for (JointMaterial& material : materials) {
        for (const Parameter& parameter : laws()[static_cast<std::size_t>(material.law)].parameters)
            if (parameter.with_strength_divided != WithStrengthDivided::same)
                divide(parameter.in(material), parameter, factor);
        material.strength_divisor *= factor;
    }
    return materials;
}

} // namespace jointcreep::joint
