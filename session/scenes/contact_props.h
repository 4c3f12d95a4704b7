#pragma once

/// The props that avatars meet, for ContactTable. Internal: not installed.

#include "session/scenes/contact_outline.h"

#include <span>
#include <tuple>
#include <vector>

namespace lorica {

/// A prop and a part: measured between hulls, or told by the physics.
struct PropMeeting {
  int avatar = 0, part = 0, prop = 0;
  Meeting meeting;
  double impulse = 0.0;

  [[nodiscard]] auto key() const { return std::tuple(avatar, part, prop); }
};

/// Finds the props that parts of avatars touch or are near to.
class PropMeetings {
 public:
  /// @param reach  to which is searched [m]
  explicit PropMeetings(double reach) : reach_(reach) {}

  /// Those of the session's last frame, in the order of PropMeeting::key(): of each pair the deepest, with all
  /// impulses. Valid until the next call.
  std::span<const PropMeeting> find(const Session& session, std::span<ContactOutline> outlines);

 private:
  /// A convex piece of a prop in world space.
  struct Piece {
    std::vector<Vec3> points = {};
    double radius = 0.0;
    Aabb box;  ///< with the radius
  };
  void setPiece(const Prop& prop, std::size_t hull);
  void findProp(int index, const Prop& prop, int avatar, ContactOutline& outline);

  double reach_;
  std::vector<PropMeeting> found_;
  Piece piece_;
};

}  // namespace lorica
