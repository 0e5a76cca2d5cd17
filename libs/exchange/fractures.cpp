// Joints in space for programs of fracture networks: FracMan's .fab and dfnWorks' polygons by their corners. Discs are
// polygons of 16 corners and the disc's area.

#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"

#include <limits>

namespace jointcreep::exchange
{

std::vector<File> write_fracman(const Job& job)
{
    const Section& section = job.sections[0];
    const std::vector<Plane> planes = planes_of(section, job.width);
    const std::vector<std::string>& sets = section.network.names.joint_set;
    std::size_t nodes = 0;
    for (const Plane& plane : planes)
        nodes += plane.corner.size();
    std::string text =
        "BEGIN FORMAT\n    Format = Ascii\n    Length_Unit = M\n    XAxis = East\n    Scale = 1\n"
        "    No_Fractures = ";
    text.append(std::to_string(planes.size())).append("\n    No_TessFractures = 0\n    No_Nodes = ");
    text.append(std::to_string(nodes)).append("\n    No_Properties = 3\nEND FORMAT\nBEGIN PROPERTIES\n");
    text +=
        "    Prop1 = (Real*4) \"Joint\"\n    Prop2 = (Real*4) \"Number\"\n    Prop3 = (Real*4) \"Diameter\"\n"
        "END PROPERTIES\nBEGIN SETS\n";
    for (std::size_t set = 0; set < sets.size(); ++set) // readers split lines at =
        text.append("    Set")
            .append(std::to_string(set + 1))
            .append(" = \"")
            .append(without(without(sets[set], "\"", '\''), "=", '-'))
            .append("\"\n");
    text += "END SETS\nBEGIN FRACTURE\n";
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const Plane& plane = planes[i];
        const Joints& joints = section.network.joints;
        text.append(std::to_string(i + 1))
            .append(" ")
            .append(std::to_string(plane.corner.size()))
            .append(" ");
        text.append(std::to_string(joints.set[plane.joint] + 1))
            .append(" ")
            .append(std::to_string(plane.joint));
        text.append(" ")
            .append(std::to_string(joints.number[plane.joint]))
            .append(" ")
            .append(shown(plane.diameter));
        text += '\n';
        for (std::size_t c = 0; c < plane.corner.size(); ++c)
            text.append(std::to_string(c + 1))
                .append(" ")
                .append(place_text(plane.corner[c], " "))
                .append("\n");
        text.append("0 ").append(place_text(plane.normal, " ")).append("\n");
    }
    text += "END FRACTURE\n";
    return {{"ids", ".csv", ids_csv(job.all("planes"), counted_from(1))}, {"", "", text}};
}

// The domain of dfnWorks has its centre at the origin: all places count from the middle of the polygons' box, which
// the table of ids says in its first comment line.
std::vector<File> write_dfnworks(const Job& job)
{
    const std::vector<Plane> planes = planes_of(job.sections[0], job.width);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Eigen::Vector3d low = Eigen::Vector3d::Constant(infinity), high = -low;
    for (const Plane& plane : planes)
        for (const Eigen::Vector3d& corner : plane.corner) {
            low = low.cwiseMin(corner);
            high = high.cwiseMax(corner);
        }
    const Eigen::Vector3d middle =
        planes.empty() ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d((low + high) / 2);
    std::string text = "nPolygons: " + std::to_string(planes.size()) + "\n";
    for (const Plane& plane : planes) {
        text += std::to_string(plane.corner.size());
        for (const Eigen::Vector3d& corner : plane.corner)
            text.append(" {").append(place_text(Eigen::Vector3d(corner - middle), ", ")).append("}");
        text += '\n';
    }
    const std::string ids = "# places count from east, north, up [m]: " + place_text(middle, ", ") + "\n" +
                            ids_csv(job.all("planes"), counted_from(1));
    return {{"ids", ".csv", ids}, {"", "", text}};
}

} // namespace jointcreep::exchange
