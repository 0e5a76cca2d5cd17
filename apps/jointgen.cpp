// jointgen: sample the joints of a section and cut it into blocks.
//
//   jointgen data/column/scene.toml -o network.h5
//   jointgen data/slope/scene.toml --realization 7 -o network-7.h5
//   jointgen traces.gpkg --traces --layer joints                      what [[mapped]] takes from a file
//
// Reads   SCENE.toml   the scene                         (docs/scene.md)
// Writes  network.h5   joints, traces, blocks and edges  (docs/file-format.md)

#include "program.hpp"

#include "blocks/cut.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "model/version.hpp"
#include "sampling/joint_sets.hpp"
#include "scene/field_data.hpp"
#include "scene/scene.hpp"
#include "statistics/statistics.hpp"
#include "store/files.hpp"
#include "zoning/cost.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <numeric>

using namespace jointcreep;

namespace
{

constexpr double silent_seconds = 5; // work that takes longer is announced

const Program program{
    .name = "jointgen",
    .summary = "Samples the joints of a section and cuts it into blocks.",
    .input = "SCENE.toml",
    .output = "network.h5",
    .options =
        {{"seed", "N", "seed of the joint sets (default: the scene's)"},
         {"realization", "R", "which of the seed's networks (default 0)"},
         {"report", "",
          "compare the network with the laws of the scene, print the result, and keep it in the file"},
         {"check", "", "read the scene, cut it, report, and write nothing"},
         {"cut-with", "NAME",
          "code that divides lines where they cross: own (default), or cgal, CGAL's Arrangement_2. cgal "
          "gives the same blocks and takes longer; it is built with the tests only"},
         {"traces", "",
          "print the traces of a file as CSV, as [[mapped]] of a scene reads them, and nothing else; give the file in "
          "place of the scene"},
         {"layer", "NAME", "with --traces: layer of the file"},
         {"property", "NAME", "with --traces: property whose value is printed"},
         {"scene-keys", "", "print every scene key as a table, tab separated"},
         {"scene-schema", "", "print the JSON Schema of scenes, for editors"},
         {"scene-keys-markdown", "", "print docs/scene.md"}},
    .example = "jointgen data/column/scene.toml -o network.h5",
    .other_usage = "SCENE.toml --check",
};

// Of joint sets that are on no edge, or that are mostly cut back.
Warnings warnings_of(const Network& network)
{
    const Blocks& blocks = network.blocks;
    std::vector<double> on_edges(network.names.joint_set.size(), 0.0); // [m]
    for (std::size_t e = 0; e < blocks.edge_joint.size(); ++e)
        if (blocks.edge_joint[e] >= 0) {
            const auto [a, b] = blocks.edge_vertex[e];
            on_edges[network.joints.set[blocks.edge_joint[e]]] +=
                (blocks.vertex[a] - blocks.vertex[b]).norm();
        }
    const JointFates& fates = blocks.fates;
    std::vector<double> cut_back(on_edges.size(), 0.0), inside(on_edges.size(), 0.0); // [m]
    for (std::size_t j = 0; j < network.joints.set.size(); ++j) {
        const Index set = network.joints.set[j];
        cut_back[set] += fates.dangling_end[j];
        inside[set] += fates.kept[j] + fates.shared[j] + fates.dangling_end[j];
    }
    Warnings warnings;
    for (std::size_t set = 0; set < on_edges.size(); ++set) {
        const std::string& name = network.names.joint_set[set];
        if (on_edges[set] == 0)
            warnings.add(program.name, "no block edge lies on joint set \"" + name +
                                           "\": its joints are outside the section, or end inside blocks");
        else if (cut_back[set] > inside[set] / 2)
            warnings.add(program.name, rounded(100 * cut_back[set] / inside[set], 2) +
                                           " percent of joint set \"" + name +
                                           "\" are cut back, because they end inside blocks; " +
                                           "[cutting] dangling_ends = \"extend\" keeps them");
    }
    return warnings;
}

// As the file keeps them.
std::string options_of(const Arguments& arguments)
{
    std::string options = arguments.has("report") ? "--report" : "";
    if (const auto name = arguments.text("cut-with"))
        options += (options.empty() ? "--cut-with " : " --cut-with ") + *name;
    return options;
}

blocks::Subdivision chosen_subdivision(const Arguments& arguments)
{
    const std::string name = arguments.text("cut-with").value_or("own");
    if (name != "own" && name != "cgal")
        throw input_error("--cut-with is '" + name + "'; it must be own or cgal");
    return name == "cgal" ? blocks::Subdivision::cgal : blocks::Subdivision::own;
}

void report(const Arguments& arguments, const Network& network, const Warnings& warnings)
{
    const Blocks& blocks = network.blocks;
    std::array<std::size_t, 3> edges{};
    for (const Index kind : blocks.edge_kind)
        ++edges[kind];
    Summary summary;
    summary.add("joints", network.joints.set.size());
    summary.add("joint traces", network.joints.trace_joint.size());
    summary.add("blocks", blocks.block_area.size());
    summary.add("edges on joints", edges[static_cast<std::size_t>(EdgeKind::joint)]);
    summary.add("edges bonded", edges[static_cast<std::size_t>(EdgeKind::bonded)]);
    summary.add("area", std::accumulate(blocks.block_area.begin(), blocks.block_area.end(), 0.0), "m2");
    summary.add("shortest edge", blocks.report.shortest_edge, "m");
    summary.add("smallest angle", blocks.report.smallest_angle / unit::deg, "deg");
    summary.add("merged vertices", blocks.report.merged_vertices);
    summary.add("merged edges", blocks.report.merged_edge_length, "m");
    summary.add("merged blocks", blocks.report.merged_block_area, "m2");
    summary.add("largest move", blocks.report.largest_move, "m");
    const auto total = [](const std::vector<double>& lengths) {
        return std::accumulate(lengths.begin(), lengths.end(), 0.0);
    };
    const JointFates& fates = blocks.fates;
    summary.add("length of joints",
                total(fates.kept) + total(fates.shared) + total(fates.on_outline) + total(fates.outside) +
                    total(fates.dangling_end) + total(fates.merged),
                "m");
    summary.add("  on block edges", total(fates.kept), "m");
    summary.add("  on edges of others", total(fates.shared), "m");
    summary.add("  along the outline", total(fates.on_outline), "m");
    summary.add("  outside, clipped", total(fates.outside), "m");
    summary.add("  inside, cut back", total(fates.dangling_end), "m");
    summary.add("  merged away", total(fates.merged), "m");
    if (const double extended = total(fates.extended); extended > 0)
        summary.add("extended", extended, "m");
    summary.add("joints dropped",
                std::count(fates.fate.begin(), fates.fate.end(), static_cast<Index>(JointFate::dropped)));
    for (const std::string& warning : warnings.text)
        summary.warn(warning);
    summary.count_warnings(0, 0);
    summary.print(arguments);
}

// A text in double quotes, as CSV has it.
std::string quoted(const std::string& text)
{
    std::string all = "\"";
    for (const char c : text)
        all.append(c == '"' ? 2 : 1, c);
    return all + '"';
}

void print_traces(const Arguments& arguments)
{
    const std::string text = scene::read_field_data(arguments.input());
    const scene::TraceFilter filter{.property = arguments.text("property").value_or(""),
                                    .layer = arguments.text("layer").value_or("")};
    const scene::TracesOfFile found =
        of_file(arguments.input(), [&] { return scene::traces_of_file(text, filter); });
    std::cout << "id,part,x_m,y_m,value\n";
    for (std::size_t t = 0; t < found.trace.size(); ++t)
        for (std::size_t part = 0; part < found.trace[t].polylines.size(); ++part)
            for (const Eigen::Vector2d& place : found.trace[t].polylines[part])
                std::cout << found.trace[t].id << ',' << part << ',' << shown(place.x()) << ','
                          << shown(place.y()) << ',' << quoted(found.value[t]) << '\n';
}

void generate(const Arguments& arguments)
{
    if (arguments.has("traces"))
        return print_traces(arguments);
    for (const char* option : {"layer", "property"})
        if (arguments.has(option))
            throw input_error("--" + std::string(option) +
                              " goes with --traces; in a scene it is a key of [[mapped]]");
    using Page = std::pair<const char*, std::string (*)()>;
    for (const auto& [option, text] :
         {Page("scene-keys", scene::scene_keys_tsv), Page("scene-schema", scene::scene_schema),
          Page("scene-keys-markdown", scene::scene_keys_markdown)})
        if (arguments.has(option)) {
            std::cout << text();
            return;
        }
    const std::string& input = arguments.input();
    const bool check = arguments.has("check");
    if (!check)
        store::check_writable(arguments.output());

    // 1. The scene.
    const auto [text, files] = scene::read_scene(input);
    std::vector<NamedFile> read;
    for (const std::string& path : files)
        read.push_back({path, path + ", which the scene names"});
    if (!check)
        refuse_overwriting(read, arguments.files({"output"}));
    const Scene scene = scene::parse_scene(text, input);
    const std::uint64_t seed =
        arguments.whole_number("seed", 0, static_cast<std::uint64_t>(scene::seeds.most)).value_or(scene.seed);
    const auto realization = static_cast<std::int32_t>(
        arguments.whole_number("realization", 0, std::numeric_limits<std::int32_t>::max()).value_or(0));

    const blocks::Subdivision subdivision = chosen_subdivision(arguments);

    // 2. Its joints.
    Network network;
    network.names = names_of(scene);
    network.joints = of_file(input, [&] { return sampling::sample_joints(scene, seed, realization); });

    // 3. Its blocks.
    if (const blocks::CuttingCost cost = blocks::expected_cost(scene, network.joints);
        !arguments.quiet() && cost.seconds > silent_seconds)
        std::cerr << program.name << ": " << network.joints.set.size() << " joints with about "
                  << rounded(cost.crossings, 2) << " crossings: cutting may take "
                  << 10 * std::llround(std::ceil(cost.seconds / 10)) << " s" << std::endl;
    network.blocks = of_file(input, [&] { return blocks::cut(scene, network.joints, subdivision); });

    // 4. Statistics of the network, beside the scene's laws.
    if (arguments.has("report"))
        network.statistics = statistics::statistics_of(scene, network);

    // 5. What looks wrong, and what its zones will cost. Other sizes may be given to demsolve: a network is refused by
    // --check only.
    Warnings warnings = warnings_of(network);
    for (const std::string& doubt : scene::doubts_about(scene, text, input))
        warnings.add(program.name, doubt);
    try {
        if (const std::string cost = zoning::check_cost(scene, network.blocks, input); !cost.empty())
            warnings.add(program.name, cost);
    } catch (const input_error& error) {
        if (check)
            throw;
        warnings.add(program.name, std::string(error.what()) + ". demsolve refuses this");
    }
    if (!check)
        store::write_network(arguments.output(),
                             {.scene = text,
                              .seed = seed,
                              .realization = realization,
                              .program = {program.name},
                              .version = {std::string(version())},
                              .input_sha256 = {store::sha256_of(input)},
                              .options = {options_of(arguments)},
                              .warnings = warnings},
                             network);
    report(arguments, network, warnings);
    if (!arguments.quiet() && arguments.has("report"))
        std::cout << '\n' << statistics::table(network.statistics) << statistics::left_out(scene);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, generate);
}
