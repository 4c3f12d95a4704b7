#pragma once

#include "collision/live_body.h"
#include "geometry/math.h"
#include "skinning/skeleton.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lorica {

/// Flat triangles whose edges are drawn by the fragment shader: hulls and bones. Corner k of a triangle is vertex
/// 3 i + k; every vertex carries the strength of the triangle's three edges (edge k is opposite to corner k).
struct OverlayVertex {
  Vec3f position;                            ///< world [m]
  std::array<std::int8_t, 4> normal;         ///< of the face, 127 = 1
  std::array<std::uint8_t, 4> color;         ///< linear RGB; alpha 0 = a translucent hull, 255 = opaque
  std::array<std::uint8_t, 4> edgeStrength;  ///< 0 = no edge, 255 = crisp
};

/// Turns hulls and bones into overlay triangles; keeps its memory from frame to frame.
class OverlayMesh {
 public:
  /// Hulls from far to near as seen from the eye, in each the faces that look away first: drawn in this order with
  /// blending they look right as long as hulls overlap little. Edges between nearly coplanar faces are left out.
  const std::vector<OverlayVertex>& hulls(std::span<const LivePart> parts, const Vec3& eye);

  /// Octahedra from each parent joint to its child.
  const std::vector<OverlayVertex>& bones(const Skeleton& skeleton, std::span<const Affine3> worldFromJoint);

 private:
  struct HalfEdge {
    std::uint64_t key;       ///< both vertices, the lower one first
    std::uint32_t triangle;  ///< of the hull
    std::uint32_t edge;      ///< opposite to this corner
  };
  void appendHull(const ConvexHull& hull, PartIndex part, const Vec3& eye);
  void appendBone(const Vec3& head, const Vec3& tail);

  std::vector<OverlayVertex> hullVertices_;
  std::vector<OverlayVertex> boneVertices_;
  std::vector<std::pair<double, PartIndex>> order_;
  std::vector<HalfEdge> halfEdges_;
  std::vector<Vec3> faceNormals_;
  std::vector<std::array<std::uint8_t, 4>> strengths_;
};

}  // namespace lorica
