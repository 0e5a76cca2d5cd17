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
    // `options` and `end` as the result file records them. A run with another `end` may continue from the same
    // checkpoint: checkpoints do not record it. Throws where a file could not be written, or would be written over
    // the input or another output.
    Files(const Arguments& arguments, const std::string& program, const store::JointsFile& file,
          std::string options, std::string end);

    // Says a warning at once, and writes it into all files from now on.
    void warn(const std::string& text);

    void write_result(const analysis::Trial& run, const Safety& safety = {}) const;

    // Writes a run without equilibrium. Returns the line of the message that says where it is.
    std::string write_failed(const analysis::Trial& run, const Safety& safety = {}) const;

    void write_checkpoint(const std::string& path, double factor, const Result& so_far,
                          const Checkpoint& checkpoint) const;

    // The checkpoint of an earlier run, if there is one. Throws if a run with this strength factor would not reach the
    // same state, bit by bit, or would end before it.
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
