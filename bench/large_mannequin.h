#pragma once

#include "skinning/character.h"

#include <cstddef>

namespace lorica::bench {

/// The mannequin, subdivided to a number of triangles: all triangles are split into four as long as the number is not
/// exceeded, then single triangles into three.
[[nodiscard]] Character largeMannequin(std::size_t triangleCount);

}  // namespace lorica::bench
