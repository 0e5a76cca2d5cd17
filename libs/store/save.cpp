#include "store/save.hpp"

#include "model/error.hpp"
#include "store/files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <random>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace jointcreep::store
{

namespace
{

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what)
{
    throw file_error("cannot " + what + ": " + std::strerror(errno));
}

fs::path folder_of(const fs::path& path)
{
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

class Descriptor
{
public:
    explicit Descriptor(int number = -1) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept
    {
        std::swap(number_, other.number_);
        return *this;
    }
    ~Descriptor()
    {
        if (number_ >= 0)
            ::close(number_);
    }
    int number() const { return number_; }
    bool close() { return ::close(std::exchange(number_, -1)) == 0; } // tells of late errors

private:
    int number_;
};

constexpr const char* partial_mark = ".partial-"; // then a number

// A file that is removed again unless it is renamed. Until then it is locked: the lock of a process ends with the
// process, so a partial file without a lock is one that nobody writes.
class Partial
{
public:
    // A name of its own, so that two programs with the same output do not write into one file.
    explicit Partial(const std::string& path)
    {
        do {
            const std::string name = path + partial_mark + std::to_string(std::random_device{}());
            file_ = Descriptor(::open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666));
            if (file_.number() < 0)
                fail("create " + name);
            name_ = name;
            lock_ = Descriptor(::fcntl(file_.number(), F_DUPFD_CLOEXEC, 0));
            // Where a file system has no locks, nobody removes the file either.
            ::flock(lock_.number(), LOCK_EX);
        } while (is_removed()); // by another program, which took it for a leftover before it was locked
    }
    Partial(const Partial&) = delete;
    Partial& operator=(const Partial&) = delete;
    ~Partial()
    {
        if (!name_.empty())
            ::unlink(name_.c_str());
    }

    void write(std::span<const std::byte> bytes)
    {
        while (!bytes.empty()) {
            const ssize_t written = ::write(file_.number(), bytes.data(), bytes.size());
            if (written < 0 && errno != EINTR)
                fail("write");
            bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
        }
        if (::fsync(file_.number()) != 0 || !file_.close())
            fail("write");
    }

    void rename_to(const std::string& path)
    {
        if (std::rename(name_.c_str(), path.c_str()) != 0)
            fail("rename the finished file");
        name_.clear();
    }

private:
    bool is_removed() const
    {
        struct stat status {
        };
        return ::fstat(file_.number(), &status) == 0 && status.st_nlink == 0;
    }

    std::string name_;
    Descriptor file_, lock_; // one open file: the lock lasts until both are closed
};

// Whether the name in the output's folder is that of a partial file of this output.
bool has_partial_name(const std::string& output, const std::string& name)
{
    const std::string begin = output + partial_mark;
    return name.size() > begin.size() && name.starts_with(begin) &&
           name.find_first_not_of("0123456789", begin.size()) == std::string::npos;
}

// Removes partial files of the output that a program has left which was killed: those that nobody has locked. What
// cannot be removed stays; the output can be written all the same.
void remove_leftovers(const fs::path& path)
{
    std::vector<fs::path> partial;
    std::error_code ignored;
    for (fs::directory_iterator entry(folder_of(path), ignored), end; !ignored && entry != end;
         entry.increment(ignored))
        if (has_partial_name(path.filename().string(), entry->path().filename().string()))
            partial.push_back(entry->path());
    for (const fs::path& one : partial) {
        const Descriptor file(::open(one.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
        struct stat status {
        };
        if (file.number() >= 0 && ::fstat(file.number(), &status) == 0 && S_ISREG(status.st_mode) &&
            ::flock(file.number(), LOCK_EX | LOCK_NB) == 0)
            ::unlink(one.c_str());
    }
}

// Makes the renaming itself last. Some file systems cannot; the file is in place all the same.
void sync_folder(const fs::path& folder)
{
    const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (descriptor.number() < 0 || (::fsync(descriptor.number()) != 0 && errno != EINVAL))
        fail("sync the folder");
}

// Renaming onto anything but a regular file would destroy it: a device, a pipe.
void require_place(const std::string& path)
{
    struct stat status {
    };
    if (path.empty() || path.ends_with('/'))
        throw file_error("cannot write: this is not the name of a file");
    // /dev/stdout is a link, which renaming would replace, however it is spelled.
    std::error_code unreachable;
    const fs::path in = fs::weakly_canonical(fs::absolute(folder_of(path)), unreachable);
    const std::string place = (in / fs::path(path).filename()).string();
    const bool is_system = place.starts_with("/dev/") || place.starts_with("/proc/");
    if (is_system && !place.starts_with("/dev/shm/"))
        throw file_error(
            "cannot write: names in /dev and /proc are no files; expected a file, or - for text on standard output");
    if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
        throw file_error(std::string("cannot write: there is a ") +
                         (S_ISDIR(status.st_mode) ? "folder" : "device or pipe") + " of this name");
    const fs::path folder = folder_of(path);
    if (::stat(folder.c_str(), &status) != 0)
        fail("write into the folder " + folder.string());
    if (!S_ISDIR(status.st_mode))
        throw file_error("cannot write: " + folder.string() + " is not a folder");
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        fail("write into the folder " + folder.string());
    constexpr std::size_t longest_number = 10; // of a partial file
    const long longest = ::pathconf(folder.c_str(), _PC_NAME_MAX);
    const std::size_t length =
        fs::path(path).filename().string().size() + std::strlen(partial_mark) + longest_number;
    if (longest > 0 && length > static_cast<std::size_t>(longest))
        throw file_error("cannot write: with " + std::string(partial_mark) +
                         "1234567890 the name is longer than the " + std::to_string(longest) +
                         " bytes that the folder allows; expected one that is " +
                         std::to_string(length - static_cast<std::size_t>(longest)) + " shorter");
}

} // namespace

void save(const std::string& path, std::span<const std::byte> bytes)
{
    require_place(path);
    remove_leftovers(path);
    Partial partial(path);
    partial.write(bytes);
    partial.rename_to(path);
    sync_folder(folder_of(path));
}

void save_together(const std::vector<NamedBytes>& files)
{
    std::deque<Partial> partials; // which do not move
    std::string at;
    try {
        for (const auto& [path, bytes] : files) {
            at = path;
            require_place(path);
            remove_leftovers(path);
            partials.emplace_back(path).write(bytes);
        }
        for (std::size_t i = 0; i < files.size(); ++i) {
            at = files[i].path;
            partials[i].rename_to(at);
            sync_folder(folder_of(at));
        }
    } catch (const file_error& error) {
        throw file_error(at + ": " + error.what());
    }
}

bool is_partial_of(const std::string& output, const std::string& path)
{
    std::error_code unreachable;
    const fs::path folder = fs::weakly_canonical(fs::absolute(folder_of(output)), unreachable);
    const fs::path file = fs::weakly_canonical(fs::absolute(path), unreachable);
    return file.parent_path() == folder &&
           has_partial_name(fs::path(output).filename().string(), file.filename().string());
}

void check_writable(const std::string& path)
{
    try {
        require_place(path);
    } catch (const file_error& error) {
        throw file_error(path + ": " + error.what());
    }
}

} // namespace jointcreep::store
