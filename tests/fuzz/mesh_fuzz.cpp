#include "geometry/mesh_formats.h"
#include "geometry/mesh_repair.h"
#include "geometry/result.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// Any bytes as OFF, OBJ, PLY or STL: the first byte picks the format. What is accepted must be sound and fit the bytes
/// that it came from.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  constexpr std::array kParsers = {parseOff, parseObj, parsePly, parseStl};
  if (size == 0) return 0;
  const std::string_view content(reinterpret_cast<const char*>(data + 1), size - 1);
  const Result<TriMesh> mesh = kParsers[data[0] % kParsers.size()](content, "fuzz");
  if (!mesh) {
    LORICA_CHECK(mesh.error().message.rfind("fuzz", 0) == 0, "an error that does not name the file");
    LORICA_CHECK(mesh.error().message.find('\n') == std::string::npos, "more than one line");
    return 0;
  }
  LORICA_CHECK(mesh->vertices.size() <= size && mesh->triangles.size() <= size, "more elements than bytes");
  for (const Vec3& p : mesh->vertices) LORICA_CHECK(p.allFinite(), "a vertex nowhere");
  for (const Triangle& t : mesh->triangles) {
    for (const VertexIndex v : t) {
      LORICA_CHECK(v >= 0 && static_cast<std::size_t>(v) < mesh->vertices.size(), "a triangle without a vertex");
    }
  }
  (void)checkClosedTwoManifold(*mesh);
  return 0;
}
