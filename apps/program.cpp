#include "program.hpp"

#include "keys/keys.hpp"
#include "model/error.hpp"
#include "model/version.hpp"
#include "store/save.hpp"

#include <boost/program_options.hpp>

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <latch>
#include <new>
#include <span>
#include <sstream>
#include <system_error>

namespace jointcreep
{

namespace po = boost::program_options;

namespace
{

constexpr unsigned text_width = 100; // of the help [columns]

// Options of earlier versions, refused by a message that has the new name.
struct RenamedOption {
    std::string_view before, now;
};
constexpr std::array<RenamedOption, 1> renamed_options{{{"trace", "step-history"}}};

void refuse_renamed(const Program& program, std::string_view option)
{
    for (const auto& [before, now] : renamed_options)
        for (const Option& known : program.options)
            if (before == option && known.name == now)
                throw input_error("--" + std::string(before) + " is now called --" + std::string(now));
}

// A range in words: "above 0 and at most 1".
std::string in_words(const Range& range)
{
    return std::string(range.least_open ? "above " : "at least ") + shown(range.least) + " and " +
           (range.most_open ? "below " : "at most ") + shown(range.most);
}

po::options_description described(const Program& program)
{
    po::options_description options("Options", text_width, text_width / 2);
    const auto value = [](const std::string& name) {
        return po::value<std::string>()->value_name(name.empty() ? "FILE" : name);
    };
    options.add_options()("output,o", value(program.output),
                          program.writes_text ? "the file to write; - is standard output"
                                              : "the file to write");
    for (const Option& option : program.options) {
        if (option.value.empty())
            options.add_options()(option.name.c_str(), option.text.c_str());
        else
            options.add_options()(option.name.c_str(), value(option.value), option.text.c_str());
    }
    options.add_options()("quiet,q", "no progress bar and no summary");
    options.add_options()("help,h", "show this text");
    options.add_options()("version,V", "show the version, and the commit it was built from");
    return options;
}

std::string usage(const Program& program)
{
    return "usage: " + program.name + ' ' + program.input + " -o " + program.output +
           (program.options.empty() ? "" : " [options]") + '\n' +
           (program.other_usage.empty() ? "" : "usage: " + program.name + ' ' + program.other_usage + '\n');
}

std::string help(const Program& program)
{
    std::ostringstream text;
    text << program.name << ": " << program.summary << "\n\n"
         << usage(program) << '\n'
         << described(program) << '\n'
         << (program.columns.empty() ? "" : "Columns of tables read:\n" + program.columns + '\n')
         << "Exit codes:\n"
            "  0  done\n"
            "  2  the command line or an input file is not as expected\n"
            "  3  no equilibrium, or no fit, was found\n"
            "  4  a file could not be read or written\n"
            "  5  internal error, or out of memory\n\n"
            "Example:\n  "
         << program.example << '\n';
    return text.str();
}

// The command line as Boost reads it: no abbreviated options, no option twice, one argument at most.
po::variables_map parsed(const Program& program, int argc, char** argv)
{
    po::options_description options = described(program);
    options.add_options()("input", po::value<std::vector<std::string>>());
    po::positional_options_description positional;
    positional.add("input", program.takes_several ? -1 : 1);
    po::variables_map given;
    try {
        using namespace po::command_line_style;
        po::store(po::command_line_parser(argc, argv)
                      .options(options)
                      .positional(positional)
                      .style(unix_style & ~allow_guessing)
                      .run(),
                  given);
    } catch (const po::unknown_option& error) {
        std::string name = error.get_option_name(); // "--trace", "--trace=20"
        name = name.substr(0, name.find('='));
        refuse_renamed(program, name.substr(std::min<std::size_t>(2, name.size())));
        if (name == "-v")
            throw input_error("-v is no option; -V shows the version, -q is without the summary");
        std::vector<std::string> known{"output", "quiet", "help", "version"};
        for (const Option& option : program.options)
            known.push_back(option.name);
        const bool is_long = name.starts_with("--");
        const std::string meant = is_long ? keys::nearest(name.substr(2), known) : "";
        throw input_error("there is no option " + name +
                          (meant.empty() ? "; --help shows all" : "; did you mean --" + meant + "?"));
    } catch (const po::too_many_positional_options_error&) {
        throw input_error("more than one " + program.input + " is given");
    } catch (const po::error& error) {
        throw input_error(error.what());
    }
    return given;
}

// Every line of a message says which program it comes from.
void complain(const std::string& program, std::string_view message)
{
    while (!message.empty()) {
        const std::size_t end = std::min(message.find('\n'), message.size());
        std::cerr << program << ": " << message.substr(0, end) << '\n';
        message.remove_prefix(std::min(end + 1, message.size()));
    }
}

// Leaves without exit handlers: the one of HDF5 1.10 crashes once a file could not be closed.
[[noreturn]] void leave(ExitCode code)
{
    std::cout.flush();
    std::cerr.flush();
    std::_Exit(code);
}

constexpr std::size_t enough_stack = std::size_t{1} << 20; // [bytes]

// Uses its lowest address; pages between are taken when they are used. A function of its own: what calls it has not this frame.
[[gnu::noinline]] void use_stack()
{
    volatile char room[enough_stack];
    room[0] = 0;
    asm volatile("" : : "r"(&room[0]) : "memory"); // a compiler keeps all of it
}

// Grows the stack now to what the work may need. Where address space is limited, a stack that cannot grow later ends in a crash.
// A small stack is left as it is. Throws std::bad_alloc where there is no room for it.
[[gnu::noinline]] void reserve_stack()
{
    constexpr std::size_t page = 4096; // [bytes]
    rlimit limit{};
    if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur < 2 * enough_stack)
        return;
    void* const as_much =
        mmap(nullptr, enough_stack + 64 * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (as_much == MAP_FAILED || munmap(as_much, enough_stack + 64 * page) != 0)
        throw std::bad_alloc();
    use_stack();
}

// The stack of OpenMP's threads as the environment has it [bytes]; 0 is the default. In kilobytes, or with a unit.
std::size_t openmp_stack()
{
    const char* text = std::getenv("OMP_STACKSIZE");
    if (text == nullptr)
        text = std::getenv("GOMP_STACKSIZE");
    if (text == nullptr)
        return 0;
    char* end = nullptr;
    const unsigned long long number = std::strtoull(text, &end, 10);
    const std::size_t unit = std::string("bkmg").find(static_cast<char>(std::tolower(*end)));
    const std::size_t power = *end == '\0' || unit == std::string::npos ? 1 : unit;
    return end == text ? 0 : static_cast<std::size_t>(number) << (10 * power);
}

// Threads that wait until they are let go, with the stack of OpenMP's.
class Team
{
public:
    Team()
    {
        pthread_attr_init(&attributes_);
        if (const std::size_t stack = openmp_stack(); stack > 0)
            pthread_attr_setstacksize(&attributes_,
                                      stack); // too small: refused, and the default stays, as in OpenMP
    }
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;
    ~Team()
    {
        all_.count_down();
        for (const pthread_t thread : threads_)
            pthread_join(thread, nullptr);
        pthread_attr_destroy(&attributes_);
    }
    // Starts another one; 0, or the number of the error.
    int start()
    {
        threads_.reserve(threads_.size() + 1);
        pthread_t thread{};
        const auto wait = [](void* all) -> void* {
            static_cast<std::latch*>(all)->wait();
            return nullptr;
        };
        const int error = pthread_create(&thread, &attributes_, wait, &all_);
        if (error == 0)
            threads_.push_back(thread);
        return error;
    }

private:
    pthread_attr_t attributes_{};
    std::latch all_{1};
    std::vector<pthread_t> threads_{};
};

// A descriptor that is closed would be that of the next file that is opened, and messages would go into it. Writing to
// standard output still fails then.
void open_closed_descriptors()
{
    for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(number, F_GETFD) == -1)
            open("/dev/null",
                 number == STDERR_FILENO ? O_WRONLY : O_RDONLY); // the lowest that is free: this one
}

// The path without links, as far as it exists.
std::filesystem::path without_links(const std::filesystem::path& path)
{
    const std::filesystem::path whole = std::filesystem::absolute(path);
    std::error_code unreachable;
    const std::filesystem::path found = std::filesystem::weakly_canonical(whole, unreachable);
    return unreachable ? whole.lexically_normal() : found;
}

// Whether two paths are one file, or would be once it is written.
bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other)
{
    std::error_code absent;
    return std::filesystem::equivalent(one, other, absent) || without_links(one) == without_links(other);
}

// Threads that wait for each other spin, by default for milliseconds. Beside other programs that use all processors a
// run then takes tens of times as long. The OpenMP library (libgomp) reads the time of spinning from the environment
// before main() begins. So the program sets it and starts once more. Where that is not possible, it continues.
void start_with_short_waits(char** argv)
{
    if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr)
        return;
    std::error_code none; // where a loader has been started with this program, the other name is the loader's
    if (std::filesystem::read_symlink("/proc/self/exe", none).filename() !=
        std::filesystem::path(argv[0]).filename())
        return;
    setenv("GOMP_SPINCOUNT", "1000", 0); // some 20 us
    execv("/proc/self/exe", argv);
}

} // namespace

std::size_t columns(std::string_view text)
{
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string_view shortened(std::string_view text, std::size_t most)
{
    std::size_t size = text.size();
    while (columns(text.substr(0, size)) > most)
        --size;
    while (size < text.size() && (text[size] & 0xC0) == 0x80)
        ++size;
    return text.substr(0, size);
}

std::string name_beside(const std::string& name, const std::string& word)
{
    const std::filesystem::path path(name);
    return (path.parent_path() / (path.stem().string() + '.' + word + path.extension().string())).string();
}

std::string failed_name(const std::string& output)
{
    return name_beside(output, "failed");
}

const std::string& Arguments::wanted(const std::string& name) const
{
    const auto found = given_.find(name);
    if (found == given_.end())
        throw input_error(shown_.at(name) + " is not given");
    if (found->second.empty())
        throw input_error(shown_.at(name) + " is empty; it must be the name of a file");
    return found->second;
}

void refuse_overwriting(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written)
{
    for (auto file = written.begin(); file != written.end(); ++file) {
        std::vector<NamedFile> others = read;
        others.insert(others.end(), written.begin(), file);
        for (const NamedFile& other : others)
            if (is_same_file(file->path, other.path))
                throw input_error(file->name + " is the same file as " + other.name +
                                  "; give it another name");
        for (const NamedFile& input : read)
            if (store::is_partial_of(file->path, input.path))
                throw input_error(
                    file->name + ": " + input.name +
                    " is called as an unfinished file of it, which would be removed; rename it");
    }
}

void write_texts(const std::vector<TextFile>& files)
{
    std::vector<store::NamedBytes> all;
    for (const auto& [path, text] : files)
        if (path != standard_output)
            all.push_back({path, std::as_bytes(std::span(text))});
    store::save_together(all);
    for (const auto& [path, text] : files)
        if (path == standard_output)
            std::cout << text; // run() says whether that was possible
}

std::vector<NamedFile> Arguments::files(const std::vector<std::string>& options) const
{
    std::vector<NamedFile> files;
    for (const std::string& option : options) {
        if (!has(option))
            continue;
        if (wanted(option) == standard_output && option != "input") {
            if (option == "output")
                continue;
            throw input_error("--" + option +
                              " is '-'; only -o can be standard output. Give the name of a file");
        }
        if (option == "input")
            for (const std::string& input : inputs_)
                files.push_back({input, "the input " + input});
        else
            files.push_back(
                {wanted(option), (option == "output" ? "-o" : "--" + option) + ' ' + wanted(option)});
    }
    return files;
}

std::optional<std::string> Arguments::text(const std::string& option) const
{
    const auto found = given_.find(option);
    return found == given_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint64_t> Arguments::whole_number(const std::string& option, std::uint64_t least,
                                                     std::uint64_t most) const
{
    const std::optional<std::string> given = text(option);
    if (!given)
        return {};
    std::uint64_t value = 0;
    const char* const end = given->data() + given->size();
    const auto read = std::from_chars(given->data(), end, value);
    if (read.ec != std::errc() || read.ptr != end || value < least || value > most)
        throw input_error(shown_.at(option) + " is '" + *given + "'; it must be a whole number from " +
                          std::to_string(least) + " to " + std::to_string(most));
    return value;
}

std::optional<double> Arguments::number(const std::string& option) const
{
    const std::optional<std::string> given = text(option);
    if (!given)
        return {};
    double value = 0;
    const char* const end = given->data() + given->size();
    const auto read = std::from_chars(given->data(), end, value);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value))
        throw input_error(shown_.at(option) + " is '" + *given + "'; it must be a finite number");
    return value;
}

std::optional<double> Arguments::number(const std::string& option, const Range& range,
                                        std::string_view unit) const
{
    const std::optional<double> value = number(option);
    if (value)
        require(range.holds(*value), shown_.at(option), *value, unit, "must be " + in_words(range));
    return value;
}

int Arguments::threads(const std::string& option) const
{
    const auto wanted = static_cast<int>(whole_number(option, 1, 1024).value_or(1));
    // OpenMP ends the program where it cannot start its threads. So the same number is started here first.
    Team team;
    for (int started = 1; started < wanted; ++started)
        if (const int error = team.start())
            throw input_error("--" + option + " " + std::to_string(wanted) + ": only " +
                              std::to_string(started) + " could be started here (" +
                              std::generic_category().message(error) + "); expected fewer" +
                              (openmp_stack() > 0 ? ", or another OMP_STACKSIZE" : ""));
    return wanted;
}

int run(const Program& program, int argc, char** argv, const std::function<void(const Arguments&)>& body)
{
    open_closed_descriptors();
    std::signal(SIGXFSZ, SIG_IGN); // a file that grows past the limit is then a write error with a message
    // Large arrays are allocated and freed often. Returning them to the system costs up to a tenth of the run.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    try {
        reserve_stack();
        if (argc < 2) {
            std::cerr << program.name << ": " << program.summary << '\n'
                      << usage(program) << program.name << " --help says more\n";
            return exit_input;
        }
        Arguments arguments;
        arguments.program_ = program.name;
        arguments.shown_ = {{"input", program.input}, {"output", "-o " + program.output}};
        for (const Option& option : program.options)
            arguments.shown_[option.name] = "--" + option.name;
        for (const auto& [name, value] : parsed(program, argc, argv)) {
            if (const auto* inputs = boost::any_cast<std::vector<std::string>>(&value.value())) {
                arguments.inputs_ = *inputs;
                arguments.given_[name] = inputs->front();
                continue;
            }
            const auto* text = boost::any_cast<std::string>(&value.value());
            arguments.given_[name] = text ? *text : "";
        }
        if (arguments.to_standard_output() && !program.writes_text)
            throw input_error(
                "-o -: the output is a binary file (HDF5), not for standard output; give the name of "
                "a file. A file called \"-\" is -o ./-");
        if (arguments.has("input") && arguments.has("output"))
            refuse_overwriting(arguments.files({"input"}), arguments.files({"output"}));
        if (arguments.has("help"))
            std::cout << help(program);
        else if (arguments.has("version"))
            std::cout << program.name << ' ' << version() << '\n';
        else {
            if (arguments.has("threads"))
                start_with_short_waits(argv);
            body(arguments);
        }
        std::cout.flush();
        if (!std::cout)
            throw file_error("stdout could not be written");
        return exit_ok;
    } catch (const input_error& error) {
        complain(program.name, error.what());
        leave(exit_input);
    } catch (const equilibrium_error& error) {
        complain(program.name, error.what());
        leave(exit_not_found);
    } catch (const fit_error& error) {
        complain(program.name, error.what());
        leave(exit_not_found);
    } catch (const file_error& error) {
        complain(program.name, error.what());
        leave(exit_file);
    } catch (const std::bad_alloc&) {
        complain(program.name, "out of memory");
        leave(exit_internal);
    } catch (const std::exception& error) {
        complain(program.name, std::string("internal error: ") + error.what());
        leave(exit_internal);
    }
}

namespace
{

volatile std::sig_atomic_t asked_by = 0; // a signal
std::string asked_text;                  // that is said then

void ask_to_stop(int signal)
{
    asked_by = signal;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    [[maybe_unused]] const auto written = write(STDERR_FILENO, asked_text.data(), asked_text.size());
}

} // namespace

void stop_when_asked(const std::string& program, const std::string& when)
{
    const std::string over_progress = isatty(STDERR_FILENO) != 0 ? "\r\x1b[K" : "";
    asked_text = over_progress + program + ": stops " + when + "; a second signal stops it at once\n";
    for (const int signal : {SIGINT, SIGTERM})
        if (std::signal(signal, ask_to_stop) == SIG_IGN)
            std::signal(signal, SIG_IGN); // as in the background of a shell
}

bool is_asked_to_stop()
{
    return asked_by != 0;
}

void stop_if_asked(const std::string& program, const std::string& text)
{
    if (asked_by == 0)
        return;
    print_line(program, text);
    std::raise(asked_by);
}

Progress::Progress(std::string program, bool quiet)
    : program_(std::move(program)), is_quiet_(quiet), on_terminal_(!quiet && isatty(STDERR_FILENO)),
      next_(start_ + (on_terminal_ ? Clock::duration(0) : std::chrono::minutes(1)))
{
}

Progress::~Progress()
{
    if (drawn_)
        std::cerr << "\r\x1b[K" << std::flush;
}

std::string time_left(double gone, double stalled, double first, double fraction)
{
    constexpr double shortest = 5,
                     patience = 10; // [s]: earlier the rate is not known; later it is not what it was
    const double done = fraction - first;
    if (gone < shortest || done <= 0)
        return "";
    if (stalled > std::max(patience, (gone - stalled) * (1 - fraction) / done))
        return ", time left not known";
    const double left = gone * (1 - fraction) / done;
    const bool in_minutes = left > 90, in_hours = left > 90 * 60;
    const double unit = in_hours ? 3600 : in_minutes ? 60 : 1;
    return ", " + std::to_string(std::llround(std::ceil(left / unit))) +
           (in_hours     ? " h"
            : in_minutes ? " min"
                         : " s") +
           " left";
}

void Progress::show(double fraction, const What& what)
{
    fraction = std::clamp(fraction, 0.0, 1.0);
    if (fraction > 0)
        first_ = std::min(first_, fraction); // a run that continues does not begin at 0
    const Clock::time_point now = Clock::now();
    if (fraction > last_) {
        last_ = fraction;
        advanced_ = now;
    }
    if (is_quiet_ || now < next_)
        return;
    const auto since = [now](Clock::time_point then) {
        return std::chrono::duration<double>(now - then).count();
    };
    const std::string share = fraction > 0
                                  ? std::to_string(static_cast<int>(100 * fraction)) + "%" +
                                        time_left(since(start_), since(advanced_), first_, fraction) + ": "
                                  : "";
    if (!on_terminal_) {
        next_ = Clock::now() + std::chrono::minutes(1);
        std::cerr << program_ + ": " + share + what(unlimited) + "\n" << std::flush;
        return;
    }
    next_ = Clock::now() + std::chrono::milliseconds(100);
    drawn_ = true;
    constexpr std::size_t bar_width = 6;
    const auto full = static_cast<std::size_t>(fraction * bar_width);
    const std::string bar =
        fraction > 0 ? "[" + std::string(full, '#') + std::string(bar_width - full, ' ') + "] " : "";
    winsize window{};
    const bool has_width = ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0;
    const std::size_t most = (has_width ? window.ws_col : 80) - 1;
    const auto line_of = [&](const std::string& start) {
        return start + what(most - std::min(most, columns(start)));
    };
    std::string line = line_of(bar + share);
    if (columns(line) > most)
        line = line_of(share);
    std::cerr << "\r" << shortened(line, most) << "\x1b[K" << std::flush;
}

void Summary::add(std::string label, std::string value, const std::string& unit)
{
    lines_.emplace_back(std::move(label), unit.empty() ? std::move(value) : value + ' ' + unit);
}

void Summary::add(std::string label, double value, const std::string& unit)
{
    std::array<char, 32> text{};
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
    add(std::move(label), std::string(text.data(), end), unit);
}

void Summary::add(std::string label, std::int64_t value, const std::string& unit)
{
    add(std::move(label), std::to_string(value), unit);
}

void Summary::add(std::string label, std::size_t value, const std::string& unit)
{
    add(std::move(label), std::to_string(value), unit);
}

void Summary::add(std::string label, std::int32_t value, const std::string& unit)
{
    add(std::move(label), std::to_string(value), unit);
}

void Summary::count_warnings(std::size_t said, std::size_t inherited)
{
    add("warnings", std::to_string(said + warnings_.size()) +
                        (inherited > 0 ? ", and " + std::to_string(inherited) + " of earlier programs" : ""));
}

void print_line(const std::string& program, const std::string& text)
{
    std::cerr << program + ": " + text + '\n' << std::flush;
}

void print_warning(const std::string& program, const std::string& text)
{
    print_line(program, "warning: " + text);
}

void Summary::print(const Arguments& arguments) const
{
    std::size_t width = 0;
    for (const auto& [label, value] : lines_)
        width = std::max(width, columns(label));
    if (!arguments.quiet()) {
        for (const auto& [label, value] : lines_)
            std::cout << label << std::string(width - columns(label) + 2, ' ') << value << '\n';
        std::cout.flush(); // before what comes on stderr
    }
    for (const std::string& text : warnings_)
        print_warning(arguments.program(), text);
}

} // namespace jointcreep
