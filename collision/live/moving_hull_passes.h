#pragma once

#include "collision/live/point_row.h"
#include "geometry/tri_mesh.h"

#include <cstdint>

/// What MovingHull asks of everything in every frame, in single precision and vectors: who is beyond doubt. The others
/// are handed back to be decided exactly, so that neither vector width nor rounding ever shows in a hull.
namespace lorica {

/// A point inside a hull and three that hold it: it lies in their tetrahedron with the origin s, surface included.
///
/// The three were vertices when this was written; some may be inside by now. Then their own certificates were written
/// later than this one (or they are located anew in this frame), so that a chain of certificates never returns, and
/// ends at vertices. As every link holds in the present positions, the point is inside the hull of vertices and s.
struct HullCertificate {
  VertexIndex a, b, c;
  VertexIndex point;
};

/// Bits of a doubt about a face; face * kFaceBits + bits names both.
enum FaceDoubt : std::int32_t {
  kEdgeMayBeConcave = 1,  ///< shifted by the edge's number, 0 to 2
  kMayBeTurned = 8,       ///< the origin may not be strictly below it
  kMayBePierced = 16,     ///< its cone may hold directions as close to +z as you please
  kFaceBits = 32,
};

/// Lists faces in doubt, in ascending order.
/// @param points     those that faces name
/// @param faces      count, and readable up to the next multiple of kPassWidth
/// @param opposites  for each edge of each face, the vertex across: three times as many
/// @param doubts     room for count
/// @return how many there are
int findDoubtfulFaces(const PointRow* points, const Triangle* faces, const VertexIndex* opposites, int count,
                      std::int32_t* doubts);

/// Lists certificates in doubt by their numbers, in ascending order.
/// @param certificates  count, and readable up to the next multiple of kPassWidth
/// @param doubts        room for count
/// @return how many there are
int findDoubtfulCertificates(const PointRow* points, const HullCertificate* certificates, int count,
                             std::int32_t* doubts);

/// Six times the volume between the faces and the origin, in double precision; always summed in the same order.
/// @param faces  count, and readable up to the next multiple of kPassWidth
[[nodiscard]] double sumOfDeterminants(const PointRow* points, const Triangle* faces, int count);

/// So many are read at a time, at most: what lies beyond the last must be zero or have been valid once.
inline constexpr int kPassWidth = 16;

}  // namespace lorica
