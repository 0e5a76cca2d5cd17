// The files of the chain: records to HDF5 and back. docs/file-format.md describes what is in them.
//
// A joints file holds all of a network file, and a result file all of a joints file. A file appears under its
// name only when it is complete, and equal records give equal bytes. Readers check everything that the schema
// declares. HDF5 is not thread-safe: call these functions from one thread only.
//
// Errors: file_error when a file cannot be read or written, input_error when it is readable but not what was
// wanted. A program that uses these should ignore SIGXFSZ, so that a file size limit becomes a file_error.

#pragma once

#include "model/checkpoint.hpp"
#include "model/network.hpp"
#include "model/provenance.hpp"
#include "model/result.hpp"

#include <string>

namespace jointcreep::store
{

enum class FileKind { network, joints, result, checkpoint }; // each holds all of the one before

struct NetworkFile {
    Provenance provenance;
    Network network;
};

struct JointsFile : NetworkFile {
    EquivalentJoints equivalent;
};

struct ResultFile : JointsFile {
    Result result;
    Safety safety;
};

struct CheckpointFile : ResultFile {
    Checkpoint checkpoint;
};

// What the file says it is, after checking that this program understands its version and that it is complete.
FileKind kind_of(const std::string& path);

// Why the run that made the file ended early; empty if it did not.
std::string reason_of_failure(const std::string& path);

// Each reads its own kind of file, and what it needs from the kinds that hold more.
NetworkFile read_network(const std::string& path);
JointsFile read_joints(const std::string& path);
ResultFile read_result(const std::string& path);
CheckpointFile read_checkpoint(const std::string& path);

// The records must keep to the schema too. What was under `path` stays if writing fails. The step
// history, warnings, the failure and the runs of a factor of safety are written only if there are any.
void write_network(const std::string& path, const Provenance& provenance, const Network& network);
void write_joints(const std::string& path, const Provenance& provenance, const Network& network,
                  const EquivalentJoints& equivalent);
void write_result(const std::string& path, const Provenance& provenance, const Network& network,
                  const EquivalentJoints& equivalent, const Result& result, const Safety& safety = {});
void write_checkpoint(const std::string& path, const Provenance& provenance, const Network& network,
                      const EquivalentJoints& equivalent, const Result& so_far, const Checkpoint& checkpoint,
                      const Safety& safety = {});

// Copies a file, whole or not at all.
void copy(const std::string& from, const std::string& to);

// Throws file_error if a file could not be written there later; for the start of a long run.
void check_writable(const std::string& path);

// Hexadecimal SHA-256 of the file's bytes.
std::string sha256_of(const std::string& path);

// docs/file-format.md, made from the schema.
std::string schema_markdown();

} // namespace jointcreep::store
