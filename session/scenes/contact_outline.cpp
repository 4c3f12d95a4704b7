#include "session/scenes/contact_outline.h"

#include "collision/live/hull_distance.h"
#include "collision/live/lifted_point.h"
#include "session/part_masses.h"
#include "session/scenes/hit_counter.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr double kFootSeconds = 0.033;  // over which a foot's speed is taken: one frame at 30 Hz
constexpr double kMeet = 1e-6;          // nearer hulls have no direction to speak of: they meet [m]

/// Of two things whose hulls meet, by so little that no query has found it.
Meeting touching(const Aabb& first, const Aabb& second) {
  const Vec3 between = second.center() - first.center();
  const Vec3 middle = 0.5 * (first.min.cwiseMax(second.min) + first.max.cwiseMin(second.max));
  return {0.0, middle, between.norm() > 0.0 ? Vec3(between.normalized()) : Vec3(Vec3::UnitX())};
}

}  // namespace

std::optional<Meeting> measured(std::span<const Vec3> first, const Aabb& firstBox, std::span<const Vec3> second,
                                const Aabb& secondBox, double radius, double reach) {
  if (apart(firstBox, secondBox, reach)) return std::nullopt;
  const HullGap gap = gapOf(first, second);
  const double distance = gap.distance - radius;
  if (distance > reach) return std::nullopt;
  if (distance <= kMeet) return touching(firstBox, secondBox);
  return Meeting{-distance, gap.onHull + 0.5 * distance * gap.normal, gap.normal};
}

ContactOutline::ContactOutline(const SessionAvatar& avatar)
    : query(avatar.body()), masses(partMasses(avatar.body().decomposition(), avatar.character())) {
  const Skeleton& skeleton = avatar.character().skeleton;
  for (JointIndex joint = 0; joint < skeleton.jointCount(); ++joint) {
    const HitLimb limb = limbOf(skeleton, joint);
    footOf.push_back(limb == HitLimb::kLeftFoot    ? ContactFoot::kLeft
                     : limb == HitLimb::kRightFoot ? ContactFoot::kRight
                                                   : ContactFoot::kNone);
  }
  for (const LiftedPoint& point : liftPoints(avatar.character(), avatar.body().decomposition())) {
    const auto most = std::ranges::max_element(point, {}, &LiftedTerm::weight);
    footOfPoint.push_back(most == point.end() ? ContactFoot::kNone : footOf[most->joint]);
  }
}

void ContactOutline::read(const SessionAvatar& avatar, double now, double since) {
  time_ = now;
  seconds_ = since;
  while (known_ > 1 && time_ - past_[1].time >= kFootSeconds) {
    std::rotate(past_.begin(), past_.begin() + 1, past_.begin() + known_);
    --known_;
  }
  parts = avatar.partsInWorld();
  points.clear();
  first.assign(1, 0);
  boxes.clear();
  box = Aabb();
  for (const LivePart& part : parts) {
    for (const Vec3& v : part.shape.vertices) points.push_back(part.worldFromPart * v);
    boxes.push_back(boundsOf(std::span(points).subspan(first.back())));
    first.push_back(points.size());
    if (boxes.back().empty()) continue;
    box.extend(boxes.back().min);
    box.extend(boxes.back().max);
  }
  if (!box.empty()) lowest = std::min(lowest, box.min.y());
}

void ContactOutline::remember(const SessionAvatar& avatar) {
  if (parts.empty()) {
    known_ = 0;
    return;
  }
  const double since = known_ > 0 ? time_ - past_[known_ - 1].time : kInfinity;
  if (since < kRepeatedFrameSeconds) --known_;
  if (known_ == past_.size()) past_.emplace_back();
  const std::span<const Affine3> now = avatar.worldFromJoint();
  past_[known_].worldFromJoint.assign(now.begin(), now.end());
  past_[known_++].time = time_;
}

const Vec3* ContactOutline::lowestOf(std::size_t part, ContactFoot foot) const {
  const std::span<const Vec3> vertices = pointsOf(part);
  const std::vector<VertexIndex>& vertexOf = parts[part].shape.pointOfVertex;
  const Vec3* least = nullptr;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (footOfPoint[vertexOf[v]] == foot && (least == nullptr || vertices[v].y() < least->y())) least = &vertices[v];
  }
  return least;
}

Vec3 ContactOutline::velocityOf(const SessionAvatar& avatar, std::size_t part, JointIndex bone,
                                const Vec3& point) const {
  if (known_ == 0) return Vec3::Zero();
  if (bone == kNoJoint) return velocityAt(parts[part], point, seconds_);
  const Vec3 inBone = avatar.worldFromJoint()[bone].inverse() * point;
  return (point - past_[known_ - 1].worldFromJoint[bone] * inBone) / seconds_;
}

Vec3 ContactOutline::noiseOf(const SessionAvatar& avatar, JointIndex bone, const Vec3& point) const {
  if (known_ <= 1 || bone == kNoJoint) return Vec3::Zero();
  const Vec3 inBone = avatar.worldFromJoint()[bone].inverse() * point;
  const Bones &oldest = past_.front(), &last = past_[known_ - 1];
  return (point - last.worldFromJoint[bone] * inBone) / seconds_ -
         (point - oldest.worldFromJoint[bone] * inBone) / std::max(time_ - oldest.time, kRepeatedFrameSeconds);
}

}  // namespace lorica
