#pragma once

#include "viewer/window/free_area.h"
#include "viewer/window/window_panels.h"

#include <optional>
#include <vector>

namespace lorica {

/// Height of a line of text at scale 1 [pixels].
inline constexpr float kPanelLine = 18.0f;
/// Width of the panels at the sides at scale 1 [pixels].
inline constexpr float kPanelWidth = 264.0f;

/// Layout of the panels in the picture [pixels]: transport at the bottom, who and what on the left, look and numbers on
/// the right; the centre stays free.
struct PanelLayout {
  /// State of a panel that can be collapsed.
  struct Fold {
    std::optional<bool> small;  ///< whether the picture was small when the panel was last drawn
    bool openIfLarge = true;    ///< state that the user chose in a large picture
  };

  void begin(float newWidth, float newHeight) {
    width = newWidth;
    height = newHeight;
    ceiling = margin();
    left = right = titles = 0.0f;
    floor = height;
    panels.clear();
  }
  /// Converts a size at scale 1.
  [[nodiscard]] float of(float pixels) const { return pixels * unit; }
  [[nodiscard]] float margin() const { return of(10.0f); }
  /// Whether the picture is too small for panels to be open by default.
  [[nodiscard]] bool small() const { return width < of(900.0f) || height < of(540.0f); }

  float unit = 1.0f;
  float width = 1.0f, height = 1.0f;  ///< of the picture
  float floor = 1.0f;                 ///< top of the transport
  float rightFloor = 1.0f;            ///< on the right side: top of the transport or of the inset
  float ceiling = 0.0f;               ///< bottom of the warnings
  std::vector<PixelArea> panels;      ///< as drawn
  PictureArea free;                   ///< what panels that stay leave free
  float left = 0.0f, right = 0.0f;    ///< bottoms of the last panels at both sides
  float titles = 0.0f;                ///< bottom of the lowest folded panel
  Fold who, look, numbers{{}, false};
};

/// Begins a panel below the last one at a side. It is collapsed when the picture becomes small, and as it was when the
/// picture becomes large.
/// @return whether there is room for it; then endSide() must follow @param open  whether it is not collapsed
[[nodiscard]] bool beginSide(PanelLayout& layout, PanelLayout::Fold& fold, const char* title, bool left, bool& open);
void endSide(PanelLayout& layout, bool left);

/// Call before the End() of a panel: the panel receives the mouse input over its area.
void notePanel(PanelLayout& layout);

/// Sets a dark, translucent style for text of height kPanelLine * scale.
void setPanelStyle(float scale);

void drawTransport(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests);
/// The avatar, its motion and its world.
void drawWhoPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests);
/// What is drawn and how.
void drawLookPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests);
void drawNumbersPanel(PanelLayout& layout, const WindowValues& values, const TimeGraph& times);
/// @param all  also those that come by themselves, such as warnings
void drawMessages(PanelLayout& layout, const WindowValues& values, bool all);
void drawLoading(PanelLayout& layout, const WindowValues& values, WindowRequests& requests);
void drawHelp(PanelLayout& layout, const WindowValues& values);

}  // namespace lorica
