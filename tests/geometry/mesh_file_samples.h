#pragma once

#include "geometry/tri_mesh.h"

#include <bit>
#include <string>
#include <vector>

namespace lorica::test {

/// A small file; all samples contain the same tetrahedron.
struct MeshSample {
  std::string name;
  std::string content;
};

/// The corner tetrahedron in every format and encoding that readMesh() supports.
[[nodiscard]] std::vector<MeshSample> tetrahedronFiles();

/// A number's bytes, least significant first or last.
template <typename T>
[[nodiscard]] std::string bytesOf(T value, std::endian order = std::endian::little) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof(T));
  return order == std::endian::native ? bytes : std::string(bytes.rbegin(), bytes.rend());
}

/// Binary STL of a mesh: header, count, and 50 bytes per triangle.
[[nodiscard]] std::string binaryStl(const TriMesh& mesh, std::string_view header = "");

/// Binary PLY of a mesh, with properties that a reader must skip: a colour, a list, an element of edges.
[[nodiscard]] std::string binaryPly(const TriMesh& mesh, std::endian order);

}  // namespace lorica::test
