#include "viewer/player/follow_camera.h"

#include "collision/live/ray_query.h"
#include "geometry/counts.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

constexpr double kBeside = 35.0 * std::numbers::pi / 180.0, kAbove = 0.17;  // of the usual view [rad]
constexpr double kDistance = 2.6;                                           // in sizes of the avatars
constexpr double kNear = 4.0;     // of what a scene is about, from the target [m]
constexpr double kHighest = 2.0;  // what is above waits to fall [m]
constexpr double kMaxBack = 1.5;  // the camera moves back at most to this many times its distance
constexpr double kAcross = 1.05;  // half the free width of a picture per half of its height: 16:9 without panels
constexpr double kUpward = 0.85;  // of half its height, above the transport

constexpr double kFollowSeconds = 0.6;  // time constant of the camera
constexpr double kFilled = 0.74;        // of the picture, by the body in the first one
constexpr double kMostFilled = 0.95;    // of the picture, by a body that moves
constexpr double kClose = 0.9;          // of the picture, by a portrait and by a body from above
constexpr double kChin = 0.3;           // of the height of a head, which may have a hat: the lowest part
constexpr double kFaceHeight = 1.9;     // of the width of the chin
constexpr double kShoulders = 0.5;      // of the height of the face: what a portrait shows below it
constexpr double kLongLens = 0.3;       // angle of view where near things would look too large [rad]
constexpr double kEyeLevel = 0.1;       // of a camera at the side [rad]

constexpr std::array<HumanBone, 2> kLookingBones = {HumanBone::kHead, HumanBone::kHips};

/// The face in the bind pose: what moves with the head, without a hat. Its width is that of the lowest part.
Aabb faceOf(const Character& character, JointIndex head) {
  std::vector<bool> above(character.skeleton.jointCount(), false);
  for (JointIndex j = head; j < character.skeleton.jointCount(); ++j) {
    const JointIndex parent = character.skeleton.joint(j).parent;
    above[j] = j == head || (parent != kNoJoint && above[parent]);
  }
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    double weight = 0.0;
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      if (above[character.influences[i].joint]) weight += character.influences[i].weight;
    }
    if (weight > 0.5) points.push_back(character.mesh.vertices[v]);
  }
  const Aabb all = boundsOf(points);
  std::erase_if(points, [&](const Vec3& p) { return p.y() > all.min.y() + kChin * (all.max.y() - all.min.y()); });
  Aabb face = boundsOf(points);
  face.max.y() = std::min(all.max.y(), face.min.y() + kFaceHeight * (face.max.x() - face.min.x()));
  return face;
}

constexpr double kFocusSeconds = 0.3;  // in which the focus makes up for most of a step [s]
constexpr double kRiseSeconds = 1.5;   // the same of its height: arms that go up and down do not move it [s]
constexpr double kUpright = 0.5;       // horizontal share of a direction that faces somewhere

/// Calls visit(const LivePart&) for each part of an avatar or of all: -1.
void eachPart(const Session& session, int avatar, const auto& visit) {
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    if (avatar >= 0 && avatar != a) continue;
    for (const LivePart& part : session.avatars()[a].partsInWorld()) visit(part);
  }
}

/// The middle of the avatars' parts.
std::optional<Vec3> middleOf(const Session& session, int avatar) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  eachPart(session, avatar, [&](const LivePart& part) {
    sum += part.worldFromPart.translation();
    ++count;
  });
  if (count == 0) return std::nullopt;
  return Vec3(sum / count);
}

}  // namespace

void AvatarFocus::update(const Session& session) {
  std::optional<Vec3> middle = middleOf(session, avatar_);
  const double seconds = session.time() - std::exchange(time_, session.time());
  if (!middle) return;
  const double share = position_ && seconds > 0.0 ? 1.0 - std::exp(-seconds / kFocusSeconds) : 1.0;
  const double rise = position_ && seconds > 0.0 ? 1.0 - std::exp(-seconds / kRiseSeconds) : 1.0;
  if (const std::optional<Aabb> box = bounds(session)) middle->y() = box->center().y();
  if (!position_) position_ = middle;
  *position_ += Vec3(share, rise, share).cwiseProduct(*middle - *position_);
}

std::optional<Aabb> boundsOf(const Session& session, int avatar) {
  Aabb box;
  eachPart(session, avatar, [&](const LivePart& part) {
    for (const Vec3& vertex : part.shape.vertices) box.extend(part.worldFromPart * vertex);
  });
  if (box.empty()) return std::nullopt;
  return box;
}

double facingOf(const SessionAvatar& avatar, std::span<const HumanBone> bones) {
  const Character& character = avatar.character();
  for (const HumanBone bone : bones) {
    const JointIndex joint = character.skeleton.jointOf(bone);
    if (joint == kNoJoint) continue;
    const Affine3 worldFromModel = avatar.worldFromJoint()[joint] * character.jointFromModel[joint];
    const Vec3 to = worldFromModel.linear().col(2);  // a character in its bind pose faces +Z
    if (std::hypot(to.x(), to.z()) > kUpright * to.norm()) return std::atan2(to.x(), to.z());
  }
  return 0.0;
}

int avatarAt(const Session& session, const Ray& ray) {
  std::vector<std::span<const LivePart>> bodies;
  for (const SessionAvatar& avatar : session.avatars()) bodies.push_back(avatar.partsInWorld());
  RayQuery query;
  query.update(bodies);
  return query.nearest({ray.origin, ray.direction}).body;
}

std::vector<std::string> avatarNames(const Session& session) {
  std::vector<std::string> names;
  for (const SessionAvatar& avatar : session.avatars()) {
    names.push_back(fmt::format("{} {}", names.size() + 1, avatar.character().name));
  }
  return names;
}

Vec3 usualDirection(double facing) {
  return directionAt(facing - kBeside, kAbove);
}

Camera windowCamera(const Aabb& avatars, double facing, const World& world) {
  Camera camera;
  camera.target = avatars.center();
  const double size = std::max(avatars.max.y() - avatars.min.y(), 0.5 * avatars.diagonal()), usual = kDistance * size;
  const Vec3 direction = usualDirection(facing);
  camera.eye = camera.target + usual * direction;
  const ViewAxes axes = axesOf(camera);
  const double half = std::tan(0.5 * camera.verticalFov);
  double distance = usual;
  for (const Prop& prop : world.props()) {
    const Vec3 from = prop.worldFromProp.translation() - camera.target;
    const bool part = prop.mass > 0.0 && from.norm() <= kNear && prop.worldFromProp.translation().y() <= kHighest;
    if (!part) continue;
    const double reach = prop.halfExtents.norm();
    const double needed = std::max((std::abs(from.dot(axes.right)) + reach) / (half * kAcross),
                                   (std::abs(from.dot(axes.up)) + reach) / (half * kUpward));
    distance = std::max(distance, needed - from.dot(axes.forward));
  }
  camera.eye = camera.target + std::min(distance, kMaxBack * usual) * direction;
  return camera;
}

FollowCamera::FollowCamera(const CameraOptions& options, double aspect) : preset_(options.preset), aspect_(aspect) {
  if (options.eye && options.target) fixed_ = Camera{*options.eye, *options.target};
}

/// Points of what is framed: of all bodies, or the head and shoulders of the first.
void FollowCamera::findPoints(const Session& session) {
  points_.clear();
  const Character& character = session.character();
  const JointIndex head = character.skeleton.jointOf(HumanBone::kHead);
  if (preset_ == "face" && head != kNoJoint && session.avatar().present()) {
    if (!face_) face_ = faceOf(character, head);
    const Affine3 worldFromModel = session.worldFromJoint()[head] * character.jointFromModel[head];
    const double shoulders = kShoulders * (face_->max.y() - face_->min.y());
    if (!face_->empty()) {
      for (const Vec3& corner : cornersOf(*face_)) points_.push_back(worldFromModel * corner);
      points_.push_back(boundsOf(points_).center());
      points_.back().y() = boundsOf(points_).min.y() - shoulders;
      return;
    }
  }
  for (const SessionAvatar& avatar : session.avatars()) {
    for (const LivePart& part : avatar.partsInWorld()) {
      for (const Vec3& vertex : part.shape.vertices) points_.push_back(part.worldFromPart * vertex);
    }
  }
}

void FollowCamera::aim(const Session& session) {
  const SessionAvatar& first = session.avatar();
  const double facing = facingOf(first), quarter = 0.5 * std::numbers::pi;
  if (preset_ == "face" || preset_ == "top") fov_ = kLongLens;
  direction_ = preset_ == "front"  ? directionAt(facing, kEyeLevel)
               : preset_ == "side" ? directionAt(facing - quarter, kEyeLevel)
               : preset_ == "back" ? directionAt(facing + 2.0 * quarter, kEyeLevel)
               : preset_ == "face" ? directionAt(facingOf(first, kLookingBones), kEyeLevel)
               : preset_ == "top"  ? Vec3(Vec3::UnitY())
                                   : usualDirection(facing);
}

void FollowCamera::update(const Session& session, double seconds) {
  if (fixed_) return;
  findPoints(session);
  if (points_.empty()) return;
  if (!direction_) aim(session);
  const ViewAxes axes = axesOf(Camera{*direction_, Vec3::Zero()});
  Aabb seen;  // to the right, up and away
  for (const Vec3& p : points_) seen.extend(Vec3(p.dot(axes.right), p.dot(axes.up), p.dot(axes.forward)));
  const Vec3 middle = seen.center();
  const bool first = distance_ == 0.0;
  const double step = first ? 1.0 : 1.0 - std::exp(-seconds / kFollowSeconds);
  target_ += step * (middle.x() * axes.right + middle.y() * axes.up + middle.z() * axes.forward - target_);
  PictureArea area;
  area.half *= !first ? kMostFilled : fov_ == kLongLens ? kClose : kFilled;
  const auto needed = [&] {
    return distanceToSee(points_, Camera{target_ + *direction_, target_, fov_}, area, aspect_);
  };
  distance_ = std::max(distance_, distance_ + step * (needed() - distance_));
  // What is near looks larger, so the middle of the points is not that of their picture.
  for (int pass = 0; first && pass < 3; ++pass) {
    Aabb picture;
    for (const Vec3& p : points_) {
      const Vec3 from = p - camera().eye;
      picture.extend(Vec3(from.dot(axes.right), from.dot(axes.up), 0.0) / from.dot(axes.forward));
    }
    target_ += distance_ * (picture.center().x() * axes.right + picture.center().y() * axes.up);
    distance_ = needed();
  }
}

Camera FollowCamera::still(const Session& session) {
  const double distance = std::exchange(distance_, 0.0);
  const Vec3 target = target_;
  update(session, 0.0);
  const Camera now = camera();
  distance_ = distance;
  target_ = target;
  return now;
}

Camera FollowCamera::camera() const {
  if (fixed_ || !direction_) return fixed_.value_or(Camera());
  return Camera{target_ + distance_ * *direction_, target_, fov_};
}

}  // namespace lorica
