// Measured poles, and mapped traces in GeoJSON and CSV: all of them, or those with a property.

#include "fuzz.hpp"

#include "scene/field_data.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace jointcreep;
    const scene::TraceFilter one{.property = "set", .value = "fault"};
    fuzz::give(data, size, [](std::string_view text) { scene::poles_in_csv(text); });
    fuzz::give(data, size, [](std::string_view text) { scene::mapped_traces(text, {}); });
    return fuzz::give(data, size, [&one](std::string_view text) { scene::mapped_traces(text, one); });
}
