#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/renderer.h"
#include "viewer/renderer/scene.h"
#include "viewer/window/window_values.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A GLFW window that shows scenes, with panels to control playback. Keys and mouse: docs/WINDOW.md, or H in the
/// window. Pictures and videos are saved in the working directory, under the first free name lorica-001.png or .mp4.
/// Only one may exist at a time; used from the main thread.
class Window {
 public:
  /// @return the window, or kNoDisplay with advice: run without --window, snapshots need no display
  static Result<Window> create(const std::string& title, int width, int height);
  ~Window();
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;

  [[nodiscard]] bool open() const;
  /// Whether the simulation should advance by a frame: it is not paused, or a single step was requested. The call
  /// consumes the request.
  [[nodiscard]] bool wantsStep();
  [[nodiscard]] bool paused() const;
  /// Playback speed, 1 = as recorded.
  [[nodiscard]] double speed() const;

  /// Draws, presents, polls input.
  void show(const Scene& scene, const WindowValues& values);
  /// The requests since the last call.
  [[nodiscard]] WindowRequests takeRequests();
  /// While nothing else can be asked for: forgets the requests, but for dropped files, which the next requests have.
  /// @return whether to cancel what is loading
  [[nodiscard]] bool takeCancel();
  /// The ray from the eye through the mouse cursor.
  [[nodiscard]] Ray pointer() const;
  [[nodiscard]] Camera camera() const;

  /// Adds a frame to the time graph. @param stages  at most TimeGraph::kMaxStages; a change of stages clears the graph
  void addTimes(std::span<const TimedStage> stages);
  /// Shows a message.
  void notice(std::string sentence, double seconds = 3.0);
  static constexpr double kNoticeSeconds = 12.0;  ///< long enough to read a path
  /// Shows what failed for kNoticeSeconds, marked as such.
  void problem(std::string sentence);
  void setTitle(const std::string& title);

  /// The layers that are drawn, which the user may change.
  [[nodiscard]] const SceneOptions& shown() const;
  void setShown(const SceneOptions& show);
  /// What the user chose, by keys or panels.
  [[nodiscard]] const WindowChoices& choices() const;
  void setChoices(const WindowChoices& choices);
  /// Sets the initial camera, to which R resets.
  void setCamera(const Camera& camera);
  /// Sets a fixed quality; none = chosen automatically by speed, the default.
  void setQuality(std::optional<RenderQuality> quality);

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Whether a display seems to be available (DISPLAY or WAYLAND_DISPLAY is set).
[[nodiscard]] bool displayAvailable();

}  // namespace lorica
