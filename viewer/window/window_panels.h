#pragma once

#include "geometry/result.h"
#include "viewer/renderer/window_values.h"
#include "viewer/window/free_area.h"
#include "viewer/window/time_graph.h"

#include <array>
#include <memory>

struct ImGuiContext;

namespace lorica {

/// Mouse input, in pixels from the upper left.
struct PanelInput {
  int width = 1, height = 1;  ///< of the picture
  float scale = 1.0f;         ///< of text, 1 on displays of about 96 dots per inch
  float x = 0.0f, y = 0.0f;
  std::array<bool, 2> down{};    ///< left and right button, at any time since the last picture
  float wheel = 0.0f;            ///< forward steps of the wheel
  float seconds = 1.0f / 60.0f;  ///< since the last picture
};

/// The panels of a window: playback, view options, time graph, warnings, help. Only one may exist at a time.
class WindowPanels {
 public:
  /// In the current OpenGL context, which must also be current in all later calls.
  static Result<WindowPanels> create();
  ~WindowPanels();
  WindowPanels(WindowPanels&&) noexcept;
  WindowPanels& operator=(WindowPanels&&) noexcept;

  /// Draws the panels over the bound framebuffer and handles mouse input.
  void draw(const PanelInput& input, const WindowValues& values, const TimeGraph& times, WindowChoices& choices,
            WindowRequests& requests);
  /// Whether a position is over a panel as last drawn.
  [[nodiscard]] bool covers(float x, float y) const;
  /// The part of the picture that the panels as last drawn leave free, without what comes and goes: progress and help.
  [[nodiscard]] const PictureArea& freeArea() const;
  /// Whether the mouse operates a slider or an open list.
  [[nodiscard]] bool busy() const;
  /// Closes an open list.
  /// @return whether there was one
  bool closeList();

 private:
  struct Impl;
  explicit WindowPanels(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica
