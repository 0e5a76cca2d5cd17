#include "zoning/cost.hpp"

#include "model/error.hpp"
#include "zoning/size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace jointcreep::zoning
{

using Eigen::Vector2d;

namespace
{

constexpr double share = 0.2, least_per_corner = 0.5, most_per_corner = 3;

// Of a zone. Measured: elastic, in one or two blocks, by the implicit engine, one thread.
struct Cost {
    double bytes, seconds;
};
constexpr Cost constant_strain{2300, 30e-6}, quadratic{11000, 80e-6};
constexpr double much_memory = 2.3e9; // is warned of [bytes]

// Integral of 1/size^2 over the section. Triangles between the first corner and the sides of a polygon, with their
// sign, make its area whatever its shape. They are halved until the size hardly changes in them.
class Integral
{
public:
    Integral(const Scene& scene, const ZoneSize& size)
        : size_(size), least_(scene.smallest_zone_size()),
          steepest_(std::min(size_.steepest(), 0.5)) // zones beside each other differ by no more
    {
        total_ = of(scene.outline);
        for (const Polygon& hole : scene.holes)
            total_ -= of(hole);
    }

    double total() const { return std::max(total_, 0.0); }

private:
    double of(const Polygon& polygon)
    {
        double sum = 0;
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
            sum += of(polygon[0], polygon[i], polygon[i + 1]);
        return std::abs(sum);
    }

    double of(const Vector2d& a, const Vector2d& b, const Vector2d& c)
    {
        const double area = cross(b - a, c - a) / 2;
        const Vector2d middle = (a + b + c) / 3;
        const std::array<double, 3> side{(b - a).norm(), (c - b).norm(), (a - c).norm()};
        const double longest = *std::max_element(side.begin(), side.end());
        const double size = size_.at(middle), change = steepest_ * longest;
        if (change <= size / 2)
            return area / (size * size);
        // Beyond this number there are too many zones anyway; the bound is larger than the integral.
        if (++halvings_ > 10'000'000) {
            const double bound = std::max(size - change, least_);
            return area / (bound * bound);
        }
        if (longest == side[0])
            return of(a, (a + b) / 2, c) + of((a + b) / 2, b, c);
        if (longest == side[1])
            return of(b, (b + c) / 2, a) + of((b + c) / 2, c, a);
        return of(c, (c + a) / 2, b) + of((c + a) / 2, a, b);
    }

    const ZoneSize& size_;
    double least_, steepest_, total_;
    long halvings_ = 0;
};

std::string to_two_digits(double value)
{
    return rounded(value, 2);
}

std::string up_to_two_digits(double value)
{
    const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
    return to_two_digits(std::ceil(value / unit - 1e-9) * unit);
}

double length_of_rings(const Blocks& blocks, std::size_t block)
{
    double sum = 0;
    for (Index r = blocks.block_ring[block]; r < blocks.block_ring[block + 1]; ++r)
        sum += perimeter_of(ring_of(blocks, r));
    return sum;
}

// Zones along a block that is thinner than a zone should be: as many as it is longer than thick.
double zones_along(double perimeter, double area, double size)
{
    const double compact = 6; // the ratio below of blocks whose corners have all zones
    return 2 * area < size * perimeter ? std::max(0.0, perimeter * perimeter / (4 * area) - compact) : 0.0;
}

} // namespace

double expected_zones(const Scene& scene, const Blocks& blocks)
{
    const ZoneSize size(scene, blocks);
    double at_corners = 0, along_thin_blocks = 0;
    for (std::size_t b = 0; b < blocks.block_area.size(); ++b) {
        const Index from = blocks.ring_start[blocks.block_ring[b]],
                    to = blocks.ring_start[blocks.block_ring[b + 1]];
        const double here = size.at(blocks.vertex[blocks.ring_vertex[from]]);
        at_corners += (to - from) *
                      std::min(most_per_corner, least_per_corner + (most_per_corner - least_per_corner) *
                                                                       blocks.block_area[b] / (here * here));
        along_thin_blocks += zones_along(length_of_rings(blocks, b), blocks.block_area[b], here);
    }
    return Integral(scene, size).total() / share + at_corners + along_thin_blocks;
}

std::string check_cost(const Scene& scene, const Blocks& blocks, const std::string& file)
{
    const double zones = expected_zones(scene, blocks);
    const Cost cost = scene.zones_are_quadratic() ? quadratic : constant_strain;
    if (!(zones * cost.bytes > much_memory))
        return "";
    const std::string found =
        file + ": [zones] size_m is " + shown(scene.zone_size) + " m" +
        (scene.zone_size_at_faces ? ", size_at_faces_m " + shown(*scene.zone_size_at_faces) + " m" : "") +
        ": about " + to_two_digits(zones) + " zones";
    if (!(zones <= most_zones)) {
        const double least = least_per_corner * static_cast<double>(blocks.ring_vertex.size());
        if (least > 0.9 * most_zones)
            throw input_error(found + "; expected at most " + to_two_digits(most_zones) + ". The " +
                              std::to_string(blocks.block_area.size()) +
                              " blocks have too many corners for zones of any size: give fewer joints");
        // All sizes in proportion, and a little more, as the estimate is none to a percent.
        const double factor = 1.05 * std::sqrt((zones - least) / (most_zones - least));
        throw input_error(found + "; expected at most " + to_two_digits(most_zones) + ". Set size_m to " +
                          up_to_two_digits(factor * scene.zone_size) + " m or more" +
                          (scene.zone_size_at_faces
                               ? ", and size_at_faces_m to " +
                                     up_to_two_digits(factor * *scene.zone_size_at_faces) + " m or more"
                               : ""));
    }
    return found + ". They need about " + to_two_digits(zones * cost.bytes / 1e9) +
           " GB of memory, and the in-situ equilibrium of elastic rock about " +
           to_two_digits(zones * cost.seconds) + " s; stages, creep and rock that yields take longer";
}

} // namespace jointcreep::zoning
