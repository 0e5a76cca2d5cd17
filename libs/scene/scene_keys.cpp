#include "scene/scene_keys.hpp"

#include "model/error.hpp"
#include "sampling/laws.hpp"
#include "scene/field_data.hpp"
#include "scene/forces.hpp"
#include "scene/shared_settings.hpp"

#include <filesystem>
#include <iterator>

namespace jointcreep::scene
{
namespace
{

using namespace keys;
using enum Need;
using enum Written;

constexpr KeyUnit m_per_s2{"m/s2", unit::m / (unit::s * unit::s)};
constexpr KeyUnit per_s{"1/s", 1 / unit::s};
constexpr KeyUnit seconds{"s", unit::s};
constexpr KeyUnit mm_per_day{"mm/day", unit::mm / unit::day};

constexpr double usual_shortest_edge = 0.02; // over size_at_faces_m of [zones], or over size_m without it [-]
constexpr double usual_local_damping = 0.8;

struct Schedule {
    Calendar& calendar; // filled by the first key, and used by all later dates
    double end = 0;     // since start [s]
};

// A law as a scene writes it. Every law has its own keys; the others stay 0.
struct WrittenLaw {
    ProbabilityLaw::Kind kind = ProbabilityLaw::Kind::constant;
    double mean = 0, deviation = 0;
    double half_width = 0;            // of a uniform law of angles
    double shortest = 0, longest = 0; // of a uniform law of lengths, and of a power law
    double exponent = 0;
};

// A law of poles as a scene writes it.
struct WrittenOrientation {
    bool bootstrap = false;
    FisherLaw fisher{};
    std::vector<MeasuredPole> poles{};
    std::string file{}; // of poles
    Scanline scanline{};
    double blind_zone = 0; // [rad]
};

// A density as a scene writes it: one of five measures.
struct WrittenDensity {
    std::optional<double> p10{}, p20{}, p21{}, p30{}, p32{};
    Scanline scanline{};
};

// A mapped set before its file is read.
struct WrittenMapped {
    std::string name, material, file, layer, property, value;
};

// A file that the scene holds.
struct HeldFile {
    std::string name, text;
};

Table<Scene> top()
{
    return {{"", once, optional, "Keys before the first table."},
            {text("title", &Scene::title, "What the scene is, in a line.").optional()}};
}

Table<Scene> variables()
{
    return {
        {"variables", once, optional,
         "Names for numbers: `H = 40`. A name consists of letters, digits and _. A key of the scene that wants a number "
         "can have a formula, a text with such names, numbers, + - * / ^ and ( ): `size_m = \"H / 20\"`, "
         "`outline_m = [[0, 0], [\"2 * H\", 0], ...]`. Functions are `exp`, `ln`, `sqrt`, `abs`, `min`, `max` (of two "
         "values or more), `sind`, `cosd` and `tand` (of an angle in degrees), and `atand` (an angle in degrees): "
         "`\"H / tand(dip)\"`. A variable may be a formula, too. Formulas of numbers alone, `size_m = \"3 / 2\"`, need no "
         "[variables]; a single number has no quotes. A date can be a formula of days. The copy of the scene in the "
         "programs' files has the numbers."},
        {}};
}

Table<Scene> section()
{
    return {
        {"section", once, required, "The section: a vertical plane through the rock, x to the right, y up."},
        {polygon("outline_m", &Scene::outline, "Its outline, in either direction."),
         polygons(
             "holes_m", &Scene::holes,
             "Where there is no rock from the start, a tunnel for example: inside the outline, not touching "
             "it or each other.")
             .optional(),
         text("rock", &Scene::rock, "Name of the rock that no region covers."),
         number("gravity_m_per_s2", &Scene::gravity, m_per_s2, from(0).to(100), "Gravity, downward."),
         number("azimuth_deg", &Scene::azimuth, degrees, from(0).to(360),
                "Bearing of the x axis, clockwise from north. Needed by joint sets with a dip.")
             .optional()}};
}

Table<SingleJoint> joint()
{
    return {
        {"joint", in_list, optional,
         "One joint or fault given by its ends, without rock bridges. Where a joint lies "
         "on an earlier one, the later joint replaces it. So a part of a joint can have its own material."},
        {text("name", &SingleJoint::name, "Name, once among the joints, joint sets and mapped sets."),
         text("material", &SingleJoint::material, "Name of its joint material."),
         point("from_m", &SingleJoint::from, "One end."), point("to_m", &SingleJoint::to, "The other end.")}};
}

// --- Laws -------------------------------------------------------------------------------------------------

constexpr double fewest_deviations = 3; // in the mean of a normal law of a length
constexpr double widest_range = 1e6;    // of the lengths of a power law: longest over shortest

using Kind = ProbabilityLaw::Kind;

// The words of a scene for a law, and the keys it needs; it takes no others.
struct LawWords {
    Kind kind;
    std::string_view word;
    std::vector<std::string> keys;
};

const std::vector<LawWords>& laws_of_angles()
{
    static const std::vector<LawWords> laws{{Kind::normal, "normal", {"mean_deg", "deviation_deg"}},
                                            {Kind::uniform, "uniform", {"mean_deg", "half_width_deg"}},
                                            {Kind::constant, "constant", {"mean_deg"}}};
    return laws;
}

const std::vector<LawWords>& laws_of_lengths()
{
    static const std::vector<LawWords> laws{{Kind::normal, "normal", {"mean_m", "deviation_m"}},
                                            {Kind::lognormal, "lognormal", {"mean_m", "deviation_m"}},
                                            {Kind::negative_exponential, "negative exponential", {"mean_m"}},
                                            {Kind::uniform, "uniform", {"shortest_m", "longest_m"}},
                                            {Kind::power, "power", {"exponent", "shortest_m", "longest_m"}},
                                            {Kind::constant, "constant", {"mean_m"}}};
    return laws;
}

Key<WrittenLaw> law_choice(const std::vector<LawWords>& laws)
{
    std::vector<std::pair<std::string_view, Kind>> words;
    for (const LawWords& law : laws)
        words.emplace_back(law.word, law.kind);
    return choice("law", &WrittenLaw::kind, words, "Probability law.");
}

Table<WrittenLaw> angle_law(const std::string& name, Range range, const std::string& doc)
{
    return {
        {"joint_set." + name, inside, optional, doc},
        {law_choice(laws_of_angles()),
         number("mean_deg", &WrittenLaw::mean, degrees, range, "Mean: needed by all laws."),
         number("deviation_deg", &WrittenLaw::deviation, degrees, above(0).to(90),
                "Standard deviation: needed by the normal law, refused by the others.")
             .optional(),
         number("half_width_deg", &WrittenLaw::half_width, degrees, above(0).to(90),
                "All angles up to this distance from the mean are equally likely: needed by the uniform law, "
                "refused by the others.")
             .optional()}};
}

Table<WrittenLaw> length_law(const std::string& name, Need need, const std::string& doc)
{
    return {
        {"joint_set." + name, inside, need, doc},
        {law_choice(laws_of_lengths()),
         number("mean_m", &WrittenLaw::mean, metres, lengths,
                "Mean of the quantity itself, never of its logarithm: needed by the normal, lognormal, "
                "negative exponential and constant laws, refused by the others.")
             .optional(),
         number(
             "deviation_m", &WrittenLaw::deviation, metres, lengths,
             "Standard deviation of the quantity itself: needed by the normal and lognormal laws, refused by "
             "the others. With the normal law the mean must be at least 3 deviations: values of 0 or less "
             "are drawn again, and then this changes the mean very little.")
             .optional(),
         number("shortest_m", &WrittenLaw::shortest, metres, from(0).to(farthest_metre),
                "Least value, a cut-off: needed by the uniform and power laws, refused by the others. With "
                "a power law at least 1e-6 of longest_m.")
             .optional(),
         number("longest_m", &WrittenLaw::longest, metres, lengths,
                "Largest value, a cut-off above shortest_m: needed by the uniform and power laws, refused "
                "by the others.")
             .optional(),
         number(
             "exponent", &WrittenLaw::exponent, no_unit, from(0).to(20),
             "Exponent of the power law: the probability density is proportional to the value to the power "
             "of minus this exponent. If you have fitted the exponent to the number of values that are larger than a given value, add 1 "
             "to it. Needed by the power law, refused by the others.")
             .optional()}};
}

std::vector<MeasuredPole> read_poles(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    constexpr std::size_t most_poles = 100000;
    const auto* const list = std::get_if<TomlValue::List>(&value.content);
    if (!list || list->empty() || list->size() > most_poles)
        place.refuse(key, value);
    KeyInfo dip = key, direction = key;
    dip.unit = direction.unit = degrees;
    dip.range = from(0).to(90);
    direction.range = from(0).to(360);
    std::vector<MeasuredPole> poles;
    for (const TomlValue& one : *list) {
        const auto* const pair = std::get_if<TomlValue::List>(&one.content);
        if (!pair || pair->size() != 2)
            place.refuse(key, value);
        poles.push_back(
            {read_number(dip, pair->front(), place), read_number(direction, pair->back(), place), 1});
    }
    return poles;
}

// At the least concentration, 5, 7 poles in a thousand are past 90 degrees from the mean pole; below, the set
// has hardly a direction left.
Table<WrittenOrientation> orientation_law()
{
    using W = WrittenOrientation;
    const auto dip = [](W& law) -> double& { return law.fisher.dip; };
    const auto dip_direction = [](W& law) -> double& { return law.fisher.dip_direction; };
    const auto concentration = [](W& law) -> double& { return law.fisher.concentration; };
    const auto trend = [](W& law) -> double& { return law.scanline.trend; };
    const auto plunge = [](W& law) -> double& { return law.scanline.plunge; };
    const std::string fisher_only = ": needed by Fisher's law, refused by the other.",
                      bootstrap_only = " With the law bootstrap only.";
    return {
        {"joint_set.orientation", inside, optional,
         "Law of the poles (normals) of the joint planes in space, which needs section.azimuth_deg. For segments and "
         "discs the law describes all joints in space. For lines there are two cases. The bootstrap describes all planes of "
         "the set. Fisher's law describes only those planes of the set that cross a scanline which lies in the section, "
         "normal to the mean trace. The "
         "larger the angle between a joint and the section, the more often the section cuts it; jointgen takes this into account."},
        {choice("law", &W::bootstrap, {{"Fisher", false}, {"bootstrap", true}},
                "Probability law. Fisher's: symmetric about the mean pole. Bootstrap: measured poles, drawn "
                "with replacement."),
         number<W>("mean_dip_deg", dip, degrees, from(0).to(90),
                   "Dip below the horizontal of the plane of the mean pole" + fisher_only)
             .optional(),
         number<W>("mean_dip_direction_deg", dip_direction, degrees, from(0).to(360),
                   "Bearing of the dip of that plane, clockwise from north" + fisher_only)
             .optional(),
         number<W>(
             "concentration", concentration, no_unit, from(5).to(1e6),
             "Fisher's constant kappa: a large value means little scatter. 63 percent of the poles lie "
             "within 81 / sqrt(kappa) degrees of their mean; the standard deviation about each of two axes is 57.3 / sqrt(kappa) "
             "degrees, so 5 degrees are kappa = 131. Needed by Fisher's law, refused by the other.")
             .optional(),
         key_of<W>({"poles_deg",
                    "poles",
                    {},
                    {},
                    "The measured planes, [[dip, dip direction], ...]. The law bootstrap needs either it or "
                    "poles."},
                   &W::poles, read_poles)
             .asks_for("poles [[dip, dip direction], ...] of numbers in [0, 90] and [0, 360] deg")
             .optional(),
         text(
             "poles", &W::file,
             "File with the measured planes, in the folder of the scene or in a subfolder: CSV with the columns "
             "dip_deg, dip_direction_deg and, optional, weight." +
                 bootstrap_only)
             .optional(),
         number<W>(
             "scanline_trend_deg", trend, degrees, from(0).to(360),
             "Bearing of the scanline or borehole on which the planes were measured, toward its lower end (toward its upper end with "
             "a negative plunge). They "
             "then have Terzaghi's weights: one over the cosine of the angle between pole and scanline." +
                 bootstrap_only)
             .together("scanline"),
         number<W>("scanline_plunge_deg", plunge, degrees, from(-90).to(90),
                   "Its inclination below the horizontal." + bootstrap_only)
             .together("scanline"),
         number("blind_zone_deg", &W::blind_zone, degrees, above(0).to(45),
                "Planes at a smaller angle to the scanline have the weight of planes at this angle. With a "
                "scanline only.")
             .optional("10")}};
}

// Refuses keys that the law lacks or does not take.
void check_law_keys(const Table<WrittenLaw>& table, const LawWords& law, const TomlValue& value,
                    const Place& place)
{
    const std::string the_law = "the law \"" + std::string(law.word) + "\" ";
    for (const Key<WrittenLaw>& key : table.keys) {
        if (key.info.name == "law")
            continue;
        const TomlValue* const given = value.find(key.info.name);
        const bool wanted = std::find(law.keys.begin(), law.keys.end(), key.info.name) != law.keys.end();
        if (wanted && !given)
            place.refuse(value.line, place.table + " has no " + key.info.name + ": " + the_law + "needs it");
        if (!wanted && given)
            place.refuse(given->line, place.table + " " + key.info.name + " = " + shown(*given) + ": " +
                                          the_law + "does not take it");
    }
}

void check_range(const WrittenLaw& law, const TomlValue& value, const Place& place)
{
    if (law.longest <= law.shortest)
        place.refuse(value.line, place.table + " longest_m = " + shown(law.longest) +
                                     " m: expected above shortest_m, " + shown(law.shortest) + " m");
    if (law.kind == Kind::power && law.shortest * widest_range < law.longest)
        place.refuse(value.line, place.table + " shortest_m = " + shown(law.shortest) +
                                     " m: the law \"power\" needs at least 1e-6 of longest_m, here " +
                                     shown(law.longest / widest_range) + " m");
}

ProbabilityLaw law_of(const WrittenLaw& law)
{
    switch (law.kind) {
    case Kind::uniform:
        return law.half_width > 0 ? uniform_law(law.mean - law.half_width, law.mean + law.half_width)
                                  : uniform_law(law.shortest, law.longest);
    case Kind::power:
        return power_law(law.exponent, law.shortest, law.longest);
    case Kind::negative_exponential:
        return {law.kind, law.mean, law.mean};
    case Kind::constant:
    case Kind::normal:
    case Kind::lognormal:
        break;
    }
    return {law.kind, law.mean, law.deviation};
}

ProbabilityLaw read_law(const Table<WrittenLaw>& table, const std::vector<LawWords>& laws,
                        const TomlValue& value, const Place& outer)
{
    const Place place{outer.reading, table.info.shown()};
    WrittenLaw law;
    read_table(table, value, place, law);
    check_law_keys(table,
                   *std::find_if(laws.begin(), laws.end(),
                                 [&](const LawWords& words) { return words.kind == law.kind; }),
                   value, place);
    if (&laws == &laws_of_lengths()) {
        if (law.kind == Kind::normal && law.mean < fewest_deviations * law.deviation)
            place.refuse(table.keys[1].info, *value.find("mean_m"),
                         "the law \"normal\" needs a mean of at least 3 deviations, here " +
                             shown(fewest_deviations * law.deviation) +
                             " m; a lognormal law has no such limit");
        if (law.kind == Kind::uniform || law.kind == Kind::power)
            check_range(law, value, place);
    }
    return law_of(law);
}

constexpr const char* a_law = "a law such as { law = \"constant\", mean_m = 2 }";

template <class Member>
Key<JointSet> law(std::string name, Member member, const Table<WrittenLaw>& table,
                  const std::vector<LawWords>& laws, std::string doc)
{
    return key_of<JointSet>({std::move(name), "law", {}, {}, std::move(doc)}, member,
                            [table, &laws](const KeyInfo&, const TomlValue& value, const Place& place) {
                                return read_law(table, laws, value, place);
                            })
        .asks_for(a_law);
}

// The text of a file that a key names.
const std::string& text_of_file(const std::string& file, const TomlValue& key_value, const std::string& key,
                                const Place& place)
{
    const auto found = place.reading.files.find(file);
    if (found == place.reading.files.end())
        place.refuse(
            key_value.line,
            place.table + " " + key + " = " + shown(key_value) + ": expected the name of " +
                (is_beside_scene(file)
                     ? "a file beside the scene that can be read, or of a [[file]] in it"
                     : "a file in the folder of the scene, or in a folder there, without \"..\". Copy the "
                       "file to the scene"));
    return found->second;
}

void read_bootstrap(const TomlValue& value, const Place& place, WrittenOrientation& law)
{
    const TomlValue* const file = value.find("poles");
    if ((file != nullptr) == !law.poles.empty())
        place.refuse(value.line, place.table +
                                     (file ? " has both poles_deg and poles" : " has no poles_deg") +
                                     ": the law \"bootstrap\" needs either poles_deg or poles");
    if (file) {
        const std::string& text = text_of_file(law.file, *file, "poles", place);
        try {
            law.poles = poles_in_csv(text);
        } catch (const input_error& error) {
            place.refuse(file->line, place.table + " poles = " + shown(*file) + ": " + error.what());
        }
    }
    const bool measured_on_line = value.find("scanline_trend_deg") != nullptr;
    if (!measured_on_line && value.find("blind_zone_deg"))
        place.refuse(value.find("blind_zone_deg")->line,
                     place.table + " blind_zone_deg: expected scanline_trend_deg beside it");
    constexpr double usual_blind_zone = 10 * unit::deg;
    if (measured_on_line)
        correct_for_scanline(law.poles, law.scanline, law.blind_zone > 0 ? law.blind_zone : usual_blind_zone);
}

// The persistence of lines whose traces and rock bridges have these means.
Key<JointSet> bridge_length()
{
    const auto read = [](JointSet& set, const KeyInfo& key, const TomlValue& value, const Place& place) {
        const double bridge = read_number(key, value, place);
        if (!set.length) // its key is read before this one
            return;
        const double trace = sampling::mean_of_positive(*set.length);
        set.persistence = trace / (trace + bridge);
    };
    Key<JointSet> key{
        {"bridge_length_m", "number", metres, lengths,
         "Mean length of the rock bridges of lines, in place of persistence. Persistence is then the mean "
         "trace length over the sum of both means."},
        read,
        {}};
    return std::move(key).optional();
}

Key<JointSet> orientation(const Table<WrittenOrientation>& table)
{
    const auto read = [table](JointSet& set, const KeyInfo&, const TomlValue& value, const Place& outer) {
        const Place place{outer.reading, table.info.shown()};
        WrittenOrientation law;
        read_table(table, value, place, law);
        for (const Key<WrittenOrientation>& key : table.keys) {
            if (key.info.name == "law")
                continue;
            const bool of_fisher = key.info.name.starts_with("mean_") || key.info.name == "concentration";
            const TomlValue* const given = value.find(key.info.name);
            if (given && of_fisher == law.bootstrap)
                place.refuse(given->line, place.table + " " + key.info.name + " = " + shown(*given) +
                                              ": the law does not take it");
            if (!given && of_fisher && !law.bootstrap)
                place.refuse(value.line,
                             place.table + " has no " + key.info.name + ": the law \"Fisher\" needs it");
        }
        if (!law.bootstrap) {
            set.orientation = law.fisher;
            return;
        }
        read_bootstrap(value, place, law);
        set.poles = law.poles;
    };
    Key<JointSet> key{{"orientation", "law", {}, {}, "Law of the joint planes' poles in space."}, read, {}};
    return std::move(key).asks_for(a_law).optional();
}

Table<WrittenDensity> density_table()
{
    using W = WrittenDensity;
    constexpr KeyUnit per_m{"1/m", 1 / unit::m}, per_m2{"1/m2", 1 / (unit::m * unit::m)},
        per_m3{"1/m3", 1 / (unit::m * unit::m * unit::m)};
    const auto angle = [](W& all) -> std::optional<double>& { return all.scanline.angle; };
    const auto trend = [](W& all) -> double& { return all.scanline.trend; };
    const auto plunge = [](W& all) -> double& { return all.scanline.plunge; };
    const Range dense = from(1e-9).to(1e6);
    return {
        {"joint_set.density", inside, optional,
         "Density of a set, by one of five measures. Joint traces count before terminations at other sets "
         "shorten them. For lines the density sets the mean spacing. If a spacing is given too, only its law and its relative "
         "scatter are used. Scatter of the orientation is taken into account."},
        {number(
             "P10_per_m", &W::p10, per_m, dense,
             "Joint traces that a scanline meets per metre. It needs the direction of the scanline: "
             "scanline_angle_deg, or scanline_trend_deg and scanline_plunge_deg. Give it as counted: jointgen applies "
             "Terzaghi's correction.")
             .optional(),
         number("P20_per_m2", &W::p20, per_m2, dense, "Trace midpoints per area of section; not of lines.")
             .optional(),
         number("P21_per_m", &W::p21, per_m, dense, "Trace length per area of section.").optional(),
         number("P30_per_m3", &W::p30, per_m3, dense, "Disc centres per volume; of discs only.").optional(),
         number("P32_per_m", &W::p32, per_m, dense,
                "Joint area per volume; of sets with an orientation in space.")
             .optional(),
         number<W>("scanline_angle_deg", angle, degrees, within(180),
                   "Direction of the scanline in the section, counter-clockwise from the x axis; with "
                   "P10_per_m only.")
             .optional(),
         number<W>(
             "scanline_trend_deg", trend, degrees, from(0).to(360),
             "Bearing of a scanline in space, toward its lower end (toward its upper end with a negative plunge); with "
             "P10_per_m only.")
             .together("scanline"),
         number<W>("scanline_plunge_deg", plunge, degrees, from(-90).to(90),
                   "Its inclination below the horizontal.")
             .together("scanline")}};
}

Density read_density(const Table<WrittenDensity>& table, const TomlValue& value, const Place& outer)
{
    using Measure = Density::Measure;
    const Place place{outer.reading, table.info.shown()};
    WrittenDensity written;
    read_table(table, value, place, written);
    const std::vector<std::pair<Measure, std::optional<double>>> measures{{Measure::p10, written.p10},
                                                                          {Measure::p20, written.p20},
                                                                          {Measure::p21, written.p21},
                                                                          {Measure::p30, written.p30},
                                                                          {Measure::p32, written.p32}};
    std::optional<Density> density;
    for (const auto& [measure, amount] : measures)
        if (amount) {
            if (density)
                place.refuse(value.line, place.table + " = " + shown(value) + ": expected one measure alone");
            density = Density{measure, *amount, written.scanline};
        }
    if (!density)
        place.refuse(value.line, place.table + " = " + shown(value) +
                                     ": expected one of P10_per_m, P20_per_m2, P21_per_m, P30_per_m3 and "
                                     "P32_per_m");
    const bool angle = value.find("scanline_angle_deg"), trend = value.find("scanline_trend_deg");
    if (density->measure == Measure::p10 && angle == trend)
        place.refuse(value.line, place.table + " = " + shown(value) +
                                     ": P10_per_m needs either scanline_angle_deg, or scanline_trend_deg and "
                                     "scanline_plunge_deg");
    if (density->measure != Measure::p10 && (angle || trend))
        place.refuse(value.line,
                     place.table + " = " + shown(value) + ": only P10_per_m is measured on a scanline");
    return *density;
}

// The tables inside a joint set.
struct TablesInJointSet {
    Table<MaterialInRock> material_in;
    Table<WrittenLaw> trace_angle, dip, dip_direction, spacing, length, diameter;
    Table<WrittenOrientation> orientation;
    Table<WrittenDensity> density;
};

Table<MaterialInRock> material_in()
{
    return {{"joint_set.material_in", inside, optional,
             "Joint material of the set's joints in one of the rocks."},
            {text("rock", &MaterialInRock::rock, "Name of the rock."),
             text("material", &MaterialInRock::material, "Name of the joint material.")}};
}

Table<JointSet> joint_set(const TablesInJointSet& laws)
{
    const auto read_materials = [table = laws.material_in](const KeyInfo& key, const TomlValue& value,
                                                           const Place& place) {
        return read_rows(table, 1, 100, key, value, place);
    };
    const auto read_amount = [table = laws.density](const KeyInfo&, const TomlValue& value,
                                                    const Place& place) {
        return read_density(table, value, place);
    };
    return {
        {"joint_set", in_list, optional,
         "Joints with the same statistics. Their orientation is given by one of trace_angle, orientation, or "
         "dip and dip_direction."},
        {text("name", &JointSet::name, "Name, once among the joints, joint sets and mapped sets."),
         text("material", &JointSet::material, "Name of the joint material of its traces."),
         key_of<JointSet>(
             {"material_in",
              "rocks and materials",
              {},
              {},
              "Other joint materials in some of the rocks, for joints that run from one rock into "
              "another. Along a border between two rocks the material with the smaller "
              "normal stiffness is used."},
             &JointSet::material_in, read_materials)
             .optional(),
         choice(
             "kind", &JointSet::kind,
             {{"lines", SetKind::lines}, {"segments", SetKind::segments}, {"discs", SetKind::discs}},
             "lines: lines through the whole section; along each line joint traces and rock bridges "
             "alternate. segments: joint traces at random places in the section (Baecher). discs: the traces "
             "of discs at random places in space.")
             .or_else(std::string("lines")),
         law("trace_angle", &JointSet::trace_angle, laws.trace_angle, laws_of_angles(),
             "Angle of the traces in the section. Not for discs.")
             .optional(),
         law("dip", &JointSet::dip, laws.dip, laws_of_angles(), "Dip of the joint planes.").optional(),
         law("dip_direction", &JointSet::dip_direction, laws.dip_direction, laws_of_angles(),
             "Dip direction of the joint planes.")
             .optional(),
         orientation(laws.orientation),
         law("spacing", &JointSet::spacing, laws.spacing, laws_of_lengths(),
             "For lines: distance between neighbouring joint planes. Lines need it or a density. With both, "
             "the density gives the mean, and the law is scaled to this mean. With a density alone the law "
             "is negative exponential. The position of the first line is random, also with a constant "
             "spacing. For a joint at a given place use [[joint]].")
             .optional(),
         key_of<JointSet>(
             {"density", "density", {}, {}, "Density of the joints. Segments and discs need it."},
             &JointSet::density, read_amount)
             .asks_for("a density such as { P21_per_m = 0.5 }")
             .optional(),
         law("length", &JointSet::length, laws.length, laws_of_lengths(),
             "Length of the joint traces, before terminations at other sets shorten them. Segments need it, and "
             "lines unless their persistence is 0 or 1.")
             .optional(),
         law("diameter", &JointSet::diameter, laws.diameter, laws_of_lengths(),
             "Diameter of the discs. Discs need it; other kinds refuse it.")
             .optional(),
         number("persistence", &JointSet::persistence, no_unit, from(0).to(1),
                "Fraction of a line that is joint. Lines need it, or bridge_length_m. Segments and discs "
                "refuse it: they end where their length or diameter ends.")
             .optional(),
         bridge_length(),
         names("terminates_at", &JointSet::terminates_at,
               "Names of joint sets, joints and mapped sets. Traces of this set may end at their traces. For "
               "segments and discs.")
             .optional(),
         number("termination_probability", &JointSet::termination_probability, no_unit, above(0).to(1),
                "Probability that a trace, grown from its midpoint, ends at a crossing with one of them.")
             .or_else(1.0),
         polygon("region_m", &JointSet::region, "Where the set exists.").optional("the whole section"),
         names("rocks", &JointSet::rocks, "Names of the rocks in which the set exists, instead of a region.")
             .optional("all")}};
}

Table<WrittenMapped> mapped()
{
    using W = WrittenMapped;
    return {
        {"mapped", in_list, optional,
         "Joint traces from a map of the section: every straight piece is a joint without rock bridges."},
        {text("name", &W::name, "Name, once among the joints, joint sets and mapped sets."),
         text("material", &W::material, "Name of the joint material."),
         text(
             "file", &W::file,
             "File in the folder of the scene or in a subfolder, with coordinates in metres of the section. "
             "One of: GeoJSON of LineString and MultiLineString; CSV with the columns x1_m, y1_m, x2_m, y2_m "
             "and, optional, id; CSV with the columns id, x_m, y_m, a row for each point of a trace, the "
             "rows of a trace one after another; GeoPackage, Shapefile or DXF, if the programs were built "
             "with GDAL. If every id is a whole number from 0 to 2097151, it is the number of the joint. "
             "Otherwise the position in the file is its number."),
         text("layer", &W::layer,
              "Layer of the file (DXF: layer of the entities). Needed where lines are in several layers.")
             .optional(),
         text("property", &W::property,
              "Name of a property, in CSV of a column. Only traces for which it has the value below are "
              "used.")
             .together("property"),
         text("value", &W::value, "The property's value.").together("property")}};
}

std::string read_file_text(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const text = std::get_if<std::string>(&value.content);
    if (!text || text->empty())
        place.refuse(key, value);
    return *text;
}

Table<HeldFile> held_file()
{
    return {
        {"file", in_list, optional,
         "A file that the scene names, stored in the scene itself. The programs write it into the copy of "
         "the scene in their own files, so that this copy is complete."},
        {text("name", &HeldFile::name,
              "Name of the file in the other keys of the scene. A file of this name in the folder of the "
              "scene is not read."),
         key_of<HeldFile>({"text", "file text", {}, {}, "Text of the file."}, &HeldFile::text, read_file_text)
             .asks_for("the text of a file, 16 MiB at most")}};
}

// --- Stages, numerical settings -------------------------------------------------------------------------

Table<Schedule> schedule()
{
    const KeyInfo start{
        "start", "date", days, within(farthest_day),
        "Start of time. With a date here all others may be dates, or numbers of days since it. With "
        "a number all dates are numbers on the same scale of days."};
    const auto calendar = [](Schedule& all) -> Calendar& { return all.calendar; };
    return {{"schedule", once, required, "Start and end."},
            {key_of<Schedule>(start, calendar, read_start).or_else(std::int64_t{0}),
             date("end", &Schedule::end, "End of time, after the start.")}};
}

Table<Stage> stage()
{
    return {
        {"stage", in_list, optional, "One excavation step, later than the one before it."},
        {text("name", &Stage::name, "Name, once among the stages."),
         date("date", &Stage::time, "When: after the start, not after the end."),
         polygons("remove_m", &Stage::remove, "The rock inside these polygons is excavated."),
         choice(
             "displacements", &Stage::reset_displacements, {{"go on", false}, {"reset", true}},
             "Reset: displacements have a second count, which begins at the equilibrium after this stage and ends "
             "at the next stage that resets them. The first count, since the in-situ equilibrium, goes on.")
             .or_else(std::string("go on"))}};
}

Table<MonitoringPoint> monitoring_point()
{
    return {
        {"point", in_list, optional, "A place whose displacement is recorded."},
        {text("name", &MonitoringPoint::name, "Name, once among the points."),
         point(
             "at_m", &MonitoringPoint::at,
             "Its place, inside the section or on its outline. A point on the face of an excavation belongs "
             "to the rock that stays. A point on the border between the rock of two stages belongs to the "
             "rock that stays longer."),
         date("first_reading", &MonitoringPoint::first_reading, "When its own readings begin.")
             .optional("the start")}};
}

Table<MonitoringLine> monitoring_line()
{
    return {
        {"monitoring_line", in_list, optional,
         "Points at equal distances on a line, such as an inclinometer or an extensometer. They are points as any "
         "other, called \"NAME 1\" at from_m to \"NAME n\" at to_m."},
        {text("name", &MonitoringLine::name, "Name, once among the monitoring lines."),
         point("from_m", &MonitoringLine::from, "One end, inside the section."),
         point("to_m", &MonitoringLine::to, "The other end."),
         integer("points", &MonitoringLine::points, from(2).to(1000),
                 "Number of points, both ends included."),
         date("first_reading", &MonitoringLine::first_reading, "When the line's own readings begin.")
             .optional("the start")}};
}

std::vector<MonitoringPoint> points_of(const MonitoringLine& line)
{
    std::vector<MonitoringPoint> points;
    for (Index i = 0; i < line.points; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(line.points - 1);
        points.push_back({line.name + " " + std::to_string(i + 1), (1 - share) * line.from + share * line.to,
                          line.first_reading});
    }
    return points;
}

Table<Gauge> gauge()
{
    return {{"gauge", in_list, optional,
             "A place on a joint whose traction demsolve --step-history records: the nearest contact."},
            {text("name", &Gauge::name, "Name, once among the gauges."),
             point("at_m", &Gauge::at, "Where, inside the section.")}};
}

Table<CreepSettings> creep()
{
    const Range step = creep_steps;
    return {
        {"creep", once, optional,
         "Creep of joints and rock. Without this table nothing creeps. Either step_days or tolerance_m is "
         "given."},
        {choice(
             "scheme", &CreepSettings::scheme, creep_scheme_words(),
             "Time scheme: the assumed force on a joint during a step. \"auto\" takes \"fitted\", "
             "and \"linear force\" in steps during which loads change. \"published\" is stable only if the step is below a "
             "limit (theory manual, section 8).")
             .or_else(std::string("auto")),
         number("step_days", &CreepSettings::step, days, step, "Time step.").optional(),
         number("tolerance_m", &CreepSettings::tolerance, metres, creep_tolerances,
                "Allowed estimated error of a step; the time steps are chosen by it.")
             .optional(),
         number(
             "first_step_days", &CreepSettings::first_step, days, step,
             "First step tried after the start, and after each stage and date of a load history; with tolerance_m.")
             .optional("0.1 of the shortest relaxation time"),
         number("shortest_step_days", &CreepSettings::shortest_step, days, step,
                "The tolerance makes no step shorter than this; with tolerance_m.")
             .optional(),
         number("longest_step_days", &CreepSettings::longest_step, days, step,
                "Longest step; with tolerance_m.")
             .optional(),
         number("stop_rate_mm_per_day", &CreepSettings::stop_rate, mm_per_day, above(0).to(1e6),
                "After the last stage creep ends once no gridpoint moves faster than this.")
             .optional()}};
}

Table<Scene> zones()
{
    return {
        {"zones", once, required, "Zones: the triangles inside the blocks."},
        {choice(
             "kind", &Scene::asks_for_quadratic_zones, {{"constant strain", false}, {"quadratic", true}},
             "Displacements in a zone: linear between its three corners, so that its strain is constant, or "
             "quadratic, with three more gridpoints in the middles of its sides. Zones of constant strain are too "
             "stiff where rock bends, and too strong where it yields; quadratic ones cost about four times as "
             "much at the same size. Quadratic zones are for small displacements.")
             .optional(
                 "constant strain if the scene has [large_displacements], engine \"relaxation\" or masses \"real\". In other "
                 "scenes: quadratic if a rock has the law \"Mohr-Coulomb\"; also quadratic if there is neither a [[joint_set]] "
                 "nor a [[mapped]]; otherwise constant strain"),
         number("size_m", &Scene::zone_size, metres, zone_sizes,
                "Longest zone side. If fine_m is given, this size applies only inside the polygon fine_m."),
         polygon("fine_m", &Scene::fine_zones,
                 "Where zones have the size size_m; outside they are larger. Without it they have this "
                 "size everywhere.")
             .together("coarsening"),
         number("coarsening_m", &Scene::zone_coarsening, metres, lengths,
                "Distance over which the zone size grows by size_m: at this distance from fine_m zones are "
                "twice as large, and at two times this distance three times.")
             .together("coarsening"),
         number("size_at_faces_m", &Scene::zone_size_at_faces, metres, lengths,
                "Longest zone side on faces that stages excavate, at points and at gauges. From there it "
                "grows by 0.3 m per metre, up to the size that the other keys give. At most size_m.")
             .optional()}};
}

Table<Cutting> cutting()
{
    return {
        {"cutting", once, optional,
         "Limits below which details are merged when the section is cut into blocks."},
        {number(
             "shortest_edge_m", &Cutting::shortest_edge, metres, above(0).to(farthest_metre),
             "Vertices that are closer to each other than this length are merged. Vertices that are closer to an "
             "edge than half of this length are merged with it. At most the zone size, and less than the extent of the section.")
             .optional("0.02 x zones.size_at_faces_m, or x zones.size_m without that key"),
         number(
             "smallest_angle_deg", &Cutting::smallest_angle, degrees, from(0).to(30),
             "Wedges between two edges that are narrower than this are closed, if this moves no vertex by more "
             "than 5 times shortest_edge_m.")
             .or_else(std::int64_t{1}),
         choice("dangling_ends", &Cutting::dangling_ends,
                {{"prune", DanglingEnds::prune}, {"extend", DanglingEnds::extend}},
                "What happens to a joint that ends inside a block. prune: it is cut back to the last block "
                "edge that it met. extend: it is extended in its own direction to the next line. The "
                "extension is rock bridge, so every rock needs a strength.")
             .formerly("dead_ends")
             .or_else("prune")}};
}

Table<Equilibrium> equilibrium()
{
    using E = Equilibrium;
    return {
        {"equilibrium", once, optional, "How equilibrium is found."},
        {choice(
             "engine", &E::engine, engine_words(),
             "Dynamic relaxation, or the implicit engine, which solves equations for the equilibrium. auto: the implicit engine; "
             "then dynamic relaxation, if it finds neither an equilibrium nor moving blocks. With real masses, or with the "
             "option --step-history of demsolve: only dynamic relaxation.")
             .former_word(std::string(former_engine_word), std::string(engine_word_for_it))
             .or_else(std::string("auto")),
         number(
             "tolerance", &E::tolerance, no_unit, equilibrium_tolerances,
             "Limit of the unbalanced force ratio and of the change of contact forces. Dynamic relaxation also estimates the "
             "displacement that remains. The estimate is divided by the displacement since the search began, or by a tenth of the "
             "whole displacement if that is larger. The result must be at most 1000 times the tolerance, and at most 0.1, unless "
             "only rounding errors remain.")
             .or_else(1e-6),
         choice("masses", &E::masses, {{"scaled", Masses::scaled}, {"real", Masses::real}},
                "Nodal masses: scaled, which finds the same equilibrium sooner, or the real ones.")
             .or_else(std::string("scaled")),
         choice("damping", &E::damping,
                {{"adaptive", Damping::adaptive},
                 {"kinetic", Damping::kinetic},
                 {"local", Damping::local},
                 {"combined", Damping::combined},
                 {"mass", Damping::mass}},
                "Damping of dynamic relaxation.")
             .or_else(std::string("adaptive")),
         number(
             "mass_damping_per_s", &E::mass_damping, per_s, from(0).to(1e12),
             "Mass-proportional damping. Needed with damping = \"mass\", refused otherwise. It may be 0 only if "
             "stiffness_damping_s is given.")
             .optional(),
         number("stiffness_damping_s", &E::stiffness_damping, seconds, above(0).to(1e6),
                "Stiffness-proportional damping of zones, and dashpots in joints that neither slip nor are "
                "open; with damping = \"mass\".")
             .optional(),
         number("local_damping", &E::local_damping, no_unit, above(0).below(1),
                "Fraction of the unbalanced force; with damping = \"local\" or \"combined\" only.")
             .optional("0.8"),
         integer("unloading_increments", &E::unloading_increments, numbers_of_increments,
                 "Number of increments of excavation, and of loads that change between dates. With "
                 "[large_displacements] it is 1; release_s is used in its place.")
             .or_else(std::int64_t{1}),
         number(
             "increments_tolerance", &E::increments_tolerance, no_unit, increments_tolerances,
             "Increments chosen by error: the run begins with unloading_increments, and is repeated with twice as many, "
             "until displacements and joint tractions change by less than this share.")
             .optional(),
         integer(
             "most_steps", &E::most_steps, from(1).to(2147483647),
             "Largest number of steps of dynamic relaxation for an equilibrium. If it is not enough, the exit code is 3. "
             "With [large_displacements] it limits the search for the in-situ equilibrium; longest_s limits "
             "the dynamic analyses.")
             .or_else(std::int64_t{1000000})}};
}

Table<LargeDisplacements> large_displacements()
{
    return {
        {"large_displacements", once, optional,
         "Dynamic analysis with large displacements after each stage, until the rock is at rest. Masses are "
         "real, and contacts are found again as blocks move. Each creep step of joints is such an analysis, "
         "too. Without this table displacements are small.",
         in_list, "motion"},
        {text("new_contacts", &LargeDisplacements::new_contacts,
              "Joint material of new contacts, and of rock that slides off its joint: its stiffnesses and "
              "friction angle, the residual one if it has one, without cohesion, tensile strength and "
              "dilation."),
         names("rigid_rocks", &LargeDisplacements::rigid_rocks,
               "Rocks whose blocks do not deform in the dynamic analysis. Before it they deform.")
             .optional("none"),
         number(
             "stiffness_damping_s", &LargeDisplacements::stiffness_damping, seconds, from(0).to(10),
             "Stiffness-proportional damping: viscosity of the dashpots of zones and closed joints over the stiffness of their springs. Removes the energy of impacts and of "
             "vibration; shortens the time step.")
             .or_else(1e-4),
         number("mass_damping_per_s", &LargeDisplacements::mass_damping, per_s, from(0).to(1e6),
                "Damping force per mass and velocity. It also slows down moving blocks.")
             .or_else(0.0),
         number(
             "release_s", &LargeDisplacements::release, seconds, from(0).to(1e6),
             "Time in which the forces of excavated rock decrease to 0, and in which the creep of a step is "
             "added. It must be above 0 with [creep].")
             .or_else(0.0),
         number("longest_s", &LargeDisplacements::longest, seconds, above(0).to(1e6),
                "Longest time of each dynamic analysis. If rock still moves at its end, the exit code is 3.")
             .or_else(60.0),
         number(
             "stop_s", &LargeDisplacements::stop, seconds, above(0).to(1e6),
             "The dynamic analysis of the last stage ends this long after its beginning, at rest or not. Without this key it ends "
             "at rest.")
             .optional(),
         number("record_every_s", &LargeDisplacements::record_every, seconds, above(0).to(1e6),
                "The section and the balance of energy are recorded that often.")
             .or_else(1.0),
         number(
             "energy_tolerance", &LargeDisplacements::energy_tolerance, no_unit, from(1e-6).to(1),
             "Largest error of the energy balance of a dynamic analysis in which rock moves, over its largest "
             "energy. A larger error is exit code 3. Smaller zones and more stiffness damping reduce it.")
             .or_else(0.01)}};
}

Table<Scene> random_numbers()
{
    return {
        {"random", once, optional, "Needed by joint sets."},
        {integer("seed", &Scene::seed, seeds, "Another seed gives another network of the same statistics.")}};
}

// The mapped set that a table of the scene, at `place`, stands for, from the file that it names.
MappedSet mapped_set(const WrittenMapped& written, const TomlValue& table, const Place& place)
{
    const TomlValue& file = *table.find("file");
    const std::string& text = text_of_file(written.file, file, "file", place);
    try {
        return {written.name, written.material,
                mapped_traces(text, {written.property,
                                     written.property.empty() ? std::nullopt : std::optional(written.value),
                                     written.layer})};
    } catch (const input_error& error) {
        place.refuse(file.line, place.table + " file = " + shown(file) + ": " + error.what());
    }
}

void read_held_files(const Table<HeldFile>& table, const TomlValue& root, Reading& reading)
{
    const auto& list = list_of(table.info, root, reading);
    const auto files = read_list(table, root, reading);
    for (std::size_t i = 0; i < files.size(); ++i)
        if (!reading.files.try_emplace(files[i].name, files[i].text).second)
            Place{reading, table.info.shown()}.refuse(list[i].find("name")->line,
                                                      "[[file]] name = " + shown(*list[i].find("name")) +
                                                          ": the name is taken by another file");
}

std::vector<MappedSet> read_mapped(const Table<WrittenMapped>& table, const TomlValue& root,
                                   const Reading& reading)
{
    const auto& list = list_of(table.info, root, reading);
    const auto written = read_list(table, root, reading);
    std::vector<MappedSet> sets;
    for (std::size_t i = 0; i < written.size(); ++i)
        sets.push_back(mapped_set(written[i], list[i],
                                  {reading, table.info.shown() + " " + shown(*list[i].find("name"))}));
    return sets;
}

TablesInJointSet tables_in_joint_set()
{
    return {
        .material_in = material_in(),
        .trace_angle = angle_law(
            "trace_angle", within(180),
            "Angle of a trace, counter-clockwise from the x axis: a trace at 35 deg rises to the right, one "
            "at -35 deg descends to the right. Joints that dip 35 deg out of a slope whose face looks to "
            "the right have -35."),
        .dip = angle_law("dip", from(0).to(90),
                         "Dip below the horizontal, with dip_direction and section.azimuth_deg."),
        .dip_direction =
            angle_law("dip_direction", from(0).to(360), "Bearing of the dip, clockwise from north."),
        .spacing = length_law("spacing", optional, "Spacing along the set's mean normal in space."),
        .length = length_law("length", optional, "Length of the joint traces."),
        .diameter = length_law("diameter", optional, "Diameter of the discs."),
        .orientation = orientation_law(),
        .density = density_table()};
}

// --- The list -------------------------------------------------------------------------------------------

using Parts = std::vector<Part<Scene>>;

// A table that fills members of the scene itself.
Part<Scene> of_scene(const Table<Scene>& table)
{
    return part_once<Scene>(table, [](Scene& scene) -> Scene& { return scene; });
}

Part<Scene> in_turn(Turn turn, Part<Scene> part)
{
    part.turn = turn;
    return part;
}

Parts general_parts()
{
    const auto read_top = [table = top()](const TomlValue& root, Reading& reading, Scene& scene) {
        fill(table, root, {reading, ""}, scene);
    };
    return {part_read_by<Scene>(top(), read_top),
            part_read_by<Scene>(variables(), nullptr), // read_scene() reads them
            of_scene(section())};
}

Parts joint_parts()
{
    const TablesInJointSet in_set = tables_in_joint_set();
    const auto read_maps = [table = mapped()](const TomlValue& root, Reading& reading, Scene& scene) {
        scene.mapped = read_mapped(table, root, reading);
    };
    return {part_in_list(joint(), &Scene::joints),  part_in_list(joint_set(in_set), &Scene::joint_sets),
            part_inside<Scene>(in_set.material_in), part_inside<Scene>(in_set.trace_angle),
            part_inside<Scene>(in_set.dip),         part_inside<Scene>(in_set.dip_direction),
            part_inside<Scene>(in_set.orientation), part_inside<Scene>(in_set.spacing),
            part_inside<Scene>(in_set.length),      part_inside<Scene>(in_set.diameter),
            part_inside<Scene>(in_set.density),     part_read_by<Scene>(mapped(), read_maps)};
}

Parts schedule_parts()
{
    const auto read_schedule = [table = schedule()](const TomlValue& root, Reading& reading, Scene& scene) {
        Schedule written{reading.calendar};
        read_once(table, root, reading, written);
        scene.end = written.end;
    };
    const auto read_lines = [table = monitoring_line()](const TomlValue& root, Reading& reading,
                                                        Scene& scene) {
        scene.lines = read_list(table, root, reading);
        for (const MonitoringLine& line : scene.lines)
            std::ranges::copy(points_of(line), std::back_inserter(scene.points));
    };
    return {in_turn(Turn::calendar, part_read_by<Scene>(schedule(), read_schedule)),
            in_turn(Turn::dated, part_in_list(stage(), &Scene::stages)),
            in_turn(Turn::dated, part_in_list(monitoring_point(), &Scene::points)),
            in_turn(Turn::dated, part_read_by<Scene>(monitoring_line(), read_lines)),
            in_turn(Turn::dated, part_in_list(gauge(), &Scene::gauges))};
}

// Some defaults depend on other keys, or on whether a key is used.
Parts settings_parts()
{
    const auto read_cutting = [table = cutting()](const TomlValue& root, Reading& reading, Scene& scene) {
        scene.cutting.shortest_edge = usual_shortest_edge * scene.smallest_zone_size();
        read_once(table, root, reading, scene.cutting);
    };
    const auto read_equilibrium = [table = equilibrium()](const TomlValue& root, Reading& reading,
                                                          Scene& scene) {
        scene.equilibrium.local_damping = usual_local_damping;
        read_once(table, root, reading, scene.equilibrium);
    };
    const auto read_files = [table = held_file()](const TomlValue& root, Reading& reading, Scene&) {
        read_held_files(table, root, reading);
    };
    return {in_turn(Turn::settings, part_if_given(creep(), &Scene::creep)),
            in_turn(Turn::settings, of_scene(zones())),
            in_turn(Turn::settings, part_read_by<Scene>(cutting(), read_cutting)),
            in_turn(Turn::settings, part_read_by<Scene>(equilibrium(), read_equilibrium)),
            in_turn(Turn::settings, part_if_given(large_displacements(), &Scene::large_displacements)),
            in_turn(Turn::settings, of_scene(random_numbers())),
            in_turn(Turn::files, part_read_by<Scene>(held_file(), read_files))};
}

Parts all_parts()
{
    Parts all = general_parts();
    const auto add = [&all](const Parts& more) { all.insert(all.end(), more.begin(), more.end()); };
    for (const ForceKeys<Scene>& force : forces())
        add(force.materials);
    add(joint_parts());
    for (const ForceKeys<Scene>& force : forces())
        add(force.loads);
    add(schedule_parts());
    for (const ForceKeys<Scene>& force : forces())
        add(force.settings);
    add(settings_parts());
    return all;
}

} // namespace

const std::vector<Part<Scene>>& scene_parts()
{
    static const Parts parts = all_parts();
    return parts;
}

bool is_beside_scene(const std::string& file)
{
    const std::filesystem::path path(file);
    return path.is_relative() && std::find(path.begin(), path.end(), "..") == path.end();
}

} // namespace jointcreep::scene
