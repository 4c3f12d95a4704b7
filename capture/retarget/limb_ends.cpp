#include "capture/retarget/limb_ends.h"

#include "skinning/linear_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr double kShortest = 1e-3;  // [m]

Vec3 middleOf(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

double farthestAlong(std::span<const Vec3> points, const Vec3& from, const Vec3& along) {
  double farthest = 0.0;
  for (const Vec3& p : points) farthest = std::max(farthest, (p - from).dot(along));
  return farthest;
}

}  // namespace

RestMesh::RestMesh(const Character& character)
    : point_(character.mesh.vertices.size()),
      follows_(character.mesh.vertices.size(), kNoJoint),
      carries_(static_cast<std::size_t>(character.skeleton.jointCount()), false) {
  std::vector<Affine3> world(carries_.size());
  computeWorldFromJoint(character.skeleton, restPose(character.skeleton), world);
  computeWorldFromModel(character, world, world);
  skinLinearBlend(character, world, point_);
  for (std::size_t v = 0; v < point_.size(); ++v) {
    double max = 0.0;
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      if (character.influences[i].weight <= max) continue;
      max = character.influences[i].weight;
      follows_[v] = character.influences[i].joint;
    }
    if (follows_[v] != kNoJoint) carries_[follows_[v]] = true;
  }
}

std::vector<Vec3> RestMesh::pointsOf(const std::vector<bool>& marked) const {
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < point_.size(); ++v) {
    if (follows_[v] != kNoJoint && marked[follows_[v]]) points.push_back(point_[v]);
  }
  return points;
}

bool RestMesh::carriesVertices(JointIndex joint) const {
  return carries_[joint];
}

std::optional<Vec3> armEnd(std::span<const Vec3> points, const Vec3& lastJoint) {
  if (points.empty()) return std::nullopt;
  const Vec3 along = middleOf(points) - lastJoint;
  if (along.norm() < kShortest) return std::nullopt;
  const Vec3 unit = along.normalized();
  return lastJoint + farthestAlong(points, lastJoint, unit) * unit;
}

std::optional<Vec3> legEnd(std::span<const Vec3> points, const Vec3& lastJoint, double above) {
  constexpr double kAnkleHeight = 0.1;     // fraction of the leg
  constexpr double kMostlyDown = 0.7;      // sine: a standing leg
  constexpr double kShaftAbove = 2.0;      // the foot does not protrude higher than this above the sole, in ankle
                                           // heights
  constexpr double kShortestShaft = 0.05;  // fraction of the distance to the sole
  if (points.empty()) return std::nullopt;
  Vec3 along = middleOf(points) - lastJoint;
  if (along.norm() < kShortest) return std::nullopt;
  along.normalize();
  if (along.y() < -kMostlyDown) along = -Vec3::UnitY();
  const double toSole = farthestAlong(points, lastJoint, along);
  const double ankle = std::min(kAnkleHeight * (above + toSole), 0.5 * toSole);

  std::vector<Vec3> shaft;
  for (const Vec3& p : points) {
    if ((p - lastJoint).dot(along) < toSole - kShaftAbove * ankle) shaft.push_back(p);
  }
  Vec3 direction = along;
  if (!shaft.empty()) {
    const Vec3 middle = middleOf(shaft) - lastJoint;
    const double down = middle.dot(along);
    if (down > kShortestShaft * toSole && down > kMostlyDown * middle.norm()) direction = middle / down;
  }
  return lastJoint + (toSole - ankle) * direction;
}

std::vector<Vec3> solePoints(std::span<const Vec3> points) {
  std::vector<Vec3> sole;
  if (points.empty()) return sole;
  std::vector<std::size_t> chosen;
  const auto choose = [&](double tilt, double azimuth) {
    const Vec3 down(std::sin(tilt) * std::cos(azimuth), -std::cos(tilt), std::sin(tilt) * std::sin(azimuth));
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (points[i].dot(down) > points[best].dot(down)) best = i;
    }
    if (std::find(chosen.begin(), chosen.end(), best) == chosen.end()) chosen.push_back(best);
  };
  constexpr int kAzimuths = 8;
  choose(0.0, 0.0);
  for (const double tilt : {0.15, 0.4, 0.8}) {
    for (int a = 0; a < kAzimuths; ++a) choose(tilt, 2.0 * std::numbers::pi * a / kAzimuths);
  }
  sole.reserve(chosen.size());
  for (const std::size_t i : chosen) sole.push_back(points[i]);
  return sole;
}

}  // namespace lorica
