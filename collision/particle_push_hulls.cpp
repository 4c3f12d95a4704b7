#include "collision/particle_push_hulls.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

bool pushes(const LivePart& part) {
  return !part.shape.degenerate() && part.worldFromPart.matrix().allFinite() &&
         part.previousWorldFromPart.matrix().allFinite();
}

}  // namespace

void PushHulls::prepare(std::span<const LivePart> parts, double seconds, double radius) {
  hulls_.clear();
  for (std::vector<float>* v : {&x_, &y_, &z_, &offset_}) v->clear();

  Aabb box;
  for (const LivePart& part : parts) {
    if (!pushes(part)) continue;
    for (const Vec3& v : part.shape.vertices) box.extend(part.worldFromPart * v);
  }
  if (box.empty() || !box.min.allFinite() || !box.max.allFinite()) return;
  // Rounding of a height: a few units in the last place of a local coordinate, and of a world one where it is written.
  const double farthest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
  margin_ = static_cast<float>(0x1p-20 * (box.diagonal() + farthest));
  const double grown = radius + 4.0 * static_cast<double>(margin_);
  origin_ = (box.min.array() - grown).matrix().cast<float>();
  boxMax_ = (box.max.array() + grown).matrix().cast<float>() - origin_;

  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (pushes(parts[i])) addHull(parts[i], static_cast<std::uint32_t>(i), seconds, radius);
  }
}

void PushHulls::addHull(const LivePart& part, std::uint32_t index, double seconds, double radius) {
  Hull hull;
  hull.part = index;
  hull.firstPlane = x_.size();
  const Vec3 origin = origin_.cast<double>();
  vertices_.clear();
  Aabb box;
  for (const Vec3& v : part.shape.vertices) {
    vertices_.push_back(part.worldFromPart * v - origin);
    box.extend(vertices_.back());
  }
  for (const Triangle& t : part.shape.triangles) {
    const Vec3& a = vertices_[static_cast<std::size_t>(t[0])];
    const Vec3& b = vertices_[static_cast<std::size_t>(t[1])];
    const Vec3& c = vertices_[static_cast<std::size_t>(t[2])];
    const Vec3 cross = (b - a).cross(c - a);
    const double twiceArea = cross.norm();
    if (!(twiceArea > 0.0)) continue;
    const Vec3 normal = cross / twiceArea;
    double offset = normal.dot(a);
    // The normal of a sliver is uncertain. A plane that all vertices are below cuts nothing off, whatever its normal.
    const double longestSq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if (twiceArea < 1e-3 * longestSq) {
      for (const Vec3& v : vertices_) offset = std::max(offset, normal.dot(v));
    }
    x_.push_back(static_cast<float>(normal.x()));
    y_.push_back(static_cast<float>(normal.y()));
    z_.push_back(static_cast<float>(normal.z()));
    offset_.push_back(static_cast<float>(offset + radius));
  }
  if (x_.size() == hull.firstPlane) return;
  while (x_.size() % kBlock != 0) {
    x_.push_back(0.0F);
    y_.push_back(0.0F);
    z_.push_back(0.0F);
    offset_.push_back(std::numeric_limits<float>::infinity());
  }
  hull.planeCount = x_.size() - hull.firstPlane;
  const Vec3f grown = Vec3f::Constant(static_cast<float>(radius) + margin_);
  hull.boxMin = box.min.cast<float>() - grown;
  hull.boxMax = box.max.cast<float>() + grown;

  // The material that is at a place now was at previous * place one frame ago.
  const Isometry3 previous = part.previousWorldFromPart * part.worldFromPart.inverse();
  const double rate = part.trust / seconds;
  const Mat3 velocityOfPlace = rate * (Mat3::Identity() - previous.linear());
  hull.velocityOfPlace = velocityOfPlace.cast<float>();
  hull.velocity = (velocityOfPlace * origin - rate * previous.translation()).cast<float>();
  hulls_.push_back(hull);
}

PushHulls::Nearest PushHulls::nearest(const Hull& hull, const Vec3f& p) const {
  Nearest best{height(hull.firstPlane, p), hull.firstPlane};
  for (std::size_t i = hull.firstPlane + 1; i < hull.firstPlane + hull.planeCount; ++i) {
    const float h = height(i, p);
    if (h > best.height) best = {h, i};
  }
  return best;
}

Vec3f PushHulls::surfaceVelocity(const Hull& hull, const Vec3f& p) const {
  return hull.velocityOfPlace * p + hull.velocity;
}

}  // namespace lorica
