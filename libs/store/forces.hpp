// The kinds of force that keep something in files: this is the one list of them. Each has a folder of its own.
//
// To add one: write its fields_in_files(), and add it to the list. Writing, reading, checking and
// docs/file-format.md follow.

#pragma once

#include "boundary/fields.hpp"
#include "joint/fields.hpp"
#include "rock/fields.hpp"

namespace jointcreep::store
{

// In the order in which their rows are written and documented.
inline const std::vector<fields::ForceFields>& forces()
{
    static const std::vector<fields::ForceFields> all{rock::fields_in_files(), boundary::fields_in_files(),
                                                      joint::fields_in_files()};
    return all;
}

} // namespace jointcreep::store
