#pragma once

#include "session/session.h"

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

}  // namespace lorica
