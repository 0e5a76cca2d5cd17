// What one kind of force keeps in files: its rows of the records that forces share, and its dimensions. The
// owner of the files puts those of all forces after its own.
//
//     fields::ForceFields fields_in_files()
//     {
//         return {.dimensions = {{"contact", "a pair of gridpoints ..."}}, .mesh = fields_of};
//     }

#pragma once

#include "fields/fields.hpp"
#include "model/checkpoint.hpp"
#include "model/network.hpp"
#include "model/result.hpp"

namespace jointcreep::fields
{

// The rows that a force has of a record, and what must hold between their values. They refer to the record.
template <class Record>
using RowsOf = std::vector<Field> (*)(Record&);
template <class Record>
using InvariantsOf = std::vector<Invariant> (*)(const Record&);

// Any may be none.
struct ForceFields {
    std::vector<Described> dimensions{}; // those of its rows that nobody else has
    RowsOf<Network> network = nullptr;
    RowsOf<EquivalentJoints> equivalent_joints = nullptr;
    InvariantsOf<EquivalentJoints> invariants_of_equivalent_joints = nullptr;
    RowsOf<Mesh> mesh = nullptr;
    InvariantsOf<Mesh> invariants_of_mesh = nullptr;
    RowsOf<States> states = nullptr;
    RowsOf<StepHistory> step_history = nullptr;
    RowsOf<DynamicsHistory> dynamics = nullptr;
    RowsOf<Checkpoint> checkpoint = nullptr;
    RowsOf<DynamicsState> dynamics_state = nullptr;
};

} // namespace jointcreep::fields
