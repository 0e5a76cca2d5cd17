// What leaves for other programs, before any format is chosen: layers of lines or polygons with attributes. Every
// format that holds geometry writes these.

#pragma once

#include "model/network.hpp"
#include "model/polygon.hpp"

#include <Eigen/Geometry>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::exchange
{

// A cut section as it leaves: the records of one file.
struct Section {
    std::string file; // that it was read from
    Index realization = 0;
    std::optional<double> azimuth{}; // bearing of +x, clockwise from north [rad]
    Polygon outline{};
    std::vector<Polygon> holes{};
    Network network{};
    std::optional<EquivalentJoints> equivalent{}; // after strength-averaging
};

// A value for each row: a number, or an index into names.
struct Attribute {
    std::string name;
    std::string units; // SI; "1" for numbers without one
    std::function<std::optional<double>(std::size_t row)> value;
    bool is_integer = false;
    const std::vector<std::string>* names = nullptr; // of an index: what it stands for

    // "area_m2": the name with its unit, for formats that have no place for units.
    std::string heading() const;
};

enum class Shape { lines, polygons };

// Rows of one shape. They refer to the section, which must outlive them.
struct Layer {
    std::string name;
    Shape shape;
    bool is_in_space = false;             // points are {east, north, up}; otherwise {x, y, 0} in the section
    std::vector<Eigen::Vector3d> point{}; // [m]
    // Rings of row i are first_ring[i] up to first_ring[i + 1], corners of ring r first_corner[r] up to
    // first_corner[r + 1]. A line is one ring of two points. Of a polygon the first ring is the outer one,
    // counter-clockwise, the others are holes, clockwise.
    std::vector<Index> first_ring{0}, first_corner{0}, corner{};
    std::vector<Attribute> attributes{};
    std::size_t leading = 0; // so many attributes come before the coordinates in tables

    std::size_t rows() const { return first_ring.size() - 1; }
    std::span<const Index> ring(Index r) const
    {
        return {corner.data() + first_corner[r], corner.data() + first_corner[r + 1]};
    }
    // The points of a line.
    const Eigen::Vector3d& from(std::size_t row) const { return point[ring(first_ring[row])[0]]; }
    const Eigen::Vector3d& to(std::size_t row) const { return point[ring(first_ring[row])[1]]; }

    void add_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
    void add_ring(const std::vector<Eigen::Vector3d>& points);
    void end_row() { first_ring.push_back(static_cast<Index>(first_corner.size()) - 1); }

    double length() const; // of all lines [m]
    double area() const;   // of all polygons, holes taken out [m2]
};

// A layer by its name. `width` is how far the joints that are no discs reach across the section, for the layer
// "planes" [m]; it throws input_error where there are such joints and no width.
Layer layer_of(const Section& section, std::string_view name, std::optional<double> width = {});

// Joints in space, {east, north, up} from the section's origin: discs as they were sampled, and rectangles along the
// other joint traces.
struct Plane {
    Index joint;
    Eigen::Vector3d centre; // [m]
    Eigen::Vector3d normal; // upward unit normal [-]
    double diameter;        // of a disc; 0: a rectangle [m]
    // Corners in order: of a rectangle four; of a disc 16, on a circle so much larger that the area is the disc's.
    std::vector<Eigen::Vector3d> corner;

    double dip() const;           // below the horizontal [rad]
    double dip_direction() const; // clockwise from north [rad]
};
std::vector<Plane> planes_of(const Section& section, std::optional<double> width);

// What became of joints, by JointFate; kinds of edges, by EdgeKind.
const std::vector<std::string>& fate_names();
const std::vector<std::string>& edge_kind_names();

} // namespace jointcreep::exchange
