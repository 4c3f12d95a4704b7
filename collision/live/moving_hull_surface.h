#pragma once

#include "collision/live/point_row.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Adjacency of a closed triangulated surface: topology without coordinates.
///
/// Half-edge h = 3 * face + i runs from corner i of its face to the next corner. Its apex is the remaining corner, its
/// twin is the same edge in the other face. Faces stay contiguous: a removed face is replaced by the last one. All
/// memory is reserved at the start, and first touched when that number of faces occurs.
class HullSurface {
 public:
  using HalfEdge = std::int32_t;
  static constexpr std::int32_t kNone = -1;
  static constexpr int kPadding = 16;  ///< faces after the last that may be read but are not used

  explicit HullSurface(int pointCount);

  void clear();
  /// Memory in bytes.
  [[nodiscard]] std::size_t memory() const;

  [[nodiscard]] int faceCount() const { return faceCount_; }
  [[nodiscard]] std::span<const Triangle> faces() const {
    return {faces_.data(), static_cast<std::size_t>(faceCount_)};
  }
  /// For each half-edge of each face, the apex of its twin.
  [[nodiscard]] const VertexIndex* opposites() const { return opposites_.data(); }

  [[nodiscard]] static std::int32_t faceOf(HalfEdge h) { return h / 3; }
  [[nodiscard]] static HalfEdge next(HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; }
  [[nodiscard]] static HalfEdge previous(HalfEdge h) { return h % 3 == 0 ? h + 2 : h - 1; }
  [[nodiscard]] HalfEdge twin(HalfEdge h) const { return twins_[h]; }
  [[nodiscard]] VertexIndex start(HalfEdge h) const { return corner(h); }
  [[nodiscard]] VertexIndex end(HalfEdge h) const { return corner(next(h)); }
  [[nodiscard]] VertexIndex apex(HalfEdge h) const { return corner(previous(h)); }
  [[nodiscard]] VertexIndex opposite(HalfEdge h) const { return opposites_[h]; }
  /// A half-edge that starts at a vertex; kNone for points that are not vertices.
  [[nodiscard]] HalfEdge outOf(VertexIndex v) const { return outOf_[v]; }
  /// The next half-edge with the same start, counter-clockwise.
  [[nodiscard]] HalfEdge turn(HalfEdge h) const { return twin(previous(h)); }

  /// Whether the start vertex of a half-edge has three edges.
  [[nodiscard]] bool hasThreeEdges(HalfEdge h) const { return turn(turn(turn(h))) == h; }

  /// Appends a face whose edges the caller still has to glue.
  std::int32_t addFace(VertexIndex a, VertexIndex b, VertexIndex c) {
    if (static_cast<std::size_t>(faceCount_) + kPadding >= faces_.size()) touchMore();
    setFace(faceCount_, a, b, c);
    return faceCount_++;
  }
  /// Overwrites a face; its edges keep their old twins until glued.
  void setFace(std::int32_t face, VertexIndex a, VertexIndex b, VertexIndex c) {
    faces_[face] = {a, b, c};
    outOf_[a] = 3 * face;
    outOf_[b] = 3 * face + 1;
    outOf_[c] = 3 * face + 2;
  }
  /// Makes two half-edges twins; the corners of both faces must be set.
  void glue(HalfEdge h, HalfEdge g) {
    twins_[h] = g;
    twins_[g] = h;
    opposites_[h] = apex(g);
    opposites_[g] = apex(h);
  }
  /// Removes a face that nothing is glued to any more; the last face takes its number.
  /// @return whether a face moved there
  bool eraseFace(std::int32_t face);

  /// Flips the edge of h = ab, with c and d across, to cd. Its two faces are then (a, d, c), replacing that of h, and
  /// (d, b, c), replacing that of its twin: the old outer edges are half-edges 0 and 2 of the first, 0 and 1 of the
  /// second.
  void flip(HalfEdge h);
  /// Inserts point p into a face: the face becomes (a, b, p), two more are appended.
  void splitFace(std::int32_t face, VertexIndex p);
  /// Inserts point p into the edge of h: both faces are halved, two are appended.
  void splitEdge(HalfEdge h, VertexIndex p);
  /// Replaces vertex v by point p.
  void replaceVertex(VertexIndex v, VertexIndex p);
  /// Marks a point as not being a vertex any more.
  void forget(VertexIndex v) { outOf_[v] = kNone; }

 private:
  // Corners are contiguous in memory, without gaps between faces.
  [[nodiscard]] VertexIndex corner(HalfEdge h) const { return faces_.data()->data()[h]; }

  void touchMore();

  int faceCount_ = 0;
  std::vector<Triangle> faces_;  ///< faceCount_ and at least kPadding more that may be read; the arrays below likewise
  std::vector<VertexIndex> opposites_;
  std::vector<HalfEdge> twins_;
  std::vector<HalfEdge> outOf_;  ///< of each point
};

/// A first small hull of some of the points with the origin strictly inside, if one exists; usually it has 4 to 12
/// faces. Exact for coordinates as in PointRow.
class HullStart {
 public:
  /// Reserves memory, so that finding does not allocate for this number of points.
  void fit(std::size_t pointCount);

  /// @return the faces, counter-clockwise from outside; none if the origin is not strictly inside the points' hull
  [[nodiscard]] std::span<const Triangle> find(std::span<const PointRow> points);

 private:
  bool spanTetrahedron(std::span<const PointRow> points);
  void add(std::span<const PointRow> points, VertexIndex p);

  std::vector<Triangle> faces_;
  std::vector<Triangle> kept_;     ///< scratch: faces that a new point does not see
  std::vector<Triangle> visible_;  ///< scratch: faces that it sees
};

}  // namespace lorica
