// Data files of UDEC 7 and 3DEC 7: only commands whose syntax Itasca's pages show. Neither program was run with them.

#include "exchange/convex.hpp"
#include "exchange/csv.hpp"
#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "model/version.hpp"

#include <algorithm>

namespace jointcreep::exchange
{

namespace
{

std::string head(const std::string& what)
{
    return "; jointcreep " + std::string(version()) + ": " + what + "; metres\nmodel new\n";
}

// A name in single quotes.
std::string single_quoted(const std::string& name)
{
    return '\'' + without(name, "'", '"') + '\'';
}

std::string vector_text(const Eigen::Vector3d& place)
{
    return '(' + place_text(place, ",") + ')';
}

} // namespace

std::vector<File> write_udec(const Job& job)
{
    const std::vector<Layer> layers = job.all("blocks");
    const Layer& layer = layers[0];
    std::string text = head("one block of the table of ids a line");
    std::string ids = "polygon,block,rock,stage,realization\n";
    std::size_t polygon = 0;
    for (std::size_t row = 0; row < layer.rows(); ++row) {
        const bool has_holes = layer.first_ring[row + 1] - layer.first_ring[row] > 1;
        for (std::vector<Index> ring : has_holes
                                           ? convex_parts(layer, row)
                                           : std::vector<std::vector<Index>>{with_bridges(layer, row)}) {
            std::reverse(ring.begin(), ring.end()); // clockwise
            text += "block create polygon";
            for (const Index corner : ring)
                text.append(" ").append(place_text(Eigen::Vector2d(layer.point[corner].head<2>()), ","));
            text += '\n';
            ids.append(std::to_string(++polygon));
            for (const char* name : {"block", "rock", "stage", "realization"})
                ids.append(",").append(csv_field(text_of(*find_attribute(layer, name), row)));
            ids += '\n';
        }
    }
    return {{"ids", ".csv", ids}, {"", "", text}};
}

// x runs east along the section, y across it, z up; blocks are as wide as --width.
std::vector<File> write_3dec(const Job& job)
{
    if (job.layers[0] == "planes") {
        const Section& section = job.sections[0];
        const std::vector<Plane> planes = planes_of(section, job.width);
        std::string text = head("discs; x east, y north, z up");
        Eigen::Vector3d low(0, 0, 0), high(0, 0, 0);
        for (const Plane& plane : planes) {
            if (!(plane.diameter > 0))
                throw input_error(
                    "joint set \"" +
                    section.network.names.joint_set[section.network.joints.set[plane.joint]] +
                    "\" is not of discs; 3DEC's fractures are discs. Export its traces by --format dxf "
                    "--what planes --width M");
            for (const Eigen::Vector3d& corner : plane.corner) {
                low = low.cwiseMin(corner);
                high = high.cwiseMax(corner);
            }
        }
        const Eigen::Vector3d margin = 0.01 * (high - low);
        low -= margin;
        high += margin;
        text.append("model domain extent");
        for (int i = 0; i < 3; ++i)
            text.append(" ").append(shown(low[i])).append(" ").append(shown(high[i]));
        text += '\n';
        for (const Plane& plane : planes)
            text.append("fracture create position ")
                .append(vector_text(plane.centre))
                .append(" dip ")
                .append(shown(plane.dip() / unit::deg))
                .append(" dip-direction ")
                .append(shown(plane.dip_direction() / unit::deg))
                .append(" size ")
                .append(shown(plane.diameter))
                .append(" dfn ")
                .append(
                    single_quoted(section.network.names.joint_set[section.network.joints.set[plane.joint]]))
                .append("\n");
        return {{"ids", ".csv", ids_csv(job.all("planes"), counted_from(1))}, {"", "", text}};
    }
    const std::vector<Layer> layers = job.all("blocks");
    const Layer& layer = layers[0];
    const double half = job.width.value_or(1) / 2;
    std::string text = head("convex parts of blocks; x along the section, y across it, z up");
    std::string ids = "prism,block,rock,stage,realization\n";
    std::size_t prism = 0;
    for (std::size_t row = 0; row < layer.rows(); ++row)
        for (const std::vector<Index>& ring : convex_parts(layer, row)) {
            text += "block create prism";
            for (const double y : {-half, half}) {
                text.append(y < 0 ? " face-1" : " face-2");
                for (const Index corner : ring)
                    text.append(" ").append(
                        vector_text({layer.point[corner].x(), y, layer.point[corner].y()}));
            }
            text.append(" group ").append(single_quoted("block " + std::to_string(row))).append("\n");
            ids.append(std::to_string(++prism));
            for (const char* name : {"block", "rock", "stage", "realization"})
                ids.append(",").append(csv_field(text_of(*find_attribute(layer, name), row)));
            ids += '\n';
        }
    return {{"ids", ".csv", ids}, {"", "", text}};
}

} // namespace jointcreep::exchange
