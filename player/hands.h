#pragma once

#include "player/action_tape.h"
#include "session/session.h"
#include "viewer/renderer/screen.h"

#include <array>
#include <optional>

namespace lorica {

/// Turns the mouse, controllers and the ball key into actions of the session.
class Hands {
 public:
  /// @param again  whether the session can restart, so that actions have to be recorded
  explicit Hands(bool again) : again_(again) {}

  /// @param factor  times the earth's gravity: how thrown balls are aimed
  void setGravity(double factor) { gravity_ = factor; }
  /// Grabs the props that hands point at, releases them, or throws a ball.
  /// @param target  of the ball, unless its thrower has one [m]; none = what the camera looks at
  void take(const WindowRequests& requests, const Screen& screen, const std::optional<Vec3>& target, Session& session);
  /// Call before each frame of the session: repeats its recorded actions and moves held props to where hands point.
  void beforeStep(const Screen& screen, Session& session);
  /// Call before the session restarts: releases held props. Recorded actions will be repeated.
  void rewind(Session& session);
  /// The session has ended and the world continues without it: actions are applied to the world at once and not
  /// recorded.
  void goOnWithout() { without_ = true; }
  /// Forgets the last action, if canUndo(). The session has to restart and come back to see it.
  void undo() { tape_.undo(); }
  [[nodiscard]] bool canUndo() const { return tape_.canUndo(); }
  /// Forgets all recorded actions and the held props. Call when the world was replaced.
  void forget();

  /// A bit for each hand that holds a prop.
  [[nodiscard]] unsigned holds() const;

 private:
  void act(Session& session, const WorldAction& action);

  bool again_;
  bool without_ = false;  // see goOnWithout()
  double gravity_ = 1.0;
  ActionTape tape_;
  /// Of the point that each hand holds, along its forward direction [m].
  std::array<std::optional<double>, World::kMaxHands> depths_;
};

}  // namespace lorica
