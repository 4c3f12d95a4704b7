#pragma once

#include "geometry/math.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// An avatar that a scene file asks for.
struct AvatarSetting {
  std::string character = "mannequin";  ///< what ships, or a file beneath the scene's folder
  std::string motion;                   ///< the same; empty = the character's own clip
  double start = 0.0;                   ///< time in the motion at which it begins, from its first frame [s]
  Vec3 place = Vec3::Zero();            ///< of the motion's origin [m]
  double heading = 0.0;                 ///< by which the motion is turned around the vertical [degrees]
  std::optional<Vec3f> color;           ///< its look is tinted with this, linear RGB; none = as it is
};

class SceneElement;

/// Reads "avatars" of a scene. Internal to scene_file.cpp.
[[nodiscard]] std::vector<AvatarSetting> readStage(SceneElement& root);

}  // namespace lorica
