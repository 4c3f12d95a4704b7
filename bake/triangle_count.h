#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lorica {

/// How many triangles a file has, without reading its geometry: exactly for triangle meshes in OFF, OBJ and STL; of PLY
/// two for each face; of glTF those of all its meshes, each once; of FBX and COLLADA, which say it nowhere, one for
/// every 12 bytes. Files that are no such files have some number.
/// @param ending  of the file's name, in small letters: ".off"
[[nodiscard]] std::uint64_t trianglesIn(std::string_view content, const std::string& ending);

}  // namespace lorica
