// What the programs share: their command line, their exit codes (docs/programs.md), a progress bar and the
// summary.
//
//     int main(int argc, char** argv)
//     {
//         return run({.name = "jointgen",
//                     .summary = "Makes the joints and blocks of a section.",
//                     .input = "SCENE.toml",
//                     .output = "network.h5",
//                     .options = {{"seed", "N", "seed of the joint sets (default: the scene's)"},
//                                 {"check", "", "..."}},
//                     .example = "jointgen data/column/scene.toml -o network.h5"},
//                    argc, argv, generate);
//     }

#pragma once

#include "model/error.hpp"
#include "model/quantity.hpp"
#include "scene/shared_settings.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace jointcreep
{

enum ExitCode {
    exit_ok = 0,
    exit_input = 2,     // command line, scene or input file: input_error
    exit_not_found = 3, // no equilibrium, equilibrium_error; no fit, fit_error
    exit_file = 4,      // not readable or not writable: file_error
    exit_internal = 5   // anything else, memory that ran out among it
};

// A search that has not converged: exit code 3.
struct fit_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// "result.WORD.h5" for "result.h5".
std::string name_beside(const std::string& name, const std::string& word);

// "result.failed.h5" for "result.h5": the file of a run, or a search, that failed.
std::string failed_name(const std::string& output);

// An option of one program. All options are long ones (--name), and are given at most once.
struct Option {
    std::string name;  // without the dashes
    std::string value; // what stands for the value in the usage, "N" or "NAME"; empty: a flag
    std::string text;  // what it does, with unit and default
};

// A program as its user sees it. Besides its own options every program has -o, --quiet, --help and --version.
struct Program {
    std::string name;
    std::string summary; // one line
    std::string input;   // the one argument: "SCENE.toml"
    std::string output;  // the value of -o: "network.h5"
    std::vector<Option> options;
    std::string example;        // a whole command line
    std::string other_usage{};  // arguments without -o, if some go without it
    std::string columns{};      // of tables that it reads, if any; indented lines
    bool takes_several = false; // inputs
    bool writes_text = false;   // -o - is possible: standard output
};

// The value of -o that means standard output. Nothing else is then written there.
constexpr std::string_view standard_output = "-";

// A file of a run, and what messages call it: "--readings fit.csv".
struct NamedFile {
    std::string path, name;
};

// Refuses an output that is also an input, or another output: its content would be lost. Two paths are one file
// whatever links and folders they go through, also where there is no file yet.
void refuse_overwriting(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written);

// Writes texts as files, which appear once all of them are whole, then those for standard output. Throws file_error.
struct TextFile {
    std::string path, text;
};
void write_texts(const std::vector<TextFile>& files);

// Calls read(). Messages of input_error begin with the file's name.
template <class Read>
auto of_file(const std::string& path, const Read& read)
{
    try {
        return read();
    } catch (const input_error& error) {
        const std::string_view message = error.what();
        throw input_error(path + (message.starts_with("line ") ? ", " : ": ") + error.what());
    }
}

// What was given on the command line. Every accessor throws input_error when what is given is not what is
// wanted.
class Arguments
{
public:
    // The file to read, and the file to write; both refuse if not given.
    const std::string& input() const { return wanted("input"); }
    const std::string& output() const { return wanted("output"); }
    // All files to read, of a program that takes several.
    const std::vector<std::string>& inputs() const { return inputs_; }

    const std::string& program() const { return program_; } // its name
    bool has(const std::string& option) const { return given_.contains(option); }
    bool quiet() const { return has("quiet") || to_standard_output(); }
    bool to_standard_output() const { return text("output") == standard_output; }

    // The files of those options that are given; "input" and "output" are options, too. Standard output is no file.
    std::vector<NamedFile> files(const std::vector<std::string>& options) const;

    // The value of an option, or nothing if it is not given.
    std::optional<std::string> text(const std::string& option) const;
    std::optional<std::uint64_t> whole_number(const std::string& option, std::uint64_t least,
                                              std::uint64_t most) const;
    std::optional<double> number(const std::string& option) const; // finite
    std::optional<double> number(const std::string& option, const Range& range, std::string_view unit) const;
    // The value of --threads or another option, 1 if it is not given; refuses more threads than the system starts.
    int threads(const std::string& option = "threads") const;

private:
    friend int run(const Program&, int, char**, const std::function<void(const Arguments&)>&);
    const std::string& wanted(const std::string& name) const;

    std::string program_;
    std::vector<std::string> inputs_;
    std::map<std::string, std::string> given_;
    std::map<std::string, std::string> shown_; // how messages name them: "--seed", "SCENE.toml"
};

// The whole of a main(): reads the command line, answers --help and --version, or else calls `body`. What
// `body` throws becomes a message on stderr, "jointgen: scene.toml:12: ...", and an exit code.
int run(const Program& program, int argc, char** argv, const std::function<void(const Arguments&)>& body);

// How far a run is, on stderr: on a terminal one line that changes, with a bar; elsewhere a line a minute. The
// destructor clears the bar.
class Progress
{
public:
    Progress(std::string program, bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // What is being done, in so many columns if it can be said in these; `unlimited`: not on a terminal.
    using What = std::function<std::string(std::size_t most)>;
    static constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

    // `fraction` done, from 0 (not known) to 1, and what is being done. Cheap to call often: asks for it 10 times a second at most.
    // After some seconds the time left is shown: time_left(). The bar goes where there is no room for it.
    void show(double fraction, const What& what);

private:
    using Clock = std::chrono::steady_clock;
    std::string program_;
    bool is_quiet_, on_terminal_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now(), next_{};
    double first_ = 1;                    // the fraction that this run began at
    double last_ = 0;                     // the largest fraction so far
    Clock::time_point advanced_ = start_; // when it became so large
};

// The time left in words, ", 3 min left", as if the rest went on at the rate so far. `gone`: time since the beginning, `stalled`: time
// since the fraction last grew [s]; `first`, `fraction`: done at the beginning, and now. Empty while the rate is not known. Not known
// any more once nothing has advanced for longer than the rest should have taken, and for 10 s: a search near failure can take very long.
std::string time_left(double gone, double stalled, double first, double fraction);

// Says a line on stderr: "demsolve: ...".
void print_line(const std::string& program, const std::string& text);
// Says a warning on stderr: "demsolve: warning: ...".
void print_warning(const std::string& program, const std::string& text);

// Columns that UTF-8 text takes, combining characters aside.
std::size_t columns(std::string_view text);
// The beginning of a UTF-8 text, no wider than `most` columns.
std::string_view shortened(std::string_view text, std::size_t most);

// From here on a first SIGINT or SIGTERM only asks the program to stop, and says when it does: "at the next ...". A second one
// ends it.
void stop_when_asked(const std::string& program, const std::string& when);
// Whether it was asked.
bool is_asked_to_stop();
// It can stop now: if it was asked, it ends by that signal, with this line.
void stop_if_asked(const std::string& program, const std::string& text);

// The summary at the end of a run: lines "label   value unit", their values aligned; and warnings: what a person should
// look at, although the run came to its end.
class Summary
{
public:
    void add(std::string label, std::string value, const std::string& unit = "");
    void add(std::string label, double value, const std::string& unit = ""); // to six digits
    void add(std::string label, std::int64_t value, const std::string& unit = "");
    void add(std::string label, std::size_t value, const std::string& unit = "");
    void add(std::string label, std::int32_t value, const std::string& unit = "");
    void warn(const std::string& text) { warnings_.push_back(text); }
    // A last line: how many warnings there were. `said` before, by this program, and those of the input file.
    void count_warnings(std::size_t said, std::size_t inherited);
    // Lines to stdout, unless --quiet. Warnings to stderr, also with --quiet: "demsolve: warning: ...".
    void print(const Arguments& arguments) const;

private:
    std::vector<std::pair<std::string, std::string>> lines_; // label, value with unit
    std::vector<std::string> warnings_;
};

} // namespace jointcreep
