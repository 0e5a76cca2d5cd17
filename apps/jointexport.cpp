// jointexport: what a file of the chain holds, in the formats of other tools.
//
//   jointexport result.h5 -o result.vtu                       the zones at the last state, for ParaView
//   jointexport result.h5 -o histories.csv                    the histories of the measuring points
//   jointexport network.h5 -o joints.csv                      the joint traces
//   jointexport result.h5 -o base.vtu --what contacts --state 0
//
// Reads   network.h5, joints.h5 or result.h5   (from jointgen, strength-averaging, demsolve)
// Writes  one .vtu or .csv file                (docs/programs.md lists what is in it)

#include "program.hpp"

#include "exchange/csv.hpp"
#include "exchange/vtu.hpp"
#include "model/error.hpp"
#include "store/files.hpp"
#include "store/save.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <span>

using namespace jointcreep;

namespace
{

// What can be exported, from which files and in which formats.
struct View {
    std::string_view what;
    bool vtu, csv;
    bool of_result; // only a result file has it
};

constexpr std::array<View, 6> views = {{
    {"blocks", true, true, false},
    {"joints", true, true, false},
    {"edges", false, true, false},
    {"zones", true, false, true},
    {"contacts", true, false, true},
    {"histories", false, true, true},
}};

bool is_offered(const View& view, FileKind kind, bool vtu)
{
    return (vtu ? view.vtu : view.csv) && (!view.of_result || kind == FileKind::result);
}

// What is meant when --what is not given.
std::string_view usual(FileKind kind, bool vtu)
{
    if (kind == FileKind::result)
        return vtu ? "zones" : "histories";
    return vtu ? "blocks" : "joints";
}

bool wants_vtu(const std::string& output)
{
    const std::string extension = std::filesystem::path(output).extension().string();
    if (extension != ".vtu" && extension != ".csv")
        throw input_error(output + ": the name must end in .vtu or .csv, which decides the format");
    return extension == ".vtu";
}

std::string chosen(const Arguments& arguments, FileKind kind, bool vtu)
{
    std::string what = arguments.text("what").value_or(std::string(usual(kind, vtu)));
    std::string offered;
    for (const View& view : views) {
        if (!is_offered(view, kind, vtu))
            continue;
        if (view.what == what)
            return what;
        offered.append(offered.empty() ? "" : ", ").append(view.what);
    }
    throw input_error("--what is '" + what + "'; from " + arguments.input() + " a " +
                      (vtu ? ".vtu" : ".csv") + " file can have: " + offered);
}

// The row of the states that is meant: a number, a stage (its state after removal), or the last.
std::size_t chosen_state(const Arguments& arguments, const States& states)
{
    const std::string wanted = arguments.text("state").value_or("last");
    const std::size_t count = states.time.size();
    if (count == 0)
        throw input_error(arguments.input() + ": there is no state in this file");
    if (wanted == "last")
        return count - 1;
    std::size_t row = 0;
    const auto read = std::from_chars(wanted.data(), wanted.data() + wanted.size(), row);
    if (read.ec == std::errc() && read.ptr == wanted.data() + wanted.size() && row < count)
        return row;
    const auto stage = std::find(states.event.begin(), states.event.end(), wanted);
    if (!wanted.empty() && stage != states.event.end())
        return static_cast<std::size_t>(stage - states.event.begin());
    std::string message = "--state is '" + wanted + "'; the states are:";
    for (row = 0; row < count; ++row) {
        message += '\n' + std::to_string(row) + ", day " + shown(states.time[row]);
        if (!states.event[row].empty())
            message += ", after " + states.event[row];
    }
    throw input_error(message);
}

std::string text_of(const Arguments& arguments, FileKind kind, const std::string& what, bool vtu)
{
    const std::string& input = arguments.input();
    if (what == "blocks") {
        const Network network = read_network(input).network;
        return vtu ? blocks_vtu(network) : blocks_csv(network);
    }
    if (what == "joints" && !vtu)
        return joints_csv(read_network(input).network);
    if (what == "joints" || what == "edges") {
        if (kind == FileKind::network) {
            const Network network = read_network(input).network;
            return vtu ? joints_vtu(network, nullptr) : edges_csv(network, nullptr);
        }
        const JointsFile file = read_joints(input);
        return vtu ? joints_vtu(file.network, &file.equivalent) : edges_csv(file.network, &file.equivalent);
    }
    const ResultFile file = read_result(input);
    if (what == "histories")
        return histories_csv(file.result.history);
    const std::size_t state = chosen_state(arguments, file.result.states);
    return what == "zones" ? zones_vtu(file.network, file.result, state) : contacts_vtu(file.result, state);
}

void write(const std::string& path, const std::string& text)
{
    try {
        save(path, std::as_bytes(std::span(text)));
    } catch (const file_error& error) {
        throw file_error(path + ": " + error.what());
    }
}

void export_file(const Arguments& arguments)
{
    if (arguments.has("file-format")) {
        std::cout << schema_markdown();
        return;
    }
    const std::string& input = arguments.input();
    const std::string& output = arguments.output();
    const bool vtu = wants_vtu(output);
    check_writable(output);
    const FileKind kind = kind_of(input);
    if (std::error_code absent; std::filesystem::equivalent(input, output, absent))
        throw input_error(output + ": this is the file to read; it is not overwritten");

    const std::string what = chosen(arguments, kind, vtu);
    if (arguments.has("state") && what != "zones" && what != "contacts")
        throw input_error("--state goes with --what zones or contacts, not with " + what);
    write(output, text_of(arguments, kind, what, vtu));

    if (!arguments.quiet()) {
        Summary summary;
        summary.add(what, output);
        summary.print();
    }
}

} // namespace

int main(int argc, char** argv)
{
    return run(
        {.name = "jointexport",
         .summary = "Writes what a file of the chain holds in the formats of other tools.",
         .input = "FILE.h5",
         .output = "NAME.EXT",
         .options = {{"what", "NAME",
                      "blocks (.vtu, .csv), joints (.vtu, .csv), edges (.csv); from a result file also "
                      "zones (.vtu), contacts (.vtu), histories (.csv). Default: zones or histories from "
                      "a result file, blocks or joints from others"},
                     {"state", "STATE",
                      "of zones and contacts: its number, counted from 0, the stage that it follows, or "
                      "last (default)"},
                     {"file-format", "", "show the format of the HDF5 files of the chain, and no more"}},
         .example = "jointexport result.h5 -o zones.vtu --state \"block 2 removed\""},
        argc, argv, export_file);
}
