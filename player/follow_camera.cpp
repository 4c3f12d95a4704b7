#include "player/follow_camera.h"

#include "geometry/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace lorica {
namespace {

constexpr double kFollowSeconds = 0.6;  // time constant of the camera
constexpr double kDistance = 2.29;      // in heights of the character
constexpr double kTargetHeight = 0.54;  // of the character's height: the middle of a standing body
constexpr double kSpread = 0.5;         // how much farther the camera goes for avatars apart
constexpr double kBelow = 0.12;         // of the height: what is as far below the floor is still in the picture
constexpr double kAbove = 1.22;         // of the height: what is as high is still in the picture
constexpr double kLow = 0.45;           // of the height: a body that is less high at first does not stand
constexpr double kWide = 2.2;           // of the height: a wider body is not in the picture
constexpr double kWidthShown = 0.9;     // height of a frame for a body of width 1
constexpr double kWideEnough = 1.0;     // width / height of a picture below which the camera steps back
constexpr double kFarthest = 1e4;       // maximum distance of a position from the origin [m]

Vec3 directionOf(const std::string& preset) {
  // A character faces +Z; its right hand is at -X.
  if (preset == "front") return Vec3(0.0, 0.10, 1.0).normalized();
  if (preset == "side") return Vec3(-1.0, 0.10, 0.0).normalized();
  if (preset == "top") return Vec3::UnitY();
  return kViewDirection;
}

Vec3 centerOf(std::span<const LivePart> parts) {
  Vec3 center = Vec3::Zero();
  for (const LivePart& part : parts) center += part.worldFromPart.translation();
  return center / parts.size();
}

Aabb boundsOf(std::span<const LivePart> parts) {
  Aabb box;
  for (const LivePart& part : parts) {
    for (const Vec3& p : part.shape.vertices) box.extend(part.worldFromPart * p);
  }
  return box;
}

}  // namespace

std::optional<Vec3> positionOf(std::string_view text) {
  Vec3 position;
  const char* at = text.data();
  const char* end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return std::nullopt;
    const auto [stopped, error] = std::from_chars(at, end, position[i]);
    if (error != std::errc() || !(std::abs(position[i]) <= kFarthest)) return std::nullopt;
    at = stopped;
  }
  if (at != end) return std::nullopt;
  return position;
}

Result<FollowCamera> FollowCamera::create(const CameraOptions& options, int width, int height) {
  if (options.eye.empty()) {
    const double aspect = static_cast<double>(width) / height;
    return FollowCamera(kDistance * std::max(1.0, kWideEnough / aspect), directionOf(options.preset));
  }
  const std::optional<Vec3> eye = positionOf(options.eye);
  const std::optional<Vec3> target = positionOf(options.target);
  if (!eye || !target || (*eye - *target).norm() < 1e-3) {
    return invalidArgument("--eye {} --target {}: expected two positions at least 1 mm apart", options.eye,
                           options.target);
  }
  Camera camera;
  camera.eye = *eye;
  camera.target = *target;
  return FollowCamera(camera);
}

void FollowCamera::update(const Session& session, double seconds) {
  if (fixed_) return;
  Aabb box;     // of the centres of those who are there
  Aabb bodies;  // of all their points
  double height = 0.0;
  double width = 0.0;
  for (const SessionAvatar& avatar : session.avatars()) {
    if (!avatar.present()) continue;
    box.extend(centerOf(avatar.body().parts()));
    const Aabb body = boundsOf(avatar.body().parts());
    bodies.extend(body.min);
    bodies.extend(body.max);
    width = std::max({width, body.max.x() - body.min.x(), body.max.z() - body.min.z()});
    height = std::max(height, avatar.character().height);
  }
  if (box.empty()) return;
  const double step = started_ ? 1.0 - std::exp(-seconds / kFollowSeconds) : 1.0;
  double low = 0.0;
  const bool shown = bodies.min.y() >= -kBelow * height && bodies.max.y() <= kAbove * height && width <= kWide * height;
  const bool stands = started_ || bodies.max.y() - bodies.min.y() >= kLow * height;
  if (own_ || !shown || !stands) {
    if (!own_) {
      own_.emplace();
      framed_ = height;
      if (started_) {  // it stood until now
        own_->extend(Vec3::Zero());
        own_->extend(Vec3(0.0, height, 0.0));
      }
    }
    own_->extend(Vec3(0.0, bodies.min.y(), 0.0));
    own_->extend(Vec3(width, bodies.max.y(), 0.0));
    framed_ += step * (std::max(own_->max.y() - own_->min.y(), kWidthShown * own_->max.x()) - framed_);
    low = own_->center().y() - 0.5 * framed_;
    height = framed_;
  }
  Vec3 wanted = box.center();
  wanted.y() = low + kTargetHeight * height;
  height_ = height + kSpread * Vec3(box.max.x() - box.min.x(), 0.0, box.max.z() - box.min.z()).norm();
  target_ += step * (wanted - target_);
  started_ = true;
}

Camera FollowCamera::camera() const {
  if (fixed_) return *fixed_;
  Camera camera;
  camera.target = target_;
  camera.eye = target_ + heights_ * height_ * direction_;
  return camera;
}

}  // namespace lorica
