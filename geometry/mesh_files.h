#pragma once

#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// Reads a triangle mesh: .off, .obj, .ply (ascii and binary) or .stl (ascii and binary, equal corners welded).
/// Polygons are fanned into triangles from their first corner, which is right for flat convex ones. Vertices keep the
/// file's order and number; only where that leaves fewer open edges, vertices at exactly equal positions become one
/// (files split them for normals and texture seams).
/// Checked while reading: every index in range, every number finite. Closedness is not: see checkClosedTwoManifold.
/// @return the mesh in the file's own coordinates, or a sentence with file, line or element, found and expected
[[nodiscard]] Result<TriMesh> readMesh(const std::filesystem::path& file);

/// One object of an OBJ file.
struct NamedMesh {
  std::string name;
  TriMesh mesh;
};

/// Reads an OBJ file as one mesh for each `o` or `g` statement that has faces, with the vertices that these use in the
/// file's order. Faces before the first such statement form a mesh named after the file.
[[nodiscard]] Result<std::vector<NamedMesh>> readObjObjects(const std::filesystem::path& file);

/// Writes objects to an OBJ file, whole or not at all: beside the target first, then renamed.
[[nodiscard]] Result<void> writeObjObjects(const std::filesystem::path& file, const std::vector<NamedMesh>& objects);

}  // namespace lorica
