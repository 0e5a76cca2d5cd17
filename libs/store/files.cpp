#include "store/files.hpp"

#include "model/error.hpp"
#include "store/hdf5.hpp"
#include "store/save.hpp"

#include <fstream>
#include <iterator>
#include <span>

namespace jointcreep::store
{

using fields::append;
using fields::Field;
using fields::Invariant;
using fields::reading;
using schema::Dimensions;
using schema::fields_of;
using schema::invariants_of;

namespace
{

// Runs `work`, putting the file's name before the message of what it throws.
template <class Work>
auto naming(const std::string& path, Work work)
{
    try {
        return work();
    } catch (const input_error& error) {
        throw input_error(path + ": " + error.what());
    } catch (const file_error& error) {
        throw file_error(path + ": " + error.what());
    }
}

// What a file holds, part by part.
struct Contents {
    std::vector<Field> fields;
    std::vector<Invariant> invariants;

    Contents(const Provenance& provenance, const Network& network)
        : fields(fields_of(reading(provenance))), invariants(invariants_of(network))
    {
        append(fields, fields_of(reading(network)));
        if (!provenance.warnings.text.empty())
            add(provenance.warnings);
    }
    void add(const EquivalentJoints& equivalent)
    {
        append(fields, fields_of(reading(equivalent)));
        append(invariants, invariants_of(equivalent));
    }
    void add(const Result& result, bool with_step_history, bool with_dynamics, bool with_guards,
             bool with_failure)
    {
        append(fields, fields_of(reading(result)));
        append(invariants, invariants_of(result.mesh));
        if (with_step_history)
            append(fields, fields_of(reading(result.step_history)));
        if (with_dynamics)
            append(fields, fields_of(reading(result.dynamics)));
        if (with_guards)
            append(fields, fields_of(reading(result.guards)));
        if (with_failure)
            append(fields, fields_of(reading(result.failure)));
    }
    void add(const Checkpoint& checkpoint, bool with_dynamics)
    {
        append(fields, fields_of(reading(checkpoint)));
        if (with_dynamics)
            append(fields, fields_of(reading(checkpoint.dynamics)));
    }
    void add(const Warnings& warnings) { append(fields, fields_of(reading(warnings))); }
    void add(const Safety& safety) { append(fields, fields_of(reading(safety))); }
};

void write(const std::string& path, FileKind kind, const Provenance& provenance, const Contents& contents)
{
    naming(path, [&] {
        Dimensions dimensions;
        if (const schema::Fault fault = schema::fault_in(contents.fields, contents.invariants, dimensions))
            throw file_error("not written: " + *fault);
        if (provenance.program.empty())
            throw file_error("not written: the provenance names no program");

        hdf5::Image image;
        image.set_text("filetype", schema::file_type(kind));
        image.set_integers("format_version", {schema::major_version, schema::minor_version});
        image.set_text("program", provenance.program.back());
        image.set_text("program_version", provenance.version.back());
        image.set_natural("seed", provenance.seed);
        image.set_integers("realization", {provenance.realization});
        for (const Field& field : contents.fields)
            image.add(field, dimensions);
        image.set_integers("complete", {1});
        save(path, image.close());
    });
}

FileKind checked_kind(const hdf5::Source& source)
{
    const std::string type = source.text("filetype");
    const Index major = source.integers("format_version", 2)[0];
    if (!type.starts_with("jointcreep "))
        throw input_error("this is a \"" + type + "\" file; expected one of jointcreep's");
    if (major != schema::major_version)
        throw input_error("the file has format version " + std::to_string(major) +
                          "; this program reads version " + std::to_string(schema::major_version));
    for (const FileKind kind : {FileKind::network, FileKind::joints, FileKind::result, FileKind::checkpoint})
        if (type == schema::file_type(kind)) {
            if (source.integers("complete", 1)[0] != 1)
                throw input_error("the file is not complete");
            return kind;
        }
    throw input_error("this is a \"" + type + "\" file, which this program does not know");
}

// Any kind that holds all of the wanted one will do.
hdf5::Source open(const std::string& path, FileKind kind)
{
    hdf5::Source source(path);
    const FileKind actual = checked_kind(source);
    if (actual < kind)
        throw input_error("this is a \"" + schema::file_type(actual) + "\" file; expected a \"" +
                          schema::file_type(kind) + "\" file, which " + schema::maker(kind) + " makes");
    return source;
}

// What a result file has.
Contents contents_of(const ResultFile& file, const hdf5::Source& source)
{
    Contents contents(file.provenance, file.network);
    contents.add(file.equivalent);
    contents.add(file.result, source.has_group("/step_history"), source.has_group("/dynamics"),
                 source.has_group("/guards"), source.has_group("/failure"));
    if (source.has_group("/safety"))
        contents.add(file.safety);
    return contents;
}

void fill(const hdf5::Source& source, Provenance& provenance, Contents contents)
{
    if (source.has_group("/warnings"))
        contents.add(provenance.warnings);
    provenance.seed = source.natural("seed");
    provenance.realization = source.integers("realization", 1)[0];
    Dimensions dimensions;
    for (const Field& field : contents.fields)
        source.read(field, dimensions);
    if (const schema::Fault fault = schema::fault_in(contents.fields, contents.invariants, dimensions))
        throw input_error(*fault);
}

} // namespace

FileKind kind_of(const std::string& path)
{
    return naming(path, [&] { return checked_kind(hdf5::Source(path)); });
}

std::string reason_of_failure(const std::string& path)
{
    return naming(path, [&] {
        const hdf5::Source source = open(path, FileKind::network);
        Failure failure;
        Dimensions dimensions;
        if (source.has_group("/failure"))
            for (const Field& field : fields_of(failure))
                source.read(field, dimensions);
        return failure.reason;
    });
}

NetworkFile read_network(const std::string& path)
{
    return naming(path, [&] {
        const hdf5::Source source = open(path, FileKind::network);
        NetworkFile file;
        fill(source, file.provenance, Contents(file.provenance, file.network));
        return file;
    });
}

JointsFile read_joints(const std::string& path)
{
    return naming(path, [&] {
        const hdf5::Source source = open(path, FileKind::joints);
        JointsFile file;
        Contents contents(file.provenance, file.network);
        contents.add(file.equivalent);
        fill(source, file.provenance, contents);
        return file;
    });
}

ResultFile read_result(const std::string& path)
{
    return naming(path, [&] {
        const hdf5::Source source = open(path, FileKind::result);
        ResultFile file;
        fill(source, file.provenance, contents_of(file, source));
        return file;
    });
}

CheckpointFile read_checkpoint(const std::string& path)
{
    return naming(path, [&] {
        const hdf5::Source source = open(path, FileKind::checkpoint);
        CheckpointFile file;
        Contents contents = contents_of(file, source);
        contents.add(file.checkpoint, source.has_group("/dynamics_state"));
        fill(source, file.provenance, contents);
        return file;
    });
}

void write_network(const std::string& path, const Provenance& provenance, const Network& network)
{
    write(path, FileKind::network, provenance, Contents(provenance, network));
}

void write_joints(const std::string& path, const Provenance& provenance, const Network& network,
                  const EquivalentJoints& equivalent)
{
    Contents contents(provenance, network);
    contents.add(equivalent);
    write(path, FileKind::joints, provenance, contents);
}

void write_result(const std::string& path, const Provenance& provenance, const Network& network,
                  const EquivalentJoints& equivalent, const Result& result, const Safety& safety)
{
    Contents contents(provenance, network);
    contents.add(equivalent);
    contents.add(result, !result.step_history.time.empty(), !result.dynamics.time.empty(),
                 !result.guards.penetration.empty(), !result.failure.reason.empty());
    if (!safety.factor.empty())
        contents.add(safety);
    write(path, FileKind::result, provenance, contents);
}

void write_checkpoint(const std::string& path, const Provenance& provenance, const Network& network,
                      const EquivalentJoints& equivalent, const Result& so_far, const Checkpoint& checkpoint,
                      const Safety& safety)
{
    Contents contents(provenance, network);
    contents.add(equivalent);
    contents.add(so_far, !so_far.step_history.time.empty(), !so_far.dynamics.time.empty(),
                 !so_far.guards.penetration.empty(), false);
    contents.add(checkpoint, !checkpoint.dynamics.place.empty());
    if (!safety.factor.empty())
        contents.add(safety);
    write(path, FileKind::checkpoint, provenance, contents);
}

void copy(const std::string& from, const std::string& to)
{
    naming(to, [&] {
        std::ifstream file(from, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        if (!file)
            throw file_error("cannot copy " + from);
        save(to, std::as_bytes(std::span(bytes)));
    });
}

} // namespace jointcreep::store
