#pragma once

#include "session/session.h"
#include "viewer/window.h"

namespace lorica {

/// What a person does to the world with the mouse and the ball key, as actions of the session.
class WindowHands {
 public:
  /// Takes hold of the prop under the mouse, or lets go, or throws.
  void take(const WindowRequests& requests, const Window& window, Session& session);
  /// Before each frame of the session: draws what is held to where the mouse is.
  void beforeStep(const Window& window, Session& session);
  /// Lets go without an action: the world is another one.
  void forget() { holds_ = false; }

  [[nodiscard]] bool holds() const { return holds_; }

 private:
  bool holds_ = false;
  double depth_ = 0.0;  // of the held place along the view [m]
};

}  // namespace lorica
