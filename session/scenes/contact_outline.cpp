#include "session/scenes/contact_outline.h"

#include "collision/live/hull_distance.h"
#include "collision/live/lifted_point.h"
#include "geometry/counts.h"
#include "session/contact_events.h"
#include "session/scenes/hit_counter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lorica {
namespace {

constexpr double kFootSeconds = 0.033;  // over which a foot's speed is taken: one frame at 30 Hz
constexpr double kMeet = 1e-6;          // nearer hulls have no direction to speak of: they meet [m]
constexpr int kSides = 32;              // of a cylinder

/// Of two things whose hulls meet, by so little that no query has found it.
Meeting touching(const Aabb& first, const Aabb& second) {
  const Vec3 between = second.center() - first.center();
  const Vec3 middle = 0.5 * (first.min.cwiseMax(second.min) + first.max.cwiseMin(second.max));
  return {0.0, middle, between.norm() > 0.0 ? Vec3(between.normalized()) : Vec3(Vec3::UnitX())};
}

void addCorners(const Prop& prop, std::vector<Vec3>& points) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    points.emplace_back(prop.worldFromProp * signs.cwiseProduct(prop.halfExtents));
  }
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

/// @param hull  index of the piece of a mesh; 0 for other shapes
void PropMeetings::setPiece(const Prop& prop, std::size_t hull) {
  const Vec3& half = prop.halfExtents;
  piece_.points.clear();
  piece_.radius = 0.0;
  switch (prop.shape) {
    case PropShape::kBox:
      addCorners(prop, piece_.points);
      break;
    case PropShape::kSphere:
      piece_.radius = half.x();
      piece_.points.emplace_back(prop.worldFromProp.translation());
      break;
    case PropShape::kCapsule:
      piece_.radius = half.x();
      for (const double end : {-1.0, 1.0}) {
        piece_.points.emplace_back(prop.worldFromProp * Vec3(0.0, end * (half.y() - half.x()), 0.0));
      }
      break;
    case PropShape::kCylinder:
      for (int i = 0; i < kSides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kSides;
        const Vec3 rim(half.x() * std::cos(angle), half.y(), half.x() * std::sin(angle));
        piece_.points.emplace_back(prop.worldFromProp * rim);
        piece_.points.emplace_back(prop.worldFromProp * rim.cwiseProduct(Vec3(1.0, -1.0, 1.0)));
      }
      break;
    case PropShape::kMesh:
      for (const Vec3& v : prop.mesh->hulls[hull].vertices) piece_.points.emplace_back(prop.worldFromProp * v);
      break;
  }
  piece_.box = boundsOf(piece_.points);
  piece_.box.min.array() -= piece_.radius;
  piece_.box.max.array() += piece_.radius;
}

/// Measures a prop against the parts of an avatar that are near it.
void PropMeetings::findProp(int index, const Prop& prop, int avatar, ContactOutline& outline) {
  const std::size_t pieces = prop.shape == PropShape::kMesh ? prop.mesh->hulls.size() : 1;
  for (std::size_t hull = 0; hull < pieces; ++hull) {
    setPiece(prop, hull);
    const auto begin = static_cast<std::ptrdiff_t>(found_.size());
    bool deep = false;
    for (std::size_t p = 0; p < outline.parts.size(); ++p) {
      if (outline.parts[p].shape.degenerate()) continue;
      const std::optional<Meeting> meeting =
          measured(outline.pointsOf(p), outline.boxes[p], piece_.points, piece_.box, piece_.radius, reach_);
      if (!meeting) continue;
      deep = deep || meeting->depth == 0.0;
      found_.push_back({avatar, static_cast<int>(p), index, *meeting});
    }
    if (!deep) continue;
    for (const ShapeContact& contact : outline.query.find(outline.parts, {piece_.points, piece_.radius})) {
      const auto found = std::find_if(found_.begin() + begin, found_.end(),
                                      [&](const PropMeeting& one) { return one.part == contact.part; });
      if (found != found_.end()) found->meeting = {contact.depth, contact.position, contact.direction};
    }
  }
}

std::span<const PropMeeting> PropMeetings::find(const Session& session, std::span<ContactOutline> outlines) {
  found_.clear();
  const std::span<const Prop> props = session.world().props();
  for (int index = 0; index < countOf(props); ++index) {
    const Prop& prop = props[index];
    const Vec3 middle = prop.worldFromProp.translation(), extent = Vec3::Constant(boundingRadius(prop));
    const Aabb around{middle - extent, middle + extent};
    for (int a = 0; a < countOf(outlines); ++a) {
      if (outlines[a].box.empty() || apart(outlines[a].box, around, reach_)) continue;
      findProp(index, prop, a, outlines[a]);
    }
  }
  for (const Contact& contact : session.world().contacts()) {
    found_.push_back(
        {contact.avatar, contact.part, contact.prop, {contact.depth, contact.point, contact.normal}, contact.impulse});
  }
  std::ranges::sort(found_, [](const PropMeeting& a, const PropMeeting& b) {
    return std::tuple(a.key(), -a.meeting.depth) < std::tuple(b.key(), -b.meeting.depth);
  });
  std::size_t kept = 0;
  for (const PropMeeting& one : found_) {
    if (kept > 0 && found_[kept - 1].key() == one.key()) {
      found_[kept - 1].impulse += one.impulse;
    } else {
      found_[kept++] = one;
    }
  }
  return std::span(found_).first(kept);
}

}  // namespace lorica
