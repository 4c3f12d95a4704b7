#pragma once

#include <cstdint>
#include <string>

namespace lorica::test {

/// A character that conforms to glTF 2.0 and uses many of its features: nodes by matrix (sheared ones too) and by
/// translation, rotation and scale (mirrored and uneven ones too); skins with different inverse bind matrices over the
/// same bones, some without any; 4 to 8 influences in bytes, shorts or floats; rigid meshes; strips, fans, indices and
/// none; strides, sparse and normalised positions; morph targets; clips of all three interpolations.
[[nodiscard]] std::string randomGlb(std::uint64_t seed);

}  // namespace lorica::test
