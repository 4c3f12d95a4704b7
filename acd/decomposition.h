#pragma once

#include "geometry/counts.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

using PointIndex = std::int32_t;  ///< a mesh vertex (< vertexCount) or a cut point (>= vertexCount)
using PartIndex = std::int32_t;   ///< a part of a decomposition, from 0

/// Positions of one mesh in several keyframes (not owned): keyframeCount x vertexCount, keyframe-major [m].
struct PoseView {
  std::span<const Vec3> positions;  ///< model space [m], keyframe-major
  int vertexCount = 0;              ///< of the mesh, in each keyframe

  /// 0 for a mesh without vertices
  [[nodiscard]] int keyframeCount() const { return vertexCount == 0 ? 0 : countOf(positions) / vertexCount; }
  /// The vertices of keyframe `k` [m].
  [[nodiscard]] std::span<const Vec3> keyframe(int k) const {
    return positions.subspan(static_cast<std::size_t>(k) * vertexCount, vertexCount);
  }
};

/// A vertex made by a cut: position = lambda * p[first] + (1 - lambda) * p[second] in every pose (Eq. 10).
/// Both ends have smaller indices, so processing cut points in order computes all of them.
struct CutPoint {
  PointIndex first = 0;   ///< one end of the edge that was cut
  PointIndex second = 0;  ///< the other end
  double lambda = 0.0;    ///< 0 = at `first`, 1 = at `second`
};

/// A closed submesh of the decomposed mesh.
struct Part {
  std::vector<Triangle> triangles;           ///< indices are PointIndex; surface and caps
  std::vector<std::int32_t> sourceTriangle;  ///< for each triangle, the mesh triangle it came from; -1 on caps
  std::vector<PointIndex> points;            ///< all points that the triangles use, ascending
};

/// An approximate convex decomposition, valid in any pose of its mesh. Immutable once made.
///
/// Parts are ordered by level of detail: part i + 1 was split from part splitFrom[i]. If every part from n on is merged
/// into the part that it was split from, the first n parts are again a decomposition.
struct Decomposition {
  int vertexCount = 0;               ///< of the mesh it was made from
  int triangleCount = 0;             ///< of the mesh it was made from
  std::vector<CutPoint> cutPoints;   ///< PointIndex = vertexCount + index in this list
  std::vector<PartIndex> splitFrom;  ///< one entry for each part except the first, splitFrom[i] <= i
  std::vector<Part> parts;           ///< at least one

  [[nodiscard]] int pointCount() const { return vertexCount + countOf(cutPoints); }  ///< vertices and cut points
};

/// 64-bit hash of the whole decomposition, bit for bit; equal decompositions have equal hashes on every machine.
[[nodiscard]] std::uint64_t hashOf(const Decomposition& decomposition);

}  // namespace lorica
