// What the fuzz targets share. A target gives bytes to a reader, as libFuzzer asks: it may refuse them by an exception of
// model/error.hpp, or by the end of the process with exit code 2. Whatever else ends the process is a fault.

#pragma once

#include "model/error.hpp"

#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <unistd.h>

namespace jointcreep::fuzz
{

inline std::jmp_buf refused;
inline bool is_reading = false;

// Calls read(text).
template <class Read>
int give(const std::uint8_t* data, std::size_t size, Read read)
{
    is_reading = true;
    if (setjmp(refused) == 0)
        try {
            read(std::string_view(reinterpret_cast<const char*>(data), size));
        } catch (const input_error&) {
        } catch (const file_error&) {
        }
    is_reading = false;
    return 0;
}

} // namespace jointcreep::fuzz

// In place of the C library's. A reader that cannot throw where it meets what it cannot read ends the process with code 2;
// here the next bytes are read.
extern "C" void _Exit(int code) noexcept
{
    using namespace jointcreep::fuzz;
    if (code == 2 && is_reading)
        std::longjmp(refused, 1);
    _exit(code);
}
