// Overlap of two faces and its depth. Inside libs/large_displacements only.

#pragma once

#include "large_displacements/face_contacts.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace jointcreep::large_displacements
{

// Least cosine between a face's normal and the opposite of the other's, for two faces that face each other.
inline constexpr double least_facing = 0.02;

// The overlap of two faces, projected on one line.
struct Overlap {
    Vector2d tangent;            // along a
    std::array<double, 2> on_a;  // ends of the overlap in order along the line, as fractions of a
    std::array<double, 2> on_b;  // and of b
    std::array<double, 2> gap;   // along the normal from a to b [m]
    std::array<double, 2> inset; // at each end: how far the end of a is inside b; below 0: of b inside a [m]
    double length;               // [m]
    // Length and smallest depth of the complete overlap [m]. Where two corners just meet, `length` and `gap` are of a part of it.
    double whole, least_sunk;

    Vector2d normal() const { return {tangent.y(), -tangent.x()}; }
    // Whether they are everywhere deeper in each other than their overlap is long: then other faces of the two corners
    // touch.
    bool is_behind() const { return least_sunk > whole; }
    double sunk() const { return -std::min(gap[0], gap[1]); } // the largest depth [m]
};

// The ends of a face: places or displacements of its gridpoints [m].
inline std::array<Vector2d, 2> ends_of(const std::array<Index, 2>& face, const std::vector<Vector2d>& values)
{
    return {values[face[0]], values[face[1]]};
}

// Linear between two ends.
template <class Value>
Value at(const std::array<Value, 2>& ends, double fraction)
{
    return ends[0] + fraction * (ends[1] - ends[0]);
}

// The overlap in the plane of the contact; none if the faces do not face each other or do not overlap.
std::optional<Overlap> overlap_of(const FacePair& pair, const Faces& faces,
                                  const std::vector<FaceShape>& shapes, const std::vector<Vector2d>& place);

// Whether two faces do not face each other, or overlap by no more than rounding: then overlap_of() has no result. Most
// pairs of near faces are like that.
inline bool are_apart(const FacePair& pair, const Faces& faces, const std::vector<FaceShape>& shapes,
                      const std::vector<Vector2d>& place)
{
    const Vector2d along_a = shapes[pair.a].along, along_b = -shapes[pair.b].along;
    if (along_a.dot(along_b) < least_facing)
        return true;
    const Vector2d between = along_a + along_b;
    const auto a = ends_of(faces.gridpoint[pair.a], place), b = ends_of(faces.gridpoint[pair.b], place);
    const double end_of_a = (a[1] - a[0]).dot(between), first_of_b = (b[1] - a[0]).dot(between),
                 last_of_b = (b[0] - a[0]).dot(between);
    return std::min(end_of_a, last_of_b) - std::max(0.0, first_of_b) <= -1e-9 * end_of_a;
}

} // namespace jointcreep::large_displacements
