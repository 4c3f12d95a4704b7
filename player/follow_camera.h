#pragma once

#include "geometry/result.h"
#include "session/session.h"
#include "viewer/renderer/scene.h"

#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// --camera, --eye and --target: the camera of pictures.
struct CameraOptions {
  std::string preset;  ///< front, side, top or three-quarter; follows the body; empty = three-quarter
  std::string eye;     ///< "x,y,z" in the world [m]; used with `target`, instead of a preset
  std::string target;
};

/// Parses a position such as "1.5,1,-3"; none for any other text.
[[nodiscard]] std::optional<Vec3> positionOf(std::string_view text);

/// Unit vector from the body to the camera: on the right, slightly in front and above, so that a kick is visible.
inline const Vec3 kViewDirection = Vec3(-0.80, 0.17, 0.575).normalized();

/// A fixed camera, or one that follows moving bodies: it tracks the centre of their parts smoothly, at constant height
/// and distance. These suit a body that stands, of the file's height. A body that is not so, such as half a body, or
/// that leaves the picture, is framed as it is; the frame then grows, and never shrinks.
class FollowCamera {
 public:
  /// @param heights    distance from the body, in heights of the character
  /// @param direction  from the body to the camera, unit
  explicit FollowCamera(double heights, const Vec3& direction = kViewDirection)
      : heights_(heights), direction_(direction) {}
  explicit FollowCamera(const Camera& fixed) : fixed_(fixed) {}

  /// The requested camera, at a distance that suits the aspect ratio of the picture.
  /// @return the camera, or an error about the options
  static Result<FollowCamera> create(const CameraOptions& options, int width, int height);

  /// @param seconds  since the previous frame [s]
  void update(const Session& session, double seconds);
  [[nodiscard]] Camera camera() const;

 private:
  double heights_ = 1.0;
  Vec3 direction_ = kViewDirection;
  std::optional<Camera> fixed_;
  double height_ = 0.0;      // of what is framed, with the distance between avatars [m]
  std::optional<Aabb> own_;  // of bodies that are framed as they are: x from 0 to their width, y as far as they reached
  double framed_ = 0.0;      // height of their frame [m]
  Vec3 target_ = Vec3::Zero();
  bool started_ = false;
};

}  // namespace lorica
