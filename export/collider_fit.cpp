#include "export/collider_fit.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/parallel_progress.h"
#include "geometry/random_numbers.h"
#include "geometry/triangle_tree.h"
#include "skinning/linear_blend.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace lorica {

namespace {

constexpr int kSamples = 64;       // of each collider's surface
constexpr double kCore = 0.02;     // tolerance of the hull inside another, see convexHullOutline()
constexpr double kInside = 1e-9;   // [m]
constexpr double kVisible = 1e-3;  // [m]

/// A convex solid with its planes.
class Hull {
 public:
  explicit Hull(const RigidCollider& collider)
      : mesh_(&collider.hull),
        planes_(planesOf(*mesh_)),
        box_(boundsOf(mesh_->vertices)),
        tree_(mesh_->vertices, mesh_->triangles) {
    std::vector<Vec3> few;
    for (const VertexIndex v : convexHullOutline(mesh_->vertices, kCore).points) few.push_back(mesh_->vertices[v]);
    const ConvexHull core = convexHull(few);
    core_ = planesOf({core.vertices, core.triangles});
  }
  /// The distance of a point outside, at most 0 inside; or any number from `below` on if it is at least that.
  [[nodiscard]] double outside(const Vec3& p, double below) const {
    if (distanceSqToBox(p, box_) >= below * below) return below;
    if (const double deep = beyond(core_, p, 0.0); deep < 0.0 && !core_.empty()) return deep;
    // Hulls have thousands of planes, and most points are near the surface. From inside, the nearest point of the
    // surface is straight ahead; from outside, beyond an edge, it may seem so if the edge is very sharp.
    const TriangleTree::Hit hit = tree_.nearest(p, below, [](std::int32_t) { return true; });
    if (hit.triangle >= 0) {
      const auto& [a, b, c] = tree_.corners(hit);
      const Vec3 away = p - (hit.shares.x() * a + hit.shares.y() * b + hit.shares.z() * c);
      const double height = (b - a).cross(c - a).normalized().dot(away);
      if (height >= 0.0) return hit.distance;
      if (height <= -0.999 * hit.distance) return height;
    }
    const double rough = beyond(planes_, p, below);
    return rough <= 0.0 || rough >= below ? rough : std::min(hit.distance, below);
  }
  /// Points of the surface, spread by area.
  [[nodiscard]] std::vector<Vec3> samples(std::uint64_t seed) const {
    std::vector<double> upTo;
    double all = 0.0;
    for (const Triangle& t : mesh_->triangles) {
      all += 0.5 * areaNormal(mesh_->vertices, t).norm();
      upTo.push_back(all);
    }
    std::vector<Vec3> points;
    RandomNumbers random(seed);
    for (int i = 0; i < kSamples; ++i) {
      const double at = all * (i + 0.5) / kSamples;
      const auto found = std::lower_bound(upTo.begin(), upTo.end() - 1, at);
      const Triangle& t = mesh_->triangles[found - upTo.begin()];
      double u = random.unit();
      double v = random.unit();
      if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
      }
      const Vec3& a = mesh_->vertices[t[0]];
      points.push_back(a + u * (mesh_->vertices[t[1]] - a) + v * (mesh_->vertices[t[2]] - a));
    }
    return points;
  }

 private:
  struct Plane {
    Vec3 normal;
    double offset = 0.0;
  };
  static std::vector<Plane> planesOf(const TriMesh& mesh) {
    std::vector<Plane> planes;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 normal = areaNormal(mesh.vertices, t);
      if (!(normal.norm() > 1e-14)) continue;
      planes.push_back({normal.normalized(), normal.normalized().dot(mesh.vertices[t[0]])});
    }
    return planes;
  }
  /// The largest distance beyond a plane; or any number from `below` on if it is at least that.
  static double beyond(std::span<const Plane> planes, const Vec3& p, double below) {
    double most = -kInfinity;
    for (std::size_t i = 0; i < planes.size() && most < below; ++i) {
      most = std::max(most, planes[i].normal.dot(p) - planes[i].offset);
    }
    return most;
  }

  const TriMesh* mesh_;
  std::vector<Plane> planes_;
  std::vector<Plane> core_;  ///< of a hull of few vertices inside
  Aabb box_;
  TriangleTree tree_;
};

class Round {
 public:
  explicit Round(const RigidCollider& collider) : capsule_(collider.capsule) {}
  [[nodiscard]] double outside(const Vec3& p, double) const { return capsule_.outside(p); }
  [[nodiscard]] std::vector<Vec3> samples(std::uint64_t seed) const {
    RandomNumbers random(seed);
    const Vec3 along = capsule_.to - capsule_.from;
    const double length = along.norm();
    const Vec3 axis = length > 0.0 ? Vec3(along / length) : Vec3(Vec3::UnitY());
    const Quat turn = rotationBetween(Vec3::UnitY(), axis);
    const double r = capsule_.radius;
    std::vector<Vec3> points;
    for (int i = 0; i < kSamples; ++i) {
      // A band of a ball has the area of the cylinder around it: so heights are even from pole to pole.
      const double height = (length + 2.0 * r) * (i + 0.5) / kSamples - r;
      const double angle = 2.0 * std::numbers::pi * random.unit();
      const double beyond = height < 0.0 ? height : std::max(0.0, height - length);
      const double across = std::sqrt(std::max(0.0, r * r - beyond * beyond));
      points.push_back(capsule_.from + turn * Vec3(across * std::cos(angle), height, across * std::sin(angle)));
    }
    return points;
  }

 private:
  Capsule capsule_;
};

/// One pose: the skin, its tree, and where colliders are.
struct PosedSkin {
  std::vector<Vec3> vertices;
  std::span<const Triangle> triangles;
  std::vector<Affine3> modelFromWorld;  // of each joint
};

struct OnePose {
  double worstOut = 0.0, worstStandOff = 0.0, sumStandOff = 0.0;
  std::size_t out = 0, samples = 0;
};

template <typename Shape>
OnePose measurePose(std::span<const RigidCollider> colliders, const std::vector<Shape>& shapes,
                    const std::vector<std::vector<Vec3>>& samples, std::span<const bool> isSkin, const PosedSkin& skin,
                    const TriangleTree& tree, std::span<const Affine3> worldFromModel) {
  OnePose pose;
  std::size_t last = 0;  // the collider that held the point before this one
  const auto outsideAll = [&](const Vec3& p, std::size_t except) {
    double least = kInfinity;
    for (std::size_t i = 0; i < shapes.size() && least > 0.0; ++i) {
      const std::size_t c = (last + i) % shapes.size();
      if (c == except) continue;
      least = std::min(least, shapes[c].outside(skin.modelFromWorld[colliders[c].joint] * p, least));
      if (least <= 0.0) last = c;
    }
    return least;
  };
  for (std::size_t v = 0; v < skin.vertices.size(); ++v) {
    if (!isSkin[v]) continue;
    const double outside = outsideAll(skin.vertices[v], shapes.size());
    if (outside <= kInside) continue;
    pose.worstOut = std::max(pose.worstOut, outside);
    if (outside > kVisible) ++pose.out;
  }
  for (std::size_t c = 0; c < shapes.size(); ++c) {
    for (const Vec3& sample : samples[c]) {
      const Vec3 p = worldFromModel[colliders[c].joint] * sample;
      if (outsideAll(p, c) < 0.0) continue;
      ++pose.samples;
      const TriangleTree::Hit hit = tree.nearest(p);
      const std::array<Vec3, 3>& t = tree.corners(hit);
      const Vec3 nearest = hit.shares.x() * t[0] + hit.shares.y() * t[1] + hit.shares.z() * t[2];
      if ((t[1] - t[0]).cross(t[2] - t[0]).dot(p - nearest) <= 0.0) continue;  // inside the skin
      pose.worstStandOff = std::max(pose.worstStandOff, hit.distance);
      pose.sumStandOff += hit.distance;
    }
  }
  return pose;
}

ColliderFit sumOf(std::span<const OnePose> poses, std::size_t vertexCount) {
  ColliderFit fit;
  std::size_t out = 0;
  std::size_t samples = 0;
  double sum = 0.0;
  for (const OnePose& pose : poses) {
    fit.worstOut = std::max(fit.worstOut, pose.worstOut);
    fit.meanWorstOut += pose.worstOut / poses.size();
    fit.worstStandOff = std::max(fit.worstStandOff, pose.worstStandOff);
    sum += pose.sumStandOff;
    out += pose.out;
    samples += pose.samples;
  }
  if (samples > 0) fit.meanStandOff = sum / samples;
  fit.shareOut = out / static_cast<double>(std::max<std::size_t>(1, poses.size() * vertexCount));
  return fit;
}

template <typename Shape>
void prepare(std::span<const RigidCollider> colliders, std::vector<Shape>& shapes,
             std::vector<std::vector<Vec3>>& samples) {
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    shapes.emplace_back(colliders[c]);
    samples.push_back(shapes.back().samples(c));
  }
}

}  // namespace

Result<ColliderFits> measureFit(const Character& character, std::span<const RigidCollider> colliders,
                                BonePoseView poses, int threads,
                                const std::function<bool(int done, int poses)>& progress) {
  const std::span<const Triangle> triangles =
      character.shown.empty() ? std::span(character.mesh.triangles) : std::span(character.shown);
  const std::size_t count = character.mesh.vertices.size();
  Decomposition undivided;
  undivided.vertexCount = countOf(character.mesh.vertices);
  const std::vector<PointIndex> first = firstAlike(liftPoints(character, undivided));
  const auto isSkin = std::make_unique<bool[]>(count);
  for (const Triangle& t : triangles) {
    for (const VertexIndex v : t) isSkin[first[v]] = true;
  }
  std::vector<Hull> hulls;
  std::vector<Round> rounds;
  std::vector<std::vector<Vec3>> ofHulls, ofRounds;
  prepare(colliders, hulls, ofHulls);
  prepare(colliders, rounds, ofRounds);

  const std::size_t poseCount = poses.poseCount();
  std::vector<OnePose> hullPoses(poseCount), roundPoses(poseCount);
  const bool finished = inParallel(poseCount, threads, progress, [&](std::size_t k) {
    const std::span<const Affine3> worldFromModel = poses.pose(k);
    PosedSkin skin{std::vector<Vec3>(count), triangles, {}};
    skinLinearBlend(character, worldFromModel, skin.vertices);
    for (const Affine3& transform : worldFromModel) skin.modelFromWorld.push_back(transform.inverse());
    const TriangleTree tree(skin.vertices, triangles);
    const std::span<const bool> isShown(isSkin.get(), count);
    hullPoses[k] = measurePose(colliders, hulls, ofHulls, isShown, skin, tree, worldFromModel);
    roundPoses[k] = measurePose(colliders, rounds, ofRounds, isShown, skin, tree, worldFromModel);
  });
  if (!finished) return cancelled();
  const std::size_t shown = std::count(isSkin.get(), isSkin.get() + count, true);
  ColliderFits fits{sumOf(hullPoses, shown), sumOf(roundPoses, shown)};
  for (const RigidCollider& collider : colliders) {
    fits.hulls.volume += collider.volume;
    fits.capsules.volume += collider.capsule.volume();
  }
  return fits;
}

}  // namespace lorica
