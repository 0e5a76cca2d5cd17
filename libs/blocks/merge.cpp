#include "blocks/merge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

// Who moves to whom: the lower level moves.
enum Level { free_vertex = 0, on_welded = 1, on_outline = 2, outline_corner = 3 };

// Vertices by square cells, for finding those near a place.
class CellGrid
{
public:
    explicit CellGrid(double cell) : cell_(cell) {}

    void insert(Index id, const Vector2d& place)
    {
        cells_[key(index(place.x()), index(place.y()))].push_back(id);
    }

    // Calls found(id) for every entry in the cells that a square of half width `reach` around `place`
    // touches.
    template <class Found>
    void near(const Vector2d& place, double reach, Found&& found) const
    {
        const auto x0 = index(place.x() - reach), x1 = index(place.x() + reach);
        const auto y0 = index(place.y() - reach), y1 = index(place.y() + reach);
        for (auto x = x0; x <= x1; ++x)
            for (auto y = y0; y <= y1; ++y)
                if (const auto cell = cells_.find(key(x, y)); cell != cells_.end())
                    for (const Index id : cell->second)
                        found(id);
    }

private:
    std::int64_t index(double x) const { return static_cast<std::int64_t>(std::floor(x / cell_)); }
    static std::uint64_t key(std::int64_t x, std::int64_t y)
    {
        return (static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(y) & 0xffffffffu);
    }

    double cell_;
    std::unordered_map<std::uint64_t, std::vector<Index>> cells_;
};

Level level_of(const Edge& edge, const std::vector<Source>& sources)
{
    Level level = free_vertex;
    for (const Index s : edge.sources) {
        if (sources[s].kind == Source::Kind::outline)
            return on_outline;
        if (sources[s].kind == Source::Kind::welded)
            level = on_welded;
    }
    return level;
}

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

} // namespace

bool merge_pass(Graph& graph, const std::vector<Source>& sources, const Polygon& outline,
                const MergeLimits& limits, CuttingReport& report)
{
    const double reach = limits.shortest_edge;
    const auto n = static_cast<Index>(graph.vertex.size());

    std::vector<Level> level(n, free_vertex);
    for (const Edge& e : graph.edge)
        for (const Index v : {e.first, e.second})
            level[v] = std::max(level[v], level_of(e, sources));
    std::map<std::pair<double, double>, int> corners;
    for (const Vector2d& c : outline)
        corners[{c.x(), c.y()}] = 1;
    for (Index v = 0; v < n; ++v)
        if (level[v] == on_outline && corners.contains({graph.vertex[v].x(), graph.vertex[v].y()}))
            level[v] = outline_corner;

    // Vertices on the outline may only join a neighbour along it: two sides of the section never meet.
    std::vector<std::vector<Index>> outline_neighbours(n);
    for (const Edge& e : graph.edge)
        if (level_of(e, sources) == on_outline) {
            outline_neighbours[e.first].push_back(e.second);
            outline_neighbours[e.second].push_back(e.first);
        }
    const auto may_join = [&](Index v, Index target) {
        if (level[v] < on_outline)
            return true;
        const auto& along = outline_neighbours[v];
        return level[v] != outline_corner && std::find(along.begin(), along.end(), target) != along.end();
    };

    // 1. Vertices within reach of one that does not move join it.
    std::vector<Index> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return level[a] > level[b]; });
    std::vector<Index> joined(n);
    std::iota(joined.begin(), joined.end(), 0);
    CellGrid kept(reach);
    bool changed = false;
    for (const Index v : order) {
        Index nearest = -1;
        double distance = reach;
        kept.near(graph.vertex[v], reach, [&](Index w) {
            const double d = (graph.vertex[w] - graph.vertex[v]).norm();
            if ((d < distance || (d == distance && w < nearest)) && may_join(v, w)) {
                distance = d;
                nearest = w;
            }
        });
        if (nearest < 0) {
            kept.insert(v, graph.vertex[v]);
            continue;
        }
        joined[v] = nearest;
        ++report.merged_vertices;
        report.largest_move = std::max(report.largest_move, distance);
        changed = true;
    }

    std::map<std::pair<Index, Index>, std::vector<Index>> edges; // by ends, so that doubles become one
    const auto add_edge = [&](Index a, Index b, const std::vector<Index>& edge_sources) {
        auto& all = edges[std::minmax(a, b)];
        if (!all.empty()) // two edges have become one
            report.merged_edge_length += (graph.vertex[a] - graph.vertex[b]).norm();
        all.insert(all.end(), edge_sources.begin(), edge_sources.end());
    };
    for (const Edge& e : graph.edge) {
        if (joined[e.first] == joined[e.second])
            report.merged_edge_length += (graph.vertex[e.first] - graph.vertex[e.second]).norm();
        else
            add_edge(joined[e.first], joined[e.second], e.sources);
    }

    // 2. Edges that pass within half the reach of a vertex go through it, or the vertex moves onto them.
    // (With the whole reach all three corners of a small triangle could be close to their opposite sides, for
    // ever.)
    double mean_length = 0;
    for (const auto& [ends, s] : edges)
        mean_length += (graph.vertex[ends.first] - graph.vertex[ends.second]).norm();
    mean_length = edges.empty() ? 1 : mean_length / static_cast<double>(edges.size());
    const double far_reach = MergeLimits::farthest_closing * reach;
    const double cell = std::max(far_reach, mean_length / 2);
    CellGrid all(cell);
    std::vector<std::vector<Index>> neighbours(n);
    for (const auto& [ends, s] : edges) {
        neighbours[ends.first].push_back(ends.second);
        neighbours[ends.second].push_back(ends.first);
    }
    for (Index v = 0; v < n; ++v)
        if (joined[v] == v && !neighbours[v].empty())
            all.insert(v, graph.vertex[v]);

    std::vector<Vector2d> moved = graph.vertex;
    std::vector<char> has_moved(n, 0);
    std::map<std::pair<Index, Index>, std::vector<Index>> bent;
    for (const auto& [ends, edge_sources] : edges) {
        const Index first = ends.first, second = ends.second;
        const Vector2d p = graph.vertex[first], q = graph.vertex[second];
        const Level edge_level = level_of({first, second, edge_sources}, sources);
        const double length = (q - p).norm();
        std::vector<std::pair<double, Index>> through;
        const auto consider = [&](Index v) {
            if (v == first || v == second)
                return;
            const Vector2d& place = graph.vertex[v];
            const Foot foot = foot_on(p, q, place);
            if (foot.distance >= far_reach || foot.along <= 0 || foot.along >= 1)
                return;
            bool close = foot.distance < reach / 2;
            if (!close) { // the far end of a narrow wedge
                const auto is_wedge_from = [&](Index tip) {
                    const auto& around = neighbours[v];
                    return std::find(around.begin(), around.end(), tip) != around.end() &&
                           foot.distance <
                               (place - graph.vertex[tip]).norm() * std::sin(limits.smallest_angle);
                };
                close = is_wedge_from(first) || is_wedge_from(second);
            }
            if (!close || (level[v] >= on_outline && edge_level == on_outline))
                return;
            if (level[v] < edge_level) {
                if (has_moved[v])
                    return; // once a pass; the next one looks again
                has_moved[v] = 1;
                moved[v] = foot.place;
            }
            report.largest_move = std::max(report.largest_move, foot.distance);
            through.emplace_back(foot.along, v);
        };
        // The edge in pieces of a cell each, so that a long slanting edge looks only along itself.
        const int pieces = static_cast<int>(std::ceil(length / cell));
        std::vector<Index> candidates;
        for (int i = 0; i < pieces; ++i)
            all.near(p + (q - p) * ((i + 0.5) / pieces), length / pieces / 2 + far_reach,
                     [&](Index v) { candidates.push_back(v); });
        std::sort(candidates.begin(), candidates.end());
        candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
        for (const Index v : candidates)
            consider(v);
        if (through.empty())
            continue;
        std::sort(through.begin(), through.end());
        for (const auto& [along, v] : through)
            bent[ends].push_back(v);
        report.merged_vertices += static_cast<Index>(through.size());
        changed = true;
    }
    if (!changed)
        return false;

    for (const auto& [ends, through] : bent) {
        const auto edge_sources = edges.at(ends);
        edges.erase(ends);
        Index from = ends.first;
        for (const Index v : through) {
            add_edge(from, v, edge_sources);
            from = v;
        }
        add_edge(from, ends.second, edge_sources);
    }

    // What the faces of before have become: those without area have merged into their neighbours.
    const Faces before = trace_faces(graph);
    for (const Face& face : before.face) {
        std::vector<Index> ring;
        for (std::size_t i = 0; i < face.rings[0].size(); ++i) {
            const Index a = joined[face.rings[0][i]],
                        b = joined[face.rings[0][(i + 1) % face.rings[0].size()]];
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
        if (left <= 1e-9 * face.area)
            report.merged_block_area += face.area;
    }

    Graph merged;
    std::vector<Index> index(n, -1);
    for (auto& [ends, edge_sources] : edges) {
        std::sort(edge_sources.begin(), edge_sources.end());
        edge_sources.erase(std::unique(edge_sources.begin(), edge_sources.end()), edge_sources.end());
        Edge edge{ends.first, ends.second, std::move(edge_sources)};
        for (Index* v : {&edge.first, &edge.second}) {
            if (index[*v] < 0) {
                index[*v] = static_cast<Index>(merged.vertex.size());
                merged.vertex.push_back(moved[*v]);
            }
            *v = index[*v];
        }
        merged.edge.push_back(std::move(edge));
    }
    graph = std::move(merged);
    return true;
}

} // namespace jointcreep::blocks
