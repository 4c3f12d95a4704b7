#pragma once

#include "viewer/renderer/scene.h"
#include "viewer/vr/headset.h"

namespace lorica {

/// What an eye sees: the camera's picture is the eye's, edge for edge.
/// @param nearest  see Camera [m]
[[nodiscard]] Camera cameraOf(const Isometry3& worldFromEye, const EyeAngles& angles, double nearest);

/// Where the stage of a headset is in the world. It only turns around Y, and but for inside() its floor is the world's.
class HeadsetPlace {
 public:
  [[nodiscard]] const Isometry3& worldFromStage() const { return worldFromStage_; }
  /// The wearer stands at a place and looks in a direction, both along the floor; their height stays.
  void stand(const Isometry3& stageFromHead, const Vec3& place, const Vec3& forward);
  void set(const Isometry3& worldFromStage) { worldFromStage_ = worldFromStage; }
  /// The head comes to a point in the world and keeps its direction.
  void inside(const Isometry3& stageFromHead, const Vec3& eye);
  /// The wearer moves along the floor. @param stick  to the right of and along where they look, 1 = kWalk
  void walk(const Isometry3& stageFromHead, const Eigen::Vector2d& stick, double seconds);
  /// The wearer turns around themselves. @param angle  to the left [rad]
  void turn(const Isometry3& stageFromHead, double angle);

  static constexpr double kWalk = 1.4;  ///< [m/s]

 private:
  void keepHead(const Isometry3& stageFromHead, const Vec3& head);

  Isometry3 worldFromStage_ = Isometry3::Identity();
};

}  // namespace lorica
