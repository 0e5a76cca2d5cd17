// SVG 1.1: one unit a metre, y turned round, a group for each layer and joint set or rock. Lines keep their width when
// zoomed. Each shape has its attributes as data-NAME.

#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"

#include <array>
#include <limits>

namespace jointcreep::exchange
{

namespace
{

// The colours that the project's plots give to joint sets, in their order.
constexpr std::array colours = {"#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd",
                                "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22", "#17becf"};

std::string place(const Eigen::Vector3d& point)
{
    return shown(point.x()) + ' ' + shown(0.0 - point.y());
}

std::string path_of(const Layer& layer, std::size_t row)
{
    std::string path;
    for (Index r = layer.first_ring[row]; r < layer.first_ring[row + 1]; ++r) {
        const auto ring = layer.ring(r);
        for (std::size_t i = 0; i < ring.size(); ++i)
            path.append(i == 0 ? "M" : "L").append(place(layer.point[ring[i]]));
        path += 'Z';
    }
    return path;
}

void append_shape(std::string& text, const Layer& layer, std::size_t row,
                  const std::vector<std::string>& headings)
{
    if (layer.shape == Shape::lines) {
        const Eigen::Vector3d &from = layer.from(row), &to = layer.to(row);
        text.append("<line x1=\"").append(shown(from.x())).append("\" y1=\"").append(shown(0.0 - from.y()));
        text.append("\" x2=\"")
            .append(shown(to.x()))
            .append("\" y2=\"")
            .append(shown(0.0 - to.y()))
            .append("\"");
    } else {
        text.append("<path fill-rule=\"evenodd\" d=\"").append(path_of(layer, row)).append("\"");
    }
    for (std::size_t i = 0; i < layer.attributes.size(); ++i)
        if (layer.attributes[i].value(row))
            text.append(" data-")
                .append(headings[i])
                .append("=\"")
                .append(xml_text(text_of(layer.attributes[i], row)))
                .append("\"");
    text += "/>\n";
}

void append_layer(std::string& text, const Layer& layer)
{
    const Attribute* by = find_attribute(layer, layer.name == "blocks" ? "rock" : "set");
    const std::size_t groups = by ? by->names->size() : 0;
    std::vector<std::string> headings;
    for (const Attribute& attribute : layer.attributes)
        headings.push_back(attribute.heading());
    for (std::size_t group = 0; group <= groups; ++group) { // the last one: of none
        std::string shapes;
        for (std::size_t row = 0; row < layer.rows(); ++row)
            if ((by ? by->value(row).value_or(static_cast<double>(groups)) : 0) == static_cast<double>(group))
                append_shape(shapes, layer, row, headings);
        if (shapes.empty())
            continue;
        const bool is_line = layer.shape == Shape::lines;
        const std::string colour = group < groups && by ? colours[group % colours.size()] : "#000000";
        text.append("<g class=\"").append(layer.name);
        if (group < groups)
            text.append("\" data-name=\"").append(xml_text((*by->names)[group]));
        text.append("\" stroke=\"").append(is_line ? colour : "#808080");
        text.append("\" fill=\"").append(is_line || layer.name != "blocks" ? "none" : colour);
        if (layer.name == "blocks")
            text += "\" fill-opacity=\"0.15";
        if (layer.name == "bridges")
            text += "\" stroke-dasharray=\"2 2";
        text.append("\">\n").append(shapes).append("</g>\n");
    }
}

} // namespace

std::vector<File> write_svg(const Job& job)
{
    const Section& section = job.sections[0];
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Eigen::Vector2d low(infinity, infinity), high(-infinity, -infinity);
    for (const Eigen::Vector2d& corner : section.outline) {
        low = low.cwiseMin(corner);
        high = high.cwiseMax(corner);
    }
    const Eigen::Vector2d margin = 0.02 * (high - low), size = high - low + 2 * margin;
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                       "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"1000\" height=\"";
    text.append(shown(std::round(1000 * size.y() / size.x()))).append("\" viewBox=\"");
    text.append(place_text(Eigen::Vector2d(low.x() - margin.x(), -high.y() - margin.y()), " ")).append(" ");
    text.append(place_text(size, " "))
        .append("\">\n<style>line, path { vector-effect: non-scaling-stroke }</style>\n");
    for (const std::string& name : job.layers)
        append_layer(text, job.all(name)[0]);
    return {{"", "", text + "</svg>\n"}};
}

} // namespace jointcreep::exchange
