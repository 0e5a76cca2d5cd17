// An unstructured grid of VTK, and the two files that can hold it: XML (.vtu) and HDF5 (.vtkhdf). The same grid gives the
// same bytes, and every number reads back as the same double.

#pragma once

#include "model/statistics.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace jointcreep::exchange
{

enum class CellType {
    vertex = 1,
    line = 3,
    triangle = 5,
    polygon = 7,
    quadratic_triangle = 22
}; // VTK's numbers

struct GridArray {
    std::string name;
    std::size_t components = 1;
    std::variant<std::vector<double>, std::vector<Index>, std::vector<std::int64_t>,
                 std::vector<unsigned char>>
        values{};
};

// Vectors in the plane get a third component, 0: VTK's have three.
GridArray array_of(std::string name, const std::vector<Eigen::Vector2d>& vectors);
GridArray array_of(std::string name, const std::vector<Eigen::Vector3d>& vectors);
// Names behind a code, as bytes of UTF-8, each ended by a 0. (meshio ends at VTK's arrays of the type String.)
GridArray array_of(std::string name, const std::vector<std::string>& names);
template <class Value>
GridArray array_of(std::string name, std::vector<Value> values)
{
    return {std::move(name), 1, std::move(values)};
}

struct Grid {
    std::vector<GridArray> field_data{}, point_data{}, cell_data{};
    GridArray points{};
    std::vector<std::int64_t> connectivity{}, offsets{}; // points of all cells; where those of each cell end
    CellType type = CellType::polygon;                   // of all cells

    std::size_t point_count() const { return std::get<std::vector<double>>(points.values).size() / 3; }
};

// Numbers are binary, all in base64 behind the grid, each array with its size in bytes before it. Readers of raw bytes are
// fewer, and meshio's can take one array for another.
std::string vtu_of(const Grid& grid);

// Version 1.0 of the format, which VTK reads from 9.1 on.
std::string vtkhdf_of(const Grid& grid);

} // namespace jointcreep::exchange
