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
// Refinement has split the edge into constrained parts; of those at `at` the one that points best is it.
Cdt::Edge next_part(const Cdt& cdt, Cdt::Vertex_handle at, Cdt::Vertex_handle target)
{
    const Eigen::Vector2d ahead = (place(target) - place(at)).normalized();
    double best = -2;
    Cdt::Edge part;
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
            part = *edge;
        }
    } while (++edge != first);
    if (best < 1 - 1e-9)
        throw std::logic_error("zoning lost a block edge near " + shown(place(at)));
    // The face from which the part runs from `at` onwards, counter-clockwise, is on its left.
    if (part.first->vertex(cdt.ccw(part.second)) != at)
        part = cdt.mirror_edge(part);
    return part;
}

// All block edges as constraints; `corner`: the vertices of the blocks.
void insert_edges(Cdt& cdt, std::vector<Cdt::Vertex_handle>& corner, const Blocks& blocks)
{
    corner.reserve(blocks.vertex.size());
    for (const Eigen::Vector2d& v : blocks.vertex)
        corner.push_back(cdt.insert({v.x(), v.y()}, corner.empty() ? nullptr : corner.back()->face()));
    for (const auto& [a, b] : blocks.edge_vertex)
        cdt.insert_constraint(corner[a], corner[b]);
}

// A part of a block edge between two neighbouring vertices.
struct EdgePart {
    Index edge;
    Cdt::Vertex_handle from, to;
    Cdt::Face_handle left, right;
};

// All parts of all block edges, in order.
std::vector<EdgePart> edge_parts_of(const Cdt& cdt, const std::vector<Cdt::Vertex_handle>& corner,
                                    const Blocks& blocks)
{
    std::vector<EdgePart> parts;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const auto [a, b] = blocks.edge_vertex[e];
        for (Cdt::Vertex_handle at = corner[a]; at != corner[b];) {
            const Cdt::Edge left = next_part(cdt, at, corner[b]);
            const auto to = left.first->vertex(cdt.cw(left.second));
            parts.push_back({static_cast<Index>(e), at, to, left.first, cdt.mirror_edge(left).first});
            at = to;
        }
    }
    return parts;
}

// Gives each face the number of its block, -1 outside the section: from the parts of the edges on, by flooding. (CGAL's
// seeds would need a place inside each hole of the outline.)
void find_blocks(const Cdt& cdt, const std::vector<EdgePart>& parts, const Blocks& blocks)
{
    constexpr Index unknown = -2;
    for (const auto f : cdt.all_face_handles())
        f->info() = unknown;
    std::vector<Cdt::Face_handle> front;
    for (const EdgePart& part : parts)
        for (const auto& [face, block] : {std::pair(part.left, blocks.edge_block[part.edge][0]),
                                          std::pair(part.right, blocks.edge_block[part.edge][1])}) {
            face->info() = block;
            front.push_back(face);
        }
    while (!front.empty()) {
        const auto f = front.back();
        front.pop_back();
        for (int i = 0; i < 3; ++i) {
            const auto g = f->neighbor(i);
            if (f->is_constrained(i))
                continue;
            if (g->info() == unknown) {
                g->info() = f->info();
                front.push_back(g);
            } else if (g->info() != f->info()) {
                throw std::logic_error("zoning mixed up blocks " + std::to_string(f->info()) + " and " +
                                       std::to_string(g->info()));
            }
        }
    }
}

// The faces inside blocks. CGAL keeps its own order; this one is by block and place, a property of the triangulation
// alone.
std::vector<Cdt::Face_handle> in_order(const Cdt& cdt)
{
    std::vector<Cdt::Face_handle> faces;
    for (const auto f : cdt.finite_face_handles())
        if (f->info() >= 0)
            faces.push_back(f);
    std::sort(faces.begin(), faces.end(), [&](Cdt::Face_handle f, Cdt::Face_handle g) {
        const Eigen::Vector2d a = middle_of(f), b = middle_of(g);
        return std::tuple(f->info(), a.x(), a.y()) < std::tuple(g->info(), b.x(), b.y());
    });
    return faces;
}

// Adds the triangles with their vertices and blocks; gives each vertex its number.
void number_vertices(Triangulation& result, const Cdt& cdt, const std::vector<Cdt::Face_handle>& faces)
{
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
}

// Adds the neighbours of the triangles; gives each face the number of its triangle, -1 outside the section.
void number_faces(Triangulation& result, const Cdt& cdt, const std::vector<Cdt::Face_handle>& faces)
{
    for (const auto f : cdt.all_face_handles())
        f->info() = -1;
    for (std::size_t t = 0; t < faces.size(); ++t)
        faces[t]->info() = static_cast<Index>(t);
    for (std::size_t t = 0; t < faces.size(); ++t) {
        std::array<Index, 3> neighbour{};
        for (int i = 0; i < 3; ++i) {
            int corner = 0;
            while (result.triangle[t][corner] != faces[t]->vertex(i)->info())
                ++corner;
            neighbour[corner] = faces[t]->is_constrained(i) ? -1 : faces[t]->neighbor(i)->info();
        }
        result.neighbour.push_back(neighbour);
    }
}

} // namespace

Triangulation triangulate(const Blocks& blocks, double least, const SizeAt& size)
{
    Cdt cdt;
    std::vector<Cdt::Vertex_handle> corner;
    insert_edges(cdt, corner, blocks);
    find_blocks(cdt, edge_parts_of(cdt, corner, blocks), blocks);
    for (const auto f : cdt.all_face_handles())
        f->set_in_domain(f->info() >= 0);

    const double floor = std::min(least, blocks.report.shortest_edge) / 4;
    CGAL::Delaunay_mesher_2<Cdt, Criteria> mesher(cdt, Criteria(0.125, size, floor));
    mesher.init(true); // the domain is marked already
    mesher.refine_mesh();

    // Refinement makes new faces: the blocks are found again.
    const std::vector<EdgePart> parts = edge_parts_of(cdt, corner, blocks);
    find_blocks(cdt, parts, blocks);
    Triangulation result;
    const std::vector<Cdt::Face_handle> faces = in_order(cdt);
    number_vertices(result, cdt, faces);
    number_faces(result, cdt, faces);
    for (const EdgePart& part : parts)
        result.side.push_back(
            {part.edge, {part.from->info(), part.to->info()}, {part.left->info(), part.right->info()}});
    return result;
}

} // namespace jointcreep::zoning
