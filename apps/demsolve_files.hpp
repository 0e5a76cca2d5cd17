// The files that demsolve writes, with where they come from: result.h5, result.failed.h5 and checkpoints.

#pragma once

#include "program.hpp"

#include "analysis/safety.hpp"
#include "store/files.hpp"

#include <optional>
#include <string>

namespace jointcreep::demsolve
{

class Files
{
public:
    // `options` and `end` as the result file records them. A run that ends on another day may go on from the
    // same checkpoint: `end` is no part of what a checkpoint records. Throws where a file could not be
    // written, or would be written over the input or each other.
    Files(const Arguments& arguments, const std::string& program, const store::JointsFile& file,
          std::string options, std::string end);

    void write_result(const analysis::Trial& run, const Safety& safety = {}) const;

    // A run without equilibrium. Returns what to say of it.
    std::string write_failed(const analysis::Trial& run, const Safety& safety = {}) const;

    void write_checkpoint(const std::string& path, double factor, const Result& so_far,
                          const Checkpoint& checkpoint) const;

    // What --checkpoint has kept before, if anything. Throws if a run with this strength factor would not
    // have come by where the checkpoint is, bit by bit, or ends before it.
    std::optional<store::CheckpointFile> kept_before(const Arguments& arguments, const Scene& scene,
                                                     double factor) const;

private:
    void write(const analysis::Trial& run, const Safety& safety, const std::string& path) const;
    void check_same_run(const std::string& path, double factor, const Provenance& kept) const;
    std::string options_of(double factor) const;
    Provenance provenance(const std::string& options) const;

    std::string input_, output_, failed_;
    const store::JointsFile& file_;
    Provenance provenance_;
    std::string options_, end_;
};

} // namespace jointcreep::demsolve
