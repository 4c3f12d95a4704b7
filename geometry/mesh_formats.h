#pragma once

/// The parsers used by readMesh(), one for each format, and what writers of files share. Internal: not installed.

#include "geometry/mesh_files.h"

#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// Each parses the whole content of a file. The file name is used in error messages.
[[nodiscard]] Result<TriMesh> parseOff(std::string_view content, const std::string& fileName);
[[nodiscard]] Result<TriMesh> parseObj(std::string_view content, const std::string& fileName);
[[nodiscard]] Result<TriMesh> parsePly(std::string_view content, const std::string& fileName);
[[nodiscard]] Result<TriMesh> parseStl(std::string_view content, const std::string& fileName);

/// readMesh() before vertices are welded: those of the file, in its order; of .stl three for each triangle.
[[nodiscard]] Result<TriMesh> readStoredMesh(const std::filesystem::path& file, NamedBy by = NamedBy::kUser);

/// Appends a polygon as a triangle fan around its first corner; exact for flat convex polygons.
inline void appendPolygon(std::span<const VertexIndex> corners, std::vector<Triangle>& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

/// The digits with which positions are written for other programs: 9, and more if the objects are far from the origin.
[[nodiscard]] int digitsFor(std::span<const NamedMesh> objects);
/// "1 0.333333333 2". @param digits  0 = as few as read back as the same numbers
[[nodiscard]] std::string written(const Vec3& p, int digits);

}  // namespace lorica
