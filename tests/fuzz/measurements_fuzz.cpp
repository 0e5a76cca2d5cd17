// Measured displacements of a scene with two points and two stages, and a measured curve.

#include "fuzz.hpp"

#include "scene/measurements.hpp"
#include "scene/scene.hpp"

namespace
{

const jointcreep::Scene measured = jointcreep::scene::parse_scene(R"(
[section]
outline_m = [[0, 0], [10, 0], [10, 10], [0, 10]]
rock = "rock"
gravity_m_per_s2 = 9.81
[[rock]]
name = "rock"
density_kg_per_m3 = 2500
youngs_modulus_GPa = 10
poissons_ratio = 0.2
[in_situ_stress]
elevation_m = 10
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.01
compression_yy_gradient_MPa_per_m = 0.02
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, 0]
to_m = [10, 0]
fix = "xy"
[schedule]
end = 30
[[stage]]
name = "upper"
date = 1
remove_m = [[[5, 8], [10, 8], [10, 10], [5, 10]]]
[[stage]]
name = "lower"
date = 10
remove_m = [[[5, 6], [10, 6], [10, 8], [5, 8]]]
[[point]]
name = "A"
at_m = [2, 9]
[[point]]
name = "B"
at_m = [2, 5]
first_reading = 2
[zones]
size_m = 2
)",
                                                                  "scene");

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace jointcreep;
    fuzz::give(data, size, [](std::string_view text) { scene::measurements_in_csv(text, measured); });
    return fuzz::give(data, size, [](std::string_view text) { scene::creep_curve_in_csv(text); });
}
