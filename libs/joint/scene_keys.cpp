#include "joint/scene_keys.hpp"

#include "joint/law.hpp"

#include <algorithm>

namespace jointcreep::joint
{
namespace
{

using namespace keys;

constexpr KeyUnit MPa_day_per_m{"MPa day/m", unit::MPa* unit::day / unit::m};

constexpr Range viscosity = from(1e-9).to(1e12); // [MPa day/m]

Range stiffness() // [MPa/m]
{
    return parameters::normal_stiffness.range;
}

// A member of a material's first Kelvin unit; reading it makes the unit.
template <auto Member>
constexpr auto unit_part = [](JointMaterial& material) -> double& {
    if (material.kelvin.empty())
        material.kelvin.emplace_back();
    return material.kelvin.front().*Member;
};

Table<Kelvin> kelvin_chain()
{
    return {{"joint_material.kelvin_chain", Written::inside, Need::optional, "One Kelvin unit of a chain."},
            {number("normal_stiffness_MPa_per_m", &Kelvin::normal_stiffness, MPa_per_m, stiffness(),
                    "Stiffness of its spring, normal."),
             number("normal_viscosity_MPa_day_per_m", &Kelvin::normal_viscosity, MPa_day_per_m, viscosity,
                    "Its dashpot, normal."),
             number("shear_stiffness_MPa_per_m", &Kelvin::shear_stiffness, MPa_per_m, stiffness(),
                    "Its spring, shear."),
             number("shear_viscosity_MPa_day_per_m", &Kelvin::shear_viscosity, MPa_day_per_m, viscosity,
                    "Its dashpot, shear.")}};
}

Table<JointMaterial> joint_material(const Table<Kelvin>& chain)
{
    constexpr auto maxwell = &JointMaterial::maxwell;
    const auto read_chain = [chain](const KeyInfo& key, const TomlValue& value, const Place& place) {
        return read_rows(chain, 1, 20, key, value, place);
    };
    std::vector<Key<JointMaterial>> keys{
        text("name", &JointMaterial::name, "Name, once among the joint materials.")};
    for (const Parameter& parameter : all_parameters()) {
        auto key = number<JointMaterial>(
            std::string(parameter.key),
            [parameter](JointMaterial& material) -> double& { return parameter.in(material); },
            parameter.unit, parameter.range, std::string(parameter.meaning));
        const auto law = std::ranges::find_if(
            laws(), [&](const LawInfo& one) { return std::ranges::count(one.own, parameter.name) > 0; });
        if (law != laws().end())
            key = law->own.size() > 1 ? std::move(key).together(std::string(law->name))
                                      : std::move(key).optional();
        else if (parameter.otherwise)
            key = std::move(key).or_else(*parameter.otherwise);
        keys.push_back(std::move(key));
    }
    std::vector<Key<JointMaterial>> creep{
        number<JointMaterial>("normal_kelvin_stiffness_MPa_per_m", unit_part<&Kelvin::normal_stiffness>,
                              MPa_per_m, stiffness(), "Kelvin spring, normal.")
            .together("Kelvin"),
        number<JointMaterial>("normal_kelvin_viscosity_MPa_day_per_m", unit_part<&Kelvin::normal_viscosity>,
                              MPa_day_per_m, viscosity, "Kelvin dashpot, normal.")
            .together("Kelvin"),
        number<JointMaterial>("shear_kelvin_stiffness_MPa_per_m", unit_part<&Kelvin::shear_stiffness>,
                              MPa_per_m, stiffness(), "Kelvin spring, shear.")
            .together("Kelvin"),
        number<JointMaterial>("shear_kelvin_viscosity_MPa_day_per_m", unit_part<&Kelvin::shear_viscosity>,
                              MPa_day_per_m, viscosity, "Kelvin dashpot, shear.")
            .together("Kelvin"),
        key_of<JointMaterial>({"kelvin_chain",
                               "Kelvin units",
                               {},
                               {},
                               "Several Kelvin units in series, in place of the four keys of one."},
                              &JointMaterial::kelvin, read_chain)
            .asks_for("one Kelvin unit or more, [{ normal_stiffness_MPa_per_m = 690, ... }, ...]")
            .optional(),
        number<JointMaterial>("normal_maxwell_viscosity_MPa_day_per_m",
                              in_optional<maxwell, &Maxwell::normal_viscosity>, MPa_day_per_m, viscosity,
                              "Maxwell dashpot, normal: it creeps without end.")
            .together("Maxwell"),
        number<JointMaterial>("shear_maxwell_viscosity_MPa_day_per_m",
                              in_optional<maxwell, &Maxwell::shear_viscosity>, MPa_day_per_m, viscosity,
                              "Maxwell dashpot, shear.")
            .together("Maxwell")};
    std::ranges::move(creep, std::back_inserter(keys));
    return {
        {"joint_material", Written::in_list, Need::optional,
         "Properties of joints: springs of stress per displacement, Coulomb friction, and creep units in "
         "series with the springs: Kelvin units (spring parallel to dashpot) and a Maxwell dashpot. One "
         "Kelvin unit has keys of its own; several are a kelvin_chain. A Kelvin unit and a Maxwell dashpot "
         "make a Burgers joint. Without them the joint does not creep."},
        keys};
}

// Finds the law from the given keys.
void find_law(JointMaterial& material)
{
    for (std::size_t law = 0; law < laws().size(); ++law)
        if (std::ranges::any_of(laws()[law].own,
                                [&](std::string_view own) { return material.own.contains(own); }))
            material.law = static_cast<Index>(law);
}

// --- Checks ---------------------------------------------------------------------------------------------

std::string name_of_key(std::string_view parameter)
{
    return std::string(std::ranges::find(all_parameters(), parameter, &Parameter::name)->key);
}

void check_joint_materials(const Scene& scene, const Source& source)
{
    for (std::size_t i = 0; i < scene.joint_materials.size(); ++i) {
        const Given given = source.in_list("joint_material", i);
        if (given.find("kelvin_chain") && given.find("normal_kelvin_stiffness_MPa_per_m"))
            given.refuse("kelvin_chain", "expected either it, or the four keys of one Kelvin unit, not both");
        const JointMaterial& material = scene.joint_materials[i];
        const LawInfo& law = laws()[static_cast<std::size_t>(material.law)];
        for (const LawInfo& other : laws())
            for (const std::string_view name : other.own)
                if (material.own.contains(name) && std::ranges::count(law.own, name) == 0)
                    given.refuse(name_of_key(name), "expected keys of one joint law; those of \"" +
                                                        std::string(law.name) + "\" are given, too");
        if (!law.creeps)
            for (const char* const key : {"kelvin_chain", "normal_kelvin_stiffness_MPa_per_m",
                                          "normal_maxwell_viscosity_MPa_day_per_m"})
                if (given.find(key))
                    given.refuse(key, "a joint of the law \"" + std::string(law.name) + "\" does not creep");
        const auto complaint = law.check([&](const Parameter& parameter) { return parameter.of(material); });
        if (complaint)
            given.refuse(std::string(complaint->parameter.key), complaint->wanted);
    }
}

Table<Averaging> averaging()
{
    return {
        {"averaging", Written::once, Need::optional,
         "How joints and their rock bridges become equivalent joints."},
        {choice(
             "over", &Averaging::over,
             {{"edge", AverageOver::edge}, {"line", AverageOver::line}, {"set", AverageOver::set}},
             "Joint and bridges are averaged over each edge between two blocks, each joint's whole line, or "
             "all lines of a set.")
             .or_else(std::string("edge")),
         choice("stiffness", &Averaging::stiffness,
                {{"joint", StiffnessRule::joint},
                 {"lower bound", StiffnessRule::lower_bound},
                 {"upper bound", StiffnessRule::upper_bound},
                 {"staggered", StiffnessRule::staggered}},
                "Stiffnesses and Kelvin constants of a joint with rock bridges. joint: those of the joint "
                "itself. lower bound, upper bound: bounds for joint traces that rock bridges connect. "
                "staggered: those of many lines with staggered traces and bridges.")
             .or_else(std::string("joint"))}};
}

} // namespace

ForceKeys<Scene> scene_keys()
{
    const Table<Kelvin> chain = kelvin_chain();
    const Table<JointMaterial> material = joint_material(chain);
    const auto read = [material](const TomlValue& root, Reading& reading, Scene& scene) {
        scene.joint_materials = read_list(material, root, reading);
        std::ranges::for_each(scene.joint_materials, find_law);
    };
    auto materials = part_read_by<Scene>(material, read);
    materials.has_names = true;
    materials.values = check_joint_materials;
    auto averages = part_once<Scene>(averaging(), &Scene::averaging);
    averages.turn = keys::Turn::settings;
    return {.materials = {materials, part_inside<Scene>(chain)}, .settings = {averages}};
}

} // namespace jointcreep::joint
