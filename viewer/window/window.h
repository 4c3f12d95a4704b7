#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/renderer.h"
#include "viewer/renderer/scene.h"
#include "viewer/renderer/screen.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// A GLFW window that shows scenes, with panels to control playback. Keys and mouse: docs/WINDOW.md, or H in the
/// window. Pictures and videos are saved in the working directory, under the first free name lorica-001.png or .mp4.
/// Only one may exist at a time; used from the main thread.
class Window : public Screen {
 public:
  /// @return the window, or kNoDisplay with advice: run without --window, snapshots need no display
  /// @param transparent  the desktop shows through a transparent background, where the system has such windows
  static Result<Window> create(const std::string& title, int width, int height, bool transparent = false);
  /// What is shown where nobody sees it, without display, panels, keys and mouse: for a headset.
  /// @param say  gets the messages
  /// @return the window, or kNoDisplay if there is no OpenGL by EGL
  static Result<Window> createUnseen(std::function<void(const std::string&)> say);
  ~Window() override;
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;

  [[nodiscard]] bool open() const override;
  void show(const Scene& scene, const WindowValues& values) override;
  void rest(double seconds) override;
  [[nodiscard]] Asked& asked() override;
  void chooseFiles() override;
  [[nodiscard]] HandAim aim(int hand) const override;
  [[nodiscard]] Camera camera() const override;
  void setCamera(const Camera& camera) override;
  /// @param stages  at most TimeGraph::kMaxStages
  void addTimes(std::span<const TimedStage> stages) override;
  void notice(std::string sentence, double seconds = 3.0) override;
  void problem(std::string sentence) override;
  void setTitle(const std::string& title) override;
  /// Sets a fixed quality; none = chosen automatically by speed, the default.
  void setQuality(std::optional<RenderQuality> quality);
  /// How many pictures were drawn so far.
  [[nodiscard]] long long pictures() const;
  /// Finds functions of the window's OpenGL context.
  [[nodiscard]] Renderer::GetProc glFunctions() const;

 protected:
  /// Draws the scene for somewhere else, and leaves a picture in the renderer for the window.
  /// @return false if it has drawn nothing: then the window draws the scene as its own camera sees it
  using Eyes = std::function<bool(Renderer&, const Scene&, const SceneOptions&)>;
  /// From now on each show() calls this and waits for no display; null = as before.
  /// @param longest  time of a picture, above which the quality is lowered [s]; 0 = that of a window
  void drawFor(Eyes eyes, double longest = 0.0);
  /// Whether there is a window on a display.
  [[nodiscard]] bool seen() const;

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Whether a display seems to be available (DISPLAY or WAYLAND_DISPLAY is set).
[[nodiscard]] bool displayAvailable();

}  // namespace lorica
