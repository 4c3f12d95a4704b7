#include "player/avatar_fade.h"

#include <algorithm>
#include <utility>

namespace lorica {

void AvatarFade::update(const Session& session) {
  const int last = std::exchange(frame_, session.frameCount());
  const double seconds = std::max(session.time() - std::exchange(time_, session.time()), 0.0);
  if (frame_ == last) return;
  const bool first = last == 0 || frame_ < last;
  visible_.resize(session.avatars().size(), 0.0);
  for (std::size_t a = 0; a < visible_.size(); ++a) {
    const bool present = session.avatars()[a].present();
    const double change = first ? 1.0 : seconds / kSeconds;
    visible_[a] = std::clamp(visible_[a] + (present ? change : -change), 0.0, 1.0);
  }
}

double AvatarFade::of(const Session& session, std::size_t avatar) const {
  if (avatar < visible_.size()) return visible_[avatar];
  return session.avatars()[avatar].present() ? 1.0 : 0.0;
}

}  // namespace lorica
