#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// The two parts of a GLB, or the text of a .gltf alone. Both refer to the bytes of the file.
struct GltfParts {
  std::string_view json;
  std::optional<std::span<const std::byte>> binary;
};

/// Splits a .glb, .vrm or .gltf, detected from the content. The JSON is not parsed.
[[nodiscard]] Result<GltfParts> splitGltf(std::span<const std::byte> bytes, const std::string& name);

}  // namespace lorica
