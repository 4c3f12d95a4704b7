#pragma once

#include "collision/world/world.h"
#include "session/session.h"
#include "viewer/renderer/picture_area.h"
#include "viewer/renderer/scene.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Around the parts of an avatar as they are now, or of all: -1 [m]; none if none is there.
[[nodiscard]] std::optional<Aabb> boundsOf(const Session& session, int avatar = -1);

/// The azimuth to which an avatar faces, see directionAt() [rad]; 0 if that is up or down, or not known.
/// @param bones  the first that faces somewhere tells
inline constexpr std::array<HumanBone, 2> kFacingBones = {HumanBone::kHips, HumanBone::kChest};
[[nodiscard]] double facingOf(const SessionAvatar& avatar, std::span<const HumanBone> bones = kFacingBones);

/// The point that a following camera moves with: the middle of one avatar or of all, without its quick movements.
class AvatarFocus {
 public:
  /// Call after each frame of the session.
  void update(const Session& session);
  /// Call when the session restarts.
  void reset() { position_.reset(); }
  /// @param avatar  index, or -1 = all
  void choose(int avatar) { avatar_ = avatar; }

  [[nodiscard]] int avatar() const { return avatar_; }
  /// World [m]; none before the first frame with an avatar.
  [[nodiscard]] const std::optional<Vec3>& position() const { return position_; }
  /// Around the parts of the followed avatars, as they are now [m]; none if none is there.
  [[nodiscard]] std::optional<Aabb> bounds(const Session& session) const { return boundsOf(session, avatar_); }
  /// Where the followed avatar looks, or the first of all, see facingOf() [rad].
  [[nodiscard]] double facing(const Session& session) const { return facingOf(session.avatar(std::max(avatar_, 0))); }

 private:
  int avatar_ = -1;
  double time_ = 0.0;  // of the last update [s]
  std::optional<Vec3> position_;
};

/// The avatar whose hulls a ray meets first; -1 = none.
[[nodiscard]] int avatarAt(const Session& session, const Ray& ray);

/// "1 mannequin", "2 hero": the avatars of a session.
[[nodiscard]] std::vector<std::string> avatarNames(const Session& session);

/// From where a camera looks unless the user says otherwise: 35 degrees from where the avatar faces, on its right, so
/// that a kick is visible; slightly from above.
[[nodiscard]] Vec3 usualDirection(double facing);

/// The initial camera of a window: it looks at the avatars and shows what the scene is about, the props that can move
/// and are near them, between the panels.
/// @param avatars  around them @param facing  azimuth to which they face [rad]
[[nodiscard]] Camera windowCamera(const Aabb& avatars, double facing, const World& world);

/// --camera, --eye and --target: the camera of pictures.
struct CameraOptions {
  std::string preset;  ///< front, side, back, top, face or three-quarter; follows the body; empty = three-quarter
  std::optional<Vec3> eye = {};  ///< in the world [m]; used with `target`, instead of a preset
  std::optional<Vec3> target = {};
};

/// A fixed camera, or one that follows moving bodies: it looks at their middle smoothly, from one side of them, which
/// the first picture decides. Its distance is that at which the first picture is filled; it grows with what the bodies
/// need, and never shrinks.
class FollowCamera {
 public:
  /// @param aspect  width per height of the picture
  FollowCamera(const CameraOptions& options, double aspect);

  /// @param seconds  since the previous frame [s]
  void update(const Session& session, double seconds);
  [[nodiscard]] Camera camera() const;
  /// The camera of a picture of this frame alone: the bodies are in its middle and fill it.
  [[nodiscard]] Camera still(const Session& session);

 private:
  void aim(const Session& session);
  void findPoints(const Session& session);

  std::string preset_;
  double aspect_;
  std::optional<Camera> fixed_;
  std::optional<Vec3> direction_;  // from the bodies to the camera, unit; none = not yet
  std::optional<Aabb> face_;       // of the first avatar in the bind pose, for a portrait
  std::vector<Vec3> points_;       // that are framed, in this frame
  Vec3 target_ = Vec3::Zero();
  double distance_ = 0.0;  // [m]; 0 = nothing was seen yet
  double fov_ = Camera().verticalFov;
};

}  // namespace lorica
