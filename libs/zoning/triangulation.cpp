#include "zoning/triangulation.hpp"

#include "model/error.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <string>

namespace jointcreep::zoning
{

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase =
    CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel, CGAL::Delaunay_mesh_vertex_base_2<Kernel>>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<Index, Kernel, CGAL::Delaunay_mesh_face_base_2<Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>, CGAL::No_constraint_intersection_tag>;

Eigen::Vector2d place(Cdt::Vertex_handle v)
{
    return {v->point().x(), v->point().y()};
}

using SizeAt = std::function<double(const Eigen::Vector2d&)>;

Eigen::Vector2d middle_of(const Cdt::Face_handle& face)
{
    return (place(face->vertex(0)) + place(face->vertex(1)) + place(face->vertex(2))) / 3;
}

// CGAL's criteria for size and angle, with a size that changes from place to place. But a triangle whose
// sides are all below a floor is good enough whatever its angles: in a corner of blocks sharper than the
// angle asked for no triangle is ever good, and refinement would continue there until rounding ends it, with a
// crash.
class Criteria : public CGAL::Delaunay_mesh_size_criteria_2<Cdt>
{
    using Sized = CGAL::Delaunay_mesh_size_criteria_2<Cdt>;

public:
    Criteria(double shape, const SizeAt& size, double floor) : Sized(shape), size_(&size), floor_(floor) {}

    class Is_bad : public Sized::Is_bad
    {
    public:
        Is_bad(double shape, const SizeAt& size, double floor)
            : Sized::Is_bad(shape, 0, Kernel()), size_(&size), floor_(floor)
        {
        }

        using Sized::Is_bad::operator();
        CGAL::Mesh_2::Face_badness operator()(const Cdt::Face_handle& face, Sized::Quality& quality) const
        {
            const Sized::Is_bad here(this->B, (*size_)(middle_of(face)), this->traits);
            const CGAL::Mesh_2::Face_badness badness = here(face, quality);
            for (int i = 0; i < 3; ++i)
                if ((place(face->vertex(i)) - place(face->vertex((i + 1) % 3))).norm() >= floor_)
                    return badness;
            quality = Sized::Quality(1, 0);
            return CGAL::Mesh_2::NOT_BAD;
        }

    private:
        const SizeAt* size_;
        double floor_;
    };
    Is_bad is_bad_object() const { return {bound(), *size_, floor_}; }

private:
    const SizeAt* size_;
    double floor_; // [m]
};

// The next vertex from `at` along the straight block edge to `target`, and the face on the left of it.
// Refinement has split the edge into constrained pieces; of those at `at` the one that points best is it.
Cdt::Edge next_piece(const Cdt& cdt, Cdt::Vertex_handle at, Cdt::Vertex_handle target)
{
    const Eigen::Vector2d ahead = (place(target) - place(at)).normalized();
    double best = -2;
    Cdt::Edge piece;
    auto edge = cdt.incident_edges(at);
    const auto first = edge;
    do {
        if (cdt.is_infinite(edge) || !cdt.is_constrained(*edge))
            continue;
        const auto a = edge->first->vertex(cdt.cw(edge->second)),
                   b = edge->first->vertex(cdt.ccw(edge->second));
        const auto other = a == at ? b : a;
        const double along = (place(other) - place(at)).normalized().dot(ahead);
        if (along > best) {
            best = along;
            piece = *edge;
        }
    } while (++edge != first);
    if (best < 1 - 1e-9)
        throw std::logic_error("zoning lost a block edge near " + shown(place(at)));
    // The face from which the piece runs from `at` onwards, counter-clockwise, is on its left.
    if (piece.first->vertex(cdt.ccw(piece.second)) != at)
        piece = cdt.mirror_edge(piece);
    return piece;
}

} // namespace

Triangulation triangulate(const Blocks& blocks, double least, const SizeAt& size)
{
    Cdt cdt;
    std::vector<Cdt::Vertex_handle> corner;
    corner.reserve(blocks.vertex.size());
    for (const Eigen::Vector2d& v : blocks.vertex)
        corner.push_back(cdt.insert({v.x(), v.y()}, corner.empty() ? nullptr : corner.back()->face()));
    for (const auto& [a, b] : blocks.edge_vertex)
        cdt.insert_constraint(corner[a], corner[b]);

    // Inside and outside by flooding, not by CGAL's seeds: an outline with holes needs no further thought
    // then.
    for (const auto f : cdt.all_face_handles())
        f->info() = -2;
    std::vector<Cdt::Face_handle> front;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const auto [a, b] = blocks.edge_vertex[e];
        const Cdt::Edge left = next_piece(cdt, corner[a], corner[b]);
        left.first->info() = blocks.edge_block[e][0];
        cdt.mirror_edge(left).first->info() = blocks.edge_block[e][1];
        front.push_back(left.first);
        front.push_back(cdt.mirror_edge(left).first);
    }
    while (!front.empty()) {
        const auto f = front.back();
        front.pop_back();
        for (int i = 0; i < 3; ++i) {
            const auto g = f->neighbor(i);
            if (f->is_constrained(i) || g->info() != -2)
                continue;
            g->info() = f->info();
            front.push_back(g);
        }
    }
    for (const auto f : cdt.all_face_handles())
        f->set_in_domain(f->info() >= 0);

    const double floor = std::min(least, blocks.report.shortest_edge) / 4;
    CGAL::Delaunay_mesher_2<Cdt, Criteria> mesher(cdt, Criteria(0.125, size, floor));
    mesher.init(true); // the domain is marked already
    mesher.refine_mesh();

    // Refinement makes new faces: the blocks are found again from their edges, piece by piece.
    for (const auto f : cdt.all_face_handles())
        f->info() = -2;
    struct Piece {
        Index edge;
        Cdt::Vertex_handle from, to;
        Cdt::Face_handle left, right;
    };
    std::vector<Piece> pieces;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const auto [a, b] = blocks.edge_vertex[e];
        for (Cdt::Vertex_handle at = corner[a]; at != corner[b];) {
            const Cdt::Edge left = next_piece(cdt, at, corner[b]);
            const Cdt::Edge right = cdt.mirror_edge(left);
            const auto to = left.first->vertex(cdt.cw(left.second));
            pieces.push_back({static_cast<Index>(e), at, to, left.first, right.first});
            for (const auto& [face, block] : {std::pair(left.first, blocks.edge_block[e][0]),
                                              std::pair(right.first, blocks.edge_block[e][1])}) {
                face->info() = block;
                front.push_back(face);
            }
            at = to;
        }
    }
    while (!front.empty()) {
        const auto f = front.back();
        front.pop_back();
        for (int i = 0; i < 3; ++i) {
            const auto g = f->neighbor(i);
            if (f->is_constrained(i))
                continue;
            if (g->info() == -2) {
                g->info() = f->info();
                front.push_back(g);
            } else if (g->info() != f->info()) {
                throw std::logic_error("zoning mixed up blocks " + std::to_string(f->info()) + " and " +
                                       std::to_string(g->info()));
            }
        }
    }

    Triangulation result;
    // CGAL keeps its own order; ours is by block and place, a property of the triangulation alone.
    std::vector<Cdt::Face_handle> faces;
    for (const auto f : cdt.finite_face_handles())
        if (f->info() >= 0)
            faces.push_back(f);
    std::sort(faces.begin(), faces.end(), [&](Cdt::Face_handle f, Cdt::Face_handle g) {
        const Eigen::Vector2d a = middle_of(f), b = middle_of(g);
        return std::tuple(f->info(), a.x(), a.y()) < std::tuple(g->info(), b.x(), b.y());
    });
    for (const auto v : cdt.finite_vertex_handles())
        v->info() = -1;
    for (const auto f : faces) {
        // Start at the lexicographically first corner: which one CGAL calls 0 is its own affair.
        int start = 0;
        for (int i = 1; i < 3; ++i)
            if (f->vertex(i)->point() < f->vertex(start)->point())
                start = i;
        std::array<Index, 3> triangle{};
        for (int i = 0; i < 3; ++i) {
            const auto v = f->vertex((start + i) % 3);
            if (v->info() < 0) {
                v->info() = static_cast<Index>(result.vertex.size());
                result.vertex.push_back(place(v));
            }
            triangle[i] = v->info();
        }
        result.triangle.push_back(triangle);
        result.block.push_back(f->info());
    }
    for (const auto f : cdt.all_face_handles())
        f->info() = -1;
    for (std::size_t t = 0; t < faces.size(); ++t)
        faces[t]->info() = static_cast<Index>(t);
    for (std::size_t t = 0; t < faces.size(); ++t) {
        std::array<Index, 3> neighbour{};
        for (int i = 0; i < 3; ++i) {
            int corner_of = 0;
            while (result.triangle[t][corner_of] != faces[t]->vertex(i)->info())
                ++corner_of;
            neighbour[corner_of] = faces[t]->is_constrained(i) ? -1 : faces[t]->neighbor(i)->info();
        }
        result.neighbour.push_back(neighbour);
    }
    for (const Piece& piece : pieces)
        result.side.push_back(
            {piece.edge, {piece.from->info(), piece.to->info()}, {piece.left->info(), piece.right->info()}});
    return result;
}

} // namespace jointcreep::zoning
