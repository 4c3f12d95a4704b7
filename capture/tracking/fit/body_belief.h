#pragma once

#include "capture/tracking/fit/body_fit.h"

namespace lorica::fit {

/// Whether what is fitted is a person at all: furniture and two people at once are also given a pose, but the body
/// explains them badly, most of its parts are not seen, and it is as large as it may be. The limits are from recordings
/// of real people and rooms, see docs/TRACKING.md.
class BodyBelief {
 public:
  /// A view and the body fitted to it.
  struct Evidence {
    FitCost cost;
    CapsuleSupport support;
    float height = 0.0F;    ///< standing [m]
    bool moved = false;     ///< since it was found; furniture does not move
    bool attached = false;  ///< to the room, which the body need not explain
    bool part = false;      ///< only legs need be seen: the head is known, or it was said so
  };
  void update(const Evidence& evidence);
  void forget() { *this = BodyBelief(); }

  [[nodiscard]] bool believed() const { return believed_; }

 private:
  bool believed_ = false;
  int trust_ = 0;  ///< views for it less views against it, limited
};

}  // namespace lorica::fit
