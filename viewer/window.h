#pragma once

#include "viewer/image.h"
#include "viewer/renderer.h"
#include "viewer/scene.h"
#include "viewer/window_values.h"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// A GLFW window that shows scenes, with panels to steer what plays. Its keys and what the mouse does: docs/WINDOW.md,
/// or H in the window. Pictures and videos go to the working directory, to the first free name lorica-001.png or .mp4.
/// One at a time, used from the main thread.
class Window {
 public:
  /// @return the window, or kNoDisplay with what to do: run without --window, snapshots need no display
  static Result<Window> create(const std::string& title, int width, int height);
  ~Window();
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;

  [[nodiscard]] bool open() const;
  /// Whether the simulation should advance by a frame: not paused, or a single step was asked for, which this takes.
  [[nodiscard]] bool wantsStep();
  [[nodiscard]] bool paused() const;
  /// How fast to play, 1 = as recorded.
  [[nodiscard]] double speed() const;

  /// Draws, presents, polls input.
  void show(const Scene& scene, const WindowValues& values);
  /// What was asked for since the last call.
  [[nodiscard]] WindowRequests takeRequests();
  /// From the eye through the mouse.
  [[nodiscard]] Ray pointer() const;
  [[nodiscard]] Camera camera() const;

  /// The next frame of the graph. @param stages  at most TimeGraph::kMostStages; where they change it begins anew
  void addTimes(std::span<const TimedStage> stages);
  /// Shows a sentence for three seconds.
  void notice(std::string sentence);

  /// Where the camera starts and what R returns to.
  void setCamera(const Camera& camera);
  /// Draws at this quality, whatever it takes; none = as the machine can, which is how it starts.
  void setQuality(std::optional<RenderQuality> quality);

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Whether a display seems to be there (DISPLAY or WAYLAND_DISPLAY is set).
[[nodiscard]] bool displayAvailable();

}  // namespace lorica
