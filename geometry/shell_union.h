#pragma once

/// The union of closed surfaces that overlap. Internal: not installed.

#include "geometry/tri_mesh.h"

#include <cstddef>
#include <optional>

namespace lorica {

/// A mesh whose pieces do not overlap.
struct ShellUnion {
  TriMesh mesh;            ///< vertices of the input in its order, then those where pieces cross
  std::size_t pieces = 0;  ///< of the input that overlapped others
};

/// Replaces the pieces of a closed surface that overlap by the surface of their union: what the surface winds around at
/// least once is solid. So copies of a piece and pieces inside others go, and cavities stay. No vertex is moved by more
/// than 1e-5 of the diagonal. A piece that overlaps itself counts once, too, unless the overlap is so small that 500
/// points in the bounds miss it, or fewer for more than 40,000 triangles. Where no union can be found, overlaps of less
/// than 1 % are left as they are.
/// @param mesh  closed two-manifold, its pieces face outward
/// @return the union; nothing if pieces do not overlap, or only touch; or an error if their union cannot be found
[[nodiscard]] Result<std::optional<ShellUnion>> uniteShells(const TriMesh& mesh);

}  // namespace lorica
