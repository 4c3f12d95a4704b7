#pragma once

#include "geometry/result.h"
#include "viewer/renderer/picture_area.h"
#include "viewer/renderer/window_values.h"
#include "viewer/window/time_graph.h"

#include <imgui.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// A panel that stays where it is put.
inline constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                           ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                           ImGuiWindowFlags_NoFocusOnAppearing;

[[nodiscard]] constexpr ImU32 inkOf(std::uint32_t color) {
  return IM_COL32(color >> 24, color >> 16 & 0xff, color >> 8 & 0xff, color & 0xff);
}

/// Height of a line of text at scale 1 [pixels].
inline constexpr float kPanelLine = 18.0f;
/// Width of the panels at the sides at scale 1 [pixels].
inline constexpr float kPanelWidth = 300.0f;

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
  [[nodiscard]] float margin() const { return of(12.0f); }
  /// Whether the picture is too small for panels to be open by default.
  [[nodiscard]] bool small() const { return width < of(900.0f) || height < of(540.0f); }

  const PanelColors* colors = nullptr;
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

/// The width of a slider with its value beside it, where the knob does not cover it. @param longest  text of a value
[[nodiscard]] float besideSlider(float room, const std::string& longest);

/// Sets the style for text of height kPanelLine * scale.
void setPanelStyle(const PanelColors& colors, float scale);

/// A slider without a number on it: a line that is filled up to a round knob. As ImGui::SliderFloat().
bool drawSlider(const PanelLayout& layout, const char* id, float width, float& value, float least, float most);

/// While it exists, buttons have the colour of what is chosen, or is done most.
class Strong {
 public:
  explicit Strong(const PanelLayout& layout, bool on = true);
  ~Strong() { ImGui::PopStyleColor(count_); }
  Strong(const Strong&) = delete;
  Strong& operator=(const Strong&) = delete;

 private:
  int count_ = 0;
};

void drawTransport(PanelLayout& layout, const WindowValues& values, const Controls& controls, Asked& asked);
/// The avatar, its motion and its world.
void drawWhoPanel(PanelLayout& layout, const WindowValues& values, const Controls& controls, Asked& asked);
/// What is drawn and how.
void drawLookPanel(PanelLayout& layout, const Controls& controls, Asked& asked);
void drawNumbersPanel(PanelLayout& layout, const WindowValues& values, const TimeGraph& times);
/// @param all  also those that come by themselves, such as warnings
void drawMessages(PanelLayout& layout, const WindowValues& values, bool all);
void drawLoading(PanelLayout& layout, const WindowValues& values, Asked& asked);
void drawHelp(PanelLayout& layout, const Controls& controls);

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

  /// Draws the panels over the bound framebuffer and handles mouse input.
  void draw(const PanelInput& input, const WindowValues& values, const TimeGraph& times, const Controls& controls,
            Asked& asked);
  /// Whether a position is over a panel as last drawn.
  [[nodiscard]] bool covers(float x, float y) const;
  /// The part of the picture that the panels as last drawn leave free, without what comes and goes: progress and help.
  [[nodiscard]] const PictureArea& freeArea() const { return layout_.free; }
  /// Whether the mouse operates a slider or an open list.
  [[nodiscard]] bool busy() const;
  /// Closes an open list.
  /// @return whether there was one
  bool closeList();

 private:
  struct End {
    void operator()(ImGuiContext* context) const;
  };
  void takeInput(const PanelInput& input);
  void noteCharacters(const WindowValues& values);
  void takeStyle(float wantedScale, const SceneOptions& show);
  void noteFreeArea(const WindowValues& values);

  std::unique_ptr<ImGuiContext, End> context_;
  float scale_ = 0.0f;      // of the current font and style
  std::u32string beyond_;   // ASCII: characters that were shown
  bool fontLacks_ = false;  // some of them
  PanelLayout layout_;
};

}  // namespace lorica
