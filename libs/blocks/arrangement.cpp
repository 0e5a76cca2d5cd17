#include "blocks/graph.hpp"
#include "blocks/predicates.hpp"
#include "blocks/segment_grid.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

// The edges of a graph that must be compared: the unsettled ones with each other and with those settled ones
// that come near them.
struct ToCompare {
    std::vector<Index> edge; // the unsettled ones first
    std::vector<Segment> segment;
    Index unsettled = 0;

    explicit ToCompare(const Graph& graph)
    {
        edge.reserve(graph.edge.size());
        segment.reserve(graph.edge.size());
        for (const bool is_settled : {false, true}) {
            for (std::size_t e = 0; e < graph.edge.size(); ++e)
                if (const Edge& here = graph.edge[e]; here.is_settled == is_settled) {
                    edge.push_back(static_cast<Index>(e));
                    segment.push_back({graph.vertex[here.first], graph.vertex[here.second]});
                }
            if (!is_settled)
                unsettled = static_cast<Index>(edge.size());
        }
        if (edge.size() < 2 * static_cast<std::size_t>(unsettled))
            return; // hardly any would be left out
        const SegmentGrid grid(segment, unsettled);
        auto count = static_cast<std::size_t>(unsettled);
        for (std::size_t i = count; i < edge.size(); ++i)
            if (grid.is_near_listed(segment[i])) {
                edge[count] = edge[i];
                segment[count++] = segment[i];
            }
        edge.resize(count);
        segment.resize(count);
    }
};

// Calls meet(a, b, box) for pairs of segments to compare that come close together: at least once for every
// two that have a place in common, with a box that holds the place. Segments are sorted into the cells of a
// grid, and crowded cells divided further.
template <class Meet>
class Neighbours
{
public:
    Neighbours(const ToCompare& these, const std::optional<Box>& window, Meet& meet)
        : segments_(these.segment), unsettled_(these.unsettled), meet_(meet), grid_(these.segment)
    {
        // Twice what a place may be off by where segments are not nearly parallel (crosses_elsewhere).
        sure_ = 1e-9 * grid_.farthest() + grid_.margin();
        grid_.for_cells([&](std::span<const Index> in_cell, const Vector2d& low, const Vector2d& high) {
            const double margin = grid_.margin();
            if (!window || ((low.array() <= window->high.array() + margin).all() &&
                            (high.array() >= window->low.array() - margin).all()))
                visit(in_cell, {low, high}, 0);
        });
    }

private:
    void visit(std::span<const Index> near, const Box& box, int depth)
    {
        constexpr std::size_t crowd = 24;
        if (near.size() > crowd && depth < 40) {
            std::array<std::vector<Index>, 2> best;
            std::array<Box, 2> best_box;
            double best_pairs = 0.75 * static_cast<double>(near.size()) * static_cast<double>(near.size());
            for (const int axis : {0, 1}) {
                const double middle = (box.low[axis] + box.high[axis]) / 2;
                std::array<Box, 2> half{box, box};
                half[0].high[axis] = half[1].low[axis] = middle;
                if (half[0].high[axis] - half[0].low[axis] < 4 * grid_.margin())
                    continue;
                std::array<std::vector<Index>, 2> in;
                for (const int side : {0, 1})
                    std::ranges::copy_if(near, std::back_inserter(in[side]),
                                         [&](Index i) { return may_touch(segments_[i], half[side]); });
                double pairs = 0;
                for (const auto& list : in)
                    pairs += static_cast<double>(list.size()) * static_cast<double>(list.size());
                if (pairs < best_pairs) {
                    best_pairs = pairs;
                    best = std::move(in);
                    best_box = half;
                }
            }
            if (!best[0].empty() || !best[1].empty()) {
                for (const int side : {0, 1})
                    visit(best[side], best_box[side], depth + 1);
                return;
            }
        }
        const Box wide{box.low - Vector2d(sure_, sure_), box.high + Vector2d(sure_, sure_)};
        for (std::size_t i = 0; i < near.size() && near[i] < unsettled_; ++i)
            for (std::size_t j = i + 1; j < near.size(); ++j)
                meet_(near[i], near[j], wide);
    }

    bool may_touch(const Segment& s, const Box& box) const
    {
        const double margin = grid_.margin();
        const Vector2d reach(margin, margin), low = box.low - reach, high = box.high + reach;
        if (std::max(s.from.x(), s.to.x()) < low.x() || std::min(s.from.x(), s.to.x()) > high.x() ||
            std::max(s.from.y(), s.to.y()) < low.y() || std::min(s.from.y(), s.to.y()) > high.y())
            return false;
        const Vector2d middle = (low + high) / 2, half = (high - low) / 2, d = s.to - s.from,
                       o = middle - s.from;
        return std::abs(d.x() * o.y() - d.y() * o.x()) <= std::abs(d.x()) * half.y() +
                                                              std::abs(d.y()) * half.x() +
                                                              margin * (std::abs(d.x()) + std::abs(d.y()));
    }

    const std::vector<Segment>& segments_;
    const Index unsettled_;
    Meet& meet_;
    SegmentGrid grid_;
    double sure_ = 0;
};

template <class Meet>
void for_neighbours(const ToCompare& these, const std::optional<Box>& window, Meet meet)
{
    Neighbours<Meet>(these, window, meet);
}

bool boxes_apart(const Segment& p, const Segment& q)
{
    return std::max(p.from.x(), p.to.x()) < std::min(q.from.x(), q.to.x()) ||
           std::max(q.from.x(), q.to.x()) < std::min(p.from.x(), p.to.x()) ||
           std::max(p.from.y(), p.to.y()) < std::min(q.from.y(), q.to.y()) ||
           std::max(q.from.y(), q.to.y()) < std::min(p.from.y(), p.to.y());
}

// Whether the lines of two segments cross outside a box for sure, even if doubles err: the segments then need
// no look in this box.
bool crosses_elsewhere(const Segment& p, const Segment& q, const Box& box)
{
    const Vector2d d = p.to - p.from, e = q.to - q.from, o = q.from - p.from;
    const double below = d.x() * e.y() - d.y() * e.x();
    if (std::abs(below) < 1e-5 * (std::abs(d.x()) + std::abs(d.y())) * (std::abs(e.x()) + std::abs(e.y())))
        return false; // nearly parallel
    const Vector2d place = p.from + (o.x() * e.y() - o.y() * e.x()) / below * d;
    return place.x() < box.low.x() || place.x() > box.high.x() || place.y() < box.low.y() ||
           place.y() > box.high.y();
}

// What two segments have in common beyond an end they share: cross() once if they cross within both, and
// touch(i, is_from) for every end of one that lies within the other, i telling which one is touched. Exact.
template <class Cross, class Touch>
void intersect(const Segment& p, const Segment& q, Cross cross, Touch touch)
{
    const int q_from = turn(p.from, p.to, q.from), q_to = turn(p.from, p.to, q.to);
    if (q_from * q_to > 0)
        return;
    const int p_from = turn(q.from, q.to, p.from), p_to = turn(q.from, q.to, p.to);
    if (p_from * p_to > 0)
        return;
    if (q_from * q_to < 0 && p_from * p_to < 0)
        return cross();
    if (q_from == 0 && is_between(p.from, p.to, q.from))
        touch(0, true);
    if (q_to == 0 && is_between(p.from, p.to, q.to))
        touch(0, false);
    if (p_from == 0 && is_between(q.from, q.to, p.from))
        touch(1, true);
    if (p_to == 0 && is_between(q.from, q.to, p.to))
        touch(1, false);
}

// A place on an edge; places are numbered.
struct Stop {
    Index edge, place;
};

// Replaces places by their numbers in lexicographic order, equal ones by one number.
std::vector<Index> number_in_order(std::vector<Vector2d>& place)
{
    struct Numbered {
        double x, y;
        Index number;
    };
    // First into strips of x with a few places each: sorting them one by one stays in the cache.
    double low = 0, high = 0;
    for (const Vector2d& p : place) {
        low = std::min(low, p.x());
        high = std::max(high, p.x());
    }
    const std::size_t strips = place.size() / 8 + 1;
    const double per_strip = high > low ? static_cast<double>(strips) / (high - low) : 0.0;
    const auto strip_of = [&](const Vector2d& p) {
        return std::min(static_cast<std::size_t>((p.x() - low) * per_strip), strips - 1);
    };
    Grouped<Numbered> sorted(strips, [&](auto add) {
        for (std::size_t i = 0; i < place.size(); ++i) // -0 becomes 0
            add(strip_of(place[i]), {place[i].x() + 0.0, place[i].y() + 0.0, static_cast<Index>(i)});
    });
    for (std::size_t s = 0; s < strips; ++s)
        std::ranges::sort(sorted[s], [](const Numbered& a, const Numbered& b) {
            return a.x != b.x ? a.x < b.x : a.y < b.y;
        });
    std::vector<Index> number(place.size());
    std::size_t count = 0;
    for (const Numbered& n : sorted.all()) {
        const Vector2d here(n.x, n.y);
        if (count == 0 || place[count - 1] != here)
            place[count++] = here;
        number[n.number] = static_cast<Index>(count) - 1;
    }
    place.resize(count);
    return number;
}

// Edges by their ends; those with the same ends become one.
void sort_and_unite(Graph& graph, Sources& sources)
{
    Grouped<Edge> leaving(graph.vertex.size(), [&](auto add) {
        for (const Edge& e : graph.edge)
            add(e.first, e);
    });
    graph.edge.clear();
    for (std::size_t v = 0; v < leaving.size(); ++v) {
        const std::span<Edge> edges = leaving[v];
        std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
            return std::tie(a.second, a.sources) < std::tie(b.second, b.sources);
        });
        for (auto from = edges.begin(), to = from; from != edges.end(); from = to) {
            while (to != edges.end() && to->second == from->second)
                ++to;
            graph.edge.push_back(united({from, to}, sources));
        }
    }
}

} // namespace

Graph arrange(const Graph& lines, Sources& sources, const std::optional<Box>& window)
{
    const auto count = static_cast<Index>(lines.edge.size());
    const auto along = [&](Index e) -> Vector2d {
        return lines.vertex[lines.edge[e].second] - lines.vertex[lines.edge[e].first];
    };

    // Where the edges stop: their ends, crossings, and ends of others. Places may come more than once.
    std::vector<Vector2d> place = lines.vertex;
    std::vector<Stop> stops;
    stops.reserve(4 * lines.edge.size());
    for (Index e = 0; e < count; ++e)
        if (along(e) != Vector2d(0, 0)) {
            stops.push_back({e, lines.edge[e].first});
            stops.push_back({e, lines.edge[e].second});
        }
    const ToCompare these(lines);
    for_neighbours(these, window, [&](Index a, Index b, const Box& box) {
        const Segment &p = these.segment[a], &q = these.segment[b];
        if (boxes_apart(p, q) || crosses_elsewhere(p, q, box))
            return;
        intersect(
            p, q,
            [&] {
                for (const Index s : {a, b})
                    stops.push_back({these.edge[s], static_cast<Index>(place.size())});
                place.push_back(crossing(p.from, p.to, q.from, q.to));
            },
            [&](int touched, bool is_from) {
                const Edge& other = lines.edge[these.edge[touched == 0 ? b : a]];
                stops.push_back({these.edge[touched == 0 ? a : b], is_from ? other.first : other.second});
            });
    });

    const std::vector<Index> vertex_of = number_in_order(place);
    Graph planar{.vertex = std::move(place), .edge = {}};

    Grouped<Index> on_edge(lines.edge.size(), [&](auto add) { // vertices
        for (const Stop& stop : stops)
            add(stop.edge, vertex_of[stop.place]);
    });
    planar.edge.reserve(stops.size());
    for (Index e = 0; e < count; ++e) {
        const auto begin = on_edge[e].begin(), end = on_edge[e].end();
        const bool is_whole = end - begin == 2; // not even touched: its own ends are all its stops
        std::sort(begin, end);
        // The order of vertices is that along the edge, but for vertices of one x on a falling edge.
        const Vector2d d = along(e);
        if ((d.x() < 0) != (d.y() < 0))
            for (auto from = begin; from != end;) {
                const auto to = std::find_if(
                    from, end, [&](Index v) { return planar.vertex[v].x() != planar.vertex[*from].x(); });
                std::reverse(from, to);
                from = to;
            }
        for (auto i = begin; i + 1 < end; ++i)
            if (i[0] != i[1])
                planar.edge.push_back(
                    {std::min(i[0], i[1]), std::max(i[0], i[1]), lines.edge[e].sources, is_whole});
    }
    sort_and_unite(planar, sources);
    return planar;
}

bool crosses_nowhere(const Graph& graph)
{
    const ToCompare these(graph);
    bool is_clear = true;
    for_neighbours(these, {}, [&](Index a, Index b, const Box& box) {
        const Segment &p = these.segment[a], &q = these.segment[b];
        if (is_clear && !boxes_apart(p, q) && !crosses_elsewhere(p, q, box))
            intersect(
                p, q, [&] { is_clear = false; }, [&](int, bool) { is_clear = false; });
    });
    return is_clear;
}

} // namespace jointcreep::blocks
