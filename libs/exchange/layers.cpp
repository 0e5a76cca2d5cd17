#include "exchange/layers.hpp"

#include "exchange/forces.hpp"
#include "joint/pieces.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace jointcreep::exchange
{

namespace
{

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d in_section(const Vector2d& place)
{
    return {place.x(), place.y(), 0};
}

std::optional<double> or_none(Index index)
{
    return index < 0 ? std::nullopt : std::optional<double>(index);
}

// The value that an index of a row leads to; none where the index is.
std::function<std::optional<double>(std::size_t)> through(std::vector<Index> rows,
                                                          const std::vector<Index>& values)
{
    return [rows = std::move(rows), &values](std::size_t row) {
        return rows[row] < 0 ? std::nullopt : or_none(values[rows[row]]);
    };
}

Attribute realization_of(const Section& section)
{
    return {"realization", "1", [r = section.realization](std::size_t) { return r; }, true};
}

Attribute index_of_row(const std::string& name, std::vector<Index> rows)
{
    return {name, "1", [rows = std::move(rows)](std::size_t row) { return or_none(rows[row]); }, true};
}

// Which joint a row is of: its set and number, its row in the file, its fate.
struct JointAttributes {
    Attribute set, number, joint, fate;
};
JointAttributes of_joints(const Network& network, const std::vector<Index>& joint)
{
    const Joints& joints = network.joints;
    return {{"set", "1", through(joint, joints.set), true, &network.names.joint_set},
            {"number", "1",
             [joint, &joints](std::size_t row) {
                 return joint[row] < 0 ? std::nullopt : std::optional<double>(joints.number[joint[row]]);
             },
             true},
            index_of_row("joint", joint),
            {"fate", "1", through(joint, network.blocks.fates.fate), true, &fate_names()}};
}

// How many ends of each piece of trace are not ends of a trace: there the section's outline cuts it.
std::vector<Index> ends_cut(const Joints& joints, const Pieces& pieces)
{
    std::vector<std::vector<double>> ends(joints.from.size()); // places along the joint [m]
    const auto place = [&](Index joint, const Vector2d& at) {
        return (at - joints.from[joint]).dot((joints.to[joint] - joints.from[joint]).normalized());
    };
    for (std::size_t t = 0; t < joints.trace_joint.size(); ++t)
        for (const Vector2d& end : {joints.trace_from[t], joints.trace_to[t]})
            ends[joints.trace_joint[t]].push_back(place(joints.trace_joint[t], end));
    for (std::vector<double>& of_joint : ends)
        std::sort(of_joint.begin(), of_joint.end());
    std::vector<Index> cut(pieces.joint.size(), 0);
    for (std::size_t p = 0; p < pieces.joint.size(); ++p) {
        const Index joint = pieces.joint[p];
        const double rounding = 1e-8 * (joints.to[joint] - joints.from[joint]).norm();
        for (const Vector2d& end : {pieces.from[p], pieces.to[p]}) {
            const double at = place(joint, end);
            const auto near = std::lower_bound(ends[joint].begin(), ends[joint].end(), at - rounding);
            if (near == ends[joint].end() || *near > at + rounding)
                ++cut[p];
        }
    }
    return cut;
}

// The joint traces, or the rock bridges between them, inside the section.
Layer pieces_layer(const Section& section, bool are_bridges)
{
    const Joints& joints = section.network.joints;
    const Pieces pieces = joint::pieces_of(joints, section.outline, section.holes);
    const std::vector<Index> ends = ends_cut(joints, pieces);
    Layer layer{.name = are_bridges ? "bridges" : "joints", .shape = Shape::lines};
    std::vector<Index> joint, cut;
    for (std::size_t p = 0; p < pieces.joint.size(); ++p)
        if ((pieces.is_bridge[p] != 0) == are_bridges) {
            layer.add_line(pieces.from[p], pieces.to[p]);
            joint.push_back(pieces.joint[p]);
            cut.push_back(ends[p]);
        }
    auto of = of_joints(section.network, joint);
    const auto length = std::make_shared<std::vector<double>>();
    for (std::size_t row = 0; row < layer.rows(); ++row)
        length->push_back((layer.to(row) - layer.from(row)).norm());
    layer.attributes = {of.set, of.number};
    layer.leading = 2;
    layer.attributes.push_back({"length", "m", [length](std::size_t row) { return (*length)[row]; }});
    if (!are_bridges)
        layer.attributes.push_back(index_of_row("cut_ends", cut));
    layer.attributes.insert(layer.attributes.end(), {of.joint, of.fate, realization_of(section)});
    return layer;
}

Layer edges_layer(const Section& section)
{
    const Blocks& blocks = section.network.blocks;
    Layer layer{.name = "edges", .shape = Shape::lines};
    std::vector<Index> edges, left, right;
    for (const Vector2d& vertex : blocks.vertex)
        layer.point.push_back(in_section(vertex));
    for (std::size_t edge = 0; edge < blocks.edge_vertex.size(); ++edge) {
        layer.corner.insert(layer.corner.end(), blocks.edge_vertex[edge].begin(),
                            blocks.edge_vertex[edge].end());
        layer.first_corner.push_back(static_cast<Index>(layer.corner.size()));
        layer.end_row();
        edges.push_back(static_cast<Index>(edge));
        left.push_back(blocks.edge_block[edge][0]);
        right.push_back(blocks.edge_block[edge][1]);
    }
    const auto of = of_joints(section.network, blocks.edge_joint);
    layer.attributes = {
        index_of_row("edge", edges),
        index_of_row("left_block", left),
        index_of_row("right_block", right),
        {"kind", "1", [&blocks](std::size_t row) { return blocks.edge_kind[row]; }, true, &edge_kind_names()},
        of.set,
        of.number,
        {"joint_fraction", "1",
         [&blocks](std::size_t row) {
             return blocks.edge_joint[row] < 0 ? std::nullopt
                                               : std::optional(blocks.edge_joint_fraction[row]);
         }},
        of.joint,
        of.fate,
        realization_of(section)};
    layer.leading = 1;
    if (section.equivalent)
        for (const fields::Column& column : columns_of(&fields::ForceColumns::of_edges, *section.equivalent))
            layer.attributes.push_back({column.name, column.units, column.value, column.is_integer});
    return layer;
}

Layer blocks_layer(const Section& section)
{
    const Blocks& blocks = section.network.blocks;
    const Names& names = section.network.names;
    Layer layer{.name = "blocks", .shape = Shape::polygons};
    for (const Vector2d& vertex : blocks.vertex)
        layer.point.push_back(in_section(vertex));
    if (!blocks.block_ring.empty()) {
        layer.first_ring = blocks.block_ring;
        layer.first_corner = blocks.ring_start;
        layer.corner = blocks.ring_vertex;
    }
    layer.attributes = {
        {"block", "1", [](std::size_t row) { return static_cast<double>(row); }, true},
        {"rock", "1", [&blocks](std::size_t row) { return blocks.block_rock[row]; }, true, &names.rock},
        {"stage", "1", [&blocks](std::size_t row) { return or_none(blocks.block_stage[row]); }, true,
         &names.stage},
        {"area", "m2", [&blocks](std::size_t row) { return blocks.block_area[row]; }},
        {"vertices", "1",
         [&blocks](std::size_t row) {
             return blocks.ring_start[blocks.block_ring[row + 1]] - blocks.ring_start[blocks.block_ring[row]];
         },
         true},
        {"holes", "1",
         [&blocks](std::size_t row) { return blocks.block_ring[row + 1] - blocks.block_ring[row] - 1; },
         true},
        realization_of(section)};
    layer.leading = 4;
    return layer;
}

std::vector<Vector3d> ring_of(Polygon polygon, bool counter_clockwise)
{
    if ((signed_area_of(polygon) > 0) != counter_clockwise)
        std::reverse(polygon.begin(), polygon.end());
    std::vector<Vector3d> ring;
    for (const Vector2d& corner : polygon)
        ring.push_back(in_section(corner));
    return ring;
}

Layer section_layer(const Section& section)
{
    Layer layer{.name = "section", .shape = Shape::polygons};
    layer.add_ring(ring_of(section.outline, true));
    for (const Polygon& hole : section.holes)
        layer.add_ring(ring_of(hole, false));
    layer.end_row();
    layer.attributes = {{"area", "m2", [area = layer.area()](std::size_t) { return area; }},
                        realization_of(section)};
    layer.leading = 1;
    return layer;
}

Layer planes_layer(const Section& section, std::optional<double> width)
{
    const auto planes = std::make_shared<const std::vector<Plane>>(planes_of(section, width));
    Layer layer{.name = "planes", .shape = Shape::polygons, .is_in_space = true};
    std::vector<Index> joint;
    for (const Plane& plane : *planes) {
        layer.add_ring(plane.corner);
        layer.end_row();
        joint.push_back(plane.joint);
    }
    const auto of = of_joints(section.network, joint);
    const auto number = [&](const char* name, const char* units, auto value) {
        return Attribute{name, units, [planes, value](std::size_t row) { return value((*planes)[row]); }};
    };
    layer.attributes = {
        of.set,
        of.number,
        number("diameter", "m", [](const Plane& plane) { return plane.diameter; }),
        number("dip", "rad", [](const Plane& plane) { return plane.dip(); }),
        number("dip_direction", "rad", [](const Plane& plane) { return plane.dip_direction(); }),
        of.joint,
        of.fate,
        realization_of(section)};
    layer.leading = 2;
    return layer;
}

// What a column's name says of its unit: "_Pa_s_per_m", or nothing of a plain number.
std::string suffix(std::string units)
{
    if (units == "1")
        return "";
    if (const auto slash = units.find('/'); slash != std::string::npos)
        units.replace(slash, 1, "_per_");
    std::ranges::replace(units, ' ', '_');
    return "_" + units;
}

// A rectangle or a disc about its centre, by two vectors in its plane, `along` and `across`.
std::vector<Vector3d> rectangle(const Vector3d& centre, const Vector3d& along, const Vector3d& across)
{
    return {centre - along - across, centre + along - across, centre + along + across,
            centre - along + across};
}

std::vector<Vector3d> polygon_of_disc(const Vector3d& centre, const Vector3d& along, const Vector3d& across)
{
    constexpr int corners = 16;
    const double step = 2 * std::numbers::pi / corners, larger = std::sqrt(step / std::sin(step));
    std::vector<Vector3d> polygon;
    for (int i = 0; i < corners; ++i)
        polygon.emplace_back(centre + larger * (std::cos(i * step) * along + std::sin(i * step) * across));
    return polygon;
}

} // namespace

std::string Attribute::heading() const
{
    return name + suffix(units);
}

void Layer::add_line(const Vector2d& from, const Vector2d& to)
{
    add_ring({in_section(from), in_section(to)});
    end_row();
}

void Layer::add_ring(const std::vector<Vector3d>& points)
{
    for (const Vector3d& place : points) {
        corner.push_back(static_cast<Index>(point.size()));
        point.push_back(place);
    }
    first_corner.push_back(static_cast<Index>(corner.size()));
}

double Layer::length() const
{
    double sum = 0;
    for (std::size_t row = 0; shape == Shape::lines && row < rows(); ++row)
        sum += (to(row) - from(row)).norm();
    return sum;
}

double Layer::area() const
{
    double sum = 0;
    for (std::size_t row = 0; shape == Shape::polygons && row < rows(); ++row) {
        Vector3d twice(0, 0, 0);
        for (Index r = first_ring[row]; r < first_ring[row + 1]; ++r) {
            const auto corners = ring(r);
            const Vector3d& origin = point[corners[0]];
            for (std::size_t i = 1; i + 1 < corners.size(); ++i)
                twice += (point[corners[i]] - origin).cross(point[corners[i + 1]] - origin);
        }
        sum += twice.norm() / 2;
    }
    return sum;
}

Layer layer_of(const Section& section, std::string_view name, std::optional<double> width)
{
    if (name == "joints" || name == "bridges")
        return pieces_layer(section, name == "bridges");
    if (name == "edges")
        return edges_layer(section);
    if (name == "blocks")
        return blocks_layer(section);
    if (name == "section")
        return section_layer(section);
    return planes_layer(section, width);
}

double Plane::dip() const
{
    return std::acos(std::clamp(normal.z(), -1.0, 1.0));
}

double Plane::dip_direction() const
{
    const double angle = std::atan2(normal.x(), normal.y());
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

std::vector<Plane> planes_of(const Section& section, std::optional<double> width)
{
    const Joints& joints = section.network.joints;
    const double azimuth = section.azimuth.value_or(std::numbers::pi / 2), east = std::sin(azimuth),
                 north = std::cos(azimuth);
    // x along the azimuth, y up, z at the azimuth plus 90 degrees.
    const auto in_space = [&](const Vector3d& v) -> Vector3d {
        return {east * v.x() + north * v.z(), north * v.x() - east * v.z(), v.y()};
    };
    std::vector<Plane> planes;
    const auto add = [&](Index joint, const Vector3d& centre, const Vector3d& along, const Vector3d& pole,
                         double half) {
        const bool is_disc = joints.diameter[joint] > 0;
        const Vector3d across = pole.cross(along);
        const Vector3d at = in_space(centre), u = in_space(along) * half,
                       v = in_space(across) * (is_disc ? half : *width / 2);
        planes.push_back({joint, at, in_space(pole), joints.diameter[joint],
                          is_disc ? polygon_of_disc(at, u, v) : rectangle(at, u, v)});
    };
    // Upward unit normal; of a joint that only has an angle in the section the one in the section.
    const auto pole_of = [&](Index joint, const Vector3d& along) -> Vector3d {
        if (!joints.pole[joint].isZero())
            return joints.pole[joint];
        return Vector3d(-along.y(), along.x(), 0) * (along.x() < 0 ? -1 : 1);
    };
    const auto along_of = [&](const Vector2d& from, const Vector2d& to) {
        return in_section((to - from).normalized());
    };
    // A region may leave several pieces of one disc, each a joint, one after the other; the disc is one.
    for (Index joint = 0; joint < static_cast<Index>(joints.set.size()); ++joint) {
        if (!(joints.diameter[joint] > 0))
            continue;
        if (joint > 0 && joints.set[joint] == joints.set[joint - 1] &&
            joints.centre[joint] == joints.centre[joint - 1])
            continue;
        const Vector3d along = along_of(joints.from[joint], joints.to[joint]);
        add(joint, joints.centre[joint], along, pole_of(joint, along), joints.diameter[joint] / 2);
    }
    for (std::size_t t = 0; t < joints.trace_joint.size(); ++t) {
        const Index joint = joints.trace_joint[t];
        if (joints.diameter[joint] > 0)
            continue;
        if (!width)
            throw input_error(
                "joint set \"" + section.network.names.joint_set[joints.set[joint]] +
                "\" is not of discs, and its joints have no size across the section; give one by "
                "--width, in metres");
        const Vector2d from = joints.trace_from[t], to = joints.trace_to[t];
        const Vector3d along = along_of(from, to);
        add(joint, in_section((from + to) / 2), along, pole_of(joint, along), (to - from).norm() / 2);
    }
    return planes;
}

const std::vector<std::string>& fate_names()
{
    static const std::vector<std::string> names{"kept", "clipped", "trimmed", "merged", "dropped"};
    return names;
}

const std::vector<std::string>& edge_kind_names()
{
    static const std::vector<std::string> names{"boundary", "joint", "bonded"};
    return names;
}

} // namespace jointcreep::exchange
