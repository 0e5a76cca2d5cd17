// An HDF5 file of the chain, of each kind. It is in memory, and has a name: HDF5 opens none that has no name, as of memfd_create.

#include "fuzz.hpp"

#include "store/files.hpp"

#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace
{

const std::string path = "/dev/shm/jointcreep-fuzz-" + std::to_string(getpid()) + ".h5";

int new_file()
{
    std::atexit([] { unlink(path.c_str()); });
    return open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace jointcreep;
    static const int file = new_file();
    if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size))
        return 0;
    const auto read = [&](auto of_kind) { fuzz::give(data, size, [&](std::string_view) { of_kind(path); }); };
    read(store::kind_of);
    read(store::reason_of_failure);
    read(store::read_network);
    read(store::read_joints);
    read(store::read_result);
    read(store::read_checkpoint);
    return 0;
}
