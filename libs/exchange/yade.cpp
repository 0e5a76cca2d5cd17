// A script of YADE that makes the blocks: convex polyhedra, --width wide (1 m by default), x along the section, y
// across it, z up. `yade NAME.py` makes the bodies; stiffness and friction of the material are the user's.

#include "exchange/convex.hpp"
#include "exchange/text.hpp"
#include "exchange/writers.hpp"
#include "model/error.hpp"
#include "model/version.hpp"

namespace jointcreep::exchange
{

std::vector<File> write_yade(const Job& job)
{
    const std::vector<Layer> layers = job.all("blocks");
    const Layer& layer = layers[0];
    std::string text = "# jointcreep " + std::string(version()) +
                       ": convex parts of blocks; metres\n"
                       "from yade import polyhedra_utils\n\n"
                       "width = " +
                       shown(job.width.value_or(1)) +
                       "\n# (block, rock, stage, realization, corners {x, z})\nparts = [\n";
    const auto name_of = [&](const char* name, std::size_t row) {
        return json_text(text_of(*find_attribute(layer, name), row));
    };
    for (std::size_t row = 0; row < layer.rows(); ++row)
        for (const std::vector<Index>& ring : convex_parts(layer, row)) {
            text.append("    (").append(std::to_string(row)).append(", ").append(name_of("rock", row));
            text.append(", ").append(name_of("stage", row)).append(", ");
            text.append(text_of(*find_attribute(layer, "realization"), row)).append(", [");
            for (const Index corner : ring)
                text.append(corner == ring[0] ? "(" : ", (")
                    .append(place_text(Eigen::Vector2d(layer.point[corner].head<2>()), ", "))
                    .append(")");
            text += "]),\n";
        }
    text += "]\n\n"
            "material = O.materials[O.materials.append(PolyhedraMat())]\n"
            "block_of = {}  # number of a body -> its block; the parts of one block are not held together\n"
            "for block, rock, stage, realization, ring in parts:\n"
            "    corners = [(x, y, z) for x, z in ring for y in (-width / 2, width / 2)]\n"
            "    block_of[O.bodies.append(polyhedra_utils.polyhedra(material, v=corners))] = block\n";
    return {{"", "", text}};
}

} // namespace jointcreep::exchange
