// Settings that a scene's keys and the command line share: their words, and the ranges of their numbers.

#pragma once

#include "model/quantity.hpp"
#include "model/scene.hpp"

#include <string_view>
#include <utility>
#include <vector>

namespace jointcreep::scene
{

constexpr double farthest_day = 1e6, farthest_metre = 1e6; // from the start, from the origin

inline constexpr Range zone_sizes = above(0).to(farthest_metre);      // [m]
inline constexpr Range equilibrium_tolerances = from(1e-12).to(1e-2); // [-]
inline constexpr Range creep_steps = above(0).to(farthest_day);       // [day]
inline constexpr Range creep_tolerances = above(0).to(1);             // [m]
inline constexpr Range joint_stiffnesses = above(0).to(1e9);          // [MPa/m]

// The words of a choice, each with what it stands for.
template <class Value>
using Words = std::vector<std::pair<std::string_view, Value>>;

inline Words<EngineChoice> engine_words()
{
    return {{"auto", EngineChoice::automatic},
            {"relaxation", EngineChoice::relaxation},
            {"implicit", EngineChoice::implicit}};
}

// The command line has "-" in place of " ".
inline Words<CreepScheme> creep_scheme_words()
{
    return {{"published", CreepScheme::published},
            {"backward", CreepScheme::backward},
            {"linear force", CreepScheme::linear_force},
            {"fitted", CreepScheme::fitted}};
}

} // namespace jointcreep::scene
