#include "exchange/csv.hpp"

#include "exchange/forces.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace jointcreep::exchange
{

namespace
{

std::string field(double value)
{
    return shown(value);
}

std::string field(Index value)
{
    return std::to_string(value);
}

std::string field(const Eigen::Vector2d& vector)
{
    return shown(vector.x()) + ',' + shown(vector.y());
}

// The name that an index stands for; empty for none.
std::string name_of(const std::vector<std::string>& names, Index index)
{
    return index < 0 ? "" : csv_field(names[index]);
}

template <class... Fields>
void add_row(std::string& table, const Fields&... fields)
{
    std::string_view separator;
    ((table.append(separator).append(fields), separator = ","), ...);
    table += '\n';
}

// Summed over triangles between the first vertex and every edge: exact for any ring, holes counting negative,
// and as accurate far from the origin as near it.
Eigen::Vector2d centroid(const Blocks& blocks, std::size_t block)
{
    const Eigen::Vector2d origin =
        blocks.vertex[blocks.ring_vertex[blocks.ring_start[blocks.block_ring[block]]]];
    double twice_area = 0;
    Eigen::Vector2d moment(0, 0);
    for (Index ring = blocks.block_ring[block]; ring < blocks.block_ring[block + 1]; ++ring) {
        const Index first = blocks.ring_start[ring], end = blocks.ring_start[ring + 1];
        for (Index i = first; i < end; ++i) {
            const Eigen::Vector2d p = blocks.vertex[blocks.ring_vertex[i]] - origin;
            const Eigen::Vector2d q = blocks.vertex[blocks.ring_vertex[i + 1 < end ? i + 1 : first]] - origin;
            const double cross = p.x() * q.y() - p.y() * q.x();
            twice_area += cross;
            moment += cross * (p + q);
        }
    }
    return origin + moment / (3 * twice_area);
}

Index vertices_of(const Blocks& blocks, std::size_t block)
{
    return blocks.ring_start[blocks.block_ring[block + 1]] - blocks.ring_start[blocks.block_ring[block]];
}

std::string field(const fields::Column& column, std::size_t row)
{
    const double value = column.value(row);
    return column.is_integer ? field(static_cast<Index>(value)) : field(value);
}

// What a column's name says of its unit: "_Pa_s_per_m", or nothing of a plain number.
std::string suffix(std::string unit)
{
    if (unit == "1")
        return "";
    if (const auto slash = unit.find('/'); slash != std::string::npos)
        unit.replace(slash, 1, "_per_");
    std::ranges::replace(unit, ' ', '_');
    return "_" + unit;
}

} // namespace

std::string csv_field(const std::string& text)
{
    const bool is_like_formula =
        !text.empty() && std::string_view("=+-@\t").find(text[0]) != std::string_view::npos;
    if (text.find_first_of(",\"\r\n") == std::string::npos && !is_like_formula)
        return text;
    std::string quoted = "\"";
    for (const char c : text)
        quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
}

std::string joints_csv(const Network& network)
{
    const Joints& joints = network.joints;
    std::string table = "set,number,x1_m,y1_m,x2_m,y2_m\n";
    for (std::size_t trace = 0; trace < joints.trace_joint.size(); ++trace) {
        const Index joint = joints.trace_joint[trace];
        add_row(table, name_of(network.names.joint_set, joints.set[joint]), field(joints.number[joint]),
                field(joints.trace_from[trace]), field(joints.trace_to[trace]));
    }
    return table;
}

std::string blocks_csv(const Network& network)
{
    const Blocks& blocks = network.blocks;
    std::string table = "block,rock,stage,area_m2,x_m,y_m,vertices,holes\n";
    for (std::size_t block = 0; block < blocks.block_area.size(); ++block)
        add_row(table, std::to_string(block), name_of(network.names.rock, blocks.block_rock[block]),
                name_of(network.names.stage, blocks.block_stage[block]), field(blocks.block_area[block]),
                field(centroid(blocks, block)), field(vertices_of(blocks, block)),
                field(blocks.block_ring[block + 1] - blocks.block_ring[block] - 1));
    return table;
}

std::string edges_csv(const Network& network, const EquivalentJoints* equivalent)
{
    constexpr std::array kinds = {"boundary", "joint", "bonded"}; // by EdgeKind
    const Blocks& blocks = network.blocks;
    const Joints& joints = network.joints;
    std::string table = "edge,x1_m,y1_m,x2_m,y2_m,left_block,right_block,kind,set,number,joint_fraction";
    const std::vector<fields::Column> columns =
        equivalent ? columns_of(&fields::ForceColumns::of_edges, *equivalent) : std::vector<fields::Column>();
    for (const fields::Column& column : columns)
        table.append(",").append(column.name).append(suffix(column.units));
    table += '\n';
    for (std::size_t edge = 0; edge < blocks.edge_vertex.size(); ++edge) {
        const auto [first, second] = blocks.edge_vertex[edge];
        const auto [left, right] = blocks.edge_block[edge];
        const Index joint = blocks.edge_joint[edge];
        add_row(table, std::to_string(edge), field(blocks.vertex[first]), field(blocks.vertex[second]),
                left < 0 ? "" : field(left), right < 0 ? "" : field(right), kinds.at(blocks.edge_kind[edge]),
                joint < 0 ? "" : name_of(network.names.joint_set, joints.set[joint]),
                joint < 0 ? "" : field(joints.number[joint]),
                joint < 0 ? "" : field(blocks.edge_joint_fraction[edge]));
        table.pop_back(); // the end of the line
        for (const fields::Column& column : columns)
            table.append(",").append(field(column, edge));
        table += '\n';
    }
    return table;
}

std::string histories_csv(const History& history)
{
    const std::size_t points = history.point.size();
    const bool is_reset = !history.reset_row.empty() && history.reset_row.back() > 0;
    std::string table = "time_day,event";
    for (const std::string& point : history.point)
        for (const char* column : {"_x_m", "_y_m", "_present"})
            table.append(",").append(csv_field(point + column));
    if (is_reset)
        for (const std::string& point : history.point)
            for (const char* column : {"_since_reset_x_m", "_since_reset_y_m"})
                table.append(",").append(csv_field(point + column));
    table += '\n';
    for (std::size_t row = 0; row < history.time.size(); ++row) {
        table.append(field(history.time[row])).append(",").append(csv_field(history.event[row]));
        for (std::size_t at = row * points; at < (row + 1) * points; ++at)
            table.append(",")
                .append(field(history.displacement[at]))
                .append(",")
                .append(field(history.present[at]));
        for (std::size_t p = 0; is_reset && p < points; ++p)
            table.append(",").append(
                field(Eigen::Vector2d(history.displacement[row * points + p] -
                                      history.displacement[history.reset_row[row] * points + p])));
        table += '\n';
    }
    return table;
}

} // namespace jointcreep::exchange
