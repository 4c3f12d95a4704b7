#pragma once

#include "apps/command_line.h"
#include "geometry/result.h"
#include "session/session.h"
#include "viewer/scene.h"

#include <optional>
#include <string>

namespace lorica {

/// --camera, --eye and --target: where pictures are taken from.
struct CameraOptions {
  std::string preset;  ///< front, side, top or three-quarter, following the body; empty = three-quarter
  std::string eye;     ///< "x,y,z" in the world [m]; with `target` instead of a preset
  std::string target;
};

void addCameraOptions(CommandLine& app, CameraOptions& options);

/// From the body to the camera: its right side and a little from the front and above, so that a kick shows. Unit.
inline const Vec3 kViewDirection = Vec3(-0.80, 0.17, 0.575).normalized();

/// A camera that stays where it was put, or that keeps a moving body in the picture: then it follows the middle of its
/// parts, calmly, and stays level.
class FollowCamera {
 public:
  /// @param heights    how far from the body, in heights of the character
  /// @param direction  from the body to the camera, unit
  explicit FollowCamera(double heights, const Vec3& direction = kViewDirection)
      : heights_(heights), direction_(direction) {}
  explicit FollowCamera(const Camera& fixed) : fixed_(fixed) {}

  /// The camera that was asked for; far enough from the body for a picture of these proportions.
  /// @return the camera, or what of the options is not understood
  static Result<FollowCamera> create(const CameraOptions& options, int width, int height);

  /// @param seconds  since the last frame [s]
  void update(const Session& session, double seconds);
  [[nodiscard]] Camera camera() const;

 private:
  double heights_ = 1.0;
  Vec3 direction_ = kViewDirection;
  std::optional<Camera> fixed_;
  double height_ = 0.0;  // of the character [m]
  Vec3 target_ = Vec3::Zero();
  bool started_ = false;
};

}  // namespace lorica
