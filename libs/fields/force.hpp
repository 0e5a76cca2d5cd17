// What one kind of force keeps in files: its rows of the records that forces share, and its dimensions. The
// owner of the files puts those of all forces after its own.
//
//     fields::ForceFields fields_in_files()
//     {
//         return {.dimensions = {{"contact", "a pair of gridpoints ..."}}, .mesh = {fields_of, invariants_of}};
//     }

#pragma once

#include "fields/fields.hpp"
#include "model/checkpoint.hpp"
#include "model/network.hpp"
#include "model/result.hpp"

namespace jointcreep::fields
{

// The rows that a force has of a record, and what must hold between their values; either may be none.
template <class Record>
struct Part {
    std::vector<Field> (*fields)(Record&) = nullptr;
    std::vector<Invariant> (*invariants)(const Record&) = nullptr; // they refer to the record
};

struct ForceFields {
    std::vector<Described> dimensions{}; // those of its rows that nobody else has
    Part<EquivalentJoints> equivalent_joints{};
    Part<Mesh> mesh{};
    Part<States> states{};
    Part<DynamicsHistory> dynamics{};
    Part<Checkpoint> checkpoint{};
    Part<DynamicsState> dynamics_state{};
};

} // namespace jointcreep::fields
