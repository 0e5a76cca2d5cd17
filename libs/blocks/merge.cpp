#include "blocks/merge.hpp"

#include "blocks/predicates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

// Who moves to whom: the lower level moves.
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
    VertexGrid(const std::vector<Vector2d>& vertex, std::vector<Index> which, double least_cell)
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
        const auto cell_of = [&](Index v) {
            return static_cast<std::size_t>(column(vertex[v].x())) * rows_ + row(vertex[v].y());
        };
        start_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
        for (const Index v : which)
            ++start_[cell_of(v) + 1];
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        entry_.resize(which.size());
        std::vector<Index> next(start_.begin(), start_.end() - 1);
        for (const Index v : which)
            entry_[next[cell_of(v)]++] = {vertex[v], v};
    }

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
            for (Index i = start_[base + first]; i < start_[base + last + 1]; ++i)
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

    Vector2d low_;
    double cell_ = 1, per_cell_ = 1;
    Index columns_ = 1, rows_ = 1;
    std::vector<Index> start_;
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
struct Adjacency {
    std::vector<Index> start, neighbour, edge;

    Adjacency(std::size_t vertices, const std::vector<Edge>& edges)
        : start(vertices + 1, 0), neighbour(2 * edges.size()), edge(2 * edges.size())
    {
        for (const Edge& e : edges) {
            ++start[e.first + 1];
            ++start[e.second + 1];
        }
        std::partial_sum(start.begin(), start.end(), start.begin());
        std::vector<Index> next(start.begin(), start.end() - 1);
        for (std::size_t e = 0; e < edges.size(); ++e)
            for (const auto& [v, other] :
                 {std::pair(edges[e].first, edges[e].second), std::pair(edges[e].second, edges[e].first)}) {
                neighbour[next[v]] = other;
                edge[next[v]++] = static_cast<Index>(e);
            }
    }
    std::span<const Index> operator[](Index v) const
    {
        return {neighbour.data() + start[v], neighbour.data() + start[v + 1]};
    }
    std::span<const Index> edges_at(Index v) const
    {
        return {edge.data() + start[v], edge.data() + start[v + 1]};
    }
};

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
    for (const Edge& e : edges) {
        if (count > 0 && edges[count - 1].first == e.first && edges[count - 1].second == e.second) {
            Edge& united = edges[count - 1];
            united.sources = sources.united(united.sources, e.sources);
            united.is_settled = united.is_settled && e.is_settled;
            report.merged_edge_length += (vertex[e.first] - vertex[e.second]).norm();
            continue;
        }
        edges[count++] = e;
    }
    edges.resize(count);
}

} // namespace

bool merge_pass(Graph& graph, Sources& sources, const std::vector<Polygon>& outlines,
                const MergeLimits& limits, CuttingReport& report)
{
    const double reach = limits.shortest_edge;
    const auto n = static_cast<Index>(graph.vertex.size());

    std::vector<Level> level(n, free_vertex);
    for (const Edge& e : graph.edge)
        if (const Level of_edge = level_of(e, sources); of_edge > free_vertex)
            for (const Index v : {e.first, e.second})
                level[v] = std::max(level[v], of_edge);
    std::vector<Vector2d> corners;
    for (const Polygon& outline : outlines)
        corners.insert(corners.end(), outline.begin(), outline.end());
    std::sort(corners.begin(), corners.end(), is_before);
    for (Index v = 0; v < n; ++v)
        if (level[v] == on_outline &&
            std::binary_search(corners.begin(), corners.end(), graph.vertex[v], is_before))
            level[v] = outline_corner;

    // 1. Vertices within reach of one that does not move join it. Those in use:
    std::vector<char> is_used(n, 0);
    for (const Edge& e : graph.edge)
        is_used[e.first] = is_used[e.second] = 1;
    std::vector<Index> used;
    for (Index v = 0; v < n; ++v)
        if (is_used[v])
            used.push_back(v);
    struct Pair {
        Index vertex, other;
        double distance;
    };
    std::vector<Pair> close;
    {
        const VertexGrid grid(graph.vertex, used, reach);
        const Vector2d around(reach, reach);
        for (const Index v : used)
            grid.in_rectangle(graph.vertex[v] - around, graph.vertex[v] + around,
                              [&](Index w, const Vector2d& place) {
                                  if (w == v)
                                      return;
                                  const double squared = (place - graph.vertex[v]).squaredNorm();
                                  if (squared >= 1.001 * reach * reach)
                                      return;
                                  if (const double d = std::sqrt(squared); d < reach)
                                      close.push_back({v, w, d});
                              });
    }
    // Vertices on the outline may only join a neighbour along it: two sides of the section never meet.
    std::map<Index, std::vector<Index>> along_outline;
    for (const Pair& pair : close)
        if (level[pair.vertex] >= on_outline)
            along_outline[pair.vertex] = {};
    if (!along_outline.empty())
        for (const Edge& e : graph.edge)
            if (level_of(e, sources) == on_outline)
                for (const auto& [v, other] : {std::pair(e.first, e.second), std::pair(e.second, e.first)})
                    if (const auto found = along_outline.find(v); found != along_outline.end())
                        found->second.push_back(other);
    const auto may_join = [&](Index v, Index target) {
        if (level[v] < on_outline)
            return true;
        const auto& along = along_outline[v];
        return level[v] != outline_corner && std::find(along.begin(), along.end(), target) != along.end();
    };

    std::vector<Index> joined(n);
    std::iota(joined.begin(), joined.end(), 0);
    bool changed = false;
    std::stable_sort(close.begin(), close.end(),
                     [&](const Pair& a, const Pair& b) { return level[a.vertex] > level[b.vertex]; });
    const auto comes_before = [&](Index a, Index b) { // in that order
        return level[a] != level[b] ? level[a] > level[b] : a < b;
    };
    for (auto from = close.begin(); from != close.end();) {
        const Index v = from->vertex;
        Index nearest = -1;
        double distance = reach;
        for (; from != close.end() && from->vertex == v; ++from) {
            const auto [same, w, d] = *from;
            if (comes_before(w, v) && joined[w] == w && (d < distance || (d == distance && w < nearest)) &&
                may_join(v, w)) {
                distance = d;
                nearest = w;
            }
        }
        if (nearest < 0)
            continue;
        joined[v] = nearest;
        ++report.merged_vertices;
        report.largest_move = std::max(report.largest_move, distance);
        changed = true;
    }

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

    // 2. Edges that pass within half the reach of a vertex go through it, or the vertex moves onto them.
    // (With the whole reach all three corners of a small triangle could be close to their opposite sides, for
    // ever.) The same for the far end of a wedge narrower than the limit.
    const double far_reach = MergeLimits::farthest_closing * reach;
    const Adjacency neighbours(graph.vertex.size(), edges);
    struct Near {
        Index edge, vertex;
        auto operator<=>(const Near&) const = default;
    };
    std::vector<Near> near;
    std::ptrdiff_t of_edges = 0; // of these, in order of edges already
    {
        std::erase_if(used, [&](Index v) { return joined[v] != v || neighbours[v].empty(); });
        const VertexGrid grid(graph.vertex, used, 2 * reach);
        const double margin = (0.5 + 1e-6) * reach, pieces_per_length = 0.5 / grid.cell();
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const Index first = edges[e].first, second = edges[e].second;
            const Vector2d &p = graph.vertex[first], &q = graph.vertex[second], d = q - p;
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
        of_edges = static_cast<std::ptrdiff_t>(near.size());
        // Narrow wedges: neighbours of one vertex, of which one lies close to the other's edge.
        const double sine = std::sin(limits.smallest_angle) * (1 + 1e-6);
        std::vector<Vector2d> to; // the neighbours, from the tip
        std::vector<double> squared;
        for (const Index tip : used) {
            const std::span<const Index> around = neighbours[tip], by = neighbours.edges_at(tip);
            to.clear();
            squared.clear();
            for (std::size_t i = 0; i < around.size(); ++i) {
                const Vector2d d = graph.vertex[around[i]] - graph.vertex[tip];
                to.push_back(d);
                squared.push_back(d.squaredNorm());
                for (std::size_t j = 0; j < i; ++j) {
                    const Vector2d& o = to[j];
                    if (d.dot(o) <= 0)
                        continue;
                    const double across = d.x() * o.y() - d.y() * o.x();
                    if (across * across <= sine * sine * squared[i] * squared[j]) {
                        near.push_back({by[i], around[j]});
                        near.push_back({by[j], around[i]});
                    }
                }
            }
        }
    }
    for (auto from = near.begin(); from != near.begin() + of_edges;) {
        const auto to = std::find_if(from, near.begin() + of_edges,
                                     [&](const Near& other) { return other.edge != from->edge; });
        std::sort(from, to);
        from = to;
    }
    std::sort(near.begin() + of_edges, near.end());
    std::inplace_merge(near.begin(), near.begin() + of_edges, near.end());
    near.erase(std::unique(near.begin(), near.end(), [](const Near& a, const Near& b) { return a == b; }),
               near.end());

    std::vector<Vector2d> moved = graph.vertex;
    std::vector<char> has_moved(n, 0);
    std::map<std::pair<Index, Index>, std::vector<Index>> bent;
    for (auto from = near.begin(); from != near.end();) {
        const Edge& edge = edges[from->edge];
        const Index first = edge.first, second = edge.second;
        const Vector2d p = graph.vertex[first], q = graph.vertex[second];
        const Level edge_level = level_of(edge, sources);
        std::vector<std::pair<double, Index>> through;
        Index closed_from =
            -1; // a tip: not both in one pass, or the diagonal of a narrow strip only turns over
        const auto consider = [&](Index v) {
            const Vector2d& place = graph.vertex[v];
            const Foot foot = foot_on(p, q, place);
            if (foot.distance >= far_reach || foot.along <= 0 || foot.along >= 1)
                return;
            bool is_close = foot.distance < reach / 2;
            Index tip_of_wedge = -1;
            if (!is_close) { // the far end of a narrow wedge
                // Where both sides are as long, each would go through the other's end: they would change
                // places, for ever. The first one does.
                const auto is_closed_already = [&](Index tip, Index end) {
                    const auto other = bent.find(std::minmax(tip, v));
                    return other != bent.end() &&
                           std::ranges::find(other->second, end) != other->second.end();
                };
                const auto is_wedge_from = [&](Index tip, Index end) {
                    return closed_from != end &&
                           std::ranges::find(neighbours[v], tip) != neighbours[v].end() &&
                           foot.distance <
                               (place - graph.vertex[tip]).norm() * std::sin(limits.smallest_angle) &&
                           !is_closed_already(tip, end);
                };
                const bool from_first = is_wedge_from(first, second);
                is_close = from_first || is_wedge_from(second, first);
                tip_of_wedge = from_first ? first : second;
            }
            if (!is_close || (level[v] >= on_outline && edge_level == on_outline))
                return;
            if (level[v] < edge_level) {
                if (has_moved[v])
                    return; // once a pass; the next one looks again
                has_moved[v] = 1;
                moved[v] = foot.place;
            }
            if (tip_of_wedge >= 0)
                closed_from = tip_of_wedge;
            report.largest_move = std::max(report.largest_move, foot.distance);
            through.emplace_back(foot.along, v);
        };
        for (const Index e = from->edge; from != near.end() && from->edge == e; ++from)
            consider(from->vertex);
        if (through.empty())
            continue;
        std::sort(through.begin(), through.end());
        auto& via = bent[{first, second}];
        for (const auto& [along, v] : through)
            via.push_back(v);
        report.merged_vertices += static_cast<Index>(through.size());
        changed = true;
    }
    if (!changed)
        return false;

    if (!bent.empty()) {
        std::vector<Edge> all;
        all.reserve(edges.size() + 4 * bent.size());
        std::vector<Edge> pieces;
        for (const Edge& e : edges) {
            const auto through = bent.find({e.first, e.second});
            if (through == bent.end()) {
                all.push_back(e);
                continue;
            }
            Index from = e.first;
            for (const Index v : through->second) {
                pieces.push_back({from, v, e.sources});
                from = v;
            }
            pieces.push_back({from, e.second, e.sources});
        }
        all.insert(all.end(), pieces.begin(), pieces.end());
        edges = std::move(all);
        unite(edges, graph.vertex, sources, report);
    }

    // What the faces of before have become: those without area have merged into their neighbours. Only faces
    // with an edge that has changed need a look.
    std::vector<char> has_changed(graph.edge.size(), 0);
    for (std::size_t e = 0; e < graph.edge.size(); ++e) {
        const Index a = graph.edge[e].first, b = graph.edge[e].second;
        has_changed[e] = joined[a] != a || joined[b] != b || has_moved[a] || has_moved[b] ||
                         (!bent.empty() && bent.contains(std::minmax(a, b)));
    }
    for_outer_rings(graph, has_changed, [&](std::span<const Index> outer, double area) {
        std::vector<Index> ring;
        for (std::size_t i = 0; i < outer.size(); ++i) {
            const Index a = joined[outer[i]], b = joined[outer[(i + 1) % outer.size()]];
            if (a == b)
                continue;
            ring.push_back(a);
            if (const auto through = bent.find(std::minmax(a, b)); through != bent.end()) {
                const bool same_way = a < b;
                const auto& via = through->second;
                for (std::size_t k = 0; k < via.size(); ++k)
                    ring.push_back(same_way ? via[k] : via[via.size() - 1 - k]);
            }
        }
        const double left = ring.size() < 3 ? 0.0 : ring_area(moved, ring);
        if (left <= 1e-9 * area)
            report.merged_block_area += area;
    });

    Graph merged;
    std::vector<Index> index(n, -1);
    for (Edge& edge : edges) {
        edge.is_settled = edge.is_settled && !has_moved[edge.first] && !has_moved[edge.second];
        for (Index* v : {&edge.first, &edge.second}) {
            if (index[*v] < 0) {
                index[*v] = static_cast<Index>(merged.vertex.size());
                merged.vertex.push_back(moved[*v]);
            }
            *v = index[*v];
        }
    }
    merged.edge = std::move(edges);
    graph = std::move(merged);
    return true;
}

} // namespace jointcreep::blocks
