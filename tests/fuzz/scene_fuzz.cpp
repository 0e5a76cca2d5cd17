// The text of a scene.

#include "fuzz.hpp"

#include "scene/scene.hpp"
#include "scene/shorthand.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace jointcreep;
    return fuzz::give(data, size, [](std::string_view text) {
        scene::parse_scene(scene::written_out(std::string(text), "scene"), "scene");
    });
}
