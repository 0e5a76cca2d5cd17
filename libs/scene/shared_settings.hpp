// Settings that a scene's keys and the command line share: their words, and the ranges of their numbers.

#pragma once

#include "keys/bounds.hpp"
#include "model/quantity.hpp"
#include "model/scene.hpp"

#include <string_view>

namespace jointcreep::scene
{

inline constexpr Range seeds = from(0).to(9007199254740992.0); // 2^53: up to it each whole number is a double
inline constexpr Range zone_sizes = above(0).to(keys::farthest_metre); // [m]
inline constexpr Range equilibrium_tolerances = from(1e-12).to(1e-2);  // [-]
inline constexpr Range numbers_of_increments = from(1).to(1000);
inline constexpr Range increments_tolerances = above(0).to(1);        // [-]
inline constexpr Range creep_steps = above(0).to(keys::farthest_day); // [day]
inline constexpr Range creep_tolerances = above(0).to(1);             // [m]

inline keys::Words<EngineChoice> engine_words()
{
    return {{"auto", EngineChoice::automatic},
            {"relaxation", EngineChoice::relaxation},
            {"implicit", EngineChoice::implicit}};
}
// The word that earlier versions had for one of them, and its word now.
inline constexpr std::string_view former_engine_word = "explicit", engine_word_for_it = "relaxation";

// The command line has "-" in place of " ".
inline keys::Words<CreepScheme> creep_scheme_words()
{
    return {{"auto", CreepScheme::automatic},
            {"published", CreepScheme::published},
            {"backward", CreepScheme::backward},
            {"linear force", CreepScheme::linear_force},
            {"fitted", CreepScheme::fitted}};
}

} // namespace jointcreep::scene
