#pragma once

#include "acd/small_lp.h"
#include "geometry/convex_hull.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A convex polyhedron around a body whose vertices can be merged and moved. Internal to simplifyHull().
class OuterShell {
 public:
  /// @param start   a hull with volume around the body
  /// @param body    points that must stay inside (not owned), with an extent of the order of 1
  /// @param center  a point well inside the body
  OuterShell(const ConvexHull& start, std::span<const Vec3> body, const Vec3& center);

  /// Repeatedly merges the two neighbours that add the least volume, until `maxVertices` are left.
  /// @return false if no more neighbours can be merged
  bool collapseTo(int maxVertices);

  /// Moves each vertex in turn to the position of minimum volume, until a round gains less than `share` of the volume.
  void relax(int maxRounds, double share);

  [[nodiscard]] std::vector<Vec3> vertices() const;
  [[nodiscard]] int vertexCount() const { return count_; }

 private:
  using Vertex = std::int32_t;

  /// An edge, stored at its first end.
  struct Spoke {
    Vertex to = 0;
    bool known = false;
    HalfSpace beyond;  ///< allowed positions of a vertex left of the edge: the face to it must not cut the body
  };
  struct Candidate {
    double cost = 0.0;
    Vertex a = 0, b = 0;
    std::int32_t changeA = 0, changeB = 0;
  };
  struct Placement {
    Vec3 position;
    double volume = 0.0;  ///< added volume
  };

  /// The index of `to` in the ring of `from`, and the neighbour that follows it there: the face (from, to, next).
  [[nodiscard]] std::size_t slot(Vertex from, Vertex to) const;
  [[nodiscard]] Vertex next(Vertex from, Vertex to) const;
  /// The spoke's `beyond`, cached until one of its ends moves.
  const HalfSpace& tangent(Vertex from, Vertex to);
  /// Volume of the tetrahedra between the center and the triangles from an apex to a closed chain of vertices.
  [[nodiscard]] double fanVolume(std::span<const Vertex> link, const Vec3& apex) const;
  /// Constrains the apex to be above the plane of p, q, r. @return false for a sliver, which has no reliable plane
  bool restrict(const Vec3& p, const Vec3& q, const Vec3& r);
  bool keepBelowFace(Vertex a, Vertex b, int depth);
  /// The position of an apex over a closed chain of vertices that adds the least volume; none if there is no valid one.
  std::optional<Vec3> bestApex(std::span<const Vertex> link);
  [[nodiscard]] std::vector<Vertex> linkOfVertex(Vertex v) const;
  [[nodiscard]] std::vector<Vertex> linkOfEdge(Vertex a, Vertex b) const;
  std::optional<Placement> placementFor(Vertex a, Vertex b);
  void propose(Vertex a, Vertex b);
  void collapse(Vertex a, Vertex b, const Vec3& position);
  /// Invalidates the cached planes of a vertex that has moved.
  void forget(Vertex v);

  std::span<const Vec3> body_;
  Vec3 center_;
  std::vector<Vec3> at_;
  std::vector<std::vector<Spoke>> ring_;  ///< neighbours, counter-clockwise from outside; empty for a merged vertex
  std::vector<std::int32_t> changes_;     ///< number of changes around a vertex
  std::vector<Candidate> candidates_;     ///< a heap with the cheapest in front
  std::vector<HalfSpace> halfSpaces_;
  int count_ = 0;
};

}  // namespace lorica
