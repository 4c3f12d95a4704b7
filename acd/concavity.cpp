#include "acd/concavity.h"

#include "acd/separating_plane.h"
#include "geometry/counts.h"
#include "geometry/threads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace lorica {
namespace {

constexpr double kFlatAngle = 1e-6;  // edges closer to flat than this are not concave [rad]
constexpr int kMaxComponents = 24;   // the number of pairs is quadratic; keep the largest components

/// Finds the edge that two mesh triangles share, in the direction of the left one. @return false if there is none
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

/// Returns the unit vector that divides the angle from `a` to `b` in the ratio t : 1 - t. Only bisects angles: sines
/// differ in the last bit between math libraries, and results must be identical on all machines.
Vec3 between(Vec3 a, Vec3 b, double t) {
  if (t <= 0.0) return a;
  if (t >= 1.0) return b;
  for (int i = 0; i < 40; ++i) {
    const Vec3 sum = a + b;
    if (sum.squaredNorm() <= 1e-18) return a;  // opposite directions
    const Vec3 middle = sum.normalized();
    t *= 2.0;
    if (t == 1.0) return middle;
    if (t > 1.0) {
      a = middle;
      t -= 1.0;
    } else {
      b = middle;
    }
  }
  return a;
}

}  // namespace

std::vector<Crease> creasesOf(const Part& part) {
  struct HalfEdge {
    PointIndex high;
    std::int32_t source;
    bool ascending;
    bool operator<(const HalfEdge& o) const {
      if (high != o.high) return high < o.high;
      if (ascending != o.ascending) return ascending > o.ascending;
      return source < o.source;
    }
  };
  // Counting sort of half-edges by their lower end: sorting all of them would take most of the time.
  std::vector<std::uint32_t> end(part.points.empty() ? 1 : part.points.back() + 2, 0);
  for (const Triangle& t : part.triangles) {
    for (int e = 0; e < 3; ++e) ++end[std::min(t[e], t[(e + 1) % 3]) + 1];
  }
  for (std::size_t i = 1; i < end.size(); ++i) end[i] += end[i - 1];
  std::vector<HalfEdge> edges(part.triangles.size() * 3);
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    const Triangle& t = part.triangles[i];
    for (int e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(t[e], t[(e + 1) % 3]);
      edges[end[low]++] = {high, part.sourceTriangle[i], t[e] == low};
    }
  }
  std::vector<Crease> creases;
  creases.reserve(edges.size() / 2);
  std::uint32_t first = 0;
  for (const PointIndex low : part.points) {
    const std::uint32_t last = end[low];
    std::sort(edges.begin() + first, edges.begin() + last);
    for (std::uint32_t i = first; i + 1 < last; ++i) {
      const HalfEdge& up = edges[i];
      const HalfEdge& down = edges[i + 1];
      if (up.high != down.high || !up.ascending || down.ascending) continue;
      if (up.source < 0 || down.source < 0 || up.source == down.source) continue;
      creases.push_back({low, up.high, up.source, down.source});
    }
    first = last;
  }
  return creases;
}

std::vector<Vec3> unitNormals(std::span<const Triangle> triangles, std::span<const Vec3> points) {
  std::vector<Vec3> normals;
  normals.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Vec3& a = points[t[0]];
    const Vec3 normal = (points[t[1]] - a).cross(points[t[2]] - a);
    const double length = normal.norm();
    normals.push_back(length > 0.0 ? Vec3(normal / length) : Vec3(Vec3::Zero()));
  }
  return normals;
}

std::vector<ConcaveEdge> deepestConcaveEdges(std::span<const Crease> creases, std::span<const Triangle> mesh,
                                             std::span<const Vec3> normals, std::span<const Vec3> points,
                                             const ConvexHull& hull, int count, double spacing) {
  // The hull's planes, large faces first: these cover the deep concavities.
  struct FacePlane {
    Vec3 normal;
    double offset;
    double area;
  };
  std::vector<FacePlane> planes;
  planes.reserve(hull.triangles.size());
  const double diagonal = boundsOf(hull.vertices).diagonal();
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3 ab = hull.vertices[t[1]] - a;
    const Vec3 ac = hull.vertices[t[2]] - a;
    const Vec3 normal = ab.cross(ac);
    const double area = normal.norm();
    const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    if (area <= 1e-7 * diagonal * longest) continue;  // a sliver has no reliable plane
    planes.push_back({normal / area, normal.dot(a) / area, area});
  }
  std::stable_sort(planes.begin(), planes.end(),
                   [](const FacePlane& a, const FacePlane& b) { return a.area > b.area; });
  const auto depthBelow = [&](const Vec3& p, std::size_t planeCount) {
    double depth = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(planeCount, planes.size()); ++i) {
      depth = std::min(depth, planes[i].offset - planes[i].normal.dot(p));
    }
    return depth;
  };

  // All concave edges, each with an upper bound of its depth.
  struct Found {
    double depth;
    std::uint32_t crease;
    bool exact;
    bool operator<(const Found& o) const { return depth != o.depth ? depth < o.depth : crease > o.crease; }
  };
  constexpr std::size_t kBlock = 2048;
  constexpr std::size_t kFewPlanes = 24;
  const double flatTangent = kFlatAngle;  // tangent of a small angle
  std::vector<std::vector<Found>> blocks((creases.size() + kBlock - 1) / kBlock);
  const auto middleOf = [&](const Crease& c) -> Vec3 { return 0.5 * (points[c.from] + points[c.to]); };
  const auto directionOf = [&](const Crease& c, Vec3& direction) {
    VertexIndex from = 0, to = 0;
    if (!sharedEdge(mesh[c.left], mesh[c.right], from, to)) {
      return false;
    }
    direction = points[to] - points[from];
    const double length = direction.norm();
    direction /= length;
    return length > 0.0;
  };
  parallelFor(blocks.size(), [&](std::size_t block) {
    for (std::size_t c = block * kBlock; c < std::min(creases.size(), (block + 1) * kBlock); ++c) {
      const Crease& crease = creases[c];
      const Vec3& left = normals[crease.left];
      const Vec3& right = normals[crease.right];
      Vec3 direction;
      if (left.isZero(0.0) || right.isZero(0.0) || !directionOf(crease, direction)) continue;
      const double sine = -left.cross(right).dot(direction);
      const double cosine = left.dot(right);
      if (sine <= 0.0 || sine <= flatTangent * cosine) continue;
      blocks[block].push_back({depthBelow(middleOf(crease), kFewPlanes), static_cast<std::uint32_t>(c), false});
    }
  });
  std::vector<Found> heap;
  for (const std::vector<Found>& block : blocks) heap.insert(heap.end(), block.begin(), block.end());
  std::make_heap(heap.begin(), heap.end());

  // Deepest first. Sections of one mesh edge give the same planes, so only the deepest is kept. Exact depths are
  // computed only for the few edges that reach the top of the heap.
  std::vector<ConcaveEdge> deepest;
  std::set<std::pair<std::int32_t, std::int32_t>> taken;
  while (!heap.empty() && countOf(deepest) < count) {
    std::pop_heap(heap.begin(), heap.end());
    Found found = heap.back();
    heap.pop_back();
    const Crease& crease = creases[found.crease];
    const Vec3 middle = middleOf(crease);
    const bool tooClose = std::any_of(deepest.begin(), deepest.end(), [&](const ConcaveEdge& e) {
      return (e.point - middle).squaredNorm() < spacing * spacing;
    });
    if (tooClose || taken.contains(std::minmax(crease.left, crease.right))) continue;
    if (!found.exact) {
      found.depth = depthBelow(middle, planes.size());
      found.exact = true;
      heap.push_back(found);
      std::push_heap(heap.begin(), heap.end());
      continue;
    }
    taken.insert(std::minmax(crease.left, crease.right));
    Vec3 direction = Vec3::Zero();
    directionOf(crease, direction);
    deepest.push_back({middle, direction, normals[crease.left], normals[crease.right], found.depth});
  }
  return deepest;
}

std::vector<Plane> planesThrough(const ConcaveEdge& edge, int count) {
  //      left face \   / right face        seen along the edge e; the solid is below
  //                 \ /
  //                / e \                    the left extension continues the left face, the right one the right face;
  //     right ext.       left ext.          every half-plane between them leaves both sides convex
  const Vec3 leftExtension = -(edge.leftNormal.cross(edge.direction));
  const Vec3 rightExtension = edge.rightNormal.cross(edge.direction);
  // If the faces are folded onto each other, the extensions coincide and there is only one plane.
  if (leftExtension.cross(rightExtension).norm() <= 1e-9) count = 1;
  std::vector<Plane> planes;
  for (int i = 0; i < count; ++i) {
    const Vec3 inPlane =
        between(leftExtension, rightExtension, count == 1 ? 0.5 : static_cast<double>(i) / (count - 1));
    const Vec3 normal = edge.direction.cross(inPlane).normalized();
    planes.push_back({normal, normal.dot(edge.point)});
  }
  return planes;
}

std::vector<Plane> componentPlanes(const Part& part, std::span<const Vec3> points) {
  std::vector<Plane> planes;
  const Components components = connectedComponents(points.size(), part.triangles);
  if (components.count < 2) return planes;
  std::vector<std::vector<Triangle>> trianglesOf(components.count);
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    trianglesOf[components.componentOfTriangle[i]].push_back(part.triangles[i]);
  }
  std::vector<ConvexHull> hulls;
  for (const auto& triangles : trianglesOf) {
    std::vector<Vec3> own;
    for (PointIndex p : pointsUsedBy(triangles)) own.push_back(points[p]);
    hulls.push_back(convexHull(own));
  }
  std::stable_sort(hulls.begin(), hulls.end(),
                   [](const ConvexHull& a, const ConvexHull& b) { return a.volume > b.volume; });
  if (hulls.size() > kMaxComponents) hulls.resize(kMaxComponents);
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    for (std::size_t j = i + 1; j < hulls.size(); ++j) {
      if (const auto plane = separatingPlane(hulls[i].vertices, hulls[j].vertices)) planes.push_back(*plane);
    }
  }
  return planes;
}

}  // namespace lorica
