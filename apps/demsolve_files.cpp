#include "demsolve_files.hpp"

#include "demsolve_summary.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "model/version.hpp"

#include <filesystem>

namespace jointcreep::demsolve
{

using analysis::Trial;

Files::Files(const Arguments& arguments, const std::string& program, const store::JointsFile& file,
             std::string options, std::string end)
    : input_(arguments.input()), output_(arguments.output()), failed_(failed_name(output_)), file_(file),
      provenance_(file.provenance), options_(std::move(options)), end_(std::move(end))
{
    store::check_writable(output_);
    std::vector<NamedFile> written = arguments.files({"output", "checkpoint"});
    written.push_back({failed_, failed_ + ", which a run without equilibrium writes,"});
    refuse_overwriting(arguments.files({"input"}), written);
    provenance_.program.push_back(program);
    provenance_.version.emplace_back(version());
    provenance_.input_sha256.push_back(store::sha256_of(input_));
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
    std::string options = options_of(run.factor());
    if (!end_.empty())
        options += (options.empty() ? "" : " ") + end_;
    Provenance with_warnings = provenance(options);
    for (const std::string& warning : warnings_of(run))
        with_warnings.warnings.add(with_warnings.program.back(), warning);
    store::write_result(path, with_warnings, file_.network, file_.equivalent, run.analysis().result(),
                        safety);
}

void Files::write_checkpoint(const std::string& path, double factor, const Result& so_far,
                             const Checkpoint& checkpoint) const
{
    store::write_checkpoint(path, provenance(options_of(factor)), file_.network, file_.equivalent, so_far,
                            checkpoint);
}

std::optional<store::CheckpointFile> Files::kept_before(const Arguments& arguments, const Scene& scene,
                                                        double factor) const
{
    const auto path = arguments.text("checkpoint");
    if (!path)
        return {};
    store::check_writable(*path);
    if (!std::filesystem::exists(*path))
        return {};
    store::CheckpointFile kept = store::read_checkpoint(*path);
    check_same_run(*path, factor, kept.provenance);
    if (kept.checkpoint.time > scene.end)
        throw input_error(*path + ": /checkpoint/time is day " + shown(kept.checkpoint.time / unit::day) +
                          "; wanted not after --until " + shown(scene.end / unit::day));
    return kept;
}

void Files::check_same_run(const std::string& path, double factor, const Provenance& kept) const
{
    const Provenance here = provenance(options_of(factor));
    const auto check = [&](const char* dataset, const std::vector<std::string>& of_kept,
                           const std::vector<std::string>& of_here, const std::string& wanted) {
        if (of_kept != of_here)
            throw input_error(path + ": " + dataset + " is \"" + (of_kept.empty() ? "" : of_kept.back()) +
                              "\"; wanted " + wanted + ". Delete the checkpoint to begin anew");
    };
    check("/provenance/input_sha256", kept.input_sha256, here.input_sha256,
          "that of " + input_ + ", \"" + here.input_sha256.back() + '"');
    check("/provenance/version", kept.version, here.version,
          "\"" + here.version.back() + "\", this program's, as another one may compute otherwise");
    check("/provenance/options", kept.options, here.options,
          "the same options, \"" + here.options.back() + '"');
}

std::string Files::options_of(double factor) const
{
    std::string options = factor == 1 ? "" : "--strength-factor " + shown(factor);
    if (!options.empty() && !options_.empty())
        options += ' ';
    return options + options_;
}

Provenance Files::provenance(const std::string& options) const
{
    Provenance provenance = provenance_;
    provenance.options.push_back(options);
    return provenance;
}

} // namespace jointcreep::demsolve
