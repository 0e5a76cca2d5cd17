// Gmsh's own geometry (.geo), of its built-in kernel: points, curves and surfaces that meet at common ends only, as
// the cut section has them. Physical curves are the joint sets and the outline, physical surfaces the rocks, those
// that a stage removes apart. Surfaces can be meshed at once: gmsh -2 NAME.geo.

#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"
#include "model/version.hpp"

#include <cmath>
#include <map>
#include <numeric>

namespace jointcreep::exchange
{

namespace
{

// A name in double quotes.
std::string double_quoted(const std::string& name)
{
    return '"' + without(without(name, "\"", '\''), "\\", '/') + '"';
}

void append_group(std::string& text, const char* kind, const std::string& name, std::size_t number,
                  const std::vector<std::size_t>& tags)
{
    text.append("Physical ").append(kind).append("(").append(double_quoted(name)).append(", ");
    text.append(std::to_string(number)).append(") = {");
    for (std::size_t i = 0; i < tags.size(); ++i)
        text.append(i == 0 ? "" : i % 16 == 0 ? ",\n" : ", ").append(std::to_string(tags[i]));
    text += "};\n";
}

// The side of a ring as a curve, negative against its direction.
std::string curve_text(const std::map<std::pair<Index, Index>, std::size_t>& edge_of, Index from, Index to)
{
    const auto forward = edge_of.find({from, to});
    return forward != edge_of.end() ? std::to_string(forward->second + 1)
                                    : '-' + std::to_string(edge_of.at({to, from}) + 1);
}

} // namespace

std::vector<File> write_gmsh(const Job& job)
{
    const Section& section = job.sections[0];
    const Blocks& blocks = section.network.blocks;
    const Names& names = section.network.names;
    const double area = std::accumulate(blocks.block_area.begin(), blocks.block_area.end(), 0.0);
    const double size = std::sqrt(area / static_cast<double>(blocks.block_area.size())) / 2;

    std::string text = "// jointcreep " + std::string(version()) +
                       ": curve e + 1 is edge e, surface b + 1 is block b; metres\n"
                       "// Mesh size [m]: half the side of the mean block, as a square.\n"
                       "size = " +
                       shown(size) + ";\nMesh.CharacteristicLengthMax = size;\nMesh.MshFileVersion = 4.1;\n";
    for (std::size_t v = 0; v < blocks.vertex.size(); ++v)
        text.append("Point(")
            .append(std::to_string(v + 1))
            .append(") = {")
            .append(place_text(blocks.vertex[v], ", "))
            .append(", 0};\n");
    std::map<std::pair<Index, Index>, std::size_t> edge_of;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const auto [from, to] = blocks.edge_vertex[e];
        edge_of[{from, to}] = e;
        text.append("Line(").append(std::to_string(e + 1)).append(") = {").append(std::to_string(from + 1));
        text.append(", ").append(std::to_string(to + 1)).append("};\n");
    }
    for (std::size_t b = 0; b < blocks.block_area.size(); ++b) {
        std::string loops;
        for (Index r = blocks.block_ring[b]; r < blocks.block_ring[b + 1]; ++r) {
            text.append("Curve Loop(").append(std::to_string(r + 1)).append(") = {");
            const Index first = blocks.ring_start[r], end = blocks.ring_start[r + 1];
            for (Index i = first; i < end; ++i)
                text.append(i == first ? "" : ", ")
                    .append(curve_text(edge_of, blocks.ring_vertex[i],
                                       blocks.ring_vertex[i + 1 < end ? i + 1 : first]));
            text += "};\n";
            loops.append(loops.empty() ? "" : ", ").append(std::to_string(r + 1));
        }
        text.append("Plane Surface(")
            .append(std::to_string(b + 1))
            .append(") = {")
            .append(loops)
            .append("};\n");
    }

    std::map<std::string, std::vector<std::size_t>> curves, surfaces;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        if (blocks.edge_joint[e] >= 0) {
            curves[names.joint_set[section.network.joints.set[blocks.edge_joint[e]]]].push_back(e + 1);
        } else if (blocks.edge_kind[e] == static_cast<Index>(EdgeKind::boundary)) {
            curves["outline of the section"].push_back(e + 1);
        }
    }
    for (std::size_t b = 0; b < blocks.block_area.size(); ++b) {
        const Index stage = blocks.block_stage[b];
        surfaces[names.rock[blocks.block_rock[b]] + (stage < 0 ? "" : ", removed by " + names.stage[stage])]
            .push_back(b + 1);
    }
    std::size_t number = 0;
    for (const auto& [name, tags] : curves)
        append_group(text, "Curve", name, ++number, tags);
    number = 0;
    for (const auto& [name, tags] : surfaces)
        append_group(text, "Surface", name, ++number, tags);
    std::vector<Layer> layers = job.all("edges");
    layers.push_back(layer_of(section, "blocks"));
    return {{"ids", ".csv", ids_csv(layers, counted_from(1))}, {"", "", text}};
}

} // namespace jointcreep::exchange
