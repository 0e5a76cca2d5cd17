// Joint traces from files of GIS and CAD programs, by GDAL. GDAL is in a module beside the programs, loaded when such a
// file is met: it takes long to load, and most scenes have none.

#pragma once

#include <string>

namespace jointcreep::scene
{

// Whether a file is one that GDAL reads here, by its extension: GeoPackage, Shapefile, DXF.
bool is_trace_file(const std::string& path);

// The lines of such a file, by layers, as text that mapped_traces() reads: {"layers": {NAME: a GeoJSON
// FeatureCollection}}. Layers of a DXF file are those of its entities; layers without lines are left out. What is no
// line among them has a geometry without coordinates. Arcs are lines of short pieces. Heights are not used.
//
// Throws input_error, without the file's name, where the file cannot be read, has no lines, or has coordinates in
// another unit than metres; where the programs were built without GDAL, too.
std::string lines_of_trace_file(const std::string& path);

} // namespace jointcreep::scene
