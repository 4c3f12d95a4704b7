#pragma once

#include "capture/headset/head_and_hands.h"
#include "capture/registration/head_registration.h"
#include "geometry/result.h"
#include "viewer/renderer/renderer.h"
#include "viewer/renderer/scene.h"
#include "viewer/renderer/window_values.h"

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// A pose of a headset that somebody wears who watches.
struct HeadsetPose {
  int wearer = 0;
  HeadAndHands pose;  ///< stage frame, or where its screen says that the wearer is; by its own clock
};

/// Where the wearer of a headset is, as far as the run knows.
struct WearerState {
  std::optional<Registration> registration;  ///< with the depth camera; none = not known
  std::string advice;                        ///< a sentence for the wearer; may be empty
  Vec3 origin = Vec3::Zero();                ///< of the world in the camera's floor frame [m]
  bool alone = false;                        ///< there is no camera: an avatar follows head and hands
};

/// Where a hand points.
struct HandAim {
  Ray ray;                        ///< from the eye through the mouse, or along a controller
  Vec3 forward = -Vec3::UnitZ();  ///< unit vector: what is held keeps its distance along it
};

/// Shows scenes to people, who control them: a window is one. Used from one thread.
class Screen {
 public:
  virtual ~Screen() = default;

  [[nodiscard]] virtual bool open() const = 0;
  /// Whether the simulation should advance by a frame: it is not paused, or a single step was requested. The call
  /// consumes the request.
  [[nodiscard]] bool wantsStep() {
    Choices& chosen = choices();
    if (chosen.scrubbing) return false;
    if (!chosen.paused) {
      chosen.steps = 0;
      return true;
    }
    return chosen.steps > 0 && chosen.steps-- > 0;
  }

  /// Draws and presents if anything is another than in the last picture; polls input.
  virtual void show(const Scene& scene, const WindowValues& values) = 0;
  /// Waits for input, at most so long [s].
  virtual void rest(double seconds) = 0;
  /// What its user chose, by keys or panels, and asks for.
  [[nodiscard]] virtual Asked& asked() { return asked_; }
  [[nodiscard]] Choices& choices() { return asked().choices; }
  /// What people asked for since the last call.
  [[nodiscard]] virtual std::vector<Change> takeChanges() { return std::exchange(asked().changes, {}); }
  /// Asks the user for files, which later changes have; does not wait.
  virtual void chooseFiles() {}
  /// While nothing else can be asked for: see takeCancelFrom().
  /// @return whether to cancel what is loading
  [[nodiscard]] virtual bool takeCancel() { return takeCancelFrom(asked().changes); }
  /// @param hand  one that holds a prop, or pressed for one; see Change
  [[nodiscard]] virtual HandAim aim(int hand) const = 0;
  [[nodiscard]] virtual Camera camera() const = 0;
  /// The poses of headsets since the last call.
  [[nodiscard]] virtual std::span<const HeadsetPose> headsets() { return {}; }
  /// The wearer of a headset is elsewhere than before; when a run begins, nothing is known.
  virtual void setWearer(const WearerState&) {}
  /// Sets the initial camera, to which a reset returns.
  virtual void setCamera(const Camera& camera) = 0;

  /// Adds a frame to the time graph. A change of stages clears the graph.
  virtual void addTimes(std::span<const TimedStage> stages) = 0;
  /// Shows a message.
  virtual void notice(std::string sentence, double seconds = 3.0) = 0;
  static constexpr double kNoticeSeconds = 12.0;  ///< long enough to read a path
  /// Shows what failed for kNoticeSeconds, marked as such.
  virtual void problem(std::string sentence) = 0;
  virtual void setTitle(const std::string& title) = 0;

  /// Whether its user is this machine's, so that what they chose is kept for the next time.
  [[nodiscard]] virtual bool personal() const { return true; }

 private:
  Asked asked_;
};

}  // namespace lorica
