#pragma once

#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Who neighbours whom on a closed triangulated surface over points that others keep: topology without coordinates.
///
/// Half-edge h = 3 * face + i runs from corner i of its face to the next; its apex is the corner left over, its twin
/// the same edge seen from the other face. Faces stay contiguous: one that goes is replaced by the last. All memory is
/// taken at the start, and touched when so many faces come about for the first time.
class HullSurface {
 public:
  using HalfEdge = std::int32_t;
  static constexpr std::int32_t kNone = -1;
  static constexpr int kPadding = 16;  ///< faces that may be read, not used, after the last

  explicit HullSurface(int pointCount);

  void clear();
  /// Bytes held.
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
  [[nodiscard]] HalfEdge twin(HalfEdge h) const { return twins_[static_cast<std::size_t>(h)]; }
  [[nodiscard]] VertexIndex start(HalfEdge h) const { return corner(h); }
  [[nodiscard]] VertexIndex end(HalfEdge h) const { return corner(next(h)); }
  [[nodiscard]] VertexIndex apex(HalfEdge h) const { return corner(previous(h)); }
  [[nodiscard]] VertexIndex opposite(HalfEdge h) const { return opposites_[static_cast<std::size_t>(h)]; }
  /// A half-edge that starts at a vertex; kNone for points that are no vertices.
  [[nodiscard]] HalfEdge outOf(VertexIndex v) const { return outOf_[static_cast<std::size_t>(v)]; }
  /// The next half-edge that starts where this one does, counter-clockwise.
  [[nodiscard]] HalfEdge turn(HalfEdge h) const { return twin(previous(h)); }

  /// Whether the vertex that a half-edge starts at has three edges.
  [[nodiscard]] bool hasThreeEdges(HalfEdge h) const { return turn(turn(turn(h))) == h; }

  /// Appends a face whose edges the caller has yet to glue.
  std::int32_t addFace(VertexIndex a, VertexIndex b, VertexIndex c) {
    if (static_cast<std::size_t>(faceCount_) + kPadding >= faces_.size()) touchMore();
    setFace(faceCount_, a, b, c);
    return faceCount_++;
  }
  /// Overwrites a face; its edges keep their old twins until glued.
  void setFace(std::int32_t face, VertexIndex a, VertexIndex b, VertexIndex c) {
    faces_[static_cast<std::size_t>(face)] = {a, b, c};
    outOf_[static_cast<std::size_t>(a)] = 3 * face;
    outOf_[static_cast<std::size_t>(b)] = 3 * face + 1;
    outOf_[static_cast<std::size_t>(c)] = 3 * face + 2;
  }
  /// Makes two half-edges twins; the corners of both faces must be set.
  void glue(HalfEdge h, HalfEdge g) {
    twins_[static_cast<std::size_t>(h)] = g;
    twins_[static_cast<std::size_t>(g)] = h;
    opposites_[static_cast<std::size_t>(h)] = apex(g);
    opposites_[static_cast<std::size_t>(g)] = apex(h);
  }
  /// Removes a face that nothing is glued to any more; the last face moves into its place.
  /// @return whether a face moved there
  bool eraseFace(std::int32_t face);

  /// Turns the edge of h = ab, with c and d across, into cd. Its two faces are then (a, d, c), in the place of h's, and
  /// (d, b, c), in the place of its twin's: the old outer edges are half-edges 0 and 2 of the first, 0 and 1 of the
  /// other.
  void flip(HalfEdge h);
  /// Puts point p into a face: it becomes (a, b, p), two more are appended.
  void splitFace(std::int32_t face, VertexIndex p);
  /// Puts point p into the edge of h: both faces are halved, two are appended.
  void splitEdge(HalfEdge h, VertexIndex p);
  /// Lets point p take the place of vertex v.
  void replaceVertex(VertexIndex v, VertexIndex p);
  /// Says that a point is no vertex any more.
  void forget(VertexIndex v) { outOf_[static_cast<std::size_t>(v)] = kNone; }

 private:
  // Corners lie behind each other in memory, without gaps between faces.
  [[nodiscard]] VertexIndex corner(HalfEdge h) const { return faces_.data()->data()[h]; }

  void touchMore();

  int faceCount_ = 0;
  std::vector<Triangle> faces_;  ///< faceCount_ and at least so many more as may be read; as others that follow
  std::vector<VertexIndex> opposites_;
  std::vector<HalfEdge> twins_;
  std::vector<HalfEdge> outOf_;  ///< of each point
};

}  // namespace lorica
