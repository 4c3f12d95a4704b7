#pragma once

#include "session/session.h"

#include <cstddef>
#include <vector>

namespace lorica {

/// How far the avatars of a session are visible. Who comes or leaves while it runs fades within half a second of the
/// session's time, so a session that is run again looks the same.
class AvatarFade {
 public:
  static constexpr double kSeconds = 0.5;

  /// Call after each frame of the session. Does nothing if it was called for that frame. In the first frame after its
  /// creation or after a restart of the session who is there is visible at once.
  void update(const Session& session);
  /// 0 to 1; 1 before the first update if the avatar is there.
  [[nodiscard]] double of(const Session& session, std::size_t avatar) const;

 private:
  int frame_ = 0;      // of the last update
  double time_ = 0.0;  // of the last update [s]
  std::vector<double> visible_;
};

}  // namespace lorica
