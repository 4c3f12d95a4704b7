#pragma once

#include "acd/decomposition.h"
#include "collision/world/touch_tracker.h"
#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica {

/// Mass of each part of a character: its own volume in the bind pose, without those of its neighbours, as if it were of
/// water [kg].
[[nodiscard]] std::vector<double> partMasses(const Decomposition& decomposition, const Character& character);

class Session;

/// Begin, stay and end of all contacts of a session's avatars: with props, of their own parts that are not neighbours,
/// and with each other. For games and haptics; deterministic, so that a replayed session has the same events. See
/// docs/CONTACTS.md.
///
/// Strength is an impulse [N s] for all kinds. Of a contact with a prop: the impulse along the normal that the part
/// gave the prop in this frame, from the physics. Of two parts: how fast they approach each other at the point [m/s],
/// times the mass of the lighter one; 0 while they rest or move apart. Their speed is that of their rigid motion,
/// limited by the trust of the less trusted one as strikes are (see World::step), and 0 if one jumped.
class ContactEvents {
 public:
  /// @param session  whose events are wanted; its avatars and their bodies must stay the same
  explicit ContactEvents(const Session& session);

  /// Finds the events of the session's last frame; call it once after each step. Takes about 50 us, for the
  /// self-contacts of each avatar. Allocates nothing once the most contacts of a frame have been seen.
  /// @return the events, sorted by their pairs, see TouchPair; valid until the next call
  std::span<const ContactEvent> update(const Session& session);

  /// Ends all contacts: the session is over, restarts or continues in another world.
  std::span<const ContactEvent> endAll() { return tracker_.endAll(); }

  /// Mass of a part: its own volume without those of its neighbours, as if it were of water [kg].
  [[nodiscard]] double massOf(PartIndex part, int avatar = 0) const { return masses_[avatar][part]; }

 private:
  void addPropTouches(const Session& session);
  void addSelfTouches(const Session& session, double seconds);
  void addAvatarTouches(const Session& session);

  std::vector<std::vector<double>> masses_;  // of each avatar's parts
  TouchTracker tracker_;
  std::vector<Touch> touches_;
  double time_;  // of the previous frame
};

}  // namespace lorica
