#include "blocks/graph.hpp"

#include <CGAL/Arr_consolidated_curve_data_traits_2.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <unordered_map>

namespace jointcreep::blocks
{

namespace
{

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using SegmentTraits = CGAL::Arr_segment_traits_2<Exact>;
using Traits = CGAL::Arr_consolidated_curve_data_traits_2<SegmentTraits, Index>; // data: an edge of the input
using Arrangement = CGAL::Arrangement_2<Traits>;

} // namespace

Graph arrange(const Graph& crossing)
{
    std::vector<Exact::Point_2> point;
    point.reserve(crossing.vertex.size());
    for (const Eigen::Vector2d& v : crossing.vertex)
        point.emplace_back(v.x(), v.y());

    std::vector<Traits::Curve_2> curves;
    curves.reserve(crossing.edge.size());
    for (std::size_t i = 0; i < crossing.edge.size(); ++i) {
        const Edge& e = crossing.edge[i];
        const auto &p = point[e.first], &q = point[e.second];
        if (p != q)
            curves.emplace_back(SegmentTraits::Curve_2(p, q), static_cast<Index>(i));
    }
    Arrangement arrangement;
    CGAL::insert(arrangement, curves.begin(), curves.end());

    std::vector<Arrangement::Vertex_const_handle> handles;
    std::vector<Eigen::Vector2d> place;
    handles.reserve(arrangement.number_of_vertices());
    for (auto v = arrangement.vertices_begin(); v != arrangement.vertices_end(); ++v) {
        handles.push_back(v);
        place.emplace_back(CGAL::to_double(v->point().x()), CGAL::to_double(v->point().y()));
    }

    // The order of handles is that of CGAL's sweep; a sort by place makes it a property of the result.
    std::vector<Index> order(place.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](Index i, Index j) {
        return std::pair(place[i].x(), place[i].y()) < std::pair(place[j].x(), place[j].y());
    });

    // Two vertices closer than doubles can tell become one here; merge() would join them anyway.
    Graph planar;
    std::unordered_map<const void*, Index> vertex_of;
    vertex_of.reserve(order.size());
    for (const Index i : order) {
        if (planar.vertex.empty() || planar.vertex.back() != place[i])
            planar.vertex.push_back(place[i]);
        vertex_of[&*handles[i]] = static_cast<Index>(planar.vertex.size()) - 1;
    }
    for (auto e = arrangement.edges_begin(); e != arrangement.edges_end(); ++e) {
        Edge edge{vertex_of.at(&*e->source()), vertex_of.at(&*e->target()), {}};
        if (edge.first == edge.second)
            continue;
        if (edge.first > edge.second)
            std::swap(edge.first, edge.second);
        for (auto d = e->curve().data().begin(); d != e->curve().data().end(); ++d) {
            const auto& sources = crossing.edge[*d].sources;
            edge.sources.insert(edge.sources.end(), sources.begin(), sources.end());
        }
        std::sort(edge.sources.begin(), edge.sources.end());
        edge.sources.erase(std::unique(edge.sources.begin(), edge.sources.end()), edge.sources.end());
        planar.edge.push_back(std::move(edge));
    }
    std::sort(planar.edge.begin(), planar.edge.end(), [](const Edge& a, const Edge& b) {
        return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    // A joint that runs along another line but for rounding makes edges of its own, with the same rounded
    // ends.
    std::vector<Edge> single;
    for (Edge& edge : planar.edge) {
        if (single.empty() || single.back().first != edge.first || single.back().second != edge.second) {
            single.push_back(std::move(edge));
            continue;
        }
        std::vector<Index> both;
        std::set_union(single.back().sources.begin(), single.back().sources.end(), edge.sources.begin(),
                       edge.sources.end(), std::back_inserter(both));
        single.back().sources = std::move(both);
    }
    planar.edge = std::move(single);
    return planar;
}

} // namespace jointcreep::blocks
