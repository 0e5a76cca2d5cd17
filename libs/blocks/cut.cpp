#include "blocks/cut.hpp"

#include "blocks/graph.hpp"
#include "blocks/merge.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b)
{
    return a.x() * b.y() - a.y() * b.x();
}

double distance_to(const Vector2d& a, const Vector2d& b, const Vector2d& p)
{
    const Vector2d d = b - a;
    const double along = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    return (a + along * d - p).norm();
}

double size_of(const Polygon& outline)
{
    Vector2d low = outline[0], high = outline[0];
    for (const Vector2d& p : outline) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

// The outline, counter-clockwise, with the ends of boundary conditions as further corners.
Polygon outline_with_boundary_ends(const Scene& scene)
{
    Polygon outline = scene.outline;
    double twice_area = 0;
    for (std::size_t i = 0; i < outline.size(); ++i)
        twice_area += cross(outline[i] - outline[0], outline[(i + 1) % outline.size()] - outline[0]);
    if (twice_area < 0)
        std::reverse(outline.begin(), outline.end());

    const double reach = 1e-6 * size_of(outline);
    for (std::size_t b = 0; b < scene.boundaries.size(); ++b)
        for (const Vector2d& end : {scene.boundaries[b].from, scene.boundaries[b].to}) {
            double nearest = std::numeric_limits<double>::infinity();
            std::size_t side = 0;
            for (std::size_t i = 0; i < outline.size(); ++i) {
                const double d = distance_to(outline[i], outline[(i + 1) % outline.size()], end);
                if (d < nearest) {
                    nearest = d;
                    side = i;
                }
            }
            const Vector2d p = outline[side], q = outline[(side + 1) % outline.size()];
            if (nearest > reach)
                throw input_error("boundary " + std::to_string(b + 1) + ": its end " + shown(end) + " lies " +
                                  shown(nearest) + " m off the section's outline; it must lie on it");
            if ((end - p).norm() > reach && (end - q).norm() > reach)
                outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(side) + 1, end);
        }
    return outline;
}

class Cutter
{
public:
    Cutter(const Scene& scene, const Joints& joints)
        : scene_(scene), joints_(joints), outline_(outline_with_boundary_ends(scene)),
          reach_(scene.cutting.shortest_edge)
    {
        trace_of_joint_.resize(joints.set.size());
        for (std::size_t t = 0; t < joints.trace_joint.size(); ++t)
            trace_of_joint_[joints.trace_joint[t]].push_back(t);
    }

    Blocks blocks()
    {
        draw_lines();
        const int most_passes = 60;
        for (int pass = 0;; ++pass) {
            if (pass == most_passes)
                throw input_error("cutting: after " + std::to_string(most_passes) +
                                  " passes edges still come closer than " + shown(reach_) +
                                  " m; a smaller shortest_edge_m may settle");
            graph_ = arrange(graph_);
            drop_outside();
            prune_ends();
            if (!merge_pass(graph_, sources_, outline_, {reach_, scene_.cutting.smallest_angle}, report_))
                break;
        }
        Faces faces = trace_faces(graph_);
        while (prune_slits(faces) || straighten())
            faces = trace_faces(graph_);
        return finish(faces);
    }

private:
    void add_line(const Vector2d& a, const Vector2d& b, Source source)
    {
        const auto n = static_cast<Index>(graph_.vertex.size());
        graph_.vertex.push_back(a);
        graph_.vertex.push_back(b);
        graph_.edge.push_back({n, n + 1, {static_cast<Index>(sources_.size())}});
        sources_.push_back(source);
        lines_.push_back({a, b});
    }

    void add_polygon(const Polygon& polygon, Source::Kind kind)
    {
        for (std::size_t i = 0; i < polygon.size(); ++i)
            add_line(polygon[i], polygon[(i + 1) % polygon.size()], {kind, static_cast<Index>(i)});
    }

    void draw_lines()
    {
        add_polygon(outline_, Source::Kind::outline);
        for (const Region& region : scene_.regions)
            add_polygon(region.outline, Source::Kind::welded);
        for (const Stage& stage : scene_.stages)
            for (const Polygon& polygon : stage.remove)
                add_polygon(polygon, Source::Kind::welded);
        for (std::size_t j = 0; j < joints_.set.size(); ++j) {
            // An end on a slanting line is, in doubles, a little off it: a bit of overlap makes it reach.
            // What overlaps in vain is pruned.
            const Vector2d overlap = reach_ * (joints_.to[j] - joints_.from[j]).normalized();
            add_line(joints_.from[j] - overlap, joints_.to[j] + overlap,
                     {Source::Kind::joint, static_cast<Index>(j)});
        }
    }

    bool is_on_outline(const Edge& edge) const
    {
        return std::any_of(edge.sources.begin(), edge.sources.end(),
                           [&](Index s) { return sources_[s].kind == Source::Kind::outline; });
    }

    bool is_on_joint(const Edge& edge) const
    {
        return std::any_of(edge.sources.begin(), edge.sources.end(),
                           [&](Index s) { return sources_[s].kind == Source::Kind::joint; });
    }

    double length(const Edge& edge) const
    {
        return (graph_.vertex[edge.first] - graph_.vertex[edge.second]).norm();
    }

    void drop_outside()
    {
        std::erase_if(graph_.edge, [&](const Edge& e) {
            return !is_on_outline(e) &&
                   !is_inside(outline_, (graph_.vertex[e.first] + graph_.vertex[e.second]) / 2);
        });
    }

    // Cuts off edges that end at nothing, and what ends at nothing then.
    void prune_ends()
    {
        std::vector<std::vector<Index>> at(graph_.vertex.size());
        for (std::size_t e = 0; e < graph_.edge.size(); ++e) {
            at[graph_.edge[e].first].push_back(static_cast<Index>(e));
            at[graph_.edge[e].second].push_back(static_cast<Index>(e));
        }
        std::vector<Index> ends;
        std::vector<Index> degree(graph_.vertex.size());
        for (std::size_t v = 0; v < at.size(); ++v) {
            degree[v] = static_cast<Index>(at[v].size());
            if (degree[v] == 1)
                ends.push_back(static_cast<Index>(v));
        }
        std::vector<char> gone(graph_.edge.size(), 0);
        while (!ends.empty()) {
            const Index v = ends.back();
            ends.pop_back();
            for (const Index e : at[v]) {
                if (gone[e])
                    continue;
                gone[e] = 1;
                record_pruned(graph_.edge[e]);
                const Index w = graph_.edge[e].first == v ? graph_.edge[e].second : graph_.edge[e].first;
                if (--degree[w] == 1)
                    ends.push_back(w);
            }
        }
        remove_edges(gone);
    }

    void record_pruned(const Edge& edge)
    {
        if (is_on_joint(edge) && length(edge) > 1.001 * reach_) // shorter: overlap
            report_.pruned_length += length(edge);
    }

    void remove_edges(const std::vector<char>& gone)
    {
        std::size_t kept = 0;
        for (std::size_t e = 0; e < graph_.edge.size(); ++e)
            if (!gone[e])
                graph_.edge[kept++] = graph_.edge[e];
        graph_.edge.resize(kept);
    }

    // Edges with one face on both sides separate nothing.
    bool prune_slits(const Faces& faces)
    {
        std::vector<char> gone(graph_.edge.size(), 0);
        bool any = false;
        for (std::size_t e = 0; e < graph_.edge.size(); ++e)
            if (faces.sides[e][0] == faces.sides[e][1]) {
                gone[e] = 1;
                any = true;
                record_pruned(graph_.edge[e]);
            }
        if (any) {
            remove_edges(gone);
            prune_ends();
        }
        return any;
    }

    // Removes vertices that only divide a straight edge, as pruning and merging leave behind.
    bool straighten()
    {
        std::vector<std::vector<Index>> at(graph_.vertex.size());
        for (std::size_t e = 0; e < graph_.edge.size(); ++e) {
            at[graph_.edge[e].first].push_back(static_cast<Index>(e));
            at[graph_.edge[e].second].push_back(static_cast<Index>(e));
        }
        std::vector<char> gone(graph_.edge.size(), 0);
        bool any = false;
        for (std::size_t v = 0; v < at.size(); ++v) {
            if (at[v].size() != 2)
                continue;
            const Index e = at[v][0], f = at[v][1];
            Edge &kept = graph_.edge[e], &dropped = graph_.edge[f];
            if (kept.sources != dropped.sources)
                continue;
            const auto other = [&](const Edge& edge) {
                return edge.first == static_cast<Index>(v) ? edge.second : edge.first;
            };
            const Index a = other(kept), b = other(dropped);
            const double off = distance_to(graph_.vertex[a], graph_.vertex[b], graph_.vertex[v]);
            const double straight = is_on_outline(kept) ? 1e-13 * size_of(outline_) : 1e-3 * reach_;
            if (off > straight || std::find(at[a].begin(), at[a].end(), f) != at[a].end())
                continue;
            gone[f] = 1;
            any = true;
            kept.first = std::min(a, b);
            kept.second = std::max(a, b);
            std::replace(at[b].begin(), at[b].end(), f, e);
            at[v].clear();
        }
        if (any)
            remove_edges(gone);
        return any;
    }

    // Fraction of the piece of joint `j` between two places that is joint trace.
    double joint_fraction(Index j, const Vector2d& p, const Vector2d& q) const
    {
        const Vector2d along = (joints_.to[j] - joints_.from[j]).normalized();
        const double total = (joints_.to[j] - joints_.from[j]).norm();
        const auto place = [&](const Vector2d& x) { return (x - joints_.from[j]).dot(along); };
        const auto [low, high] = std::minmax({place(p), place(q)});
        double open = 0;
        for (const std::size_t t : trace_of_joint_[j]) {
            auto [from, to] = std::minmax({place(joints_.trace_from[t]), place(joints_.trace_to[t])});
            if (from <=
                1e-9 * total) // a trace that goes to the joint's end goes as far as the joint is drawn
                from -= 2 * MergeLimits::farthest_closing * reach_;
            if (to >= (1 - 1e-9) * total)
                to += 2 * MergeLimits::farthest_closing * reach_;
            open += std::max(0.0, std::min(high, to) - std::max(low, from));
        }
        return high > low ? std::min(1.0, open / (high - low)) : 0.0;
    }

    // The boundary condition that holds an edge of the outline, -1 if none.
    Index boundary_of(const Vector2d& p, const Vector2d& q) const
    {
        const double reach = 1e-6 * size_of(outline_) + reach_ / 2;
        for (std::size_t b = 0; b < scene_.boundaries.size(); ++b) {
            const Vector2d &from = scene_.boundaries[b].from, &to = scene_.boundaries[b].to;
            if (distance_to(from, to, p) < reach && distance_to(from, to, q) < reach)
                return static_cast<Index>(b);
        }
        return -1;
    }

    void describe_edge(Blocks& blocks, Edge edge, std::array<Index, 2> sides) const
    {
        EdgeKind kind = EdgeKind::welded;
        Index joint = -1, boundary = -1;
        double fraction = 0;
        const auto turn_round = [&] {
            std::swap(edge.first, edge.second);
            std::swap(sides[0], sides[1]);
        };
        if (is_on_outline(edge)) {
            kind = EdgeKind::boundary;
            if (sides[0] < 0)
                turn_round();
            boundary = boundary_of(graph_.vertex[edge.first], graph_.vertex[edge.second]);
        } else if (is_on_joint(edge)) {
            kind = EdgeKind::joint;
            for (const Index s : edge.sources) {
                if (sources_[s].kind != Source::Kind::joint)
                    continue;
                const Index j = sources_[s].index;
                const double k = joint_fraction(j, graph_.vertex[edge.first], graph_.vertex[edge.second]);
                if (joint < 0 || k > fraction) {
                    joint = j;
                    fraction = k;
                }
            }
            const Vector2d along = joints_.to[joint] - joints_.from[joint];
            if (along.dot(graph_.vertex[edge.second] - graph_.vertex[edge.first]) < 0)
                turn_round();
        }
        blocks.edge_vertex.push_back({edge.first, edge.second});
        blocks.edge_block.push_back(sides);
        blocks.edge_kind.push_back(static_cast<Index>(kind));
        blocks.edge_joint.push_back(joint);
        blocks.edge_joint_fraction.push_back(fraction);
        blocks.edge_boundary.push_back(boundary);
    }

    Blocks finish(const Faces& faces)
    {
        Blocks blocks;
        // Only vertices in use, in their lexicographic order.
        std::vector<Index> index(graph_.vertex.size(), -1);
        for (const Edge& e : graph_.edge)
            index[e.first] = index[e.second] = 0;
        for (std::size_t v = 0; v < index.size(); ++v)
            if (index[v] == 0) {
                index[v] = static_cast<Index>(blocks.vertex.size());
                blocks.vertex.push_back(graph_.vertex[v]);
            }

        std::vector<double> held(scene_.boundaries.size(), 0.0);
        for (std::size_t e = 0; e < graph_.edge.size(); ++e) {
            describe_edge(blocks, graph_.edge[e], faces.sides[e]);
            for (Index& v : blocks.edge_vertex.back())
                v = index[v];
            if (const Index b = blocks.edge_boundary.back(); b >= 0)
                held[b] += length(graph_.edge[e]);
        }
        for (std::size_t b = 0; b < held.size(); ++b) {
            const Boundary& boundary = scene_.boundaries[b];
            const double wanted = (boundary.to - boundary.from).norm();
            if (std::abs(held[b] - wanted) > 1e-3 * wanted + 4 * reach_)
                throw input_error(
                    "boundary " + std::to_string(b + 1) + " from " + shown(boundary.from) + " to " +
                    shown(boundary.to) + ": only " + shown(held[b]) + " of its " + shown(wanted) +
                    " m lie on the outline and are not held by an earlier boundary; it must lie on "
                    "a straight part of the outline");
        }

        blocks.block_ring.push_back(0);
        blocks.ring_start.push_back(0);
        for (const Face& face : faces.face) {
            for (const auto& ring : face.rings) {
                for (const Index v : ring)
                    blocks.ring_vertex.push_back(index[v]);
                blocks.ring_start.push_back(static_cast<Index>(blocks.ring_vertex.size()));
            }
            blocks.block_ring.push_back(static_cast<Index>(blocks.ring_start.size()) - 1);
            blocks.block_area.push_back(face.area);
            const Vector2d inside = place_inside(graph_.vertex, face);
            blocks.block_rock.push_back(rock_at(inside));
            blocks.block_stage.push_back(stage_at(inside));
        }
        for (std::size_t s = 0; s < scene_.stages.size(); ++s)
            if (std::find(blocks.block_stage.begin(), blocks.block_stage.end(), static_cast<Index>(s)) ==
                blocks.block_stage.end())
                throw input_error("stage \"" + scene_.stages[s].name +
                                  "\" removes nothing: its remove_m holds no rock that earlier stages leave");
        blocks.report = report_;
        measure_moves(blocks);
        measure_limits(blocks);
        return blocks;
    }

    // What several passes have moved has moved farther than in any one of them: as far as it is off its line.
    void measure_moves(Blocks& blocks) const
    {
        const double rounding = 1e-12 * size_of(outline_);
        for (const Edge& edge : graph_.edge)
            for (const Index s : edge.sources)
                for (const Index v : {edge.first, edge.second}) {
                    const double off = distance_to(lines_[s][0], lines_[s][1], graph_.vertex[v]);
                    if (off > rounding)
                        blocks.report.largest_move = std::max(blocks.report.largest_move, off);
                }
    }

    static void measure_limits(Blocks& blocks)
    {
        blocks.report.shortest_edge = std::numeric_limits<double>::infinity();
        for (const auto& [a, b] : blocks.edge_vertex)
            blocks.report.shortest_edge =
                std::min(blocks.report.shortest_edge, (blocks.vertex[a] - blocks.vertex[b]).norm());
        blocks.report.smallest_angle = 2 * std::numbers::pi;
        for (std::size_t r = 0; r + 1 < blocks.ring_start.size(); ++r) {
            const Index start = blocks.ring_start[r], n = blocks.ring_start[r + 1] - start;
            const auto corner = [&](Index i) { return blocks.vertex[blocks.ring_vertex[start + i % n]]; };
            for (Index i = 0; i < n; ++i) {
                const Vector2d out = corner(i + 2) - corner(i + 1), back = corner(i) - corner(i + 1);
                double angle = std::atan2(cross(out, back), out.dot(back));
                if (angle <= 0)
                    angle += 2 * std::numbers::pi;
                blocks.report.smallest_angle = std::min(blocks.report.smallest_angle, angle);
            }
        }
    }

    Index rock_at(const Vector2d& place) const
    {
        std::string name = scene_.rock;
        for (const Region& region : scene_.regions)
            if (is_inside(region.outline, place))
                name = region.rock;
        const auto found = std::find_if(scene_.rocks.begin(), scene_.rocks.end(),
                                        [&](const Rock& rock) { return rock.name == name; });
        return static_cast<Index>(found - scene_.rocks.begin());
    }

    Index stage_at(const Vector2d& place) const
    {
        for (std::size_t s = 0; s < scene_.stages.size(); ++s)
            for (const Polygon& polygon : scene_.stages[s].remove)
                if (is_inside(polygon, place))
                    return static_cast<Index>(s);
        return -1;
    }

    const Scene& scene_;
    const Joints& joints_;
    Polygon outline_;
    double reach_;
    std::vector<std::array<Vector2d, 2>> lines_; // of the sources, as they were drawn
    std::vector<Source> sources_;
    std::vector<std::vector<std::size_t>> trace_of_joint_;
    Graph graph_;
    CuttingReport report_;
};

} // namespace

Blocks cut(const Scene& scene, const Joints& joints)
{
    return Cutter(scene, joints).blocks();
}

} // namespace jointcreep::blocks
