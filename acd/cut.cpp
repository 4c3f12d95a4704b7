#include "acd/cut.h"

#include "acd/cap.h"
#include "geometry/counts.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace lorica {
namespace {

std::uint64_t edgeKey(PointIndex a, PointIndex b) {
  if (a > b) std::swap(a, b);
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
}

/// Collects the triangles of one half. Clipped triangles are added as polygons of three or four corners.
class Half {
 public:
  void add(const Triangle& t, std::int32_t source) {
    part_.triangles.push_back(t);
    part_.sourceTriangle.push_back(source);
  }
  void addPolygon(std::span<const PointIndex> corners, std::int32_t source) {
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) add({corners[0], corners[i], corners[i + 1]}, source);
  }
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return part_.triangles; }
  Part take() {
    part_.points = pointsUsedBy(part_.triangles);
    return std::move(part_);
  }

 private:
  Part part_;
};

/// Gives thin triangles to the half that has most of their corners: there they do not enlarge the hull.
void assignThin(const Part& part, std::span<const std::size_t> thin, std::size_t pointCount, Half& above, Half& below) {
  if (thin.empty()) return;
  const auto cornersIn = [pointCount](const Half& half) {
    std::vector<bool> used(pointCount, false);
    for (const Triangle& t : half.triangles()) {
      for (const PointIndex p : t) {
        if (static_cast<std::size_t>(p) < pointCount) used[p] = true;
      }
    }
    return used;
  };
  const std::vector<bool> inAbove = cornersIn(above);
  const std::vector<bool> inBelow = cornersIn(below);
  for (const std::size_t i : thin) {
    int difference = 0;
    for (const PointIndex p : part.triangles[i]) difference += (inAbove[p] ? 1 : 0) - (inBelow[p] ? 1 : 0);
    (difference >= 0 ? above : below).add(part.triangles[i], part.sourceTriangle[i]);
  }
}

}  // namespace

void keepBelow(std::vector<Vec3>& polygon, const Plane& plane, std::vector<Vec3>& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double aboveA = plane.normal.dot(a) - plane.offset, aboveB = plane.normal.dot(b) - plane.offset;
    if (aboveA <= 0.0) scratch.push_back(a);
    if ((aboveA < 0.0 && aboveB > 0.0) || (aboveA > 0.0 && aboveB < 0.0)) {
      scratch.push_back(a + aboveA / (aboveA - aboveB) * (b - a));
    }
  }
  std::swap(polygon, scratch);
}

void PlaneSides::classify(const Part& part, std::span<const Vec3> points, const Plane& plane, double tolerance) {
  for (PointIndex p : part.points) classify(p, points, plane, tolerance);
}

int PlaneSides::classify(PointIndex p, std::span<const Vec3> points, const Plane& plane, double tolerance) {
  if (side_.size() < points.size()) {
    side_.resize(points.size());
    distance_.resize(points.size());
  }
  const std::size_t i = p;
  const double distance = plane.normal.dot(points[i]) - plane.offset;
  distance_[i] = distance;
  side_[i] = distance > tolerance ? 1 : distance < -tolerance ? -1 : 0;
  return side_[i];
}

CutPoint PlaneSides::crossing(PointIndex a, PointIndex b) const {
  if (a > b) std::swap(a, b);
  const double da = distanceOf(a);
  const double db = distanceOf(b);
  return {a, b, db / (db - da)};
}

int PlaneSides::sideOf(const Triangle& t, std::span<const Vec3> points, const Plane& plane, double tolerance) const {
  for (PointIndex p : t) {
    if (sideOf(p) != 0) return sideOf(p);
  }
  const Vec3& a = points[t[0]];
  const Vec3& b = points[t[1]];
  const Vec3& c = points[t[2]];
  const double twiceArea = (b - a).cross(c - a).dot(plane.normal);
  const double longestSq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  if (twiceArea * twiceArea <= tolerance * tolerance * longestSq) return 0;
  return twiceArea > 0.0 ? -1 : 1;
}

CutResult cutPart(const Part& part, std::span<const Vec3> points, const Plane& plane, double tolerance,
                  PointIndex firstNewPoint) {
  PlaneSides sides;
  sides.classify(part, points, plane, tolerance);
  CutResult result;
  std::unordered_map<std::uint64_t, PointIndex> cutPointOfEdge;
  const auto cutPoint = [&](PointIndex a, PointIndex b) {
    const auto [entry, isNew] = cutPointOfEdge.try_emplace(edgeKey(a, b), firstNewPoint + countOf(result.newPoints));
    if (isNew) result.newPoints.push_back(sides.crossing(a, b));
    return entry->second;
  };

  // Assign each triangle to a half, or clip it into a piece for each half.
  Half above, below;
  std::vector<std::size_t> thin;  // triangles without a reliable normal, in the plane
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    const Triangle& t = part.triangles[i];
    const std::int32_t source = part.sourceTriangle[i];
    const std::array<int, 3> s = {sides.sideOf(t[0]), sides.sideOf(t[1]), sides.sideOf(t[2])};
    if (std::min({s[0], s[1], s[2]}) >= 0 || std::max({s[0], s[1], s[2]}) <= 0) {
      const int side = sides.sideOf(t, points, plane, tolerance);
      if (side == 0) {
        thin.push_back(i);
      } else {
        (side > 0 ? above : below).add(t, source);
      }
      continue;
    }
    std::array<PointIndex, 4> upper{}, lower{};
    std::size_t upperCount = 0, lowerCount = 0;
    for (int e = 0; e < 3; ++e) {
      const int f = (e + 1) % 3;
      if (s[e] >= 0) upper[upperCount++] = t[e];
      if (s[e] <= 0) lower[lowerCount++] = t[e];
      if (s[e] * s[f] < 0) upper[upperCount++] = lower[lowerCount++] = cutPoint(t[e], t[f]);
    }
    above.addPolygon({upper.data(), upperCount}, source);
    below.addPolygon({lower.data(), lowerCount}, source);
  }
  assignThin(part, thin, points.size(), above, below);

  // The open edges of the upper half, all on the plane, bound the cap.
  const auto onPlane = [&](PointIndex p) { return p >= firstNewPoint || sides.sideOf(p) == 0; };
  std::vector<std::array<PointIndex, 2>> open;
  {
    std::unordered_map<std::uint64_t, int> balance;  // ascending minus descending edges
    std::vector<std::array<PointIndex, 2>> seen;
    for (const Triangle& t : above.triangles()) {
      for (int e = 0; e < 3; ++e) {
        const PointIndex a = t[e];
        const PointIndex b = t[(e + 1) % 3];
        if (!onPlane(a) || !onPlane(b)) continue;
        balance[edgeKey(a, b)] += a < b ? 1 : -1;
        seen.push_back({a, b});
      }
    }
    for (const auto& [a, b] : seen) {
      int& left = balance[edgeKey(a, b)];
      const int direction = a < b ? 1 : -1;
      if (left * direction <= 0) continue;
      left -= direction;
      open.push_back({a, b});
    }
  }

  // Plane coordinates with the normal towards the viewer: the upper half's border runs counter-clockwise around the
  // cap.
  const Vec3 u = plane.normal.unitOrthogonal();
  const Vec3 v = plane.normal.cross(u);
  std::unordered_map<PointIndex, int> capVertexOf;
  std::vector<PointIndex> pointOf;
  std::vector<Vec2> flat;
  const auto positionOf = [&](PointIndex p) -> Vec3 {
    if (p < firstNewPoint) return points[p];
    const CutPoint& c = result.newPoints[p - firstNewPoint];
    return c.lambda * points[c.first] + (1.0 - c.lambda) * points[c.second];
  };
  std::vector<CapEdge> edges;
  for (const auto& edge : open) {
    CapEdge local{};
    for (int i = 0; i < 2; ++i) {
      const auto [entry, isNew] = capVertexOf.try_emplace(edge[i], countOf(pointOf));
      if (isNew) {
        pointOf.push_back(edge[i]);
        const Vec3 p = positionOf(edge[i]);
        flat.emplace_back(u.dot(p), v.dot(p));
      }
      local[i] = entry->second;
    }
    edges.push_back(local);
  }
  for (const Triangle& t : triangulateCap(flat, edges)) {
    const PointIndex a = pointOf[t[0]];
    const PointIndex b = pointOf[t[1]];
    const PointIndex c = pointOf[t[2]];
    below.add({a, b, c}, -1);
    above.add({a, c, b}, -1);
  }
  result.above = above.take();
  result.below = below.take();
  return result;
}

std::vector<PointIndex> pointsUsedBy(std::span<const Triangle> triangles) {
  PointIndex largest = -1;
  for (const Triangle& t : triangles) largest = std::max({largest, t[0], t[1], t[2]});
  std::vector<bool> used(largest + 1, false);
  for (const Triangle& t : triangles) {
    for (const PointIndex p : t) used[p] = true;
  }
  std::vector<PointIndex> points;
  points.reserve(std::min(triangles.size() * 3, used.size()));
  for (PointIndex p = 0; p <= largest; ++p) {
    if (used[p]) points.push_back(p);
  }
  return points;
}

}  // namespace lorica
