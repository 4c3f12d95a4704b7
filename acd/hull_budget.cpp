#include "acd/hull_budget.h"

#include "acd/fewer_planes.h"
#include "acd/small_lp.h"
#include "geometry/counts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lorica {

namespace {

constexpr double kReach = 100.0;    // limit of each coordinate of a vertex
constexpr double kOnEdge = 1e-8;    // body points closer to an edge than this do not constrain planes through it
constexpr double kSlack = 1e-7;     // allowed concavity of an edge: coplanar faces are common, but not exactly coplanar
constexpr double kSliver = 1e-6;    // height below which a triangle's plane is unreliable
constexpr int kSliverDepth = 3;     // how many consecutive slivers are skipped
constexpr double kSameCost = 1e-9;  // cost tolerance of candidates that are evaluated again

bool costsMore(const auto& x, const auto& y) {
  if (x.cost != y.cost) return x.cost > y.cost;
  return x.a != y.a ? x.a > y.a : x.b > y.b;
}

/// A convex polyhedron around a body whose vertices can be merged and moved.
class OuterShell {
 public:
  /// @param start   a hull with volume around the body
  /// @param body    points that must stay inside (not owned), with an extent of the order of 1
  /// @param center  a point well inside the body
  OuterShell(const ConvexHull& start, std::span<const Vec3> body, const Vec3& center)
      : body_(body),
        center_(center),
        at_(start.vertices),
        ring_(at_.size()),
        changes_(at_.size()),
        count_(countOf(at_)) {
    // In the ring of v, a triangle (v, p, q) means that q follows p.
    std::vector<std::vector<std::array<Vertex, 2>>> follows(at_.size());
    for (const Triangle& t : start.triangles) {
      for (int i = 0; i < 3; ++i) follows[t[i]].push_back({t[(i + 1) % 3], t[(i + 2) % 3]});
    }
    for (std::size_t v = 0; v < at_.size(); ++v) {
      Vertex p = follows[v].front()[0];
      for (std::size_t i = 0; i < follows[v].size(); ++i) {
        ring_[v].push_back({p, false, {}});
        p = (*std::find_if(follows[v].begin(), follows[v].end(), [p](const auto& f) { return f[0] == p; }))[1];
      }
    }
  }

  /// Repeatedly merges the two neighbours that add the least volume, until `maxVertices` are left.
  /// @return false if no more neighbours can be merged
  bool collapseTo(int maxVertices) {
    candidates_.clear();
    for (Vertex a = 0; a < countOf(ring_); ++a) {
      for (const Vertex b : linkOfVertex(a)) {
        if (a < b) propose(a, b);
      }
    }
    while (count_ > maxVertices) {
      if (candidates_.empty()) return false;
      std::pop_heap(candidates_.begin(), candidates_.end(),
                    [](const auto& x, const auto& y) { return costsMore(x, y); });
      const Candidate cheapest = candidates_.back();
      candidates_.pop_back();
      const auto [cost, a, b, changeA, changeB] = cheapest;
      if (changes_[a] != changeA || changes_[b] != changeB) continue;  // outdated: proposed again since
      // A face beyond the link may have changed: evaluate again.
      const std::optional<Placement> now = placementFor(a, b);
      if (!now) continue;
      if (now->volume > cost + kSameCost) {
        propose(a, b);
        continue;
      }
      collapse(a, b, now->position);
      const std::vector<Vertex> link = linkOfVertex(a);
      ++changes_[a];
      ++changes_[b];
      for (const Vertex v : link) ++changes_[v];
      for (const Vertex v : link) {
        for (const Vertex w : linkOfVertex(v)) {
          const bool fromBoth = std::find(link.begin(), link.end(), w) != link.end();
          if (!fromBoth || v < w) propose(v, w);
        }
      }
    }
    return true;
  }

  /// Moves each vertex in turn to the position of minimum volume, until a round gains less than `share` of the volume.
  void relax(int maxRounds, double share) {
    for (int round = 0; round < maxRounds; ++round) {
      double volume = 0.0;
      double gained = 0.0;
      for (Vertex v = 0; v < countOf(ring_); ++v) {
        if (ring_[v].empty()) continue;
        const std::vector<Vertex> link = linkOfVertex(v);
        const double before = fanVolume(link, at_[v]);
        volume += before / 3.0;  // each triangle belongs to three fans
        const std::optional<Vec3> apex = bestApex(link);
        if (!apex) continue;
        const double gain = before - fanVolume(link, *apex);
        if (gain <= 0.0) continue;
        gained += gain;
        at_[v] = *apex;
        forget(v);
      }
      if (gained <= share * volume) return;
    }
  }

  [[nodiscard]] std::vector<Vec3> vertices() const {
    std::vector<Vec3> alive;
    for (std::size_t v = 0; v < ring_.size(); ++v) {
      if (!ring_[v].empty()) alive.push_back(at_[v]);
    }
    return alive;
  }

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
  [[nodiscard]] std::size_t slot(Vertex from, Vertex to) const {
    const std::vector<Spoke>& ring = ring_[from];
    std::size_t i = 0;
    while (i < ring.size() && ring[i].to != to) ++i;
    LORICA_CHECK(i < ring.size(), "neighbourhood of shell vertices must be symmetric");
    return i;
  }

  [[nodiscard]] Vertex next(Vertex from, Vertex to) const {
    return ring_[from][(slot(from, to) + 1) % ring_[from].size()].to;
  }

  /// The spoke's `beyond`, cached until one of its ends moves.
  const HalfSpace& tangent(Vertex from, Vertex to) {
    Spoke& spoke = ring_[from][slot(from, to)];
    if (spoke.known) return spoke.beyond;
    spoke.known = true;
    // Seen along the edge, the body spans an angle of less than 180 degrees that contains the center. The plane that
    // touches the body on its left side has the largest angle from the center.
    const Vec3& a = at_[from];
    const Vec3 along = (at_[to] - a).normalized();
    const Vec3 inward = (center_ - a - along * along.dot(center_ - a)).normalized();
    const Vec3 left = along.cross(inward);
    double touchInward = 1.0;
    double touchLeft = 0.0;
    for (const Vec3& p : body_) {
      const double pInward = inward.dot(p - a);
      const double pLeft = left.dot(p - a);
      if (pLeft <= 0.0 || touchInward * pLeft - touchLeft * pInward <= 0.0) continue;
      if (pInward * pInward + pLeft * pLeft <= kOnEdge * kOnEdge) continue;
      touchInward = pInward;
      touchLeft = pLeft;
    }
    const Vec3 normal = (touchInward * left - touchLeft * inward).normalized();
    spoke.beyond = {normal, normal.dot(a)};
    return spoke.beyond;
  }

  /// Volume of the tetrahedra between the center and the triangles from an apex to a closed chain of vertices.
  [[nodiscard]] double fanVolume(std::span<const Vertex> link, const Vec3& apex) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < link.size(); ++i) {
      const Vec3& p = at_[link[i]];
      const Vec3& q = at_[link[(i + 1) % link.size()]];
      sum += (apex - center_).dot((p - center_).cross(q - center_));
    }
    return sum / 6.0;
  }

  /// Constrains the apex to be above the plane of p, q, r. @return false for a sliver, which has no reliable plane
  bool restrict(const Vec3& p, const Vec3& q, const Vec3& r) {
    const Vec3 normal = (q - p).cross(r - p);
    const double length = normal.norm();
    if (length <= kSliver * std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()})) return false;
    halfSpaces_.push_back({normal / length, normal.dot(p) / length - kSlack});
    return true;
  }

  bool keepBelowFace(Vertex a, Vertex b, int depth) {
    const Vertex c = next(a, b);
    if (restrict(at_[b], at_[a], at_[c])) return true;
    // The plane of a sliver is unreliable: the faces behind it bound the same region.
    return depth > 0 && keepBelowFace(c, b, depth - 1) && keepBelowFace(a, c, depth - 1);
  }

  /// The position of an apex over a closed chain of vertices that adds the least volume; none if there is no valid one.
  std::optional<Vec3> bestApex(std::span<const Vertex> link) {
    halfSpaces_.clear();
    Vec3 area = Vec3::Zero();
    const std::size_t n = link.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vertex a = link[i];
      const Vertex b = link[(i + 1) % n];
      const Vertex c = link[(i + 2) % n];
      if ((at_[b] - at_[a]).squaredNorm() <= kSliver * kSliver) return {};
      area += (at_[a] - center_).cross(at_[b] - center_);
      // The new face must keep the body inside; the edge of the link and the new edge to b must be convex.
      halfSpaces_.push_back(tangent(a, b));
      if (!keepBelowFace(b, a, kSliverDepth)) return {};
      restrict(at_[a], at_[b], at_[c]);
    }
    const std::optional<Vec3> apex = minimizeLinear(area, halfSpaces_, kReach);
    if (!apex) return {};
    // Reject the apex if, due to rounding, a face is on the wrong side of the center.
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3& p = at_[link[i]];
      const Vec3& q = at_[link[(i + 1) % n]];
      if ((*apex - center_).dot((p - center_).cross(q - center_)) < 0.0) return {};
    }
    return apex;
  }

  [[nodiscard]] std::vector<Vertex> linkOfVertex(Vertex v) const {
    std::vector<Vertex> link;
    link.reserve(ring_[v].size());
    for (const Spoke& s : ring_[v]) link.push_back(s.to);
    return link;
  }

  [[nodiscard]] std::vector<Vertex> linkOfEdge(Vertex a, Vertex b) const {
    std::vector<Vertex> link;
    const std::vector<Spoke>& ra = ring_[a];
    const std::vector<Spoke>& rb = ring_[b];
    const std::size_t ia = slot(a, b);
    const std::size_t ib = slot(b, a);
    link.reserve(ra.size() + rb.size() - 4);
    // a's neighbours without b; then b's without a and the two common ones.
    for (std::size_t i = 1; i < ra.size(); ++i) link.push_back(ra[(ia + i) % ra.size()].to);
    for (std::size_t i = 2; i + 1 < rb.size(); ++i) link.push_back(rb[(ib + i) % rb.size()].to);
    return link;
  }

  std::optional<Placement> placementFor(Vertex a, Vertex b) {
    const std::vector<Vertex> link = linkOfEdge(a, b);
    // With more than two common neighbours the surface would become non-manifold.
    for (std::size_t i = 0; i < link.size(); ++i) {
      if (std::find(link.begin() + i + 1, link.end(), link[i]) != link.end()) return {};
    }
    if (link.size() < 3) return {};
    const std::optional<Vec3> apex = bestApex(link);
    if (!apex) return {};
    // Current volume of both stars: that of a, and that of b without the two shared triangles.
    const double before = fanVolume(linkOfVertex(a), at_[a]) + fanVolume(linkOfVertex(b), at_[b]);
    const Vertex c = next(a, b);
    const Vertex d = next(b, a);
    const auto cone = [this](Vertex p, Vertex q, Vertex r) {
      return (at_[p] - center_).dot((at_[q] - center_).cross(at_[r] - center_)) / 6.0;
    };
    const double shared = cone(a, b, c) + cone(b, a, d);
    return Placement{*apex, fanVolume(link, *apex) - (before - shared)};
  }

  void propose(Vertex a, Vertex b) {
    if (a > b) std::swap(a, b);
    const std::optional<Placement> found = placementFor(a, b);
    if (!found) return;
    candidates_.push_back({found->volume, a, b, changes_[a], changes_[b]});
    std::push_heap(candidates_.begin(), candidates_.end(),
                   [](const auto& x, const auto& y) { return costsMore(x, y); });
  }

  void collapse(Vertex a, Vertex b, const Vec3& position) {
    const std::vector<Vertex> link = linkOfEdge(a, b);
    for (const Vertex v : link) {
      std::vector<Spoke>& ring = ring_[v];
      bool toA = false;
      for (const Spoke& s : ring) toA |= s.to == a;
      if (toA) std::erase_if(ring, [b](const Spoke& s) { return s.to == b; });
      for (Spoke& s : ring) {
        if (s.to == b) s.to = a;
      }
    }
    ring_[b].clear();
    ring_[a].clear();
    for (const Vertex v : link) ring_[a].push_back({v, false, {}});
    at_[a] = position;
    --count_;
    forget(a);
  }

  /// Invalidates the cached planes of a vertex that has moved.
  void forget(Vertex v) {
    for (Spoke& s : ring_[v]) {
      s.known = false;
      ring_[s.to][slot(s.to, v)].known = false;
    }
  }

  std::span<const Vec3> body_;
  Vec3 center_;
  std::vector<Vec3> at_;
  std::vector<std::vector<Spoke>> ring_;  ///< neighbours, counter-clockwise from outside; empty for a merged vertex
  std::vector<std::int32_t> changes_;     ///< number of changes around a vertex
  std::vector<Candidate> candidates_;     ///< a heap with the cheapest in front
  std::vector<HalfSpace> halfSpaces_;
  int count_ = 0;
};

constexpr int kStartFactor = 6;      // the shell starts with at most this multiple of the vertex budget ...
constexpr int kStartAtLeast = 1000;  // ... or this number of vertices, whichever is larger
constexpr double kStage = 0.5;       // fraction of vertices left after a round of merging, before all are moved again
constexpr int kRoundsBetween = 2;    // rounds of moving vertices between two rounds of merging
constexpr int kRoundsLast = 40;
constexpr double kRoundGain = 1e-4;  // minimum gain of a round, as a fraction of the volume, to continue
constexpr double kTight = 1e-14;     // fraction of the diagonal up to which a point counts as inside
constexpr double kLost = 1e-3;       // a shell that needs more enlarging than this to enclose its body is invalid

/// Coordinates in which a body has equal extents in all directions. They preserve volume ratios.
struct OwnAxes {
  Mat3 bodyFromOwn = Mat3::Identity();
  Mat3 ownFromBody = Mat3::Identity();
  Vec3 origin = Vec3::Zero();

  [[nodiscard]] Vec3 to(const Vec3& p) const { return ownFromBody * (p - origin); }
  [[nodiscard]] Vec3 from(const Vec3& p) const { return origin + bodyFromOwn * p; }
};

/// Centroid and covariance of the solid, from tetrahedra that start at the coordinate origin.
void momentsOf(const ConvexHull& hull, std::span<const Vec3> vertices, Vec3& centroid, Mat3& moments) {
  double volume = 0.0;
  centroid.setZero();
  moments.setZero();
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = vertices[t[0]];
    const Vec3& b = vertices[t[1]];
    const Vec3& c = vertices[t[2]];
    const double v = a.dot(b.cross(c)) / 6.0;
    const Vec3 sum = a + b + c;
    volume += v;
    centroid += v * sum / 4.0;
    moments += v / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  centroid /= volume;
  moments = moments / volume - centroid * centroid.transpose();
}

OwnAxes ownAxesOf(const ConvexHull& hull) {
  OwnAxes axes;
  for (const Vec3& p : hull.vertices) axes.origin += p / countOf(hull.vertices);
  const double size = boundsOf(hull.vertices).diagonal();
  axes.bodyFromOwn *= size;
  axes.ownFromBody /= size;
  // For a very flat body the first round finds the plane only roughly; later rounds refine it in scaled coordinates.
  std::vector<Vec3> own(hull.vertices.size());
  for (int round = 0; round < 4; ++round) {
    std::transform(hull.vertices.begin(), hull.vertices.end(), own.begin(), [&](const Vec3& p) { return axes.to(p); });
    Vec3 centroid;
    Mat3 moments;
    momentsOf(hull, own, centroid, moments);
    if (!moments.allFinite()) break;
    const SymmetricAxes solver = symmetricAxes(moments);
    const double largest = solver.values.maxCoeff();
    if (!(largest > 0.0)) break;
    const Vec3 widths = solver.values.cwiseMax(1e-14 * largest).cwiseSqrt();
    const Mat3& directions = solver.vectors;
    axes.origin = axes.from(centroid);
    axes.bodyFromOwn = axes.bodyFromOwn * directions * widths.asDiagonal();
    axes.ownFromBody = widths.cwiseInverse().asDiagonal() * directions.transpose() * axes.ownFromBody;
    if (widths.minCoeff() > 0.7 && widths.maxCoeff() < 1.5) break;
  }
  return axes;
}

/// Factor by which a hull must be scaled about the origin to just enclose all points; below 1 if it is larger than
/// necessary.
double scaleToHold(const ConvexHull& hull, std::span<const Vec3> points) {
  double scale = 0.0;
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3 ab = hull.vertices[t[1]] - a;
    const Vec3 ac = hull.vertices[t[2]] - a;
    const Vec3 normal = ab.cross(ac);
    const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    if (normal.norm() <= 1e-7 * longest) continue;  // a sliver's plane is unreliable; its neighbours suffice
    double farthest = 0.0;
    for (const Vec3& p : points) farthest = std::max(farthest, normal.dot(p));
    scale = std::max(scale, farthest / normal.dot(a));
  }
  return scale;
}

std::vector<Vec3> scaled(std::vector<Vec3> points, double factor) {
  for (Vec3& p : points) p *= factor;
  return points;
}

/// A hull of some of the points, enlarged until it encloses all of them.
ConvexHull coarseHull(std::span<const Vec3> points, std::size_t atMost) {
  std::vector<Vec3> chosen(points.begin(), points.end());
  for (double tolerance = 1e-5; chosen.size() > atMost && tolerance < 0.1; tolerance *= 1.5) {
    chosen.clear();
    for (const VertexIndex i : convexHullOutline(points, tolerance).points) chosen.push_back(points[i]);
  }
  const ConvexHull hull = convexHull(chosen);
  if (hull.degenerate()) return hull;
  return convexHull(scaled(hull.vertices, std::max(1.0, scaleToHold(hull, points))));
}

/// Removes the vertex whose removal adds the least volume; the rest is enlarged until it encloses all points.
ConvexHull withoutOneVertex(const ConvexHull& hull, std::span<const Vec3> points) {
  ConvexHull best;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    std::vector<Vec3> others = hull.vertices;
    others.erase(others.begin() + i);
    const ConvexHull rest = convexHull(others);
    if (rest.degenerate()) continue;
    const double scale = scaleToHold(rest, points);
    if (!(scale > 0.0)) continue;
    const double volume = scale * scale * scale * rest.volume;
    if (!std::isfinite(volume) || (!best.degenerate() && volume >= best.volume)) continue;
    best = convexHull(scaled(rest.vertices, scale));
  }
  return best;
}

/// Returns the shell with at most `maxVertices` vertices; degenerate if none was found.
ConvexHull shrunkShell(std::span<const Vec3> body, int maxVertices) {
  const std::size_t budget = maxVertices;
  ConvexHull around = coarseHull(body, std::max(kStartFactor * budget, std::size_t{kStartAtLeast}));
  while (around.vertices.size() > budget && !around.degenerate()) {
    const auto count = countOf(around.vertices);
    OuterShell shell(around, body, Vec3::Zero());
    shell.relax(kRoundsBetween, kRoundGain);
    shell.collapseTo(std::max(maxVertices, static_cast<int>(kStage * count)));
    // Rebuild the shell as the hull of its vertices, which re-triangulates faces that have become coplanar.
    around = shell.vertexCount() < count ? convexHull(shell.vertices()) : withoutOneVertex(around, body);
  }
  if (around.degenerate()) return {};
  OuterShell shell(around, body, Vec3::Zero());
  shell.relax(kRoundsLast, kRoundGain);
  ConvexHull last = convexHull(shell.vertices());
  if (!last.degenerate() && scaleToHold(last, body) > 1.0 + kLost) return {};
  return last;
}

ConvexHull tetrahedronAround(std::span<const Vec3> body) {
  const ConvexHull regular = convexHull(std::vector<Vec3>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}});
  return convexHull(scaled(regular.vertices, scaleToHold(regular, body)));
}

ConvexHull boxAround(std::span<const Vec3> body) {
  const Aabb box = boundsOf(body);
  std::vector<Vec3> corners;
  corners.reserve(8);
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 1) ? box.max.x() : box.min.x(), (i & 2) ? box.max.y() : box.min.y(),
                         (i & 4) ? box.max.z() : box.min.z());
  }
  return convexHull(corners);
}

/// Converts a shell to the body's coordinates and enlarges it until it encloses the hull despite rounding errors.
std::optional<BudgetedHull> fitted(const ConvexHull& shell, const OwnAxes& axes, const ConvexHull& hull,
                                   std::span<const Vec3> body) {
  const double diagonal = boundsOf(hull.vertices).diagonal();
  ConvexHull own = shell;
  for (double margin = 1e-12; margin < 0.1; margin *= 4.0) {
    own = convexHull(scaled(own.vertices, std::max(1.0, scaleToHold(own, body)) * (1.0 + margin)));
    std::vector<Vec3> outer;
    outer.reserve(own.vertices.size());
    for (const Vec3& p : own.vertices) outer.push_back(axes.from(p));
    ConvexHull found = convexHull(outer);
    if (found.degenerate() || !(largestViolation(found, hull.vertices) <= kTight * diagonal)) continue;
    const double volume = found.volume;
    return BudgetedHull{{std::move(found.vertices), std::move(found.triangles)}, volume, volume / hull.volume};
  }
  return std::nullopt;
}

/// A rectangle around a flat set, in its plane.
BudgetedHull rectangleAround(const ConvexHull& flat) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : flat.vertices) mean += p / countOf(flat.vertices);
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : flat.vertices) spread += (p - mean) * (p - mean).transpose();
  const SymmetricAxes solver = symmetricAxes(spread);
  const Mat3& directions = solver.vectors;  // the normal of the plane first
  Aabb box;
  for (const Vec3& p : flat.vertices) box.extend(directions.transpose() * (p - mean));
  BudgetedHull around;
  for (const auto& [y, z] : {std::pair{box.min.y(), box.min.z()}, std::pair{box.max.y(), box.min.z()},
                             std::pair{box.max.y(), box.max.z()}, std::pair{box.min.y(), box.max.z()}}) {
    around.mesh.vertices.push_back(mean + directions * Vec3(box.center().x(), y, z));
  }
  return around;
}

}  // namespace

BudgetedHull simplifyHull(const ConvexHull& hull, const HullBudget& budget) {
  const auto& [maxVertices, maxPlanes, turnPlanes] = budget;
  for (const int limit : {maxVertices, maxPlanes}) {
    LORICA_CHECK(limit == 0 || limit >= 4, "a hull with volume has at least four vertices and four planes");
  }
  const auto within = [](std::size_t count, int limit) { return limit == 0 || count <= std::size_t(limit); };
  const auto asItIs = [&] { return BudgetedHull{{hull.vertices, hull.triangles}, hull.volume, 1.0}; };
  const bool few = within(hull.vertices.size(), maxVertices);
  if (few && within(hull.triangles.size(), maxPlanes)) return asItIs();
  if (hull.degenerate()) return rectangleAround(hull);

  const OwnAxes axes = ownAxesOf(hull);
  ConvexHull own = hull;
  for (Vec3& p : own.vertices) p = axes.to(p);
  const std::vector<Vec3>& body = own.vertices;
  if (few && within(planesOf(own), maxPlanes)) return asItIs();

  // What was found, and simple shapes as fallbacks: a tetrahedron always exists.
  std::vector<ConvexHull> found;
  found.push_back(tetrahedronAround(body));
  if (within(8, maxVertices) && within(6, maxPlanes)) found.push_back(boxAround(body));
  found.push_back(maxPlanes > 0 ? fewerPlanes(own, maxPlanes, maxVertices, turnPlanes)
                                : shrunkShell(body, maxVertices));
  std::erase_if(found, [](const ConvexHull& shape) { return shape.degenerate(); });
  std::stable_sort(found.begin(), found.end(),
                   [](const ConvexHull& a, const ConvexHull& b) { return a.volume < b.volume; });

  for (const ConvexHull& candidate : found) {
    if (std::optional<BudgetedHull> best = fitted(candidate, axes, hull, body)) return std::move(*best);
  }
  return asItIs();
}

}  // namespace lorica
