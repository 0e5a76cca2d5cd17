#include "demsolve_files.hpp"

#include "demsolve_summary.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "model/version.hpp"

#include <filesystem>

namespace jointcreep::demsolve
{

using analysis::Trial;

namespace
{

// Options, one behind the other; either may be none.
std::string joined(const std::string& options, const std::string& more)
{
    return options + (options.empty() || more.empty() ? "" : " ") + more;
}

// "kept.stands.h5" for "kept.h5".
std::string name_of_run(const std::string& checkpoint, bool stands)
{
    return name_beside(checkpoint, stands ? "stands" : "falls");
}

} // namespace

Files::Files(const Arguments& arguments, const std::string& program, const store::JointsFile& file,
             std::string options, std::string end)
    : input_(arguments.input()), output_(arguments.output()), failed_(failed_name(output_)),
      checkpoint_(arguments.text("checkpoint").value_or("")), is_quiet_(arguments.quiet()), file_(file),
      provenance_(file.provenance), options_(std::move(options)), end_(std::move(end))
{
    store::check_writable(output_);
    store::check_writable(failed_);
    std::vector<NamedFile> written = arguments.files({"output", "checkpoint"});
    written.push_back({failed_, failed_ + ", which a run without equilibrium writes,"});
    if (has_checkpoint() && arguments.has("factor-of-safety"))
        for (const bool stands : {true, false}) {
            const std::string name = name_of_run(checkpoint_, stands);
            written.push_back({name, name + ", which a search with --checkpoint writes,"});
        }
    refuse_overwriting(arguments.files({"input"}), written);
    provenance_.program.push_back(program);
    provenance_.version.emplace_back(version());
    provenance_.input_sha256.push_back(store::sha256_of(input_));
}

void Files::say(const std::string& text) const
{
    if (!is_quiet_)
        print_line(provenance_.program.back(), text);
}

void Files::warn(const std::string& text)
{
    const std::string& program = provenance_.program.back();
    print_warning(program, text);
    provenance_.warnings.add(program, text);
}

void Files::write_result(const Trial& run, const Safety& safety) const
{
    write(run, safety, output_);
}

std::string Files::write_failed(const Trial& run, const Safety& safety) const
{
    if (std::error_code none;
        std::filesystem::exists(output_, none) && !std::filesystem::is_regular_file(output_, none))
        return ""; // a device, say: it has no neighbours
    try {
        write(run, safety, failed_);
        return "the run up to there is in " + failed_;
    } catch (const file_error& error) {
        return std::string("the run up to there is lost: ") + error.what();
    }
}

void Files::write(const Trial& run, const Safety& safety, const std::string& path) const
{
    std::string options = options_of({run.factor(), {}});
    if (run.scene().equilibrium.increments_tolerance) // chosen: each file is that of a run with its number
        options =
            joined(options, "--increments " + std::to_string(run.scene().equilibrium.unloading_increments));
    Provenance with_warnings = provenance(joined(options, end_));
    for (const std::string& warning : warnings_of(run))
        with_warnings.warnings.add(with_warnings.program.back(), warning);
    store::write_result(path, with_warnings, file_.network, file_.equivalent, run.analysis().result(),
                        safety);
}

void Files::write_checkpoint(const StrengthReduction& reduction, const Result& so_far,
                             const Checkpoint& checkpoint, const Safety& runs_before) const
{
    store::write_checkpoint(checkpoint_, provenance(options_of(reduction)), file_.network, file_.equivalent,
                            so_far, checkpoint, runs_before);
    stop_if_asked(provenance_.program.back(), "stopped; the same command continues from " + checkpoint_);
}

void Files::keep_last_checkpoint(bool stands) const
{
    if (has_checkpoint())
        store::copy(checkpoint_, name_of_run(checkpoint_, stands));
}

std::optional<store::CheckpointFile> Files::kept_run(bool stands, std::size_t number, const Scene& scene,
                                                     const StrengthReduction& reduction) const
{
    auto kept = kept_in(name_of_run(checkpoint_, stands), scene, reduction);
    if (kept && kept->safety.factor.size() != number)
        kept.reset();
    return kept;
}

std::optional<store::CheckpointFile> Files::kept_in(const std::string& path, const Scene& scene,
                                                    const StrengthReduction& reduction) const
{
    if (!has_checkpoint())
        return {};
    store::check_writable(path);
    if (!std::filesystem::exists(path))
        return {};
    store::CheckpointFile kept = store::read_checkpoint(path);
    check_same_run(path, reduction, kept.provenance);
    if (kept.checkpoint.time > scene.end)
        throw input_error(path + ": /checkpoint/time is day " + shown(kept.checkpoint.time / unit::day) +
                          "; expected not after --until " + shown(scene.end / unit::day));
    return kept;
}

void Files::check_same_run(const std::string& path, const StrengthReduction& reduction,
                           const Provenance& kept) const
{
    const Provenance here = provenance(options_of(reduction));
    const auto check = [&](const char* dataset, const std::vector<std::string>& of_kept,
                           const std::vector<std::string>& of_here, const std::string& wanted) {
        if (of_kept != of_here)
            throw input_error(path + ": " + dataset + " is \"" + (of_kept.empty() ? "" : of_kept.back()) +
                              "\"; expected " + wanted + ". Delete the checkpoint to start again");
    };
    check("/provenance/input_sha256", kept.input_sha256, here.input_sha256,
          "that of " + input_ + ", \"" + here.input_sha256.back() + '"');
    check("/provenance/version", kept.version, here.version,
          "\"" + here.version.back() +
              "\", the version of this program: another version may have other "
              "results");
    check("/provenance/options", kept.options, here.options,
          "the same options, \"" + here.options.back() + '"');
}

std::string Files::options_of(const StrengthReduction& reduction) const
{
    return joined(reduction.text(), options_);
}

Provenance Files::provenance(const std::string& options) const
{
    Provenance provenance = provenance_;
    provenance.options.push_back(options);
    return provenance;
}

} // namespace jointcreep::demsolve
