#include "blocks/merge.hpp"

#include "blocks/predicates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

// Which vertex moves to which: the lower level moves.
enum Level : char { free_vertex = 0, on_bonded = 1, on_outline = 2, outline_corner = 3 };

Level level_of(const Edge& edge, const Sources& sources)
{
    if (sources.has_outline(edge.sources))
        return on_outline;
    return sources.has_bonded(edge.sources) ? on_bonded : free_vertex;
}

// Vertices by square cells of a size that puts few into one, for finding those near a place.
class VertexGrid
{
public:
    // With room for these vertices, and empty.
    VertexGrid(const std::vector<Vector2d>& vertex, const std::vector<Index>& which, double least_cell)
    {
        if (which.empty())
            return;
        Vector2d high = low_ = vertex[which[0]];
        for (const Index v : which) {
            low_ = low_.cwiseMin(vertex[v]);
            high = high.cwiseMax(vertex[v]);
        }
        const Vector2d extent = (high - low_).cwiseMax(least_cell);
        const auto count = static_cast<double>(which.size());
        cell_ = std::max(
            {least_cell, std::sqrt(extent.x() * extent.y() / count), extent.maxCoeff() / (4 * count + 4)});
        per_cell_ = 1 / cell_;
        columns_ = static_cast<Index>(extent.x() * per_cell_) + 1;
        rows_ = static_cast<Index>(extent.y() * per_cell_) + 1;
        start_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
        for (const Index v : which)
            ++start_[cell_of(vertex[v]) + 1];
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        entry_.resize(which.size());
        end_.assign(start_.begin(), start_.end() - 1);
    }

    void add(Index v, const Vector2d& place) { entry_[end_[cell_of(place)]++] = {place, v}; }

    double cell() const { return cell_; }

    // Calls found(v, place) for every vertex in the cells that the rectangle from `low` to `high` touches.
    template <class Found>
    void in_rectangle(const Vector2d& low, const Vector2d& high, Found&& found) const
    {
        if (entry_.empty())
            return;
        const Index first = row(low.y()), last = row(high.y());
        for (Index c = column(low.x()); c <= column(high.x()); ++c) {
            const std::size_t base = static_cast<std::size_t>(c) * rows_;
            for (std::size_t r = base + first; r <= base + last; ++r)
                for (Index i = start_[r]; i < end_[r]; ++i)
                    found(entry_[i].vertex, entry_[i].place);
        }
    }

private:
    struct Entry {
        Vector2d place;
        Index vertex;
    };
    Index column(double x) const
    {
        return std::clamp(static_cast<Index>((x - low_.x()) * per_cell_), 0, columns_ - 1);
    }
    Index row(double y) const
    {
        return std::clamp(static_cast<Index>((y - low_.y()) * per_cell_), 0, rows_ - 1);
    }
    std::size_t cell_of(const Vector2d& place) const
    {
        return static_cast<std::size_t>(column(place.x())) * rows_ + row(place.y());
    }

    Vector2d low_;
    double cell_ = 1, per_cell_ = 1;
    Index columns_ = 1, rows_ = 1;
    std::vector<Index> start_, end_; // of the entries in each cell
    std::vector<Entry> entry_;
};

struct Foot {
    double along;    // 0 at the edge's first end, 1 at its second
    double distance; // [m]
    Vector2d place;
};

Foot foot_on(const Vector2d& p, const Vector2d& q, const Vector2d& v)
{
    const Vector2d d = q - p;
    const double along = std::clamp((v - p).dot(d) / d.squaredNorm(), 0.0, 1.0);
    const Vector2d place = p + along * d;
    return {along, (v - place).norm(), place};
}

// Neighbours of vertices along edges, and these edges.
struct Neighbour {
    Index vertex, edge;
};
using Neighbours = Grouped<Neighbour>;

Neighbours neighbours_of(std::size_t vertices, const std::vector<Edge>& edges)
{
    return {vertices, [&](auto add) {
                for (Index e = 0; e < static_cast<Index>(edges.size()); ++e) {
                    add(edges[e].first, {edges[e].second, e});
                    add(edges[e].second, {edges[e].first, e});
                }
            }};
}

// Edges by their ends; those that have become one are united, and one length of each pair is merged away.
void unite(std::vector<Edge>& edges, const std::vector<Vector2d>& vertex, Sources& sources,
           CuttingReport& report)
{
    for (Edge& e : edges)
        if (e.first > e.second)
            std::swap(e.first, e.second);
    const auto is_less = [](const Edge& a, const Edge& b) {
        return a.first != b.first ? a.first < b.first : a.second < b.second;
    };
    if (!std::is_sorted(edges.begin(), edges.end(), is_less))
        std::stable_sort(edges.begin(), edges.end(), is_less);
    std::size_t count = 0;
    for (auto from = edges.begin(); from != edges.end();) {
        const auto to = std::find_if(from + 1, edges.end(), [&](const Edge& e) { return is_less(*from, e); });
        for (auto e = from + 1; e != to; ++e)
            report.merged_edge_length += (vertex[e->first] - vertex[e->second]).norm();
        edges[count++] = united({from, to}, sources);
        from = to;
    }
    edges.resize(count);
}

// How far each vertex may move.
std::vector<Level> levels_of(const Graph& graph, const Sources& sources, const std::vector<Polygon>& outlines)
{
    std::vector<Level> level(graph.vertex.size(), free_vertex);
    for (const Edge& e : graph.edge)
        if (const Level of_edge = level_of(e, sources); of_edge > free_vertex)
            for (const Index v : {e.first, e.second})
                level[v] = std::max(level[v], of_edge);
    std::vector<Vector2d> corners;
    for (const Polygon& outline : outlines)
        corners.insert(corners.end(), outline.begin(), outline.end());
    std::sort(corners.begin(), corners.end(), is_before);
    for (std::size_t v = 0; v < level.size(); ++v)
        if (level[v] == on_outline &&
            std::binary_search(corners.begin(), corners.end(), graph.vertex[v], is_before))
            level[v] = outline_corner;
    return level;
}

// Vertices with an edge.
std::vector<Index> used_vertices(const Graph& graph)
{
    std::vector<char> is_used(graph.vertex.size(), 0);
    for (const Edge& e : graph.edge)
        is_used[e.first] = is_used[e.second] = 1;
    std::vector<Index> used;
    for (std::size_t v = 0; v < is_used.size(); ++v)
        if (is_used[v])
            used.push_back(static_cast<Index>(v));
    return used;
}

// The neighbours along the outline of its vertices, each with the vertex first; sorted.
std::vector<std::array<Index, 2>> neighbours_along_outline(const Graph& graph, const Sources& sources,
                                                           const std::vector<Level>& level)
{
    std::vector<std::array<Index, 2>> along;
    for (const Edge& e : graph.edge)
        if (level[e.first] >= on_outline && level_of(e, sources) == on_outline) {
            along.push_back({e.first, e.second});
            along.push_back({e.second, e.first});
        }
    std::sort(along.begin(), along.end());
    return along;
}

// The vertex that each one joins: the nearest within reach that does not move itself, or none but itself. Vertices of a
// higher level choose first, then those of a lower number. Only vertices that stay are in the grid, no two of them
// within reach but on the outline: so it takes no longer where thousands lie together.
std::vector<Index> join_vertices(const Graph& graph, const Sources& sources, const std::vector<Index>& used,
                                 const std::vector<Level>& level, double reach, CuttingReport& report)
{
    // Vertices on the outline may only join a neighbour along it: two sides of the section never meet.
    const std::vector<std::array<Index, 2>> along = neighbours_along_outline(graph, sources, level);
    const auto may_join = [&](Index v, Index target) {
        return level[v] < on_outline ||
               (level[v] != outline_corner &&
                std::binary_search(along.begin(), along.end(), std::array{v, target}));
    };
    std::vector<Index> joined(level.size());
    std::iota(joined.begin(), joined.end(), 0);
    VertexGrid stay(graph.vertex, used, reach);
    const Vector2d around(reach, reach);
    for (const Level choosing : {outline_corner, on_outline, on_bonded, free_vertex})
        for (const Index v : used) {
            if (level[v] != choosing)
                continue;
            const Vector2d& from = graph.vertex[v];
            Index nearest = -1;
            double distance = reach;
            stay.in_rectangle(from - around, from + around, [&](Index w, const Vector2d& place) {
                const double squared = (place - from).squaredNorm();
                if (squared >= 1.001 * reach * reach)
                    return;
                const double d = std::sqrt(squared);
                if ((d < distance || (d == distance && w < nearest)) && may_join(v, w)) {
                    distance = d;
                    nearest = w;
                }
            });
            if (nearest < 0) {
                stay.add(v, from);
                continue;
            }
            joined[v] = nearest;
            ++report.merged_vertices;
            report.largest_move = std::max(report.largest_move, distance);
        }
    return joined;
}

// The edges once vertices have joined.
std::vector<Edge> joined_edges(const Graph& graph, const std::vector<Index>& joined, Sources& sources,
                               CuttingReport& report)
{
    std::vector<Edge> edges;
    edges.reserve(graph.edge.size());
    for (const Edge& e : graph.edge) {
        if (joined[e.first] == joined[e.second])
            report.merged_edge_length += (graph.vertex[e.first] - graph.vertex[e.second]).norm();
        else
            edges.push_back({joined[e.first], joined[e.second], e.sources,
                             e.is_settled && joined[e.first] == e.first && joined[e.second] == e.second});
    }
    unite(edges, graph.vertex, sources, report);
    return edges;
}

// An edge and a vertex that is perhaps close to it.
struct NearEdge {
    Index edge, vertex;
    auto operator<=>(const NearEdge&) const = default; // NOLINT: there is no pointer
};

// Vertices within about half the reach of an edge, in the order of edges.
std::vector<NearEdge> vertices_near_edges(const std::vector<Vector2d>& vertex, const std::vector<Edge>& edges,
                                          const std::vector<Index>& used, double reach)
{
    std::vector<NearEdge> near;
    VertexGrid grid(vertex, used, 2 * reach);
    for (const Index v : used)
        grid.add(v, vertex[v]);
    const double margin = (0.5 + 1e-6) * reach, pieces_per_length = 0.5 / grid.cell();
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const Index first = edges[e].first, second = edges[e].second;
        const Vector2d &p = vertex[first], &q = vertex[second], d = q - p;
        const double length = d.norm();
        // In pieces of about a cell each, so that a long slanting edge looks only along itself.
        const int pieces = static_cast<int>(length * pieces_per_length) + 1;
        for (int i = 0; i < pieces; ++i) {
            const Vector2d from = p + d * (static_cast<double>(i) / pieces),
                           to = p + d * ((i + 1.0) / pieces);
            grid.in_rectangle(from.cwiseMin(to).array() - margin, from.cwiseMax(to).array() + margin,
                              [&](Index v, const Vector2d& place) {
                                  if (v == first || v == second)
                                      return;
                                  const Vector2d o = place - p;
                                  if (std::abs(d.x() * o.y() - d.y() * o.x()) < margin * length)
                                      near.push_back({static_cast<Index>(e), v});
                              });
        }
    }
    return near;
}

// Adds both sides of wedges narrower than the limit, each with the other's far end.
void add_narrow_wedges(const std::vector<Vector2d>& vertex, const Neighbours& neighbours,
                       const std::vector<Index>& used, double smallest_angle, std::vector<NearEdge>& near)
{
    const double sine = std::sin(smallest_angle) * (1 + 1e-6);
    std::vector<Vector2d> to; // the neighbours, from the tip
    std::vector<double> squared;
    for (const Index tip : used) {
        const std::span<const Neighbour> around = neighbours[tip];
        to.clear();
        squared.clear();
        for (std::size_t i = 0; i < around.size(); ++i) {
            const Vector2d d = vertex[around[i].vertex] - vertex[tip];
            to.push_back(d);
            squared.push_back(d.squaredNorm());
            for (std::size_t j = 0; j < i; ++j) {
                const Vector2d& o = to[j];
                if (d.dot(o) <= 0)
                    continue;
                const double across = d.x() * o.y() - d.y() * o.x();
                if (across * across <= sine * sine * squared[i] * squared[j]) {
                    near.push_back({around[i].edge, around[j].vertex});
                    near.push_back({around[j].edge, around[i].vertex});
                }
            }
        }
    }
}

// Sorts, and leaves each one once. The first `in_order` are in the order of edges already.
void sort_near(std::vector<NearEdge>& near, std::ptrdiff_t in_order)
{
    const auto middle = near.begin() + in_order;
    for (auto from = near.begin(); from != middle;) {
        const auto to =
            std::find_if(from, middle, [&](const NearEdge& other) { return other.edge != from->edge; });
        std::sort(from, to);
        from = to;
    }
    std::sort(middle, near.end());
    std::inplace_merge(near.begin(), middle, near.end());
    near.erase(
        std::unique(near.begin(), near.end(), [](const NearEdge& a, const NearEdge& b) { return a == b; }),
        near.end());
}

// What a pass does to edges that have vertices close to them.
struct Bent {
    std::vector<Vector2d> place; // of vertices [m]
    std::vector<char> has_moved; // vertices, onto an edge
    // Vertices that an edge, by its ends, goes through.
    std::map<std::pair<Index, Index>, std::vector<Index>> via;

    const std::vector<Index>* through(Index a, Index b) const // in order from the lower of its ends
    {
        const auto found = via.find(std::minmax(a, b));
        return found == via.end() ? nullptr : &found->second;
    }
};

// Lets edges go through the vertices close to them, and moves vertices onto edges of a higher level. Close is
// within half the reach, or at the far end of a narrow wedge. (With the whole reach all three corners of a
// small triangle could be close to their opposite sides, for ever.)
class Bending
{
public:
    Bending(const Graph& graph, const std::vector<Edge>& edges, const Neighbours& neighbours,
            const std::vector<Level>& level, const Sources& sources, const MergeLimits& limits)
        : vertex_(graph.vertex), edges_(edges), neighbours_(neighbours), level_(level), sources_(sources),
          limits_(limits), bent_{graph.vertex, std::vector<char>(graph.vertex.size(), 0), {}}
    {
    }

    // `near`: the vertices near one edge.
    void bend(std::span<const NearEdge> near, CuttingReport& report)
    {
        const Edge& edge = edges_[near.front().edge];
        std::vector<std::pair<double, Index>> through; // fractions of the edge, vertices
        // A tip: not both in one pass, or the diagonal of a narrow strip only turns over.
        Index closed_from = -1;
        for (const NearEdge& one : near)
            if (const std::optional<Foot> foot = takes(edge, one.vertex, closed_from)) {
                report.largest_move = std::max(report.largest_move, foot->distance);
                through.emplace_back(foot->along, one.vertex);
            }
        if (through.empty())
            return;
        std::sort(through.begin(), through.end());
        auto& via = bent_.via[{edge.first, edge.second}];
        for (const auto& [along, v] : through)
            via.push_back(v);
        report.merged_vertices += static_cast<Index>(through.size());
    }

    Bent result() && { return std::move(bent_); }

private:
    // The foot of a vertex on an edge that goes through it from now on. Once a pass: the next one looks again.
    std::optional<Foot> takes(const Edge& edge, Index v, Index& closed_from)
    {
        const Foot foot = foot_on(vertex_[edge.first], vertex_[edge.second], vertex_[v]);
        if (foot.distance >= MergeLimits::farthest_closing * limits_.shortest_edge || foot.along <= 0 ||
            foot.along >= 1)
            return {};
        const bool is_close = foot.distance < limits_.shortest_edge / 2;
        const Index tip = is_close ? -1 : tip_of_wedge(edge, v, foot.distance, closed_from);
        const Level of_edge = level_of(edge, sources_);
        if ((!is_close && tip < 0) || (level_[v] >= on_outline && of_edge == on_outline))
            return {};
        if (level_[v] < of_edge) {
            if (bent_.has_moved[v])
                return {};
            bent_.has_moved[v] = 1;
            bent_.place[v] = foot.place;
        }
        if (tip >= 0)
            closed_from = tip;
        return foot;
    }

    // The end of an edge from which it and another one to `v` make a narrow wedge; -1 none.
    Index tip_of_wedge(const Edge& edge, Index v, double distance, Index closed_from) const
    {
        // Where both sides are as long, each would go through the other's end: they would change places, for
        // ever. The first one does.
        const auto is_closed_already = [&](Index tip, Index end) {
            const std::vector<Index>* const via = bent_.through(tip, v);
            return via != nullptr && std::ranges::find(*via, end) != via->end();
        };
        const auto is_wedge_from = [&](Index tip, Index end) {
            return closed_from != end &&
                   std::ranges::find(neighbours_[v], tip, &Neighbour::vertex) != neighbours_[v].end() &&
                   distance < (vertex_[v] - vertex_[tip]).norm() * std::sin(limits_.smallest_angle) &&
                   !is_closed_already(tip, end);
        };
        if (is_wedge_from(edge.first, edge.second))
            return edge.first;
        return is_wedge_from(edge.second, edge.first) ? edge.second : -1;
    }

    const std::vector<Vector2d>& vertex_;
    const std::vector<Edge>& edges_;
    const Neighbours& neighbours_;
    const std::vector<Level>& level_;
    const Sources& sources_;
    const MergeLimits& limits_;
    Bent bent_;
};

// Edges that pass within half the reach of a vertex go through it, or the vertex moves onto them; the same
// for the far end of a wedge narrower than the limit. `used`: vertices that may have edges.
Bent bend_edges(const Graph& graph, const std::vector<Edge>& edges, std::vector<Index> used,
                const std::vector<Level>& level, const Sources& sources, const MergeLimits& limits,
                CuttingReport& report)
{
    const Neighbours neighbours = neighbours_of(graph.vertex.size(), edges);
    std::erase_if(used, [&](Index v) { return neighbours[v].empty(); });
    std::vector<NearEdge> near = vertices_near_edges(graph.vertex, edges, used, limits.shortest_edge);
    const auto in_order = static_cast<std::ptrdiff_t>(near.size());
    add_narrow_wedges(graph.vertex, neighbours, used, limits.smallest_angle, near);
    sort_near(near, in_order);
    Bending bending(graph, edges, neighbours, level, sources, limits);
    for (auto from = near.begin(); from != near.end();) {
        const auto to =
            std::find_if(from, near.end(), [&](const NearEdge& other) { return other.edge != from->edge; });
        bending.bend({from, to}, report);
        from = to;
    }
    return std::move(bending).result();
}

// The edges in pieces from each vertex that they go through to the next.
void split(std::vector<Edge>& edges, const Graph& graph, const Bent& bent, Sources& sources,
           CuttingReport& report)
{
    if (bent.via.empty())
        return;
    std::vector<Edge> all;
    all.reserve(edges.size() + 4 * bent.via.size());
    std::vector<Edge> pieces;
    for (const Edge& e : edges) {
        const std::vector<Index>* const via = bent.through(e.first, e.second);
        if (via == nullptr) {
            all.push_back(e);
            continue;
        }
        Index from = e.first;
        for (const Index v : *via) {
            pieces.push_back({from, v, e.sources});
            from = v;
        }
        pieces.push_back({from, e.second, e.sources});
    }
    all.insert(all.end(), pieces.begin(), pieces.end());
    edges = std::move(all);
    unite(edges, graph.vertex, sources, report);
}

// A ring of before as it runs now.
std::vector<Index> ring_now(std::span<const Index> before, const std::vector<Index>& joined, const Bent& bent)
{
    std::vector<Index> ring;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const Index a = joined[before[i]], b = joined[before[(i + 1) % before.size()]];
        if (a == b)
            continue;
        ring.push_back(a);
        if (const std::vector<Index>* const via = bent.through(a, b)) {
            if (a < b)
                ring.insert(ring.end(), via->begin(), via->end());
            else
                ring.insert(ring.end(), via->rbegin(), via->rend());
        }
    }
    return ring;
}

// What the faces of before have become: those without area have merged into their neighbours. Only faces with
// an edge that has changed need a look.
void report_merged_faces(const Graph& graph, const std::vector<Index>& joined, const Bent& bent,
                         CuttingReport& report)
{
    std::vector<char> has_changed(graph.edge.size(), 0);
    for (std::size_t e = 0; e < graph.edge.size(); ++e) {
        const Index a = graph.edge[e].first, b = graph.edge[e].second;
        has_changed[e] = joined[a] != a || joined[b] != b || bent.has_moved[a] || bent.has_moved[b] ||
                         (!bent.via.empty() && bent.through(a, b) != nullptr);
    }
    for_outer_rings(graph, has_changed, [&](std::span<const Index> outer, double area) {
        const std::vector<Index> ring = ring_now(outer, joined, bent);
        const double left = ring.size() < 3 ? 0.0 : ring_area(bent.place, ring);
        if (left <= 1e-9 * area)
            report.merged_block_area += area;
    });
}

// The graph of these edges, with the vertices that they have.
Graph graph_of(std::vector<Edge> edges, const Bent& bent)
{
    Graph graph;
    std::vector<Index> index(bent.place.size(), -1);
    for (Edge& edge : edges) {
        edge.is_settled = edge.is_settled && !bent.has_moved[edge.first] && !bent.has_moved[edge.second];
        for (Index* v : {&edge.first, &edge.second}) {
            if (index[*v] < 0) {
                index[*v] = static_cast<Index>(graph.vertex.size());
                graph.vertex.push_back(bent.place[*v]);
            }
            *v = index[*v];
        }
    }
    graph.edge = std::move(edges);
    return graph;
}

} // namespace

bool merge_pass(Graph& graph, Sources& sources, const std::vector<Polygon>& outlines,
                const MergeLimits& limits, CuttingReport& report)
{
    const double reach = limits.shortest_edge;
    const Index merged_before = report.merged_vertices;
    const std::vector<Level> level = levels_of(graph, sources, outlines);

    // 1. Vertices within reach of one that does not move join it.
    std::vector<Index> used = used_vertices(graph);
    const std::vector<Index> joined = join_vertices(graph, sources, used, level, reach, report);
    std::vector<Edge> edges = joined_edges(graph, joined, sources, report);

    // 2. Edges go through vertices close to them.
    std::erase_if(used, [&](Index v) { return joined[v] != v; });
    const Bent bent = bend_edges(graph, edges, std::move(used), level, sources, limits, report);
    if (report.merged_vertices == merged_before)
        return false;
    split(edges, graph, bent, sources, report);
    report_merged_faces(graph, joined, bent, report);
    graph = graph_of(std::move(edges), bent);
    return true;
}

} // namespace jointcreep::blocks
