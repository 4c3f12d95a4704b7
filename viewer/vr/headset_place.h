#pragma once

#include "viewer/renderer/scene.h"
#include "viewer/vr/headset.h"

#include <optional>

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
  /// The eyes are those of an avatar that follows the wearer. While it stands still, since no image shows them, they go
  /// on.
  /// @param followed  world from stage, for what follows the wearer
  /// @param known  where the wearer's head was for it, in the world
  /// @param head  of the avatar, which differs by its proportions
  void along(const Isometry3& followed, const Vec3& known, const Vec3& head);
  /// Another avatar, or another registration.
  void forgetAvatar() { avatar_.reset(); }
  /// The head comes to a point in the world and keeps its direction.
  void inside(const Isometry3& stageFromHead, const Vec3& eye);
  /// The wearer moves along the floor. @param stick  to the right of and along where they look, 1 = kWalk
  void walk(const Isometry3& stageFromHead, const Eigen::Vector2d& stick, double seconds);
  /// The wearer turns around themselves. @param angle  to the left [rad]
  void turn(const Isometry3& stageFromHead, double angle);

  static constexpr double kWalk = 1.4;  ///< [m/s]

 private:
  void keepHead(const Isometry3& stageFromHead, const Vec3& head);

  struct Avatar {
    Vec3 head, off;
  };
  Isometry3 worldFromStage_ = Isometry3::Identity();
  std::optional<Avatar> avatar_;  // that was followed last
};

}  // namespace lorica
