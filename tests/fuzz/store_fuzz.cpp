// An HDF5 file of the chain, of each kind. It is in memory.

#include "fuzz.hpp"

#include "store/files.hpp"

#include <string>

#include <sys/mman.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace jointcreep;
    static const int file = memfd_create("fuzz.h5", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
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
