// The one list of everything in a file. Writing, reading, checking and docs/file-format.md all follow it: a
// new member of a record needs a line here, and no more. What belongs to a kind of force is listed in the
// folder of that force, and added here by store/forces.hpp.

#pragma once

#include "fields/fields.hpp"
#include "model/network.hpp"
#include "model/provenance.hpp"
#include "model/result.hpp"
#include "store/files.hpp"

namespace jointcreep::store::schema
{

inline constexpr Index major_version = 2, minor_version = 9;

// The fields point into the record. A record that is only read may be given too, as `fields::reading(record)`.
// Own rows and those of the forces that have a part in the record (store/forces.hpp).
std::vector<fields::Field> fields_of(Provenance& provenance); // without its warnings
std::vector<fields::Field> fields_of(Warnings& warnings);
std::vector<fields::Field> fields_of(Network& network);
std::vector<fields::Field> fields_of(EquivalentJoints& equivalent);
// Without its step history, dynamics, guards and failure.
std::vector<fields::Field> fields_of(Result& result);
std::vector<fields::Field> fields_of(StepHistory& step_history);
std::vector<fields::Field> fields_of(DynamicsHistory& dynamics);
std::vector<fields::Field> fields_of(GuardHistory& guards);
std::vector<fields::Field> fields_of(Failure& failure);
std::vector<fields::Field> fields_of(Safety& safety);
std::vector<fields::Field> fields_of(Checkpoint& checkpoint); // without the state of a dynamic analysis
std::vector<fields::Field> fields_of(DynamicsState& state);

// The dimension scale of the axis component of the history; only written. Fills the names.
fields::Field component_of_history(std::vector<std::string>& names);

// To be checked only when the fields are within their limits. They refer to the record.
std::vector<fields::Invariant> invariants_of(const Network& network);
std::vector<fields::Invariant> invariants_of(const EquivalentJoints& joints);
std::vector<fields::Invariant> invariants_of(const Mesh& mesh);

// Dimensions, with what one row of each is.
const std::vector<fields::Described>& dimensions();

// Attributes of the file itself.
const std::vector<fields::Described>& root_attributes();

// "jointcreep network" and so on; and the program that makes such a file.
std::string file_type(FileKind kind);
std::string maker(FileKind kind);

} // namespace jointcreep::store::schema
