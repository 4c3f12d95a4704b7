#pragma once

#include "geometry/mesh_files.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// The bytes of a file of several meshes, each with its name where the format has names:
/// - .obj: an object `o NAME` each, see writeObjObjects()
/// - .stl: text, a `solid NAME` each, since a binary file holds one only
/// - .ply: text; names as comments, the number of its mesh as the property `part` of each face
/// Coordinates are those of the meshes, with as many digits as doubles have.
/// @param extension  ".stl" or ".ply"
[[nodiscard]] std::string formatMeshes(const std::vector<NamedMesh>& meshes, const std::string& extension);

/// Writes such a file, completely or not at all. @param file  ends in .obj, .stl or .ply
[[nodiscard]] Result<void> writeMeshes(const std::filesystem::path& file, const std::vector<NamedMesh>& meshes);

/// The bytes of a binary .stl of one mesh, in single precision: the kind that every program reads.
[[nodiscard]] std::string formatBinaryStl(const TriMesh& mesh);

/// Names for a format that allows only letters, digits and "_-." and no name twice: other characters become "_", and a
/// number is added to those that repeat.
/// @return as many, in the same order
[[nodiscard]] std::vector<std::string> plainNames(const std::vector<std::string>& names);

}  // namespace lorica
