#pragma once

#include "collision/live/moving_hull_passes.h"
#include "collision/live/moving_hull_start.h"
#include "collision/live/moving_hull_surface.h"
#include "collision/live/point_row.h"
#include "geometry/math.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Convex hull, with faces, of points that move from frame to frame: last frame's triangulation is mended.
///
/// All is seen from the origin s, which the caller keeps inside by giving points relative to their mean. The faces are
/// a triangulation of the sphere of directions around s. Motion can spoil three things, and each has its repair:
///  - a face no longer turns its outside away from s: flip an edge of it, or take a vertex out and put it back later;
///  - an edge has become concave: flip it, or take out the vertex that sank below the others;
///  - a point that was inside has come out. Each point inside keeps a certificate, three points whose tetrahedron with
///    s holds it; when that fails it is located anew and, if it is outside, becomes a vertex.
/// What cannot be mended is built anew, by the same steps from a first small hull.
///
/// Every decision is exact, so a frame's hull is the hull, whatever came before; among coplanar points the choice of
/// diagonals may depend on earlier frames. Same frames, same faces, on every machine.
class MovingHull {
 public:
  /// Takes all memory that any frame can need; some of it is shared by all hulls that one thread updates, so that only
  /// the first update on another thread allocates.
  /// @param pointCount  1 or more
  explicit MovingHull(int pointCount);

  /// Follows the points. Any motion is allowed.
  /// @param points  pointCount points [ticks], whole, at most kMostTicks either way; read again by volume() and
  /// support()
  void update(std::span<const PointRow> points);

  /// The origin is not strictly inside the points' hull (there may be no volume): no faces and vertices this frame.
  [[nodiscard]] bool flat() const { return surface_.faceCount() == 0; }

  /// Point ids, counter-clockwise from outside. Closed; coplanar faces occur, faces without area do not.
  [[nodiscard]] std::span<const Triangle> faces() const { return surface_.faces(); }

  /// Ids of the points on those faces. Some may lie within a plane or edge of the hull; no two are at the same place.
  [[nodiscard]] std::span<const VertexIndex> vertices() const { return vertices_; }

  /// Where in vertices() a vertex is.
  [[nodiscard]] std::int32_t placeOf(VertexIndex vertex) const { return slot_[static_cast<std::size_t>(vertex)]; }

  /// [ticks^3]; 0 when flat.
  [[nodiscard]] double volume() const;

  /// The vertex farthest along a direction, found by climbing over neighbours; of all points when flat. Needs an
  /// update.
  /// @param startHint  a point id, best the answer for a direction or frame nearby; others only cost time
  [[nodiscard]] VertexIndex support(const Vec3& direction, VertexIndex startHint) const;

  /// What the last update did.
  struct Counts {
    int turnedFaces = 0;         ///< faces that had lost their side
    int flips = 0;               ///< edges turned
    int deletions = 0;           ///< vertices taken out
    int insertions = 0;          ///< points that became vertices
    int failedCertificates = 0;  ///< points located anew
    int rebuilds = 0;            ///< 1 when the hull was built from nothing
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// Bytes held, without what a thread's hulls share.
  [[nodiscard]] std::size_t memory() const;

 private:
  using HalfEdge = HullSurface::HalfEdge;

  /// Where a point's direction pierces the surface.
  struct Place {
    std::int32_t face = 0;
    double ab = 0, bc = 0, ca = 0;  ///< 0 on that edge of the face, above 0 beside it
  };

  /// How the link of a vertex that is taken out lies around it, as s sees it.
  enum class Link : std::uint8_t {
    kSeenFromVertex,  ///< the vertex sees all of it
    kSimple,          ///< does not cross itself, or the vertex stays
  };

  /// What an update needs and leaves empty: one for all hulls of a thread.
  struct Scratch {
    struct Corner {
      VertexIndex vertex;
      HalfEdge rim;  ///< beyond the link's edge from this corner to the next
      std::int32_t face;
      std::int32_t before, after;
    };
    HullStart start;
    std::vector<std::int32_t> doubts;    ///< what a pass hands back
    std::vector<HalfEdge> queue;         ///< edges that may be concave
    std::vector<std::uint8_t> queued;    ///< of each half-edge: it is in the queue
    std::vector<std::int32_t> turned;    ///< faces that have lost their side
    std::vector<std::int32_t> pierced;   ///< faces in whose cones one certain direction lies
    std::vector<std::int32_t> near;      ///< faces at edges in the queue
    std::vector<std::uint8_t> isNear;    ///< of each face, whether it is among those
    std::vector<VertexIndex> unsettled;  ///< points to be located
    std::vector<Corner> link;            ///< around the vertex that is taken out
    std::vector<std::int32_t> cuts;      ///< its corners in the order in which they are cut off

    void fit(std::size_t pointCount);
  };
  static Scratch& scratchOfThisThread();

  [[nodiscard]] const PointRow& at(VertexIndex p) const { return points_[static_cast<std::size_t>(p)]; }
  [[nodiscard]] double faceDet(std::int32_t face) const;
  [[nodiscard]] bool isVertex(VertexIndex p) const { return surface_.outOf(p) != HullSurface::kNone; }

  template <class Visit>
  void visitScrambled(const Visit& visit) const;
  bool repair();
  bool build();
  void scanFaces();
  void lookAgain();
  bool turnFaces();
  bool turnFace(std::int32_t face);
  [[nodiscard]] int turnedAround(VertexIndex v) const;
  bool legalise();
  bool checkCertificates();
  bool settleAll();
  bool settle(VertexIndex p);
  [[nodiscard]] VertexIndex hintFor(VertexIndex p) const;
  void startOver();
  [[nodiscard]] bool holds(const HullCertificate& certificate) const;
  [[nodiscard]] bool isPierced(std::int32_t face) const;
  [[nodiscard]] Place locate(VertexIndex p, VertexIndex from) const;
  [[nodiscard]] static Place placeAt(HalfEdge h, double beside, double besideNext, double besidePrevious);

  bool takeOut(VertexIndex v, Link link, const Triangle& certificate);
  [[nodiscard]] bool planCuts(VertexIndex v, Link link, int corners);
  [[nodiscard]] bool isEar(VertexIndex v, Link link, int before, int tip, int after) const;
  void becomeVertex(VertexIndex p);
  void becomeInside(VertexIndex p, const Triangle& certificate);
  void queueConcave(std::int32_t face, HalfEdge h, HalfEdge k);
  void queueEdge(HalfEdge h);
  void queueFace(std::int32_t face);

  std::span<const PointRow> points_;
  HullSurface surface_;
  std::vector<VertexIndex> vertices_;
  std::vector<HullCertificate> inside_;  ///< insideCount_, and padding
  std::size_t insideCount_ = 0;
  std::vector<std::int32_t> slot_;  ///< of each point, in vertices_ or inside_
  std::size_t stride_ = 1;          ///< from point to point, in a fixed order of all without pattern
  Counts counts_;

  Scratch* scratch_ = nullptr;  ///< of this thread; valid within update()
};

}  // namespace lorica
