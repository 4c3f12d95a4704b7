#pragma once

#include "viewer/window_panels.h"

#include <optional>
#include <vector>

namespace lorica {

/// Height of a line of text at scale 1 [pixels].
inline constexpr float kPanelLine = 18.0f;
/// That of times, at scale 1 [pixels].
inline constexpr float kWidestPanel = 250.0f;

/// Where panels are in the picture [pixels]: transport below, what is shown on the left, times on the right; the middle
/// stays free.
struct PanelLayout {
  struct Area {
    float left = 0, top = 0, right = 0, bottom = 0;
  };

  /// Of a panel that folds to its title.
  struct Fold {
    std::optional<bool> small;  ///< what the picture was when it was drawn last
    bool openIfLarge = true;    ///< as a user left it in a large picture
  };

  void begin(float newWidth, float newHeight) {
    width = newWidth;
    height = newHeight;
    ceiling = margin();
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
  float ceiling = 0.0f;               ///< what is above belongs to warnings
  std::vector<Area> panels;           ///< as drawn
  Fold view, times;
};

/// Before the Begin() of a panel that folds: folds it where the picture has become small; where it has become large,
/// the panel is again as it was left there.
void foldAsSizeSays(const PanelLayout& layout, PanelLayout::Fold& fold);
/// After it.
void noteFold(PanelLayout::Fold& fold);

/// Before the End() of a panel: the mouse over it belongs to it.
void notePanel(PanelLayout& layout);

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
