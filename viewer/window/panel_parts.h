#pragma once

#include "viewer/window/free_area.h"
#include "viewer/window/window_panels.h"

#include <optional>
#include <vector>

namespace lorica {

/// Height of a line of text at scale 1 [pixels].
inline constexpr float kPanelLine = 18.0f;
/// Width of the view panel at scale 1 [pixels].
inline constexpr float kViewPanel = 206.0f;
/// Width of the times panel, the widest, at scale 1 [pixels].
inline constexpr float kWidestPanel = 250.0f;

/// Layout of the panels in the picture [pixels]: transport at the bottom, view options on the left, times on the right;
/// the centre stays free.
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
  Fold view, times, motion, hits;
};

/// Call before the Begin() of a collapsible panel: collapses it when the picture becomes small, and restores its state
/// when the picture becomes large.
void foldAsSizeSays(const PanelLayout& layout, PanelLayout::Fold& fold);
/// Call after Begin(): stores the choices.
void noteFold(PanelLayout::Fold& fold);

/// Call before the End() of a panel: the panel receives the mouse input over its area.
void notePanel(PanelLayout& layout);

/// Sets a dark, translucent style for text of height kPanelLine * scale.
void setPanelStyle(float scale);

void drawTransport(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests);
void drawViewPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests);
void drawTimesPanel(PanelLayout& layout, const WindowValues& values, const TimeGraph& times);
/// Below the times, in a small picture below the view options: what performs, and how the motion and the world are
/// treated.
void drawMotionPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests);
/// Below the last panel on the right: the hits of targets.
void drawHitsPanel(PanelLayout& layout, const WindowValues& values);
void drawWarnings(PanelLayout& layout, const WindowValues& values);
void drawLoading(PanelLayout& layout, const WindowValues& values, WindowRequests& requests);
void drawHelp(PanelLayout& layout);

}  // namespace lorica
