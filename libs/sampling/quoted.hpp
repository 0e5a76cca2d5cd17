// A joint set as messages name it.

#pragma once

#include "model/scene.hpp"

#include <string>

namespace jointcreep::sampling
{

inline std::string quoted(const JointSet& set)
{
    return "joint set \"" + set.name + "\"";
}

} // namespace jointcreep::sampling
