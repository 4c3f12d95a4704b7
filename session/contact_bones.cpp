#include "session/contact_bones.h"

#include "collision/live/lifted_point.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lorica {
namespace {

/// Barycentric coordinates of the point of a triangle that is nearest to p.
/// After Ericson, Real-Time Collision Detection (2005), 5.1.5: by the Voronoi region of vertex, edge or face.
Vec3 nearestOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {1.0 - d1 / (d1 - d3), d1 / (d1 - d3), 0.0};
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {1.0 - d2 / (d2 - d6), 0.0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  const double along = (d4 - d3) + (d5 - d6);
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return {0.0, 1.0 - (d4 - d3) / along, (d4 - d3) / along};
  const double all = va + vb + vc;
  return {va / all, vb / all, vc / all};
}

}  // namespace

ContactBones::ContactBones(const Decomposition& decomposition, const Character& character)
    : weights_(character.skeleton.jointCount(), 0.0) {
  const std::vector<LiftedPoint> points = liftPoints(character, decomposition);
  std::size_t count = 0;
  for (const LiftedPoint& point : points) count += point.size();
  Points all;
  all.shares.reserve(count);
  all.begin.reserve(points.size() + 1);
  for (const LiftedPoint& point : points) {
    all.begin.push_back(all.shares.size());
    for (const LiftedTerm& term : point) all.shares.push_back({term.joint, term.weight});
  }
  all.begin.push_back(all.shares.size());
  points_ = std::make_shared<const Points>(std::move(all));
}

JointIndex ContactBones::at(const LivePart& part, const Vec3& position) {
  const ConvexHull& hull = part.shape;
  if (hull.degenerate()) return kNoJoint;
  const Vec3 p = part.worldFromPart.inverse() * position;
  double nearestSq = std::numeric_limits<double>::infinity();
  const Triangle* face = nullptr;
  Vec3 corners = Vec3::Zero();
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3& b = hull.vertices[t[1]];
    const Vec3& c = hull.vertices[t[2]];
    const Vec3 weights = nearestOnTriangle(p, a, b, c);
    const double distanceSq = (weights[0] * a + weights[1] * b + weights[2] * c - p).squaredNorm();
    if (!(distanceSq < nearestSq)) continue;
    nearestSq = distanceSq;
    face = &t;
    corners = weights;
  }
  if (face == nullptr) return kNoJoint;
  std::fill(weights_.begin(), weights_.end(), 0.0);
  for (int i = 0; i < 3; ++i) {
    const std::size_t point = hull.pointOfVertex[(*face)[i]];
    for (std::size_t s = points_->begin[point]; s < points_->begin[point + 1]; ++s) {
      weights_[points_->shares[s].joint] += corners[i] * points_->shares[s].weight;
    }
  }
  return std::max_element(weights_.begin(), weights_.end()) - weights_.begin();
}

}  // namespace lorica
