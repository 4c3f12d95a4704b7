#pragma once

#include "collision/live/point_row.h"
#include "geometry/tri_mesh.h"

#include <cstdint>

/// Passes of MovingHull over all faces and points in every frame, in single precision with vector instructions. They
/// find the elements that are certainly in order. The others are returned for an exact decision, so that neither vector
/// width nor rounding ever shows in a hull.
namespace lorica {

/// A point inside a hull and three points that hold it: it lies in their tetrahedron with the origin s, surface
/// included.
///
/// The three were vertices when this was written; some may be inside by now. In that case their own certificates were
/// written later than this one (or they are located again in this frame), so a chain of certificates has no cycles and
/// ends at vertices. As every link of the chain is valid in the present positions, the point is inside the hull of
/// vertices and s.
struct HullCertificate {
  VertexIndex a, b, c;
  VertexIndex point;
};

/// Bits of a doubt about a face; face * kFaceBits + bits stores both.
enum FaceDoubt : std::int32_t {
  kEdgeMayBeConcave = 1,  ///< shifted by the edge's number, 0 to 2
  kMayBeTurned = 8,       ///< the origin may not be strictly below it
  kMayBePierced = 16,     ///< its cone may contain directions arbitrarily close to +z
  kFaceBits = 32,
};

/// Lists faces in doubt, in ascending order.
/// @param points     those that faces refer to
/// @param faces      count, and readable up to the next multiple of kPassWidth
/// @param opposites  for each edge of each face, the vertex across: three times as many
/// @param doubts     space for count
/// @return number of faces in doubt
int findDoubtfulFaces(const PointRow* points, const Triangle* faces, const VertexIndex* opposites, int count,
                      std::int32_t* doubts);

/// Lists certificates in doubt by their numbers, in ascending order.
/// @param certificates  count, and readable up to the next multiple of kPassWidth
/// @param doubts        space for count
/// @return number of certificates in doubt
int findDoubtfulCertificates(const PointRow* points, const HullCertificate* certificates, int count,
                             std::int32_t* doubts);

/// Six times the volume between the faces and the origin, in double precision; always summed in the same order.
/// @param faces  count, and readable up to the next multiple of kPassWidth
[[nodiscard]] double sumOfDeterminants(const PointRow* points, const Triangle* faces, int count);

/// Max number of elements read at a time. Elements after the last must be zero or have been valid once.
inline constexpr int kPassWidth = 16;

}  // namespace lorica
