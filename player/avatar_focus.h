#pragma once

#include "session/session.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

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
  [[nodiscard]] std::optional<Aabb> bounds(const Session& session) const;

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
