// A write that fails leaves what was there, leaves nothing else, and says why.

#include "random_records.hpp"

#include "model/error.hpp"

#include <csignal>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace jointcreep::store::saving_test
{

namespace
{

std::string message_of(const auto& work)
{
    try {
        work();
    } catch (const file_error& error) {
        return error.what();
    }
    return "";
}

// Writes a file in a child whose files may not grow beyond `limit` bytes, as on a full disk. Gives its exit
// code: 4 for a file_error that names the file, -1 if a signal ended it.
int written_with_limit(const std::string& path, const ResultFile& file, rlim_t limit)
{
    const pid_t child = ::fork();
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limits{limit, limit};
        ::setrlimit(RLIMIT_FSIZE, &limits);
        const std::string message = message_of([&] { write(path, file); });
        std::exit(message.empty() ? 0 : message.starts_with(path) ? 4 : 5); // with HDF5's exit handlers
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// A child that stops in the middle of writing a file.
class StoppedWriter
{
public:
    StoppedWriter(const std::string& path, const ResultFile& file, rlim_t bytes) : child_(::fork())
    {
        if (child_ == 0) {
            std::signal(SIGXFSZ, [](int) { ::raise(SIGSTOP); });
            const rlimit limits{bytes, bytes};
            ::setrlimit(RLIMIT_FSIZE, &limits);
            write(path, file);
            ::_exit(0);
        }
        int status = 0;
        ::waitpid(child_, &status, WUNTRACED);
        EXPECT_TRUE(WIFSTOPPED(status));
    }
    void kill() const
    {
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }

private:
    pid_t child_;
};

} // namespace

TEST(Saving, RemovesWhatKilledWritersLeft)
{
    const TemporaryFolder folder;
    const std::string path = folder / "result.h5";
    const ResultFile file = RandomRecords(1, 10).result();
    const std::vector<std::string> others = {"other.h5.partial-7", "result.h5.partial-",
                                             "result.h5.partial-7a"};
    for (const std::string& other : others)
        std::ofstream(folder / other) << "of another output";
    write(path, file);
    const std::size_t whole = folder.files().size();
    const auto half = std::filesystem::file_size(path) / 2;

    const StoppedWriter killed(path, file, half), living(path, file, half);
    killed.kill();
    EXPECT_EQ(folder.files().size(), whole + 2);
    write(path, file);
    EXPECT_EQ(folder.files().size(), whole + 1) << "that of the living one stays";
    living.kill();
    EXPECT_EQ(folder.files().size(), whole + 1);
    write(path, file);
    std::vector<std::string> wanted = others;
    wanted.insert(wanted.begin() + 1, "result.h5");
    EXPECT_EQ(folder.files(), wanted);
    EXPECT_TRUE(same(read_result(path), file));
}

TEST(Saving, FullDiskLeavesTheOldFile)
{
    const TemporaryFolder folder;
    const std::string path = folder / "result.h5";
    const ResultFile old = RandomRecords(1, 10).result(), recent = RandomRecords(2, 10).result();
    write(path, recent);
    const auto size = std::filesystem::file_size(path);
    write(path, old);
    const std::string before = bytes_of(path);

    for (const rlim_t limit : {rlim_t(0), rlim_t(1), rlim_t(4096), rlim_t(size / 2), rlim_t(size - 1)}) {
        EXPECT_EQ(written_with_limit(path, recent, limit), 4) << limit << " of " << size << " bytes";
        EXPECT_EQ(bytes_of(path), before);
        EXPECT_EQ(folder.files(), std::vector<std::string>{"result.h5"});
    }
    EXPECT_EQ(written_with_limit(path, recent, size), 0);
    EXPECT_TRUE(same(read_result(path), recent));
}

// A pipe stands for every device: as root, a test on a real one would destroy it if it failed.
TEST(Saving, DevicesAreNotReplaced)
{
    const TemporaryFolder folder;
    const std::string pipe = folder / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const ResultFile file = RandomRecords(1, 5).result();
    EXPECT_NE(message_of([&] { write(pipe, file); }), "");
    EXPECT_NE(message_of([&] { check_writable(pipe); }), "");
    struct stat status {
    };
    ASSERT_EQ(::stat(pipe.c_str(), &status), 0);
    EXPECT_TRUE(S_ISFIFO(status.st_mode));
}

TEST(Saving, RefusesPlacesWithoutAFolder)
{
    const TemporaryFolder folder;
    const ResultFile file = RandomRecords(1, 5).result();
    std::ofstream(folder / "plain") << "a file";
    std::filesystem::create_directory(folder / "inner");
    for (const std::string& path :
         {folder / "absent/result.h5", folder / "plain/result.h5", folder / "inner", folder / "inner/"}) {
        const std::string message = message_of([&] { write(path, file); });
        EXPECT_TRUE(message.starts_with(path)) << message;
        EXPECT_EQ(message_of([&] { check_writable(path); }), message);
    }
    EXPECT_NE(message_of([&] { check_writable(""); }), "");
    EXPECT_EQ(bytes_of(folder / "plain"), "a file");
    EXPECT_EQ((std::vector<std::string>{"inner", "plain"}), folder.files());
}

TEST(Saving, RefusesFoldersThatMayNotBeWritten)
{
    if (::geteuid() == 0)
        GTEST_SKIP() << "root may write everywhere";
    const TemporaryFolder folder;
    std::filesystem::permissions(folder / ".",
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    EXPECT_NE(message_of([&] { check_writable(folder / "result.h5"); }), "");
    std::filesystem::permissions(folder / ".", std::filesystem::perms::owner_all);
}

TEST(Saving, AllowsNewAndOldFiles)
{
    const TemporaryFolder folder;
    check_writable(folder / "new.h5");
    EXPECT_TRUE(folder.files().empty());
    std::ofstream(folder / "old.h5") << "old";
    check_writable(folder / "old.h5");
    check_writable("in_this_folder.h5");
}

// A program that stores a wrong number is at fault; the file must not appear.
TEST(Saving, RefusesRecordsThatBreakTheSchema)
{
    const TemporaryFolder folder;
    const std::string path = folder / "result.h5";
    const auto refused = [&](const auto& change, const std::string& expected) {
        ResultFile file = RandomRecords(3, 6).result();
        change(file);
        const std::string message = message_of([&] { write(path, file); });
        EXPECT_TRUE(message.starts_with(path) && message.find(expected) != std::string::npos)
            << message << "\nexpected: " << expected;
        EXPECT_TRUE(folder.files().empty());
    };
    refused([](ResultFile& f) { f.result.states.stress[1][2] = std::nan(""); },
            "/states/stress[0, 1, 2] is nan");
    refused([](ResultFile& f) { f.result.history.time[0] = -1; }, "/history/time[0] is -1");
    refused([](ResultFile& f) { f.network.blocks.edge_vertex[1][0] = 99; }, "/edges/vertex[1, 0] is 99");
    refused([](ResultFile& f) { f.network.blocks.vertex.emplace_back(0, 0); },
            "each vertex is an end of an edge");
    refused([](ResultFile& f) { f.network.blocks.ring_start.back() += 1; }, "/rings/first_corner");
    refused([](ResultFile& f) { f.network.blocks.block_area.push_back(1); }, "/blocks/area");
    refused([](ResultFile& f) { f.result.history.present.pop_back(); }, "/history/present");
    refused([](ResultFile& f) { f.network.names.rock[0] = std::string("a\0b", 3); }, "/names/rock[0]");
    refused([](ResultFile& f) { f.provenance.program.clear(); }, "/provenance");
}

} // namespace jointcreep::store::saving_test
