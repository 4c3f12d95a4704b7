#pragma once

#include "viewer/imgui_draw.h"
#include "viewer/time_graph.h"
#include "viewer/window_values.h"

#include <array>
#include <memory>
#include <string>

struct ImGuiContext;

namespace lorica {

/// What a person set at a window, by keys or at its panels.
struct ControlState {
  SceneOptions show;
  bool paused = false;
  int steps = 0;           ///< single steps that were asked for
  bool scrubbing = false;  ///< the timeline is held: nothing moves on by itself
  double speed = 1.0;      ///< of playing, as a factor, 0.1 to 4
  bool help = false;
  bool panels = true;
  int quality = -1;                                 ///< of pictures; -1 = automatic
  bool picture = false, pictureWithPanels = false;  ///< to be saved
  bool video = false;                               ///< to be begun or ended
};
inline constexpr double kSlowest = 0.1, kFastest = 4.0;

/// What panels show that the window knows by itself.
struct WindowFacts {
  double pictureMilliseconds = 0.0;
  double picturesASecond = 0.0;
  std::span<const char* const> qualities;  ///< names, the lowest first
  int quality = 0;
  double videoSeconds = -1.0;  ///< of the video that is being written [s]; below 0 = none
  double insetWidth = 0.0;     ///< of Scene::inset at the lower right [pixels]; 0 = none
  std::string_view notice;     ///< a sentence that goes by itself; empty = none
};

/// What the mouse does, in pixels from the upper left.
struct PanelInput {
  int width = 1, height = 1;  ///< of the picture
  float scale = 1.0f;         ///< of text, 1 on displays of about 96 dots an inch
  float x = 0.0f, y = 0.0f;
  std::array<bool, 2> down{};    ///< left and right, within the time since the last picture
  float wheel = 0.0f;            ///< turns towards the picture
  float seconds = 1.0f / 60.0f;  ///< since the last picture
};

/// The panels of a window: how to play and what to show, times as a graph, warnings, help. One at a time.
class WindowPanels {
 public:
  static Result<WindowPanels> create(const GlFunctions& functions);
  ~WindowPanels();
  WindowPanels(WindowPanels&&) noexcept;
  WindowPanels& operator=(WindowPanels&&) noexcept;

  /// Draws them over the bound framebuffer and takes what is done with the mouse.
  void draw(const PanelInput& input, const WindowValues& values, const WindowFacts& facts, const TimeGraph& times,
            ControlState& state, WindowRequests& requests);
  /// Whether a place belongs to a panel, as it was drawn last.
  [[nodiscard]] bool covers(float x, float y) const;
  /// Whether the mouse holds a slider or an open list.
  [[nodiscard]] bool busy() const;

 private:
  struct Impl;
  explicit WindowPanels(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica
