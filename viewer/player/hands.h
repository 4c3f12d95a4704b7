#pragma once

#include "session/session.h"
#include "viewer/renderer/screen.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace lorica {

/// Records the user's actions per frame, so that a run from the start repeats them.
class ActionTape {
 public:
  /// Performs an action now and records it. Recorded actions of later frames, left from before a rewind(), are dropped.
  void act(Session& session, const WorldAction& action);
  /// Repeats the actions recorded for the current frame. Call before each step.
  void redo(Session& session);
  /// Forgets the last thrown ball, or the last drag; also all later ones, left from before a rewind(). The session has
  /// to restart and come back to see it.
  void forgetLast();
  /// Whether there is one.
  [[nodiscard]] bool hasLast() const { return next_ > 0; }
  /// The session restarts.
  void rewind() { next_ = 0; }
  void clear() { done_.clear(), next_ = 0; }

  /// Whether redo() still has actions to repeat.
  [[nodiscard]] bool goesOn() const { return next_ < done_.size(); }

 private:
  struct Done {
    int frame = 0;  // the action precedes this frame
    WorldAction action;
  };
  std::vector<Done> done_;
  std::size_t next_ = 0;  // earlier entries have been performed in this run
};

/// Turns the mouse, controllers and the ball key into actions of the session.
class Hands {
 public:
  /// @param again  whether the session can restart, so that actions have to be recorded
  explicit Hands(bool again) : again_(again) {}

  /// @param factor  times the earth's gravity: how thrown balls are aimed
  void setGravity(double factor) { gravity_ = factor; }
  /// Grabs the prop that a hand points at, releases one, or throws a ball.
  /// @param change  kPress, kRelease or kThrow
  /// @param target  of the ball, unless its thrower has one [m]; none = what the camera looks at
  void take(const Change& change, const Screen& screen, const std::optional<Vec3>& target, Session& session);
  /// Call before each frame of the session: repeats its recorded actions and moves held props to where hands point.
  void beforeStep(const Screen& screen, Session& session);
  /// Call before the session restarts: releases held props. Recorded actions will be repeated.
  void rewind(Session& session);
  /// The session has ended and the world continues without it: actions are applied to the world at once and not
  /// recorded.
  void goOnWithout() { without_ = true; }
  /// Forgets the last action, if hasLast(). The session has to restart and come back to see it.
  void forgetLast() { tape_.forgetLast(); }
  [[nodiscard]] bool hasLast() const { return tape_.hasLast(); }
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
