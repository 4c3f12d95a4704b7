#pragma once

#include "collision/live/moving_hull_passes.h"
#include "collision/live/moving_hull_surface.h"
#include "collision/live/point_row.h"
#include "geometry/math.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Convex hull, with faces, of points that move from frame to frame: the last frame's triangulation is repaired.
///
/// The origin s serves as view point; the caller keeps it inside by giving points relative to their mean. The faces are
/// a triangulation of the sphere of directions around s. Motion can cause three defects, each with its own repair:
///  - a face is turned: its outside no longer points away from s. Flip one of its edges, or remove a vertex and add it
///    again later;
///  - an edge has become concave: flip it, or remove the vertex that sank below the others;
///  - an inner point has come out. Each inner point keeps a certificate, three points whose tetrahedron with s contains
///    it. If the certificate fails, the point is located again, and becomes a vertex if it is outside.
///
/// What cannot be repaired is rebuilt by the same steps, from a small initial hull.
///
/// Every decision is exact, so the result is the convex hull regardless of earlier frames; among coplanar points the
/// choice of diagonals may depend on earlier frames. The same frames give the same faces on every machine.
class MovingHull {
 public:
  /// Allocates all memory that any frame can need. Part of it is shared by all hulls that one thread updates, so that
  /// only the first update on another thread allocates.
  /// @param pointCount  1 or more
  explicit MovingHull(int pointCount);

  /// Allocates on this thread what updates of hulls of up to that many points share.
  static void prepareThread(std::size_t pointCount) { scratchOfThisThread().fit(pointCount); }

  /// Updates the hull to new positions. Any motion is allowed.
  /// @param points  pointCount points [ticks], whole numbers from -kMaxTicks to kMaxTicks; must stay valid for volume()
  void update(std::span<const PointRow> points);

  /// Begins to fetch what update() reads first.
  void fetch() const;

  /// Whether the origin is not strictly inside the points' hull (there may be no volume): no faces and vertices this
  /// frame.
  [[nodiscard]] bool flat() const { return surface_.faceCount() == 0; }

  /// Point ids, counter-clockwise from outside. Closed; coplanar faces occur, faces without area do not.
  [[nodiscard]] std::span<const Triangle> faces() const { return surface_.faces(); }

  /// Ids of the points on those faces. Some may lie within a plane or edge of the hull; no two have the same position.
  [[nodiscard]] std::span<const VertexIndex> vertices() const { return vertices_; }

  /// Whether the last update left faces() and vertices() as they were.
  [[nodiscard]] bool keptFaces() const {
    return counts_.flips + counts_.deletions + counts_.insertions + counts_.rebuilds == 0;
  }

  /// Index of a vertex in vertices().
  [[nodiscard]] std::int32_t positionOf(VertexIndex vertex) const { return slot_[vertex]; }

  /// [ticks^3]; 0 when flat.
  [[nodiscard]] double volume() const;

  /// What the last update did.
  struct Counts {
    int turnedFaces = 0;         ///< faces whose outside no longer pointed away from s
    int flips = 0;               ///< flipped edges
    int deletions = 0;           ///< removed vertices
    int insertions = 0;          ///< points that became vertices
    int failedCertificates = 0;  ///< points located again
    int rebuilds = 0;            ///< 1 if the hull was built from scratch
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// Memory in bytes, without what a thread's hulls share.
  [[nodiscard]] std::size_t memory() const;

 private:
  using HalfEdge = HullSurface::HalfEdge;

  /// Where a point's direction pierces the surface.
  struct Position {
    std::int32_t face = 0;
    double ab = 0, bc = 0, ca = 0;  ///< 0 on that edge of the face, above 0 inside of it
  };

  /// The link of a vertex to be removed, as seen from s.
  enum class Link : std::uint8_t {
    kSeenFromVertex,  ///< the vertex sees all of it
    kSimple,          ///< must not cross itself; otherwise the vertex stays
  };

  /// Working memory of an update, empty between updates: one for all hulls of a thread.
  struct Scratch {
    struct Corner {
      VertexIndex vertex;
      HalfEdge rim;  ///< beyond the link's edge from this corner to the next
      std::int32_t face;
      std::int32_t before, after;
    };
    HullStart start;
    std::vector<std::int32_t> doubts;    ///< output of a pass
    std::vector<HalfEdge> queue;         ///< edges that may be concave
    std::vector<std::uint8_t> queued;    ///< for each half-edge: whether it is in the queue
    std::vector<std::int32_t> turned;    ///< faces whose outside does not point away from s
    std::vector<std::int32_t> pierced;   ///< faces whose cones contain one certain direction
    std::vector<std::int32_t> near;      ///< faces at edges in the queue
    std::vector<std::uint8_t> isNear;    ///< for each face, whether it is in `near`
    std::vector<VertexIndex> unsettled;  ///< points to be located
    std::vector<Corner> link;            ///< around the vertex to be removed
    std::vector<std::int32_t> cuts;      ///< its corners in the order in which they are cut off

    void fit(std::size_t pointCount);
  };
  static Scratch& scratchOfThisThread();

  [[nodiscard]] const PointRow& at(VertexIndex p) const { return points_[p]; }
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
  [[nodiscard]] Position locate(VertexIndex p, VertexIndex from) const;
  [[nodiscard]] static Position positionAt(HalfEdge h, double beside, double besideNext, double besidePrevious);

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
  std::vector<std::int32_t> slot_;  ///< index of each point in vertices_ or inside_
  std::size_t stride_ = 1;          ///< from point to point, in a fixed order of all points without pattern
  Counts counts_;

  Scratch* scratch_ = nullptr;  ///< of this thread; valid within update()
};

}  // namespace lorica
