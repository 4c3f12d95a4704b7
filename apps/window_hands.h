#pragma once

#include "apps/action_tape.h"
#include "session/session.h"
#include "viewer/window.h"

namespace lorica {

/// What a person does to the world with the mouse and the ball key, as actions of the session.
class WindowHands {
 public:
  /// @param again  whether the session may begin anew, so that what was done has to be kept
  explicit WindowHands(bool again) : again_(again) {}

  /// Takes hold of the prop under the mouse, or lets go, or throws.
  void take(const WindowRequests& requests, const Window& window, Session& session);
  /// Before each frame of the session: does what was done in it before, and draws what is held to where the mouse is.
  void beforeStep(const Window& window, Session& session);
  /// Before the session begins anew: lets go. What was done will be done again.
  void rewind(Session& session);
  /// Forgets all that was done; lets go without an action. The world is another one.
  void forget();

  [[nodiscard]] bool holds() const { return holds_; }

 private:
  void act(Session& session, const WorldAction& action);

  bool again_;
  ActionTape tape_;
  bool holds_ = false;
  double depth_ = 0.0;  // of the held place along the view [m]
};

}  // namespace lorica
