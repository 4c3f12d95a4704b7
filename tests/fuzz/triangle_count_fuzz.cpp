#include "export/bake/bake_job.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

/// Any bytes as a mesh or a character whose triangles `lorica bake` counts before it starts a process for them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::array<std::string, 7> endings = {".off", ".obj", ".stl", ".ply", ".glb", ".gltf", ".fbx"};
  if (size == 0) return 0;
  const std::string_view content(reinterpret_cast<const char*>(data + 1), size - 1);
  (void)lorica::trianglesIn(content, endings[data[0] % endings.size()]);
  return 0;
}
