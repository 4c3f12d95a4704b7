#include "viewer/vr/headset_place.h"

#include <cmath>

namespace lorica {
namespace {

constexpr double kTargetAhead = 2.5;  // of the eye, where the camera's target is; it limits what is drawn [m]

/// Where a frame's -Z points along the floor: its angle from -Z around Y.
double headingOf(const Vec3& forward) {
  return std::atan2(-forward.x(), -forward.z());
}

}  // namespace

Camera cameraOf(const Isometry3& worldFromEye, const EyeAngles& angles, double nearest) {
  const double left = std::tan(angles.left), right = std::tan(angles.right);
  const double up = std::tan(angles.up), down = std::tan(angles.down);
  Camera camera;
  camera.eye = worldFromEye.translation();
  camera.target = worldFromEye * Vec3(0.0, 0.0, -kTargetAhead);
  camera.up = worldFromEye.linear().col(1);
  camera.verticalFov = 2.0 * std::atan(0.5 * (up - down));
  camera.aspect = (right - left) / (up - down);
  camera.targetAt = {-(right + left) / (right - left), -(up + down) / (up - down)};
  camera.nearest = nearest;
  return camera;
}

/// Moves the stage so that the head is at a point of the world, along the floor.
void HeadsetPlace::keepHead(const Isometry3& stageFromHead, const Vec3& head) {
  const Vec3 away = head - worldFromStage_ * stageFromHead.translation();
  worldFromStage_.translation() += Vec3(away.x(), 0.0, away.z());
}

void HeadsetPlace::stand(const Isometry3& stageFromHead, const Vec3& place, const Vec3& forward) {
  const double heading = headingOf(forward) - headingOf(-stageFromHead.linear().col(2));
  worldFromStage_ = Eigen::AngleAxisd(heading, Vec3::UnitY());
  keepHead(stageFromHead, place);
}

void HeadsetPlace::inside(const Isometry3& stageFromHead, const Vec3& eye) {
  worldFromStage_.translation() += eye - worldFromStage_ * stageFromHead.translation();
}

void HeadsetPlace::along(const Isometry3& followed, const Vec3& known, const Vec3& head) {
  if (!avatar_ || avatar_->head != head) avatar_ = Avatar{head, head - known};
  worldFromStage_ = Eigen::Translation3d(avatar_->off) * followed;
}

void HeadsetPlace::walk(const Isometry3& stageFromHead, const Eigen::Vector2d& stick, double seconds) {
  const Mat3 along =
      Eigen::AngleAxisd(headingOf(worldFromStage_.linear() * -stageFromHead.linear().col(2)), Vec3::UnitY())
          .toRotationMatrix();
  worldFromStage_.translation() += kWalk * seconds * (along * Vec3(stick.x(), 0.0, -stick.y()));
}

void HeadsetPlace::turn(const Isometry3& stageFromHead, double angle) {
  const Vec3 head = worldFromStage_ * stageFromHead.translation();
  worldFromStage_ = Isometry3(Eigen::AngleAxisd(angle, Vec3::UnitY())) * worldFromStage_;
  keepHead(stageFromHead, head);
}

}  // namespace lorica
