#include "collision/particles/particle_push_hulls.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

/// Farther from the origin than this, a float is too coarse for a position [m].
constexpr double kFarthest = 1e6;

/// The box of a part; empty if the part does not push.
Aabb boxOf(const LivePart& part) {
  if (part.shape.degenerate() || !part.worldFromPart.matrix().allFinite() ||
      !part.previousWorldFromPart.matrix().allFinite()) {
    return {};
  }
  Aabb box;
  for (const Vec3& v : part.shape.vertices) box.extend(part.worldFromPart * v);
  const bool near = (box.min.array() > -kFarthest).all() && (box.max.array() < kFarthest).all();
  return near ? box : Aabb();
}

}  // namespace

void PushHulls::prepare(std::span<const LivePart> parts, double seconds, double radius, bool again) {
  hulls_.clear();
  for (std::vector<float>* v : {&x_, &y_, &z_, &offset_}) v->clear();
  vertices_.clear();
  wereCovered_.clear();
  if (again) {
    for (const Face& face : faces_) wereCovered_.push_back(face.covered);
  }
  faces_.clear();
  raw_.clear();

  Aabb box;
  for (const LivePart& part : parts) {
    const Aabb own = boxOf(part);
    if (own.empty()) continue;
    box.extend(own.min);
    box.extend(own.max);
  }
  if (box.empty()) return;
  // Rounding of a height: a few units in the last place of a local coordinate, and of the world coordinate when it is
  // written.
  const double farthest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
  margin_ = 0x1p-20 * (box.diagonal() + farthest);
  const double grown = radius + 4.0 * margin_;
  origin_ = (box.min.array() - grown).matrix().cast<float>();
  boxMax_ = (box.max.array() + grown).matrix().cast<float>() - origin_;

  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!boxOf(parts[i]).empty()) takeHull(parts[i], i);
  }
  if (again && wereCovered_.size() == faces_.size()) {
    for (std::size_t f = 0; f < faces_.size(); ++f) faces_[f].covered = wereCovered_[f];
  } else {
    findCovered();
  }
  for (const Raw& raw : raw_) addHull(raw, seconds, radius);
}

void PushHulls::takeHull(const LivePart& part, std::uint32_t index) {
  Raw raw{&part, index, vertices_.size(), 0, faces_.size(), 0, {}, {}};
  const Vec3 origin = origin_.cast<double>();
  const auto local = [&](VertexIndex v) -> Vec3 { return part.worldFromPart * part.shape.vertices[v] - origin; };
  raw.boxMin = boxMax_;
  raw.boxMax = Vec3f::Zero();
  for (std::size_t v = 0; v < part.shape.vertices.size(); ++v) {
    const Vec3f p = local(v).cast<float>();
    vertices_.push_back(p);
    raw.boxMin = raw.boxMin.cwiseMin(p);
    raw.boxMax = raw.boxMax.cwiseMax(p);
  }
  for (const Triangle& t : part.shape.triangles) {
    const Vec3 a = local(t[0]);
    const Vec3 b = local(t[1]);
    const Vec3 c = local(t[2]);
    const Vec3 cross = (b - a).cross(c - a);
    const double twiceArea = cross.norm();
    if (!(twiceArea > 0.0)) continue;
    const Vec3 normal = cross / twiceArea;
    double offset = normal.dot(a);
    // The normal of a sliver is uncertain. A plane with all vertices below it cuts nothing off, whatever its normal.
    const double longestSq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if (twiceArea < 1e-3 * longestSq) {
      for (std::size_t v = 0; v < part.shape.vertices.size(); ++v) {
        offset = std::max(offset, normal.dot(local(v)));
      }
    }
    const VertexIndex first = raw.firstVertex;
    faces_.push_back({normal.cast<float>(), static_cast<float>(offset), {t[0] + first, t[1] + first, t[2] + first}});
  }
  raw.endVertex = vertices_.size();
  raw.endFace = faces_.size();
  if (raw.endFace > raw.firstFace) raw_.push_back(raw);
}

/// Marks faces that are completely covered by another hull: leaving there leads into that hull. Hulls that were cut
/// apart only touch, and surfaces that coincide do not hide each other, so the test is made slightly in front of the
/// face, with a tolerance. A wrong mark only makes a particle take a longer way.
void PushHulls::findCovered() {
  const float size = boxMax_.norm();
  const float before = 2.5e-3F * size;
  const float rough = 1.5e-3F * size;
  coveredVertices_.assign(vertices_.size(), false);
  for (const Raw& hull : raw_) {
    for (const Raw& by : raw_) {
      const Vec3f lower = by.boxMin.array() - rough;
      const Vec3f upper = by.boxMax.array() + rough;
      if (&hull == &by || (hull.boxMin.array() > upper.array()).any() || (lower.array() > hull.boxMax.array()).any())
        continue;
      std::size_t above = by.firstFace;  // the face above which the last point was: usually true for the next one too
      const auto isAbove = [&](std::size_t f, const Vec3f& p) {
        return faces_[f].normal.dot(p) - faces_[f].offset >= rough;
      };
      const auto nearlyInside = [&](const Vec3f& p) {
        if ((p.array() < lower.array()).any() || (p.array() > upper.array()).any() || isAbove(above, p)) return false;
        for (std::size_t f = by.firstFace; f < by.endFace; ++f) {
          if (!isAbove(f, p)) continue;
          above = f;
          return false;
        }
        return true;
      };
      for (std::size_t v = hull.firstVertex; v < hull.endVertex; ++v) coveredVertices_[v] = nearlyInside(vertices_[v]);
      for (std::size_t f = hull.firstFace; f < hull.endFace; ++f) {
        Face& face = faces_[f];
        const auto corner = [&](std::size_t i) -> std::size_t { return face.corners[i]; };
        const auto hidden = [&](std::size_t i) { return nearlyInside(vertices_[corner(i)] + before * face.normal); };
        face.covered = face.covered || (coveredVertices_[corner(0)] && coveredVertices_[corner(1)] &&
                                        coveredVertices_[corner(2)] && hidden(0) && hidden(1) && hidden(2));
      }
    }
    // A hull that is wholly inside others keeps its ways out, so that each hull has some.
    const auto first = faces_.begin() + hull.firstFace;
    const auto end = faces_.begin() + hull.endFace;
    if (std::all_of(first, end, [](const Face& face) { return face.covered; })) {
      std::for_each(first, end, [](Face& face) { face.covered = false; });
    }
  }
}

/// Appends the planes of the faces of one kind.
void PushHulls::addPlanes(const Raw& raw, bool covered, float radius) {
  for (std::size_t f = raw.firstFace; f < raw.endFace; ++f) {
    const Face& face = faces_[f];
    if (face.covered != covered) continue;
    x_.push_back(face.normal.x());
    y_.push_back(face.normal.y());
    z_.push_back(face.normal.z());
    offset_.push_back(face.offset + radius);
  }
  while (x_.size() % kBlock != 0) {
    x_.push_back(0.0F);
    y_.push_back(0.0F);
    z_.push_back(0.0F);
    offset_.push_back(std::numeric_limits<float>::infinity());
  }
}

void PushHulls::addHull(const Raw& raw, double seconds, double radius) {
  Hull hull;
  hull.part = raw.index;
  hull.firstPlane = x_.size();
  addPlanes(raw, false, radius);
  hull.exitCount = x_.size() - hull.firstPlane;
  addPlanes(raw, true, radius);
  hull.planeCount = x_.size() - hull.firstPlane;
  const Vec3f grown = Vec3f::Constant(static_cast<float>(radius) + 2.0F * margin_);
  hull.boxMin = raw.boxMin - grown;
  hull.boxMax = raw.boxMax + grown;

  // Material that is at a position now was at previous * position one frame ago.
  const LivePart& part = *raw.part;
  const Isometry3 previous = part.previousWorldFromPart * part.worldFromPart.inverse();
  const double rate = part.trust / seconds;
  const Mat3 velocityOfPosition = rate * (Mat3::Identity() - previous.linear());
  hull.velocityOfPosition = velocityOfPosition.cast<float>();
  hull.velocity = (velocityOfPosition * origin_.cast<double>() - rate * previous.translation()).cast<float>();
  hulls_.push_back(hull);
}

Vec3f PushHulls::surfaceVelocity(const Hull& hull, const Vec3f& p) const {
  return hull.velocityOfPosition * p + hull.velocity;
}

}  // namespace lorica
