// jointexport: writes the content of a file of the chain in the formats of other tools.
//
//   jointexport result.h5 -o result.xdmf2                     the zones at all states, for ParaView
//   jointexport result.h5 -o result.vtu                       the zones at the last state
//   jointexport result.h5 -o histories.csv                    the histories of the monitoring points
//   jointexport network.h5 -o joints.csv                      the joint traces
//   jointexport result.h5 -o base.vtu --what contacts --state 0
//
// Reads   network.h5, joints.h5 or result.h5   (from jointgen, strength-averaging, demsolve)
// Writes  one .vtu, .xdmf2 or .csv file        (docs/programs.md lists what is in it)

#include "program.hpp"

#include "exchange/csv.hpp"
#include "exchange/vtu.hpp"
#include "exchange/xdmf.hpp"
#include "model/error.hpp"
#include "store/files.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <iostream>

using namespace jointcreep;

namespace
{

// What can be exported, in which formats, and from which files.
struct View {
    std::string_view what;
    std::string_view formats;
    bool of_result; // only a result file has it
};

constexpr std::array<View, 6> views = {{
    {"blocks", ".vtu .csv", false},
    {"joints", ".vtu .csv", false},
    {"edges", ".csv", false},
    {"zones", ".vtu .xdmf", true},
    {"contacts", ".vtu .xdmf", true},
    {"histories", ".csv", true},
}};

bool is_offered(const View& view, store::FileKind kind, const std::string& format)
{
    return view.formats.find(format) != std::string_view::npos &&
           (!view.of_result || kind >= store::FileKind::result);
}

// The default of --what.
std::string_view usual(store::FileKind kind, const std::string& format)
{
    if (kind >= store::FileKind::result)
        return format == ".csv" ? "histories" : "zones";
    return format == ".csv" ? "joints" : "blocks";
}

// ".vtu", ".xdmf" or ".csv".
std::string format_of(const std::string& output)
{
    const std::string extension = std::filesystem::path(output).extension().string();
    if (extension == ".xdmf2") // so ParaView takes the right reader without asking
        return ".xdmf";
    if (extension != ".vtu" && extension != ".xdmf" && extension != ".csv")
        throw input_error(output +
                          ": the name must end in .vtu, .xdmf2, .xdmf or .csv, which decides the format");
    return extension;
}

std::string chosen(const Arguments& arguments, store::FileKind kind, const std::string& format)
{
    const std::string what = arguments.text("what").value_or(std::string(usual(kind, format)));
    std::string offered;
    for (const View& view : views) {
        if (!is_offered(view, kind, format))
            continue;
        if (view.what == what)
            return what;
        offered.append(offered.empty() ? "" : ", ").append(view.what);
    }
    if (offered.empty())
        throw input_error(arguments.input() + ": a " + format +
                          " file shows states, and only a result file "
                          "has them");
    throw input_error("--what is '" + what + "'; from " + arguments.input() + " a " + format +
                      " file can have: " + offered);
}

// The row of the states that --state names: a number, a stage (its state after removal), or the last.
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

// Where the output finds the input: the path from the output's folder.
std::string path_between(const std::string& output, const std::string& input)
{
    return std::filesystem::relative(input, std::filesystem::absolute(output).parent_path()).string();
}

std::string text_of(const Arguments& arguments, store::FileKind kind, const std::string& what,
                    const std::string& format)
{
    const std::string& input = arguments.input();
    const bool vtu = format == ".vtu";
    if (what == "blocks") {
        const Network network = store::read_network(input).network;
        return vtu ? exchange::blocks_vtu(network) : exchange::blocks_csv(network);
    }
    if (what == "joints" && !vtu)
        return exchange::joints_csv(store::read_network(input).network);
    if (what == "joints" || what == "edges") {
        if (kind == store::FileKind::network) {
            const Network network = store::read_network(input).network;
            return vtu ? exchange::joints_vtu(network, nullptr) : exchange::edges_csv(network, nullptr);
        }
        const store::JointsFile file = store::read_joints(input);
        return vtu ? exchange::joints_vtu(file.network, &file.equivalent)
                   : exchange::edges_csv(file.network, &file.equivalent);
    }
    const store::ResultFile file = store::read_result(input);
    if (what == "histories")
        return exchange::histories_csv(file.result.history);
    if (format == ".xdmf") {
        const std::string result_file = path_between(arguments.output(), input);
        return what == "zones" ? exchange::zones_xdmf(file.result, result_file)
                               : exchange::contacts_xdmf(file.result, result_file);
    }
    const std::size_t state = chosen_state(arguments, file.result.states);
    return what == "zones" ? exchange::zones_vtu(file.network, file.result, state)
                           : exchange::contacts_vtu(file.result, state);
}

void export_file(const Arguments& arguments)
{
    if (arguments.has("file-format")) {
        std::cout << store::schema_markdown();
        return;
    }
    const std::string& input = arguments.input();
    const std::string& output = arguments.output();
    const std::string format = format_of(output);
    store::check_writable(output);
    const store::FileKind kind = store::kind_of(input);

    const std::string what = chosen(arguments, kind, format);
    if (arguments.has("state") && format == ".xdmf")
        throw input_error("--state does not go with .xdmf, which has all states");
    if (arguments.has("state") && what != "zones" && what != "contacts")
        throw input_error("--state goes with --what zones or contacts, not with " + what);
    Summary summary;
    summary.add(what, output);
    if (const std::string reason = store::reason_of_failure(input); !reason.empty())
        summary.warn("the run of " + input + " ended early: " + reason);
    write_text(output, text_of(arguments, kind, what, format)); // last: what fails before it leaves no file
    summary.print(arguments);
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
                      "zones (.vtu, .xdmf2), contacts (.vtu, .xdmf2), histories (.csv). Default: zones or "
                      "histories from a result file, blocks or joints from others"},
                     {"state", "STATE",
                      "of zones and contacts in a .vtu file: its number, counted from 0, the stage that it "
                      "follows, or last (default)"},
                     {"file-format", "", "show the format of the HDF5 files of the chain, and no more"}},
         .example = "jointexport result.h5 -o zones.vtu --state \"block 2 removed\""},
        argc, argv, export_file);
}
