#pragma once

#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// Reads a triangle mesh: .off, .obj, .ply (ascii and binary) or .stl (ascii and binary, equal corners welded).
/// Polygons are fanned into triangles. Checked while reading: every index in range, every number finite.
/// @return the mesh in the file's own coordinates, or a sentence with file, line or element, found and expected
[[nodiscard]] Result<TriMesh> readMesh(const std::filesystem::path& file);

/// One object of an OBJ file.
struct NamedMesh {
  std::string name;
  TriMesh mesh;
};

/// Reads an OBJ file as one mesh for each `o` or `g` statement; a file without either gives one mesh.
[[nodiscard]] Result<std::vector<NamedMesh>> readObjObjects(const std::filesystem::path& file);

/// Writes objects to an OBJ file, whole or not at all: beside the target first, then renamed.
[[nodiscard]] Result<void> writeObjObjects(const std::filesystem::path& file, const std::vector<NamedMesh>& objects);

}  // namespace lorica
