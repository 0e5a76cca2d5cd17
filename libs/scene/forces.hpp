// The kinds of force that a scene speaks of: this is the one list of them. Each has a folder of its own.
//
// To add one: write its scene_keys(), and add it to the list. The reading of scenes, the checks of its tables,
// docs/scene.md and the key list follow. Checks that concern more than one of them are in scene_checks.cpp.

#pragma once

#include "boundary/scene_keys.hpp"
#include "joint/scene_keys.hpp"
#include "rock/scene_keys.hpp"

namespace jointcreep::scene
{

// In the order in which their tables are read and documented.
inline const std::vector<keys::ForceKeys<Scene>>& forces()
{
    static const std::vector<keys::ForceKeys<Scene>> all{rock::scene_keys(), joint::scene_keys(),
                                                         boundary::scene_keys()};
    return all;
}

} // namespace jointcreep::scene
