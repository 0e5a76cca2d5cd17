// The files that demsolve writes, with where they come from: result.h5, result.failed.h5 and checkpoints.

#pragma once

#include "demsolve_settings.hpp"
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

    // Says a line at once, unless --quiet.
    void say(const std::string& text) const;
    // Ends the program by the signal that has asked it to stop, if one has, with this line.
    void stop(const std::string& text) const { stop_if_asked(provenance_.program.back(), text); }
    // Says a warning at once, and writes it into all files from now on.
    void warn(const std::string& text);
    // How many.
    std::size_t warnings_said() const
    {
        return provenance_.warnings.text.size() - file_.provenance.warnings.text.size();
    }

    void write_result(const analysis::Trial& run, const Safety& safety = {}) const;

    // Writes a run without equilibrium. Returns the line of the message that says where it is.
    std::string write_failed(const analysis::Trial& run, const Safety& safety = {}) const;

    bool has_checkpoint() const { return !checkpoint_.empty(); }
    const std::string& checkpoint() const { return checkpoint_; } // its file, or ""
    // Of a search for a factor of safety, with the runs before.
    void write_checkpoint(const StrengthReduction& reduction, const Result& so_far,
                          const Checkpoint& checkpoint, const Safety& runs_before = {}) const;

    // The checkpoint of an earlier run, if there is one. Throws if this run would not reach the same state, bit by bit,
    // or would end before it.
    std::optional<store::CheckpointFile> kept_before(const Scene& scene,
                                                     const StrengthReduction& reduction) const
    {
        return kept_in(checkpoint_, scene, reduction);
    }

    // A run of a search has ended: its last checkpoint stays, beside that of the next run, to make the run again.
    void keep_last_checkpoint(bool stands) const;
    // That checkpoint, if it is the run's with this number.
    std::optional<store::CheckpointFile> kept_run(bool stands, std::size_t number, const Scene& scene,
                                                  const StrengthReduction& reduction) const;

private:
    void write(const analysis::Trial& run, const Safety& safety, const std::string& path) const;
    std::optional<store::CheckpointFile> kept_in(const std::string& path, const Scene& scene,
                                                 const StrengthReduction& reduction) const;
    void check_same_run(const std::string& path, const StrengthReduction& reduction,
                        const Provenance& kept) const;
    std::string options_of(const StrengthReduction& reduction) const;
    Provenance provenance(const std::string& options) const;

    std::string input_, output_, failed_;
    std::string checkpoint_; // or ""
    bool is_quiet_;
    const store::JointsFile& file_;
    Provenance provenance_;
    std::string options_, end_;
};

} // namespace jointcreep::demsolve
