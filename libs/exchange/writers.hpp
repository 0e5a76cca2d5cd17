// The writers of single formats: from a job to files. Inside libs/exchange only; exchange/format.hpp lists them.
// Numbers are written so that they read back as the same doubles, unless a writer says otherwise.

#pragma once

#include "exchange/format.hpp"

namespace jointcreep::exchange
{

std::vector<File> write_csv(const Job& job);
std::vector<File> write_vtu(const Job& job);
std::vector<File> write_vtkhdf(const Job& job);
std::vector<File> write_geojson(const Job& job);
std::vector<File> write_svg(const Job& job);

// AutoCAD R12: LINE, closed POLYLINE, and 3DFACE of rectangles in space; a layer each set. Read in: ezdxf, and the
// DXF reference of R12.
std::vector<File> write_dxf(const Job& job);

// Points, curves and surfaces of the blocks; curve e + 1 is edge e, surface b + 1 is block b.
std::vector<File> write_gmsh(const Job& job);

// UDEC 7: one `block create polygon` a block, corners clockwise. A block with holes leaves as its convex parts.
std::vector<File> write_udec(const Job& job);
// 3DEC 7: `fracture create` of discs, or `block create prism` of the convex parts of blocks.
std::vector<File> write_3dec(const Job& job);
// Convex polyhedra, as a script of YADE.
std::vector<File> write_yade(const Job& job);

std::vector<File> write_fracman(const Job& job);
std::vector<File> write_dfnworks(const Job& job);
std::vector<File> write_porepy(const Job& job);
std::vector<File> write_fractopo(const Job& job);

// By GDAL. Without it null.
std::vector<File> write_geopackage(const Job& job);
std::vector<File> write_shapefile(const Job& job);

} // namespace jointcreep::exchange
