#include "acd/concavity.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace lorica {
namespace {

constexpr double kFlatAngle = 1e-6;  // edges closer to flat than this are not concave [rad]
constexpr int kMaxComponents = 24;   // pairs grow with the square; the largest components come first

Vec3 unitNormal(const Triangle& t, std::span<const Vec3> points) {
  const Vec3& a = points[static_cast<std::size_t>(t[0])];
  return (points[static_cast<std::size_t>(t[1])] - a).cross(points[static_cast<std::size_t>(t[2])] - a).normalized();
}

/// The edge that two mesh triangles share, as the left one runs along it; empty when they share none.
bool sharedEdge(const Triangle& left, const Triangle& right, VertexIndex& from, VertexIndex& to) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (left[i] == right[(j + 1) % 3] && left[(i + 1) % 3] == right[j]) {
        from = left[i];
        to = left[(i + 1) % 3];
        return true;
      }
    }
  }
  return false;
}

double supportValue(std::span<const Vec3> points, const Vec3& direction, Vec3& where) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : points) {
    const double value = direction.dot(p);
    if (value > best) {
      best = value;
      where = p;
    }
  }
  return best;
}

/// Gilbert's iteration towards the nearest points of two convex hulls; stops as soon as a plane separates them well.
bool separatingPlane(std::span<const Vec3> a, std::span<const Vec3> b, Plane& plane) {
  Vec3 towards = a.front() - b.front();  // a point of the difference set b -> a, walked towards the origin
  for (int step = 0; step < 200; ++step) {
    const double length = towards.norm();
    if (length == 0.0) return false;
    const Vec3 normal = towards / length;
    Vec3 nearestA = a.front();
    Vec3 nearestB = b.front();
    const double lowA = -supportValue(a, -normal, nearestA);
    const double highB = supportValue(b, normal, nearestB);
    // A gap of half of the best possible one is as good a place to cut as any.
    if (lowA - highB > 0.5 * length || (step == 199 && lowA > highB)) {
      plane = {normal, 0.5 * (lowA + highB)};
      return true;
    }
    const Vec3 step3 = (nearestA - nearestB) - towards;
    const double lengthSq = step3.squaredNorm();
    if (lengthSq == 0.0) return false;
    const double t = std::clamp(-towards.dot(step3) / lengthSq, 0.0, 1.0);
    if (t == 0.0) return false;
    towards += t * step3;
  }
  return false;
}

}  // namespace

std::vector<Crease> creasesOf(const Part& part) {
  struct HalfEdge {
    PointIndex low, high;
    bool ascending;
    std::int32_t source;
    bool operator<(const HalfEdge& o) const {
      if (low != o.low) return low < o.low;
      if (high != o.high) return high < o.high;
      if (ascending != o.ascending) return ascending > o.ascending;
      return source < o.source;
    }
  };
  std::vector<HalfEdge> edges;
  edges.reserve(part.triangles.size() * 3);
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    const Triangle& t = part.triangles[i];
    for (int e = 0; e < 3; ++e) {
      const PointIndex a = t[e];
      const PointIndex b = t[(e + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b, part.sourceTriangle[i]});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Crease> creases;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const HalfEdge& up = edges[i];
    const HalfEdge& down = edges[i + 1];
    if (up.low != down.low || up.high != down.high || !up.ascending || down.ascending) continue;
    if (up.source < 0 || down.source < 0 || up.source == down.source) continue;
    creases.push_back({up.low, up.high, up.source, down.source});
  }
  return creases;
}

std::vector<ConcaveEdge> deepestConcaveEdges(std::span<const Crease> creases, std::span<const Triangle> mesh,
                                             std::span<const Vec3> points, const ConvexHull& hull, int count,
                                             double spacing) {
  struct FacePlane {
    Vec3 normal;
    double offset;
  };
  std::vector<FacePlane> planes;
  const double diagonal = boundsOf(hull.vertices).diagonal();
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[static_cast<std::size_t>(t[0])];
    const Vec3 ab = hull.vertices[static_cast<std::size_t>(t[1])] - a;
    const Vec3 ac = hull.vertices[static_cast<std::size_t>(t[2])] - a;
    const Vec3 normal = ab.cross(ac);
    const double area = normal.norm();
    const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    if (area <= 1e-7 * diagonal * longest) continue;  // slivers have no plane worth the name
    planes.push_back({normal / area, normal.dot(a) / area});
  }

  // Depths of all concave edges.
  struct Found {
    ConcaveEdge edge;
    std::pair<std::int32_t, std::int32_t> triangles;
  };
  constexpr std::size_t kBlock = 512;
  std::vector<std::vector<Found>> blocks((creases.size() + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
    for (std::size_t c = block * kBlock; c < std::min(creases.size(), (block + 1) * kBlock); ++c) {
      const Crease& crease = creases[c];
      VertexIndex from = 0, to = 0;
      const Triangle& left = mesh[static_cast<std::size_t>(crease.left)];
      const Triangle& right = mesh[static_cast<std::size_t>(crease.right)];
      if (!sharedEdge(left, right, from, to)) continue;
      const Vec3 leftNormal = unitNormal(left, points);
      const Vec3 rightNormal = unitNormal(right, points);
      const Vec3 along = points[static_cast<std::size_t>(to)] - points[static_cast<std::size_t>(from)];
      const double length = along.norm();
      if (length == 0.0 || leftNormal.hasNaN() || rightNormal.hasNaN()) continue;
      const Vec3 direction = along / length;
      const double sine = leftNormal.cross(rightNormal).dot(direction);
      if (std::atan2(-sine, leftNormal.dot(rightNormal)) <= kFlatAngle) continue;
      const Vec3 middle =
          0.5 * (points[static_cast<std::size_t>(crease.from)] + points[static_cast<std::size_t>(crease.to)]);
      double depth = std::numeric_limits<double>::infinity();
      for (const FacePlane& plane : planes) depth = std::min(depth, plane.offset - plane.normal.dot(middle));
      blocks[block].push_back(
          {{middle, direction, leftNormal, rightNormal, depth}, std::minmax(crease.left, crease.right)});
    }
  });
  std::vector<Found> all;
  for (std::vector<Found>& block : blocks) all.insert(all.end(), block.begin(), block.end());
  std::stable_sort(all.begin(), all.end(), [](const Found& a, const Found& b) { return a.edge.depth > b.edge.depth; });

  // Deepest first; pieces of one mesh edge give the same planes, so the deepest stands for all.
  std::vector<ConcaveEdge> deepest;
  std::set<std::pair<std::int32_t, std::int32_t>> taken;
  for (const Found& found : all) {
    if (static_cast<int>(deepest.size()) == count) break;
    const bool crowded = std::any_of(deepest.begin(), deepest.end(), [&](const ConcaveEdge& e) {
      return (e.point - found.edge.point).squaredNorm() < spacing * spacing;
    });
    if (crowded || !taken.insert(found.triangles).second) continue;
    deepest.push_back(found.edge);
  }
  return deepest;
}

std::vector<Plane> planesThrough(const ConcaveEdge& edge, int count) {
  //      left face \   / right face        the solid is below; seen along the edge
  //                 \ /
  //                / e \                    e to the lower right continues the left face, to the lower left the right
  //                one;
  //     right ext.       left ext.          every half-plane between them leaves both sides convex
  const Vec3 leftExtension = -(edge.leftNormal.cross(edge.direction));
  const Vec3 rightExtension = edge.rightNormal.cross(edge.direction);
  const double angle = std::atan2(leftExtension.cross(rightExtension).norm(), leftExtension.dot(rightExtension));
  std::vector<Plane> planes;
  for (int i = 0; i < count; ++i) {
    const double t = count == 1 ? 0.5 : static_cast<double>(i) / (count - 1);
    // Spherical interpolation between the two extensions; they coincide when the faces fold onto each other.
    Vec3 inPlane = leftExtension;
    if (angle > 1e-9 && std::sin(angle) > 1e-9) {
      inPlane = (std::sin((1.0 - t) * angle) * leftExtension + std::sin(t * angle) * rightExtension) / std::sin(angle);
    } else if (i > 0) {
      break;
    }
    const Vec3 normal = edge.direction.cross(inPlane).normalized();
    planes.push_back({normal, normal.dot(edge.point)});
  }
  return planes;
}

std::vector<Plane> componentPlanes(const Part& part, std::span<const Vec3> points) {
  std::vector<Plane> planes;
  const Components components = connectedComponents(points.size(), part.triangles);
  if (components.count < 2) return planes;
  std::vector<std::vector<Triangle>> trianglesOf(static_cast<std::size_t>(components.count));
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    trianglesOf[static_cast<std::size_t>(components.componentOfTriangle[i])].push_back(part.triangles[i]);
  }
  std::vector<ConvexHull> hulls;
  for (const auto& triangles : trianglesOf) {
    std::vector<Vec3> own;
    for (PointIndex p : pointsUsedBy(triangles)) own.push_back(points[static_cast<std::size_t>(p)]);
    hulls.push_back(convexHull(own));
  }
  std::stable_sort(hulls.begin(), hulls.end(),
                   [](const ConvexHull& a, const ConvexHull& b) { return a.volume > b.volume; });
  if (hulls.size() > kMaxComponents) hulls.resize(kMaxComponents);
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    for (std::size_t j = i + 1; j < hulls.size(); ++j) {
      Plane plane;
      if (separatingPlane(hulls[i].vertices, hulls[j].vertices, plane)) planes.push_back(plane);
    }
  }
  return planes;
}

}  // namespace lorica
