#pragma once

#include "viewer/renderer/controls.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// A stage of a frame and its time.
struct TimedStage {
  const char* name = "";  ///< with static storage duration
  double milliseconds = 0.0;
};

/// A target and how often it was hit.
struct TargetScore {
  std::string name;
  int hits = 0;
};

/// What a screen shows beside the scene; texts and lists are borrowed while they are drawn. Independent of sessions and
/// files.
struct WindowValues {
  const Controls* controls = nullptr;     ///< null = there is no run yet
  std::string_view name;                  ///< of the played motion
  std::string_view status;                ///< one line of status
  double seconds = 0.0;                   ///< since the first frame [s]
  double duration = 0.0;                  ///< of a recording [s]; 0 = live, without timeline and speed
  double facing = 0.0;                    ///< azimuth to which the followed avatar looks, see directionAt() [rad]
  bool ended = false;                     ///< there are no more frames
  std::span<const std::string> warnings;  ///< messages
  bool outsideTraining = false;           ///< the pose is outside the training range of the hulls
  unsigned holds = 0;                     ///< a bit for each hand that moves a prop; the mouse, 0, not the camera then
  std::optional<Vec3> focus = {};         ///< what a following camera moves with [m]
  std::optional<Aabb> followed = {};      ///< what a following camera keeps in view, between the panels [m]
  int avatar = -1;                        ///< index of the followed one; -1 = all
  std::string_view hint;                  ///< what may be dropped on the window; empty = nothing is said
  std::string_view loading;               ///< what is loaded meanwhile; empty = nothing
  double loaded = 0.0;                    ///< share of it that is done
  std::span<const TargetScore> hits;      ///< of the scene's targets; empty = it has none
  std::uint64_t changes = 0;              ///< grows whenever the scene is another
  double smoothingDelay = -1.0;           ///< as measured [s]; below 0 = no smoothing
  std::string_view recording;             ///< the file that the session is recorded to; empty = none

  // Filled by the window itself.
  double pictureMilliseconds = 0.0;
  double picturesASecond = 0.0;
  double videoSeconds = -1.0;                  ///< length of the video that is written [s]; below 0 = none
  double insetWidth = 0.0, insetHeight = 0.0;  ///< of Scene::inset at the lower right [pixels]; 0 = none
  std::string_view notice = {};                ///< temporary message; empty = none
  std::optional<std::string_view> typed = {};  ///< the path of a file that the user types; none = that is not asked for
  bool problem = false;                        ///< it says what failed

  /// Whether nothing has been loaded yet.
  [[nodiscard]] bool empty() const { return controls == nullptr; }
  /// Calls visit(std::string_view) for each text.
  template <typename Visit>
  void eachText(const Visit& visit) const {
    for (const std::string_view text : {name, status, hint, loading, notice, typed.value_or("")}) visit(text);
    for (const std::string& text : warnings) visit(std::string_view(text));
    for (const TargetScore& target : hits) visit(std::string_view(target.name));
    if (controls == nullptr) return;
    for (const Control& control : *controls) {
      for (const std::string& text : control.choices) visit(std::string_view(text));
    }
  }
};
/// The value of the expressions: those that the command gave, or that the source of the motion sends.
inline constexpr int kExpressionsAsGiven = -2;

/// Colours of the panels, 0xrrggbbaa: those of the page (viewer/page/web/page.css has them by the same names).
struct PanelColors {
  std::uint32_t text, faint, panel, raised, line, strong, onStrong, warn, warnText, bad, badText;
};
inline constexpr PanelColors kLightPanels{0x1d2430ff, 0x5b6676ff, 0xffffffd9, 0xeef1f5ff, 0xd4dae2ff, 0x1264c4ff,
                                          0xffffffff, 0xfff3d6ff, 0x6b4500ff, 0xffe1deff, 0x8a1408ff};
inline constexpr PanelColors kDarkPanels{0xe7ebf1ff, 0x9aa6b6ff, 0x161b23e0, 0x262e3aff, 0x333d4bff, 0x6db1ffff,
                                         0x08131fff, 0x3d3113ff, 0xffdf9aff, 0x471f1bff, 0xffb9b0ff};

}  // namespace lorica
