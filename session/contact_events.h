#pragma once

#include "collision/world/touch_tracker.h"
#include "session/contact_bones.h"

#include <span>
#include <vector>

namespace lorica {

class Session;

/// Begin, stay and end of all contacts of a session's avatar: with props, and of its own parts that are not neighbours.
/// For games and haptics; deterministic, so that a replayed session has the same events. See docs/CONTACTS.md.
///
/// Strength is an impulse [N s] for all kinds. Of a contact with a prop: the impulse along the normal that the part
/// gave the prop in this frame, from the physics. Of two parts: how fast they approach each other at the point [m/s],
/// times the mass of the lighter one; 0 while they rest or move apart. Their speed is that of their rigid motion,
/// limited by the trust of the less trusted one as strikes are (see World::step), and 0 if one jumped.
class ContactEvents {
 public:
  /// Density of a body, for the mass of its parts [kg/m^3].
  static constexpr double kBodyDensity = 1000.0;

  /// @param session  whose events are wanted; its body must stay the same, see Session::setBody()
  explicit ContactEvents(const Session& session);

  /// Finds the events of the session's last frame; call it once after each step. Takes about 50 us, for the
  /// self-contacts. Allocates nothing once the most contacts of a frame have been seen.
  /// @return the events, sorted by kind, then part, then prop or other part; valid until the next call
  std::span<const ContactEvent> update(const Session& session);

  /// Ends all contacts: the session is over, restarts or continues in another world.
  std::span<const ContactEvent> endAll() { return tracker_.endAll(); }

  /// Mass of a part: its own volume without those of its neighbours, as if it were of water [kg].
  [[nodiscard]] double massOf(PartIndex part) const { return masses_[part]; }

 private:
  void addPropTouches(const Session& session);
  void addSelfTouches(const Session& session, double seconds);

  std::vector<double> masses_;
  ContactBones bones_;
  TouchTracker tracker_;
  std::vector<Touch> touches_;
  double time_;  // of the previous frame
};

}  // namespace lorica
