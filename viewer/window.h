#pragma once

#include "viewer/renderer.h"
#include "viewer/scene.h"

#include <functional>
#include <memory>
#include <string>

namespace lorica {

/// A GLFW window that shows scenes: orbit camera (left drag), zoom (wheel), keys: space pause, N single step,
/// 1 skin, 2 hulls, 3 bones, 4 props, P screenshot, R camera reset, H help, Esc close.
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
  /// Draws, presents, polls input. @param options  the caption; what is shown follows the keys
  void show(const Scene& scene, const std::string& caption);

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Whether a display seems to be there (DISPLAY or WAYLAND_DISPLAY is set).
[[nodiscard]] bool displayAvailable();

}  // namespace lorica
