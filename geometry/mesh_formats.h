#pragma once

/// The parsers used by readMesh(), one for each format, and shared helpers. Internal: not installed.

#include "geometry/mesh_files.h"

#include <string_view>

namespace lorica {

/// Each parses the whole content of a file. The file name is used in error messages.
[[nodiscard]] Result<TriMesh> parseOff(std::string_view content, const std::string& fileName);
[[nodiscard]] Result<TriMesh> parseObj(std::string_view content, const std::string& fileName);
[[nodiscard]] Result<TriMesh> parsePly(std::string_view content, const std::string& fileName);
[[nodiscard]] Result<TriMesh> parseStl(std::string_view content, const std::string& fileName);

/// Appends a polygon as a triangle fan around its first corner; exact for flat convex polygons.
inline void appendPolygon(std::span<const VertexIndex> corners, std::vector<Triangle>& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

}  // namespace lorica
