// A number of any key reads back as itself times the unit in the key's name, to the last bit.

#include "text.hpp"

#include <rapidcheck/gtest.h>

#include <functional>
#include <numbers>

namespace units_test
{

using namespace jointcreep;
using namespace jointcreep::scene;

namespace
{

const double pi_over_180 = std::numbers::pi / 180;

struct Case {
    std::string written; // in every_key.toml, up to the number
    std::string number;
    double factor, least, most;
    std::function<double(const Scene&)> read;
};

const std::vector<Case> cases = {
    {"gravity_m_per_s2 = ", "9.81", 1, 0, 100, [](const Scene& s) { return s.gravity; }},
    {"azimuth_deg = ", "20", pi_over_180, 0, 60, [](const Scene& s) { return *s.azimuth; }},
    {"density_kg_per_m3 = ", "2700", 1, 1, 3e4, [](const Scene& s) { return s.rocks[0].density; }},
    {"youngs_modulus_GPa = ", "30", 1e9, 1e-6, 1e4, [](const Scene& s) { return s.rocks[0].youngs_modulus; }},
    {"cohesion_MPa = ", "1.5", 1e6, 0, 1e4, [](const Scene& s) { return s.rocks[0].strength->cohesion; }},
    {"normal_stiffness_MPa_per_m = ", "5000", 1e6, 1e-9, 1e9,
     [](const Scene& s) { return s.joint_materials[0].normal_stiffness; }},
    {"normal_kelvin_viscosity_MPa_day_per_m = ", "1e5", 8.64e10, 1e-9, 1e12,
     [](const Scene& s) { return s.joint_materials[0].kelvin[0].normal_viscosity; }},
    {"mean_deg = ", "70", pi_over_180, 0, 90, [](const Scene& s) { return s.joint_sets[0].dip->mean; }},
    {"mean_m = ", "5", 1, 1e-3, 1e6, [](const Scene& s) { return s.joint_sets[0].spacing.mean; }},
    {"elevation_m = ", "20", 1, -1e6, 1e6, [](const Scene& s) { return s.in_situ_stress.elevation; }},
    {"shear_xy_MPa = ", "0", 1e6, -1e4, 1e4, [](const Scene& s) { return s.in_situ_stress.shear_xy; }},
    {"compression_yy_gradient_MPa_per_m = ", "0.026487", 1e6, -100, 100,
     [](const Scene& s) { return s.in_situ_stress.gradient_yy; }},
    {"kelvin_shear_viscosity_GPa_day = ", "2000", 8.64e13, 1e-9, 1e12,
     [](const Scene& s) { return s.rocks[0].kelvin->viscosity; }},
    {"kelvin_chain = [{ normal_stiffness_MPa_per_m = ", "900", 1e6, 1e-9, 1e9,
     [](const Scene& s) { return s.joint_materials[1].kelvin[0].normal_stiffness; }},
    {"normal_maxwell_viscosity_MPa_day_per_m = ", "1e6", 8.64e10, 1e-9, 1e12,
     [](const Scene& s) { return s.joint_materials[1].maxwell->normal_viscosity; }},
    {"step_days = ", "5", 86400, 1e-9, 1e6, [](const Scene& s) { return *s.creep->step; }},
    {"stop_rate_mm_per_day = ", "0.001", 1e-3 / 86400, 1e-9, 1e6,
     [](const Scene& s) { return *s.creep->stop_rate; }},
    {"smallest_angle_deg = ", "3", pi_over_180, 0, 30,
     [](const Scene& s) { return s.cutting.smallest_angle; }},
    {"mass_damping_per_s = ", "20", 1, 1e-9, 1e12, [](const Scene& s) { return s.equilibrium.mass_damping; }},
};

RC_GTEST_PROP(units, a_number_reads_back_in_si, ())
{
    static const std::string text = every_key_text();
    const Case& one = *rc::gen::elementOf(cases);
    const double fraction = *rc::gen::inRange(0, 1 << 30) / static_cast<double>(1 << 30);
    const double number = one.least + fraction * (one.most - one.least);
    const Scene scene =
        parse_scene(replaced(text, one.written + one.number, one.written + shown(number)), "scene.toml");
    RC_ASSERT(one.read(scene) == number * one.factor);
}

TEST(units, integers_are_numbers)
{
    const auto text = every_key_text();
    EXPECT_EQ(parse_scene(replaced(text, "= 9.81", "= 9"), "s").gravity, 9);
    EXPECT_EQ(parse_scene(replaced(text, "= 9.81", "= 0x0a"), "s").gravity, 10);
}

TEST(units, an_integer_is_not_any_number)
{
    expect_part(refusal(replaced(every_key_text(), "most_steps = 100000", "most_steps = 1e5")),
                "expected an integer");
}

} // namespace

} // namespace units_test
