// The one file of the libraries that compiles CGAL's arrangement.

#include "blocks/graph.hpp"

#ifdef JOINTCREEP_CGAL_CUTS
#include "blocks/cgal_arrangement.hpp"
#else
#include "model/error.hpp"
#endif

namespace jointcreep::blocks
{

#ifdef JOINTCREEP_CGAL_CUTS

Graph arrange_with_cgal(const Graph& lines, Sources& sources)
{
    CgalArrangement arrangement;
    insert_lines(arrangement, lines);
    // By their ends in lexicographic order: so vertices and edges come in the order of arrange().
    const EdgeLines edges = edges_of(arrangement, lines);
    std::map<std::pair<double, double>, Index> number;
    for (const auto& [ends, on] : edges) {
        number[{std::get<0>(ends), std::get<1>(ends)}];
        number[{std::get<2>(ends), std::get<3>(ends)}];
    }
    Graph graph;
    for (auto& [place, index] : number) {
        index = static_cast<Index>(graph.vertex.size());
        graph.vertex.emplace_back(place.first, place.second);
    }
    for (const auto& [ends, on] : edges)
        graph.edge.push_back({number.at({std::get<0>(ends), std::get<1>(ends)}),
                              number.at({std::get<2>(ends), std::get<3>(ends)}), sources.united(on)});
    return graph;
}

#else

Graph arrange_with_cgal(const Graph&, Sources&)
{
    throw input_error(
        "--cut-with cgal: the programs were built without it, as it takes long to compile. Build them with the "
        "tests: cmake --preset test && cmake --build --preset test");
}

#endif

} // namespace jointcreep::blocks
