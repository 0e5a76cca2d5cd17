#include "exchange/csv.hpp"

#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"

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

// The corners of a polygon's ring, closed.
template <class Visit>
void for_sides(const Layer& layer, std::size_t row, Visit visit)
{
    for (Index r = layer.first_ring[row]; r < layer.first_ring[row + 1]; ++r) {
        const auto ring = layer.ring(r);
        for (std::size_t i = 0; i < ring.size(); ++i)
            visit(layer.point[ring[i]], layer.point[ring[(i + 1) % ring.size()]]);
    }
}

// Summed over triangles between the first corner and every side: exact for any ring, holes counting negative, and as
// accurate far from the origin as near it.
Eigen::Vector3d centroid(const Layer& layer, std::size_t row)
{
    const Eigen::Vector3d origin = layer.point[layer.ring(layer.first_ring[row])[0]];
    Eigen::Vector3d normal(0, 0, 0), moment(0, 0, 0);
    for_sides(layer, row, [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
        normal += (p - origin).cross(q - origin);
    });
    for_sides(layer, row, [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
        moment += (p - origin).cross(q - origin).dot(normal) * (p + q - 2 * origin);
    });
    return origin + moment / (3 * normal.squaredNorm());
}

std::string coordinates_of(const Layer& layer, std::size_t row)
{
    if (layer.shape == Shape::lines)
        return place_text(Eigen::Vector2d(layer.from(row).head<2>()), ",") + ',' +
               place_text(Eigen::Vector2d(layer.to(row).head<2>()), ",");
    const Eigen::Vector3d centre = centroid(layer, row);
    return layer.is_in_space ? place_text(centre, ",") : place_text(Eigen::Vector2d(centre.head<2>()), ",");
}

void append_row(std::string& table, const Layer& layer, const std::string& coordinates,
                const std::function<std::string(const Attribute&)>& field_of)
{
    for (std::size_t i = 0; i < layer.attributes.size(); ++i) {
        if (i == layer.leading)
            table.append(coordinates).append(",");
        table.append(field_of(layer.attributes[i])).append(i + 1 < layer.attributes.size() ? "," : "\n");
    }
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

std::string layers_csv(std::span<const Layer> layers)
{
    std::string table;
    const std::string coordinates = layers[0].shape == Shape::lines ? "x1_m,y1_m,x2_m,y2_m"
                                    : layers[0].is_in_space         ? "east_m,north_m,up_m"
                                                                    : "x_m,y_m";
    append_row(table, layers[0], coordinates, [](const Attribute& attribute) { return attribute.heading(); });
    for (const Layer& layer : layers)
        for (std::size_t row = 0; row < layer.rows(); ++row)
            append_row(table, layer, coordinates_of(layer, row), [&](const Attribute& attribute) {
                const std::string text = text_of(attribute, row);
                return attribute.names ? csv_field(text) : text;
            });
    return table;
}

std::vector<File> write_csv(const Job& job)
{
    return {{"", "", layers_csv(job.all(job.layers[0]))}};
}

// Of joint traces in two dimensions: a line of headings and five columns. PorePy takes every further column for a
// coordinate, so what the lines are is in a table of ids beside it.
std::vector<File> write_porepy(const Job& job)
{
    const std::vector<Layer> layers = job.all("joints");
    const Layer& layer = layers[0];
    std::string table = "FID,START_X,START_Y,END_X,END_Y\n";
    for (std::size_t row = 0; row < layer.rows(); ++row)
        table.append(std::to_string(row)).append(",").append(coordinates_of(layer, row)).append("\n");
    return {{"ids", ".csv", ids_csv(layers, counted_from(0))}, {"", "", table}};
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
        table.append(shown_time(history.time[row])).append(",").append(csv_field(history.event[row]));
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

std::string failure_csv(const Failure& failure, const Blocks& blocks)
{
    std::string table =
        "block,x_m,y_m,area_m2,displacement_x_m,displacement_y_m,steps,moves_on,stage,time_day,reason\n";
    const std::string of_run = ',' + field(failure.steps) + ',' + field(failure.moves_on) + ',' +
                               csv_field(failure.stage) + ',' + field(failure.time) + ',' +
                               csv_field(failure.reason) + '\n';
    for (std::size_t i = 0; i < failure.block.size(); ++i)
        table += field(failure.block[i]) + ',' + field(failure.place[i]) + ',' +
                 field(blocks.block_area[failure.block[i]]) + ',' + field(failure.motion[i]) + of_run;
    return failure.block.empty() ? table + ",,,,," + of_run : table;
}

} // namespace jointcreep::exchange
