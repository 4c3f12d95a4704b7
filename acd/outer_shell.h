#pragma once

#include "acd/small_lp.h"
#include "geometry/convex_hull.h"

#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A convex polyhedron around a body, while its vertices are merged and moved. Internal to simplifyHull().
class OuterShell {
 public:
  /// @param start   a hull with volume around the body
  /// @param body    points that have to stay inside; borrowed. Their spread is of the order of 1
  /// @param center  well inside the body
  OuterShell(const ConvexHull& start, std::span<const Vec3> body, const Vec3& center);

  /// Merges neighbours, always the two that add least volume, until `maxVertices` are left.
  /// @return false when no two neighbours can be merged any more
  bool collapseTo(int maxVertices);

  /// Moves every vertex in turn to where the volume is least, until a round gains less than `share` of the volume.
  void relax(int maxRounds, double share);

  [[nodiscard]] std::vector<Vec3> vertices() const;
  [[nodiscard]] int vertexCount() const { return count_; }

 private:
  using Vertex = std::int32_t;

  /// An edge as its first end sees it.
  struct Spoke {
    Vertex to = 0;
    bool known = false;
    HalfSpace beyond;  ///< where a vertex left of the edge must lie so that the face between leaves the body inside
  };
  struct Candidate {
    double cost = 0.0;
    Vertex a = 0, b = 0;
    std::int32_t changeA = 0, changeB = 0;
  };
  struct Placement {
    Vec3 position;
    double volume = 0.0;  ///< added
  };

  /// Where `to` is in the ring of `from`, and the neighbour that follows it there: the face (from, to, next).
  [[nodiscard]] std::size_t slot(Vertex from, Vertex to) const;
  [[nodiscard]] Vertex next(Vertex from, Vertex to) const;
  /// The spoke's `beyond`, found once for as long as its ends stay.
  const HalfSpace& tangent(Vertex from, Vertex to);
  /// Of the tetrahedra between the center and the triangles from an apex to a closed chain of vertices.
  [[nodiscard]] double fanVolume(std::span<const Vertex> link, const Vec3& apex) const;
  /// The apex is to be above the plane of p, q, r. @return false for a sliver, which says nothing
  bool restrict(const Vec3& p, const Vec3& q, const Vec3& r);
  bool keepBelowFace(Vertex a, Vertex b, int depth);
  /// Where an apex over a closed chain of vertices adds least volume; none when it can be nowhere.
  std::optional<Vec3> bestApex(std::span<const Vertex> link);
  [[nodiscard]] std::vector<Vertex> linkOfVertex(Vertex v) const;
  [[nodiscard]] std::vector<Vertex> linkOfEdge(Vertex a, Vertex b) const;
  std::optional<Placement> placementFor(Vertex a, Vertex b);
  void propose(Vertex a, Vertex b);
  void collapse(Vertex a, Vertex b, const Vec3& position);
  /// A vertex has moved.
  void forget(Vertex v);

  std::span<const Vec3> body_;
  Vec3 center_;
  std::vector<Vec3> at_;
  std::vector<std::vector<Spoke>> ring_;  ///< neighbours, counter-clockwise from outside; empty for a merged vertex
  std::vector<std::int32_t> changes_;     ///< how often the surroundings of a vertex changed
  std::vector<Candidate> candidates_;     ///< a heap, the cheapest in front
  std::vector<HalfSpace> halfSpaces_;
  int count_ = 0;
};

}  // namespace lorica
