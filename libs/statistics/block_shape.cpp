#include "statistics/block_shape.hpp"

#include "model/polygon.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace jointcreep::statistics
{

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace
{

using Ring = std::vector<Vector2d>;

// Area and its moments about a point, holes negative as they run clockwise.
struct Area {
    double area = 0;
    Vector2d first{0, 0};
    Matrix2d second = Matrix2d::Zero();

    // Adds triangles with a corner at the point.
    void add(const Ring& ring, const Vector2d& point)
    {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vector2d a = ring[i] - point, b = ring[(i + 1) % ring.size()] - point;
            const double triangle = cross(a, b) / 2;
            area += triangle;
            first += triangle / 3 * (a + b);
            second += triangle / 12 * ((a + b) * (a + b).transpose() + a * a.transpose() + b * b.transpose());
        }
    }
};

double aspect_of(const Area& moments)
{
    const Vector2d centre = moments.first / moments.area;
    const Matrix2d about_centre = moments.second / moments.area - centre * centre.transpose();
    const Vector2d axes = Eigen::SelfAdjointEigenSolver<Matrix2d>(about_centre).eigenvalues();
    return axes[0] > 0 ? std::sqrt(axes[1] / axes[0]) : 0;
}

Ring corners_of(const Ring& ring)
{
    const double least_turn = std::numbers::pi / 180;
    Ring corners;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d before = ring[i] - ring[(i + ring.size() - 1) % ring.size()],
                       after = ring[(i + 1) % ring.size()] - ring[i];
        if (std::abs(std::atan2(cross(before, after), before.dot(after))) > least_turn)
            corners.push_back(ring[i]);
    }
    return corners;
}

struct Chords {
    double mean;
    double beta;
};

// The sums over pairs follow from sums over chords: (a . b)^2 summed over all a and b is |sum a a^T|^2.
Chords chords_of(const Ring& corners)
{
    std::vector<Vector2d> chords;
    for (std::size_t i = 0; i < corners.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            chords.emplace_back(corners[i] - corners[j]);
    std::vector<double> lengths;
    for (const Vector2d& chord : chords)
        lengths.push_back(chord.norm());
    const double mean =
        std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    double median = *middle;
    if (lengths.size() % 2 == 0)
        median = (median + *std::max_element(lengths.begin(), middle)) / 2;

    Matrix2d dyads = Matrix2d::Zero();
    double squares = 0, fourths = 0;
    for (const Vector2d& chord : chords)
        if (chord.norm() >= median * (1 - 1e-12)) {
            dyads += chord * chord.transpose();
            squares += chord.squaredNorm();
            fourths += chord.squaredNorm() * chord.squaredNorm();
        }
    const double pairs = squares * squares - fourths;
    return {mean, pairs > 0 ? 10 * std::pow((dyads.squaredNorm() - fourths) / pairs, 2) : 10};
}

} // namespace

BlockShapes block_shapes(const Blocks& blocks)
{
    const double of_square = 4 * (4 + 2 * std::numbers::sqrt2) / 6;
    constexpr std::size_t most_corners = 400; // of a block whose chords are looked at; beyond, evenly thinned
    BlockShapes shapes;
    Ring ring;
    for (std::size_t b = 0; b < blocks.block_area.size(); ++b) {
        Area moments;
        Ring corners;
        Vector2d point(0, 0);
        double outline = 0;
        for (Index r = blocks.block_ring[b]; r < blocks.block_ring[b + 1]; ++r) {
            ring.clear();
            for (Index c = blocks.ring_start[r]; c < blocks.ring_start[r + 1]; ++c)
                ring.push_back(blocks.vertex[blocks.ring_vertex[c]]);
            if (r == blocks.block_ring[b]) {
                point = ring[0];
                corners = corners_of(ring);
            }
            moments.add(ring, point);
            for (std::size_t i = 0; i < ring.size(); ++i)
                outline += (ring[(i + 1) % ring.size()] - ring[i]).norm();
        }
        shapes.aspect.push_back(aspect_of(moments));
        shapes.corners.push_back(static_cast<Index>(corners.size()));
        if (corners.size() > most_corners) {
            Ring thinned;
            for (std::size_t i = 0; i < most_corners; ++i)
                thinned.push_back(corners[i * corners.size() / most_corners]);
            corners = thinned;
        }
        const Chords chords = corners.size() >= 3 ? chords_of(corners) : Chords{0, 10};
        shapes.alpha.push_back(outline * chords.mean / (of_square * blocks.block_area[b]));
        shapes.beta.push_back(chords.beta);
    }
    return shapes;
}

double weighted_quantile(const std::vector<double>& values, const std::vector<double>& weights, double p)
{
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    double sum = 0;
    for (const std::size_t i : order) {
        sum += weights[i];
        if (sum >= p * total)
            return values[i];
    }
    return values.empty() ? 0 : values[order.back()];
}

} // namespace jointcreep::statistics
