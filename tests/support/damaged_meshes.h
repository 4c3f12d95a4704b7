#pragma once

#include "geometry/tri_mesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lorica::test {

/// What a damaged mesh can be repaired to.
enum class Loss {
  kNone,      ///< the surface as it was: the volume is the same up to rounding
  kRounding,  ///< vertices were moved by 1e-7 of the diagonal
  kSurface,   ///< something is missing or was added
};

/// A closed mesh with one kind of damage.
struct DamagedMesh {
  std::string damage;  ///< "inside out", "holes", ...
  Loss loss = Loss::kNone;
  TriMesh mesh;
};

/// A closed mesh damaged in 14 ways, always the same for the same mesh.
[[nodiscard]] std::vector<DamagedMesh> damagedMeshes(const TriMesh& mesh);

}  // namespace lorica::test
