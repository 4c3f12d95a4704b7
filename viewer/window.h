#pragma once

#include "viewer/renderer.h"
#include "viewer/scene.h"

#include <memory>
#include <string>

namespace lorica {

/// A GLFW window that shows scenes. Mouse: left drag orbits, right drag pans, the wheel zooms. Keys: space pause,
/// N single step, 1 skin, 2 hulls, 3 bones, 4 props, 5 contacts, 6 ground, C skin colours, P screenshot into the
/// working directory, R camera reset, H help, Esc close. One at a time, used from the main thread.
class Window {
 public:
  /// @return the window, or kNoDisplay with what to do: run without --window, snapshots need no display
  static Result<Window> create(const std::string& title, int width, int height);
  ~Window();
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;

  [[nodiscard]] bool open() const;
  /// Whether the simulation should advance this turn (not paused, or a single step was asked for).
  [[nodiscard]] bool wantsStep();
  /// Draws, presents, polls input. @param caption  the line at the lower left; what else is shown follows the keys
  void show(const Scene& scene, const std::string& caption);

  /// What is shown at first, before any key.
  void setOptions(const SceneOptions& options);
  /// Where the camera starts and what R returns to.
  void setCamera(const Camera& camera);

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Whether a display seems to be there (DISPLAY or WAYLAND_DISPLAY is set).
[[nodiscard]] bool displayAvailable();

}  // namespace lorica
