#pragma once

#include "viewer/window_panels.h"

#include <vector>

namespace lorica {

/// Height of a line of text at scale 1 [pixels].
inline constexpr float kPanelLine = 18.0f;

/// Where panels are in the picture [pixels]: transport below, what is shown on the left, times on the right; the middle
/// stays free.
struct PanelLayout {
  struct Area {
    float left = 0, top = 0, right = 0, bottom = 0;
  };

  void begin(float newWidth, float newHeight) {
    width = newWidth;
    height = newHeight;
    floor = height;
    panels.clear();
  }
  /// Of things that are so large at scale 1.
  [[nodiscard]] float of(float pixels) const { return pixels * unit; }
  [[nodiscard]] float margin() const { return of(10.0f); }
  /// Too small for panels to be open by themselves.
  [[nodiscard]] bool small() const { return width < of(900.0f) || height < of(540.0f); }

  float unit = 1.0f;
  float width = 1.0f, height = 1.0f;  ///< of the picture
  float floor = 1.0f;                 ///< what is below belongs to the transport
  std::vector<Area> panels;           ///< as drawn
};

/// Dark, translucent, for text of kPanelLine * scale.
void setPanelStyle(float scale);

void drawTransport(PanelLayout& layout, const WindowValues& values, const WindowFacts& facts, ControlState& state,
                   WindowRequests& requests);
void drawViewPanel(PanelLayout& layout, const WindowValues& values, const WindowFacts& facts, ControlState& state,
                   WindowRequests& requests);
void drawTimesPanel(PanelLayout& layout, const WindowFacts& facts, const TimeGraph& times);
void drawWarnings(PanelLayout& layout, const WindowValues& values, const WindowFacts& facts);
void drawHelp(PanelLayout& layout);

}  // namespace lorica
