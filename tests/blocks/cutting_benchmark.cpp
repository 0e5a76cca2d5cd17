// cutting_benchmark: what other ways of cutting take for the lines that jointgen cuts.
//
//   cutting_benchmark METHOD SCENE.toml
//   cutting_benchmark run PROGRAM ARGUMENTS...
//
// METHOD is
//   subdivision   this project's, lines to faces, without merging
//   cgal          CGAL's Arrangement_2 over exact constructions, one aggregated insertion
//   geos          GEOS: unary union, which nodes the lines, and polygonize
//
// Samples the scene's joints, clips them to the section's box, and prints one line of CSV: method, lines,
// faces, processor time of cutting [s], most memory held less that before [bytes].

#include "blocks/cgal_arrangement.hpp"
#include "blocks/graph.hpp"
#include "sampling/joint_sets.hpp"
#include "scene/scene.hpp"

#ifdef JOINTCREEP_GEOS
#include <geos_c.h>
#endif

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

using namespace jointcreep;

namespace
{

blocks::Graph lines_of(const Scene& scene, const Joints& joints)
{
    blocks::Graph lines;
    const auto add = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        const auto n = static_cast<Index>(lines.vertex.size());
        lines.vertex.push_back(a);
        lines.vertex.push_back(b);
        lines.edge.push_back({n, n + 1, static_cast<Index>(lines.edge.size())});
    };
    for (std::size_t i = 0; i < scene.outline.size(); ++i)
        add(scene.outline[i], scene.outline[(i + 1) % scene.outline.size()]);
    // Joints as far as the section's box reaches, and a bit: what lies outside is no work to compare with.
    Eigen::Vector2d low = scene.outline[0], high = low;
    for (const Eigen::Vector2d& v : scene.outline) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    const double bit = 1e-6 * (high - low).norm();
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        const Eigen::Vector2d d = joints.to[j] - joints.from[j];
        double from = 0, to = 1;
        for (const int i : {0, 1}) {
            const double a = (low[i] - bit - joints.from[j][i]) / d[i],
                         b = (high[i] + bit - joints.from[j][i]) / d[i];
            from = std::max(from, std::min(a, b));
            to = std::min(to, std::max(a, b));
        }
        if (from < to)
            add(joints.from[j] + from * d, joints.from[j] + to * d);
    }
    return lines;
}

std::size_t by_subdivision(const blocks::Graph& lines)
{
    std::vector<blocks::Source> all(lines.edge.size(), {blocks::Source::Kind::joint, 0});
    blocks::Sources sources(std::move(all));
    return blocks::trace_faces(blocks::arrange(lines, sources)).size();
}

std::size_t by_cgal(const blocks::Graph& lines)
{
    static blocks::CgalArrangement arrangement; // not freed: that would take as long again
    blocks::insert_lines(arrangement, lines);
    return arrangement.number_of_faces() - 1;
}

std::size_t by_geos(const blocks::Graph& lines)
{
#ifdef JOINTCREEP_GEOS
    GEOSContextHandle_t geos = GEOS_init_r();
    std::vector<GEOSGeometry*> segments;
    for (const blocks::Edge& e : lines.edge) {
        GEOSCoordSequence* ends = GEOSCoordSeq_create_r(geos, 2, 2);
        for (const unsigned i : {0u, 1u}) {
            const Eigen::Vector2d& v = lines.vertex[i == 0 ? e.first : e.second];
            GEOSCoordSeq_setXY_r(geos, ends, i, v.x(), v.y());
        }
        segments.push_back(GEOSGeom_createLineString_r(geos, ends));
    }
    GEOSGeometry* all = GEOSGeom_createCollection_r(geos, GEOS_MULTILINESTRING, segments.data(),
                                                    static_cast<unsigned>(segments.size()));
    const GEOSGeometry* noded = GEOSUnaryUnion_r(geos, all);
    if (!noded)
        throw std::runtime_error("GEOS cannot node these lines");
    const GEOSGeometry* polygons = GEOSPolygonize_r(geos, &noded, 1);
    return static_cast<std::size_t>(GEOSGetNumGeometries_r(geos, polygons));
#else
    static_cast<void>(lines);
    throw std::runtime_error("built without GEOS (libgeos-dev)");
#endif
}

// Of this program, without what it was started from [bytes].
double most_memory()
{
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (double kilobytes = 0; word == "VmHWM:" && status >> kilobytes)
            return 1024 * kilobytes;
    return 0;
}

// Runs another program and prints its processor time [s] and most memory [bytes]; from a small process, as a
// system counts the memory of the one that starts it, too.
int run(char** command)
{
    const pid_t child = fork();
    if (child == 0) {
        execv(command[0], command);
        std::_Exit(127);
    }
    int status = 0;
    rusage usage{};
    if (child < 0 || wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) ||
        WEXITSTATUS(status) != 0)
        throw std::runtime_error(std::string(command[0]) + " failed");
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    std::cout << seconds(usage.ru_utime) + seconds(usage.ru_stime) << ','
              << 1024 * static_cast<double>(usage.ru_maxrss) << std::endl;
    return 0;
}

} // namespace

int main(int argc, char** argv)
try {
    if (argc > 2 && std::string(argv[1]) == "run")
        return run(argv + 2);
    if (argc != 3)
        throw std::runtime_error("usage: cutting_benchmark subdivision|cgal|geos SCENE.toml");
    const std::string method = argv[1];
    const Scene scene = scene::parse_scene(scene::read_scene_text(argv[2]), argv[2]);
    const blocks::Graph lines = lines_of(scene, sampling::sample_joints(scene, scene.seed, 0));
    const double memory = most_memory();
    const std::clock_t start = std::clock();
    const std::size_t faces = method == "subdivision" ? by_subdivision(lines)
                              : method == "cgal"      ? by_cgal(lines)
                              : method == "geos"      ? by_geos(lines)
                                                 : throw std::runtime_error("no method \"" + method + "\"");
    const double taken = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    std::cout << method << ',' << lines.edge.size() << ',' << faces << ',' << taken << ','
              << most_memory() - memory << std::endl;
    std::_Exit(0); // without freeing
} catch (const std::exception& error) {
    std::cerr << "cutting_benchmark: " << error.what() << '\n';
    return 1;
}
