#pragma once

#include "collision/live/body_plan.h"
#include "collision/world/body_contacts.h"
#include "session/session_avatar.h"

#include <memory>
#include <span>
#include <vector>

namespace lorica {

/// Finds parts of different avatars of a session that overlap, see BodyContactQuery. Internal to Session.
class AvatarContacts {
 public:
  /// The overlaps in a frame; the bodies' numbers are those of the avatars. Allocates nothing once the most avatars and
  /// contacts of a frame have been seen.
  /// @param seconds  since the last frame, above 0
  std::span<const BodyContact> find(std::span<const SessionAvatar> avatars, double seconds);

 private:
  /// The masses of an avatar's parts.
  struct Masses {
    std::shared_ptr<const BodyPlan> plan;
    std::shared_ptr<const std::vector<double>> values;  ///< avatars of one plan share them
  };
  void weigh(std::span<const SessionAvatar> avatars);

  BodyContactQuery query_;
  std::vector<Masses> masses_;
  std::vector<BodyInWorld> bodies_;
};

}  // namespace lorica
