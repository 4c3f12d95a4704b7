#include "acd/hull_budget.h"

#include "acd/outer_shell.h"
#include "geometry/counts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace lorica {

namespace {

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

BudgetedHull simplifyHull(const ConvexHull& hull, int maxVertices) {
  LORICA_CHECK(maxVertices >= 4, "a hull with volume has at least four vertices");
  if (hull.vertices.size() <= static_cast<std::size_t>(maxVertices)) {
    return {{hull.vertices, hull.triangles}, hull.volume, 1.0};
  }
  if (hull.degenerate()) return rectangleAround(hull);

  const OwnAxes axes = ownAxesOf(hull);
  std::vector<Vec3> body;
  body.reserve(hull.vertices.size());
  for (const Vec3& p : hull.vertices) body.push_back(axes.to(p));

  // The shell, and simple shapes as fallbacks: a tetrahedron always exists.
  std::vector<ConvexHull> found;
  found.push_back(tetrahedronAround(body));
  if (maxVertices >= 8) found.push_back(boxAround(body));
  if (ConvexHull shrunk = shrunkShell(body, maxVertices); !shrunk.degenerate()) found.push_back(std::move(shrunk));
  std::sort(found.begin(), found.end(), [](const ConvexHull& a, const ConvexHull& b) { return a.volume < b.volume; });

  for (const ConvexHull& candidate : found) {
    if (std::optional<BudgetedHull> best = fitted(candidate, axes, hull, body)) return std::move(*best);
  }
  return {{hull.vertices, hull.triangles}, hull.volume, 1.0};
}

}  // namespace lorica
