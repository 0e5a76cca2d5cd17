#include "blocks/cut.hpp"

#include "blocks/check.hpp"
#include "blocks/crossings.hpp"
#include "blocks/extend.hpp"
#include "blocks/fate.hpp"
#include "blocks/graph.hpp"
#include "blocks/merge.hpp"
#include "blocks/predicates.hpp"
#include "model/error.hpp"
#include "model/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

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

double twice_area(const Polygon& polygon)
{
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        twice += cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
    return twice;
}

// The section's outline, counter-clockwise, then its holes, clockwise, all with the ends of boundary
// conditions as further corners.
std::vector<Polygon> outlines_with_boundary_ends(const Scene& scene)
{
    std::vector<Polygon> outlines{scene.outline};
    outlines.insert(outlines.end(), scene.holes.begin(), scene.holes.end());
    for (std::size_t o = 0; o < outlines.size(); ++o)
        if ((twice_area(outlines[o]) < 0) == (o == 0))
            std::reverse(outlines[o].begin(), outlines[o].end());

    const double reach = 1e-6 * size_of(outlines[0]);
    for (std::size_t b = 0; b < scene.boundaries.size(); ++b)
        for (const Vector2d& end : {scene.boundaries[b].from, scene.boundaries[b].to}) {
            double nearest = std::numeric_limits<double>::infinity();
            std::size_t side = 0, of = 0;
            for (std::size_t o = 0; o < outlines.size(); ++o)
                for (std::size_t i = 0; i < outlines[o].size(); ++i) {
                    const double d =
                        distance_to(outlines[o][i], outlines[o][(i + 1) % outlines[o].size()], end);
                    if (d < nearest) {
                        nearest = d;
                        side = i;
                        of = o;
                    }
                }
            Polygon& outline = outlines[of];
            const Vector2d p = outline[side], q = outline[(side + 1) % outline.size()];
            if (nearest > reach)
                throw input_error("boundary " + std::to_string(b + 1) + ": its end " + shown(end) + " lies " +
                                  shown(nearest) + " m off the section's outline; it must lie on it");
            if ((end - p).norm() > reach && (end - q).norm() > reach)
                outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(side) + 1, end);
        }
    return outlines;
}

// What a place is inside of: polygons with a value each.
class Areas
{
public:
    void add(const Polygon& polygon, Index value) { areas_.push_back({Inside(polygon), value}); }
    // The value of the first polygon that holds the place, -1 if none does.
    Index first_around(const Vector2d& place) const
    {
        for (const Area& a : areas_)
            if (a.inside.holds(place))
                return a.value;
        return -1;
    }

private:
    struct Area {
        Inside inside;
        Index value;
    };
    std::vector<Area> areas_;
};

// The edges at each vertex.
Grouped<Index> edges_at_vertices(const Graph& graph)
{
    return {graph.vertex.size(), [&](auto add) {
                for (Index e = 0; e < static_cast<Index>(graph.edge.size()); ++e) {
                    add(graph.edge[e].first, e);
                    add(graph.edge[e].second, e);
                }
            }};
}

class Cutter
{
public:
    Cutter(const Scene& scene, const Joints& joints, Subdivision subdivision)
        : scene_(scene), joints_(joints), subdivision_(subdivision),
          outlines_(outlines_with_boundary_ends(scene)), outline_(outlines_[0]), size_(size_of(outlines_[0])),
          reach_(scene.cutting.shortest_edge), traces_(joints), fates_(joints)
    {
        // Later regions cover earlier ones, earlier stages dig before later ones.
        for (std::size_t r = scene.regions.size(); r-- > 0;)
            regions_.add(scene.regions[r].outline, row_of_rock(scene.regions[r].rock));
        for (std::size_t s = 0; s < scene.stages.size(); ++s)
            for (const Polygon& polygon : scene.stages[s].remove)
                stages_.add(polygon, static_cast<Index>(s));
        for (std::size_t o = 1; o < outlines_.size(); ++o)
            holes_.add(outlines_[o], 0);
    }

    Blocks blocks()
    {
        check_crossings(scene_, joints_, box_of(outlines_[0]));
        draw_lines();
        const int most_passes = 60;
        for (int pass = 0;; ++pass) {
            if (pass == most_passes)
                throw input_error("cutting: after " + std::to_string(most_passes) +
                                  " passes edges still come closer than " + shown(reach_) +
                                  " m; try a smaller shortest_edge_m");
            graph_ = subdivision_ == Subdivision::cgal ? arrange_with_cgal(graph_, sources_)
                                                       : arrange(graph_, sources_, box_of(outlines_[0]));
            drop_outside();
            prune_ends();
            if (!merge_pass(graph_, sources_, outlines_, {reach_, scene_.cutting.smallest_angle}, report_))
                break;
        }
        prune_slits();
        while (straighten())
            ;
        Faces faces = trace_faces(graph_);
        remove_holes(faces);
        check_faces(graph_, faces, section_area(), scene_.holes.size());
        return finish(faces);
    }

private:
    void add_line(const Vector2d& a, const Vector2d& b, Source source)
    {
        const auto n = static_cast<Index>(graph_.vertex.size());
        graph_.vertex.push_back(a);
        graph_.vertex.push_back(b);
        graph_.edge.push_back({n, n + 1, static_cast<Index>(lines_.size())});
        lines_.push_back({source, a, b});
    }

    void add_polygon(const Polygon& polygon, Source::Kind kind)
    {
        for (std::size_t i = 0; i < polygon.size(); ++i)
            add_line(polygon[i], polygon[(i + 1) % polygon.size()], {kind, static_cast<Index>(i)});
    }

    void draw_lines()
    {
        for (const Polygon& outline : outlines_)
            add_polygon(outline, Source::Kind::outline);
        for (const Region& region : scene_.regions)
            add_polygon(region.outline, Source::Kind::bonded);
        for (const Stage& stage : scene_.stages)
            for (const Polygon& polygon : stage.remove)
                add_polygon(polygon, Source::Kind::bonded);
        const std::size_t first_joint = lines_.size(), corners = graph_.vertex.size();
        for (std::size_t j = 0; j < joints_.set.size(); ++j) {
            // An end on a slanting line is, in doubles, a little off it. A small overlap makes it reach the line.
            // Overlap that crosses nothing is pruned.
            const Vector2d overlap = reach_ * (joints_.to[j] - joints_.from[j]).normalized();
            add_line(given_end(joints_.from[j], -overlap, j, corners),
                     given_end(joints_.to[j], overlap, j, corners),
                     {Source::Kind::joint, static_cast<Index>(j)});
        }
        if (scene_.cutting.dangling_ends == DanglingEnds::extend)
            extend_joints(first_joint);
        divide_by_parts(first_joint);
        pass_through_corners(first_joint);
        std::vector<Source> sources;
        sources.reserve(lines_.size());
        for (const Line& line : lines_)
            sources.push_back(line.source);
        sources_ = Sources(std::move(sources));
    }

    // The end of a line that is drawn for a joint. An end at the corner of a polygon, given by the scene or a map,
    // stays there. Extended along a side of the polygon, the line would run beside that side and meet nothing.
    Vector2d given_end(const Vector2d& end, const Vector2d& overlap, std::size_t joint,
                       std::size_t corners) const
    {
        if (static_cast<std::size_t>(joints_.set[joint]) >= scene_.joint_sets.size())
            for (std::size_t c = 0; c < corners; ++c)
                if ((graph_.vertex[c] - end).norm() <= reach_ / 100) // rounded coordinates
                    return graph_.vertex[c];
        return end + overlap;
    }

    // A single joint may lie on an earlier one, as a part of it. In doubles two slanting lines rarely agree, and one
    // beside the other would end at nothing. So the longer one passes through the ends of its parts.
    void divide_by_parts(std::size_t first_joint)
    {
        const double off = reach_ / 2; // as merging has it
        for (std::size_t whole = 0; whole < joints_.set.size(); ++whole) {
            if (!is_single(static_cast<Index>(whole)))
                continue;
            const Vector2d start = joints_.from[whole], along = joints_.to[whole] - start;
            std::vector<std::pair<double, Vector2d>> places; // along it
            for (std::size_t part = whole + 1; part < joints_.set.size(); ++part) {
                const Vector2d &from = joints_.from[part], &to = joints_.to[part];
                if (!is_single(static_cast<Index>(part)) || from == to ||
                    distance_to(start, joints_.to[whole], from) > off ||
                    distance_to(start, joints_.to[whole], to) > off)
                    continue;
                for (const Vector2d& end : {from, to})
                    places.emplace_back((end - start).dot(along), end);
                move_line(first_joint + part, from, to);
            }
            std::sort(places.begin(), places.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
            Line& line = lines_[first_joint + whole];
            const Vector2d from = line.from, to = line.to;
            const Source source = line.source;
            for (std::size_t i = 0; i < places.size(); ++i) {
                const Vector2d& next = i + 1 < places.size() ? places[i + 1].second : to;
                if (i == 0)
                    move_line(first_joint + whole, from, places[0].second);
                if (places[i].second != next)
                    add_line(places[i].second, next, source);
            }
        }
    }

    // A joint along a side of the outline may continue into the rock at a corner. In doubles it would pass beside the
    // corner, and end at nothing below the side. So it is led through the corner.
    void pass_through_corners(std::size_t first_joint)
    {
        const double rounding = 1e-12 * size_;
        for (std::size_t l = first_joint, n = lines_.size(); l < n; ++l) {
            const Vector2d from = lines_[l].from, to = lines_[l].to;
            std::vector<std::pair<double, Vector2d>> places; // along it
            for (const Polygon& outline : outlines_)
                for (const Vector2d& corner : outline)
                    if (distance_to(from, to, corner) <= rounding && (corner - from).norm() > reach_ / 2 &&
                        (corner - to).norm() > reach_ / 2)
                        places.emplace_back((corner - from).dot(to - from), corner);
            if (places.empty())
                continue;
            std::sort(places.begin(), places.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
            const Source source = lines_[l].source;
            move_line(l, from, places[0].second);
            for (std::size_t i = 0; i < places.size(); ++i) {
                const Vector2d& next = i + 1 < places.size() ? places[i + 1].second : to;
                if (places[i].second != next)
                    add_line(places[i].second, next, source);
            }
        }
    }

    void move_line(std::size_t line, const Vector2d& from, const Vector2d& to)
    {
        lines_[line].from = from;
        lines_[line].to = to;
        graph_.vertex[graph_.edge[line].first] = from;
        graph_.vertex[graph_.edge[line].second] = to;
    }

    // Extends joints that end inside the section to the next line.
    void extend_joints(std::size_t first_joint)
    {
        std::vector<Segment> drawn;
        for (const Line& line : lines_)
            drawn.push_back({line.from, line.to});
        const std::vector<Extension> extensions = extensions_to_next(
            drawn, first_joint, reach_, [&](const Vector2d& place) { return is_in_section(place); });
        for (std::size_t j = 0; j < extensions.size(); ++j) {
            const Line& line = lines_[first_joint + j];
            const Vector2d along = (joints_.to[j] - joints_.from[j]).normalized();
            move_line(first_joint + j, line.from - extensions[j].before * along,
                      line.to + extensions[j].beyond * along);
            if (extensions[j].before > 0 || extensions[j].beyond > 0)
                fates_.extend(static_cast<Index>(j));
            traces_.end_before(static_cast<Index>(j), extensions[j].before > 0, extensions[j].beyond > 0);
        }
    }

    bool is_in_section(const Vector2d& place) const
    {
        return outline_.holds(place) && holes_.first_around(place) < 0;
    }

    double section_area() const
    {
        double twice = 0;
        for (const Polygon& outline : outlines_)
            twice += twice_area(outline);
        return twice / 2;
    }

    bool is_on_outline(const Edge& edge) const { return sources_.has_outline(edge.sources); }
    bool is_on_joint(const Edge& edge) const { return sources_.has_joint(edge.sources); }

    double length(const Edge& edge) const
    {
        return (graph_.vertex[edge.first] - graph_.vertex[edge.second]).norm();
    }

    void record(const Edge& edge, Fate fate)
    {
        if (is_on_joint(edge))
            for (const Index s : sources_.lines_of(edge.sources))
                if (sources_[s].kind == Source::Kind::joint)
                    fates_.add(sources_[s].index, fate, graph_.vertex[edge.first],
                               graph_.vertex[edge.second]);
    }

    void drop_outside()
    {
        std::erase_if(graph_.edge, [&](const Edge& e) {
            if (is_on_outline(e) || is_in_section((graph_.vertex[e.first] + graph_.vertex[e.second]) / 2))
                return false;
            record(e, Fate::outside);
            return true;
        });
    }

    // Cuts off edges that end at nothing, and what ends at nothing then.
    void prune_ends()
    {
        // Of the edges left at a vertex: how many, and all their numbers by exclusive or, which of one is
        // itself.
        std::vector<Index> degree(graph_.vertex.size(), 0), mixed(graph_.vertex.size(), 0);
        for (std::size_t e = 0; e < graph_.edge.size(); ++e)
            for (const Index v : {graph_.edge[e].first, graph_.edge[e].second}) {
                ++degree[v];
                mixed[v] ^= static_cast<Index>(e);
            }
        std::vector<Index> ends;
        for (std::size_t v = 0; v < degree.size(); ++v)
            if (degree[v] == 1)
                ends.push_back(static_cast<Index>(v));
        if (ends.empty())
            return;
        std::vector<char> gone(graph_.edge.size(), 0);
        while (!ends.empty()) {
            const Index v = ends.back();
            ends.pop_back();
            if (degree[v] == 0)
                continue; // the other end of the last edge
            const Index e = mixed[v];
            // Two sides that rounding makes one at a sharp corner: merging takes them back to the corner.
            if (is_on_outline(graph_.edge[e]) && length(graph_.edge[e]) < reach_)
                continue;
            gone[e] = 1;
            record_pruned(graph_.edge[e]);
            for (const Index w : {graph_.edge[e].first, graph_.edge[e].second}) {
                mixed[w] ^= e;
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
        record(edge, Fate::dangling_end);
    }

    void remove_edges(const std::vector<char>& gone)
    {
        std::size_t kept = 0;
        for (std::size_t e = 0; e < graph_.edge.size(); ++e)
            if (!gone[e])
                graph_.edge[kept++] = graph_.edge[e];
        graph_.edge.resize(kept);
    }

    void remove_holes(Faces& faces) const
    {
        if (scene_.holes.empty())
            return;
        std::vector<char> is_hole(faces.size());
        for (std::size_t face = 0; face < faces.size(); ++face)
            is_hole[face] =
                holes_.first_around(place_inside(graph_.vertex, faces, static_cast<Index>(face))) >= 0;
        remove_faces(faces, is_hole);
    }

    // Removes edges with one face on both sides: they separate nothing. These are the edges on no closed path.
    // Without them no other edge has one face on both sides, or a free end.
    void prune_slits()
    {
        const std::vector<char> gone = slits(graph_);
        for (std::size_t e = 0; e < gone.size(); ++e)
            if (gone[e])
                record_pruned(graph_.edge[e]);
        remove_edges(gone);
    }

    // Removes vertices that only divide a straight edge, as pruning and merging leave behind.
    bool straighten()
    {
        Grouped<Index> edges_at = edges_at_vertices(graph_);
        std::vector<char> gone(graph_.edge.size(), 0);
        bool any = false;
        for (Index v = 0; v < static_cast<Index>(graph_.vertex.size()); ++v) {
            if (edges_at[v].size() != 2)
                continue;
            const Index e = edges_at[v][0], f = edges_at[v][1];
            Edge &kept = graph_.edge[e], &dropped = graph_.edge[f];
            if (kept.sources != dropped.sources)
                continue;
            const auto other = [&](const Edge& edge) { return edge.first == v ? edge.second : edge.first; };
            const Index a = other(kept), b = other(dropped);
            const double off = distance_to(graph_.vertex[a], graph_.vertex[b], graph_.vertex[v]);
            const double straight = is_on_outline(kept) ? 1e-13 * size_ : 1e-3 * reach_;
            if (off > straight || std::ranges::find(edges_at[a], f) != edges_at[a].end())
                continue;
            gone[f] = 1;
            any = true;
            kept.first = std::min(a, b);
            kept.second = std::max(a, b);
            std::ranges::replace(edges_at[b], f, e);
            kept.is_settled = kept.is_settled && dropped.is_settled &&
                              turn(graph_.vertex[a], graph_.vertex[v], graph_.vertex[b]) == 0;
        }
        if (any)
            remove_edges(gone);
        return any;
    }

    // The boundary condition on an edge of the outline, -1 if none.
    Index boundary_of(const Vector2d& p, const Vector2d& q) const
    {
        const double reach = 1e-6 * size_ + reach_ / 2;
        for (std::size_t b = 0; b < scene_.boundaries.size(); ++b) {
            const Vector2d &from = scene_.boundaries[b].from, &to = scene_.boundaries[b].to;
            if (distance_to(from, to, p) < reach && distance_to(from, to, q) < reach)
                return static_cast<Index>(b);
        }
        return -1;
    }

    // Whether the joint is one of the scene's [[joint]] tables: after the sets, in the file's order.
    bool is_single(Index joint) const
    {
        const std::size_t set = joints_.set[joint], first = scene_.joint_sets.size();
        return set >= first && set < first + scene_.joints.size();
    }

    void describe_edge(Blocks& blocks, Edge edge, std::array<Index, 2> sides)
    {
        EdgeKind kind = EdgeKind::bonded;
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
            record(edge, Fate::on_outline);
        } else if (is_on_joint(edge)) {
            kind = EdgeKind::joint;
            const auto first_share = static_cast<std::ptrdiff_t>(blocks.share_joint.size());
            std::size_t own = 0;
            for (const Index s : sources_.lines_of(edge.sources)) {
                if (sources_[s].kind != Source::Kind::joint)
                    continue;
                const Index j = sources_[s].index;
                const double k = traces_.fraction(j, graph_.vertex[edge.first], graph_.vertex[edge.second],
                                                  2 * MergeLimits::farthest_closing * reach_);
                const bool is_alike =
                    joint >= 0 && is_single(j) && is_single(joint) && std::abs(k - fraction) < 1e-6;
                if (joint < 0 || (is_alike ? j > joint : k > fraction)) {
                    joint = j;
                    fraction = k;
                    own = blocks.share_joint.size();
                }
                blocks.share_joint.push_back(j);
                blocks.share_fraction.push_back(k);
            }
            // Its own joint first, the others in order.
            const auto to_front = [&](auto& values) {
                const auto place = values.begin() + static_cast<std::ptrdiff_t>(own);
                std::rotate(values.begin() + first_share, place, place + 1);
            };
            to_front(blocks.share_joint);
            to_front(blocks.share_fraction);
            for (auto s = static_cast<std::size_t>(first_share); s < blocks.share_joint.size(); ++s)
                fates_.add(blocks.share_joint[s], blocks.share_joint[s] == joint ? Fate::kept : Fate::shared,
                           graph_.vertex[edge.first], graph_.vertex[edge.second]);
            const Vector2d along = joints_.to[joint] - joints_.from[joint];
            if (along.dot(graph_.vertex[edge.second] - graph_.vertex[edge.first]) < 0)
                turn_round();
        }
        blocks.edge_vertex.push_back({edge.first, edge.second});
        blocks.edge_block.push_back(sides);
        blocks.edge_kind.push_back(static_cast<Index>(kind));
        blocks.edge_joint.push_back(joint);
        blocks.edge_joint_fraction.push_back(fraction);
        blocks.edge_share.push_back(static_cast<Index>(blocks.share_joint.size()));
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

        std::vector<double> on_boundary(scene_.boundaries.size(), 0.0);
        blocks.edge_share.push_back(0);
        for (std::size_t e = 0; e < graph_.edge.size(); ++e) {
            describe_edge(blocks, graph_.edge[e], faces.sides[e]);
            for (Index& v : blocks.edge_vertex.back())
                v = index[v];
            if (const Index b = blocks.edge_boundary.back(); b >= 0)
                on_boundary[b] += length(graph_.edge[e]);
        }
        for (std::size_t b = 0; b < on_boundary.size(); ++b) {
            const Boundary& boundary = scene_.boundaries[b];
            const double wanted = (boundary.to - boundary.from).norm();
            if (std::abs(on_boundary[b] - wanted) > 1e-3 * wanted + 4 * reach_)
                throw input_error("boundary " + std::to_string(b + 1) + " from " + shown(boundary.from) +
                                  " to " + shown(boundary.to) + ": only " + shown(on_boundary[b]) +
                                  " of its " + shown(wanted) +
                                  " m lie on the outline and not on an earlier boundary; it must lie on "
                                  "a straight part of the outline");
        }

        blocks.block_ring = faces.first_ring;
        blocks.ring_start = faces.ring_start;
        blocks.block_area = faces.area;
        for (const Index v : faces.ring_vertex)
            blocks.ring_vertex.push_back(index[v]);
        const Index rock = row_of_rock(scene_.rock);
        for (Index face = 0; face < static_cast<Index>(faces.size()); ++face) {
            const Vector2d inside = place_inside(graph_.vertex, faces, face);
            const Index other_rock = regions_.first_around(inside);
            blocks.block_rock.push_back(other_rock < 0 ? rock : other_rock);
            blocks.block_stage.push_back(stages_.first_around(inside));
        }
        blocks.fates = fates_.table(reach_);
        blocks.report = report_;
        measure_moves(blocks);
        measure_limits(blocks);
        return blocks;
    }

    // Several passes may move a vertex farther than any one of them. What counts is its distance from its line.
    void measure_moves(Blocks& blocks) const
    {
        const double rounding = 1e-12 * size_;
        for (const Edge& edge : graph_.edge)
            for (const Index s : sources_.lines_of(edge.sources))
                for (const Index v : {edge.first, edge.second}) {
                    const double off = distance_to(lines_[s].from, lines_[s].to, graph_.vertex[v]);
                    if (off > rounding)
                        blocks.report.largest_move = std::max(blocks.report.largest_move, off);
                }
    }

    // Whether an angle is wider than an acute one for sure; spares most arc tangents.
    static bool is_wider(const Vector2d& out, const Vector2d& back, double angle)
    {
        return angle < 1.5 && (out.dot(back) <= 0 || cross(out, back) <= 0 ||
                               cross(out, back) > (1 + 1e-9) * std::tan(angle) * out.dot(back));
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
                if (is_wider(out, back, blocks.report.smallest_angle))
                    continue;
                double angle = std::atan2(cross(out, back), out.dot(back));
                if (angle <= 0)
                    angle += 2 * std::numbers::pi;
                blocks.report.smallest_angle = std::min(blocks.report.smallest_angle, angle);
            }
        }
    }

    Index row_of_rock(const std::string& name) const
    {
        const auto found = std::find_if(scene_.rocks.begin(), scene_.rocks.end(),
                                        [&](const Rock& rock) { return rock.name == name; });
        return static_cast<Index>(found - scene_.rocks.begin());
    }

    struct Line {
        Source source;
        Vector2d from, to; // as drawn
    };

    const Scene& scene_;
    const Joints& joints_;
    const Subdivision subdivision_;
    std::vector<Polygon> outlines_; // of the section, then of its holes
    Inside outline_;                // of the section
    double size_, reach_;
    Areas regions_, stages_, holes_;
    std::vector<Line> lines_;
    Sources sources_;
    TracesAlong traces_;
    FateRecord fates_;
    Graph graph_;
    CuttingReport report_;
};

bool has_rock(const Blocks& blocks, std::size_t stage)
{
    return std::ranges::find(blocks.block_stage, static_cast<Index>(stage)) != blocks.block_stage.end();
}

// Whether there is rock of the stage if next to nothing is merged.
bool is_merged_away(Scene scene, std::size_t stage)
{
    scene.stages.resize(stage + 1);
    scene.boundaries.clear();
    scene.cutting = {.shortest_edge = 1e-6 * scene.cutting.shortest_edge, .smallest_angle = 0};
    try {
        return has_rock(Cutter(scene, Joints(), Subdivision::own).blocks(), stage);
    } catch (const input_error&) { // of cutting
        return false;
    }
}

} // namespace

Blocks cut(const Scene& scene, const Joints& joints, Subdivision subdivision)
{
    Blocks blocks = Cutter(scene, joints, subdivision).blocks();
    for (std::size_t s = 0; s < scene.stages.size(); ++s)
        if (!has_rock(blocks, s))
            throw input_error(
                "stage \"" + scene.stages[s].name + "\" removes nothing: " +
                (is_merged_away(scene, s)
                     ? "its rock is merged with that beside it, as [cutting] shortest_edge_m is " +
                           shown(scene.cutting.shortest_edge) +
                           " m; expected a smaller one (where it is not given, 0.02 x the smaller size of [zones])"
                     : "its remove_m contains no rock that earlier stages leave"));
    if (std::ranges::find(blocks.block_stage, Index{-1}) == blocks.block_stage.end())
        throw input_error("stage \"" + scene.stages.back().name +
                          "\" removes the last rock; expected rock that no remove_m contains");
    return blocks;
}

} // namespace jointcreep::blocks
