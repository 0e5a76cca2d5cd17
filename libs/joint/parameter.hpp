// Parameters of joint laws. A law's header lists its own parameters in a table. A parameter's row gives all uses of it:
// the scene's key with its check, the dataset, the column in exports, strength averaging with rock bridges, and the
// division of strengths.

#pragma once

#include "model/network.hpp"
#include "model/quantity.hpp"
#include "model/scene.hpp"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::joint
{

// The parameter's value on an edge with rock bridges. The share k of the edge is joint (joint/equivalent.hpp).
enum class WithBridges {
    spring,  // a stiffness: by the scene's stiffness rule; of parameters of all joints only
    mean,    // k times the joint's and 1 - k times the rock's, for an angle of its tangent; of parameters of all joints only
    share,   // k times the joint's: bridges count as 0
    weaker,  // of a friction angle: the joint's own, or the mean friction angle if that is less
    own,     // the joint's own
    refused, // no average with rock: such joints must have no bridges
};

// The parameter's value under a strength factor F.
enum class WithStrengthDivided {
    same,
    value,   // divided by F
    tangent, // an angle: its tangent is divided by F
};

struct Parameter {
    std::string_view name; // of its dataset under /equivalent, and of its column
    std::string_view key;  // in [[joint_material]]
    KeyUnit unit;          // of the key; files have SI units
    Range range;           // of the key, in its unit
    WithBridges with_bridges;
    WithStrengthDivided with_strength_divided;
    std::string_view meaning;
    std::optional<double> otherwise{}; // the default, in the key's unit; none: the scene must give it
    // Where its values are, for parameters of all joints; else they are among the own parameters of the law.
    double JointMaterial::*in_material = nullptr;
    std::vector<double> EquivalentJoints::*in_joints = nullptr;

    double of(const JointMaterial& material) const
    {
        if (in_material)
            return material.*in_material;
        const auto found = material.own.find(name);
        return found == material.own.end() ? 0.0 : found->second;
    }
    double& in(JointMaterial& material) const
    {
        return in_material ? material.*in_material : material.own[std::string(name)];
    }
    std::vector<double>& in(EquivalentJoints& joints) const
    {
        return in_joints ? joints.*in_joints : joints.own[std::string(name)];
    }
    double of(const EquivalentJoints& joints, std::size_t edge) const
    {
        if (in_joints)
            return (joints.*in_joints)[edge];
        const auto found = joints.own.find(name);
        return found == joints.own.end() ? 0.0 : found->second[edge];
    }
    std::string si_unit() const { return std::string(unit.si); }
    bool is_angle() const { return unit.symbol == degrees.symbol; }
};

// The same parameter with other rules for bridges and strength factors, in a law of its own.
inline Parameter changed(Parameter parameter, WithBridges with_bridges, WithStrengthDivided divided)
{
    parameter.with_bridges = with_bridges;
    parameter.with_strength_divided = divided;
    return parameter;
}

// An error that a law finds in a material: the wrong key and the expected value.
struct Complaint {
    Parameter parameter;
    std::string wanted;
};

// The value of a parameter, in SI units.
using ValueOf = std::function<double(const Parameter&)>;

// Properties of a law for scene keys, pages and checks.
struct LawInfo {
    std::string_view name;             // as in messages: "Barton-Bandis"
    std::string_view about;            // in a few words, for the pages of keys and files
    std::vector<Parameter> parameters; // all of them
    // Names of those that make a material one of this law: the scene gives all of them or none.
    std::vector<std::string_view> own;
    bool creeps = true; // whether creep may act in series with its springs
    // Why sensitivities refuse such joints: "their ..."; empty: they do not.
    std::string_view no_sensitivities{};
    // Checks a material, and the equivalent joint of it with rock bridges.
    std::function<std::optional<Complaint>(const ValueOf&)> check{};
};

} // namespace jointcreep::joint
