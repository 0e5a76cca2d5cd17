#include "large_displacements/face_overlap.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

constexpr double rounding_of_corners = 0.01; // of the shorter face: where two corners meet
// An overlap is at most so many times as long as that in the plane midway between the faces. Two corners beside each other
// come to overlap there first, and their force grows from 0.
constexpr double longest = 2;

std::optional<Overlap> overlap_along(const Vector2d& tangent, const std::array<Vector2d, 2>& a,
                                     const std::array<Vector2d, 2>& b)
{
    std::optional<Overlap> overlap;
    const std::array<double, 2> along_a{0, (a[1] - a[0]).dot(tangent)},
        along_b{(b[0] - a[0]).dot(tangent), (b[1] - a[0]).dot(tangent)}; // in the opposite direction
    if (along_a[1] <= 0 || along_b[0] <= along_b[1])
        return overlap;
    const std::array<double, 2> at{std::max(0.0, along_b[1]), std::min(along_a[1], along_b[0])};
    if (at[1] <= at[0])
        return overlap;
    Overlap& found = overlap.emplace();
    found.tangent = tangent;
    found.inset = {along_a[0] - along_b[1], along_b[0] - along_a[1]};
    found.length = found.whole = at[1] - at[0];
    const Vector2d normal = found.normal();
    for (int i = 0; i < 2; ++i) {
        found.on_a[i] = at[i] / along_a[1];
        found.on_b[i] = (at[i] - along_b[0]) / (along_b[1] - along_b[0]);
        found.gap[i] =
            (b[0] + found.on_b[i] * (b[1] - b[0]) - a[0] - found.on_a[i] * (a[1] - a[0])).dot(normal);
    }
    found.least_sunk = -std::max(found.gap[0], found.gap[1]);
    return overlap;
}

// Leaves so much of an overlap, at its deeper end.
void shorten(Overlap& overlap, double length)
{
    if (length >= overlap.length)
        return;
    const int deep = overlap.gap[1] < overlap.gap[0] ? 1 : 0;
    const double left = length / overlap.length;
    for (auto* const ends : {&overlap.on_a, &overlap.on_b, &overlap.gap})
        (*ends)[1 - deep] = (*ends)[deep] + left * ((*ends)[1 - deep] - (*ends)[deep]);
    overlap.length = length;
}

} // namespace

[[gnu::flatten]] std::optional<Overlap> overlap_of(const FacePair& pair, const Faces& faces,
                                                   const std::vector<FaceShape>& shapes,
                                                   const std::vector<Vector2d>& place)
{
    const FaceShape &shape_a = shapes[pair.a], &shape_b = shapes[pair.b];
    const Vector2d along_a = shape_a.along, along_b = -shape_b.along;
    if (along_a.dot(along_b) < least_facing)
        return {};
    const auto a = ends_of(faces.gridpoint[pair.a], place), b = ends_of(faces.gridpoint[pair.b], place);
    const auto between = overlap_along((along_a + along_b).normalized(), a, b);
    if (!between)
        return {};
    // Two ends meet at the deeper side. Which one is inside the other face, and is it a corner? Where the outline is
    // straight at an end, a corner sinks into this face farther along.
    const int deep = between->gap[1] < between->gap[0] ? 1 : 0;
    const double is_end_of_a = std::clamp(
        0.5 + between->inset[deep] / (2 * rounding_of_corners * std::min(shape_a.length, shape_b.length)),
        0.0, 1.0);
    const double of_b = is_end_of_a * shape_a.sharp[deep] + (1 - is_end_of_a) * (1 - shape_b.sharp[1 - deep]);
    auto found = overlap_along((of_b * along_b + (1 - of_b) * along_a).normalized(), a, b);
    if (found)
        shorten(*found, longest * between->length);
    return found;
}

} // namespace jointcreep::large_displacements
