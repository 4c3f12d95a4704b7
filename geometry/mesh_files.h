#pragma once

#include "geometry/files.h"
#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// Reads a triangle mesh: .off, .obj, .ply (ascii and binary) or .stl (ascii and binary, equal corners welded).
/// Polygons become triangle fans around their first corner, which is exact for flat convex polygons. Vertices keep the
/// file's order and count. Exception: if it reduces the number of open edges, vertices at exactly equal positions are
/// welded (files split them for normals and texture seams).
/// Checks that every index is in range and every number finite. Does not check that the mesh is closed: see
/// checkClosedTwoManifold().
/// @return the mesh in the file's coordinates, or an error that gives file, line or element, found and expected value
[[nodiscard]] Result<TriMesh> readMesh(const std::filesystem::path& file, NamedBy by = NamedBy::kUser);

/// One object of an OBJ file.
struct NamedMesh {
  std::string name;  ///< of the object in the file; may be empty
  TriMesh mesh;      ///< in the file's units
};

/// Reads an OBJ file as one mesh for each `o` or `g` statement that has faces. Each mesh has only the vertices that its
/// faces use, in the file's order. Faces before the first such statement form a mesh named after the file.
[[nodiscard]] Result<std::vector<NamedMesh>> readObjObjects(const std::filesystem::path& file);

/// Writes objects to an OBJ file, completely or not at all: see writeFileAtomically().
/// @param digits  see digitsFor(); 0 = as few as read back as the same numbers
[[nodiscard]] Result<void> writeObjObjects(const std::filesystem::path& file, const std::vector<NamedMesh>& objects,
                                           int digits = 0);

}  // namespace lorica
