#pragma once

#include "collision/world/world.h"
#include "viewer/renderer/scene.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A stage of a frame and its time.
struct TimedStage {
  const char* name = "";  ///< with static storage duration
  double milliseconds = 0.0;
};

/// A gravity that the user may choose.
struct GravityChoice {
  const char* name = "";
  double factor = 1.0;  ///< times that of the scene
};
inline constexpr std::array<GravityChoice, 4> kGravities = {
    {{"none", 0.0}, {"moon", 1.0 / 6.0}, {"usual", 1.0}, {"double", 2.0}}};

/// A smoothing of tracked joints that the user may choose.
struct SmoothingChoice {
  const char* name = "";
  double minCutoff = 0.0;  ///< see OneEuroSettings [Hz]; 0 = no smoothing
};
inline constexpr std::array<SmoothingChoice, 4> kSmoothings = {
    {{"off", 0.0}, {"light", 3.0}, {"medium", 1.5}, {"strong", 0.75}}};
/// WindowChoices::smoothing: the filter of the command line.
inline constexpr int kSmoothingAsGiven = -1;

/// How the motion and the world are treated in a window.
struct WindowTreatment {
  bool mirror = false;
  int smoothing = 0;  ///< index of kSmoothings or kSmoothingAsGiven
  int gravity = 2;    ///< index of kGravities

  [[nodiscard]] bool operator==(const WindowTreatment&) const = default;
};

/// What the user chose and keeps from one run to the next.
struct KeptChoices {
  bool loop = true;    ///< at the end of a recording it starts again; else the world continues and the avatar stands
  bool follow = true;  ///< the camera moves with WindowValues::focus
  double scale = 1.0;  ///< of text and panels, times the system's; kSmallestScale to kLargestScale
  WindowTreatment treatment;

  [[nodiscard]] bool operator==(const KeptChoices&) const = default;
};
inline constexpr double kSmallestScale = 0.5, kLargestScale = 4.0;

/// What the user can change by keys and panels.
struct WindowChoices : KeptChoices {
  SceneOptions show;  ///< the layers that are drawn
  bool paused = false;
  int steps = 0;           ///< single steps that were asked for
  bool scrubbing = false;  ///< the timeline is dragged: playback is suspended
  double speed = 1.0;      ///< of playback, one of kSpeeds; 1 = as recorded
  bool help = false;
  bool panels = true;
  int quality = -1;                                 ///< of the picture; -1 = automatic
  bool inside = false;                              ///< a headset sees through the avatar's eyes, else from beside it
  bool picture = false, pictureWithPanels = false;  ///< to be saved
  bool video = false;                               ///< to be started or stopped
};
/// A speed that the user may choose.
struct SpeedChoice {
  const char* name = "";
  double factor = 1.0;
};
inline constexpr std::array<SpeedChoice, 4> kSpeeds = {{{"1/4", 0.25}, {"1/2", 0.5}, {"1", 1.0}, {"2", 2.0}}};

/// What may be behind the picture.
struct BackgroundChoice {
  const char* name = "";
  std::optional<Vec3f> color = {};  ///< see SceneOptions
  bool transparent = false;
};
inline const std::array<BackgroundChoice, 5> kBackgrounds = {{{"sky"},
                                                              {"white", Vec3f(1.0f, 1.0f, 1.0f)},
                                                              {"black", Vec3f(0.0f, 0.0f, 0.0f)},
                                                              {"green", Vec3f(0.0f, 1.0f, 0.0f)},
                                                              {"transparent", {}, true}}};

/// A target and how often it was hit.
struct TargetScore {
  std::string name;
  int hits = 0;
};

/// What keys refer to after the picture was drawn.
struct WindowNumbers {
  double seconds = 0.0;             ///< since the first frame [s]
  std::optional<double> seekingTo;  ///< the time that the recording runs to without pictures [s]
  double duration = 0.0;            ///< of a recording [s]; 0 = live, without timeline and speed
  int parts = 0;                    ///< of the body
  int maxParts = 0;                 ///< at the finest level of detail; 0 = no choice
  double facing = 0.0;              ///< azimuth to which the followed avatar looks, see directionAt() [rad]
};

/// What a window shows in its panels; texts and lists are borrowed while they are drawn. Independent of sessions and
/// files.
struct WindowValues : WindowNumbers {
  std::string_view name;                     ///< of the played motion
  std::string_view status;                   ///< one line of status
  bool ended = false;                        ///< there are no more frames
  bool preparingParts = false;               ///< another level of detail is being computed
  std::span<const std::string> scenes;       ///< to choose from; empty = none
  int scene = 0;                             ///< index of the current scene
  std::span<const std::string> expressions;  ///< of the avatar's face, to choose from; empty = none
  int expression = -1;                    ///< index of the one that was chosen here; -1 = none; or kExpressionsAsGiven
  std::span<const std::string> warnings;  ///< messages
  bool outsideTraining = false;           ///< the pose is outside the training range of the hulls
  unsigned holds = 0;                     ///< a bit for each hand that moves a prop; the mouse, 0, not the camera then
  std::optional<Vec3> focus = {};         ///< what a following camera moves with [m]
  std::optional<Aabb> followed = {};      ///< what a following camera keeps in view, between the panels [m]
  std::span<const std::string> avatars;   ///< their names, to follow one; empty = no choice
  int avatar = -1;                        ///< index of the followed one; -1 = all
  std::span<const std::string> characters;  ///< that can be opened: recent, dropped, shipped; empty = none
  int character = -1;                       ///< index of the one that is shown; -1 = another
  std::span<const std::string> motions;     ///< that can be opened by name; empty = none
  int motion = -1;                          ///< index of the played one; -1 = another
  std::span<const std::string> clips;       ///< of the played file; empty = no choice
  int clip = 0;                             ///< index of the played one
  std::span<const std::string> people;      ///< of the played recording; empty = no choice
  int person = -1;                          ///< index of the one who is followed; -1 = everyone
  bool everyone = false;                    ///< everyone can be chosen
  std::span<const std::string> recent;      ///< other files that were opened, to be opened again; empty = none
  bool opens = false;                       ///< files can be opened
  std::string_view hint;                    ///< what may be dropped on the window; empty = nothing is said
  std::string_view loading;                 ///< what is loaded meanwhile; empty = nothing
  double loaded = 0.0;                      ///< share of it that is done
  std::span<const TargetScore> hits;        ///< of the scene's targets; empty = it has none
  bool treatable = false;                   ///< there is a choice of mirror, smoothing and gravity
  std::uint64_t changes = 0;                ///< grows whenever the scene is another
  double smoothingDelay = -1.0;             ///< as measured [s]; below 0 = no smoothing
  std::string_view recording;               ///< the file that the session is recorded to; empty = none
  // Why something cannot be done; empty = it can be done. With static storage duration.
  std::string_view noMirror;
  std::string_view noSmoothing;
  std::string_view noGravity;
  std::string_view noThrow;
  std::string_view noUndo;
  std::string_view noLoop;
  std::string_view noRecord;

  // Filled by the window itself.
  double pictureMilliseconds = 0.0;
  double picturesASecond = 0.0;
  std::span<const char* const> qualities = {};  ///< names, lowest first
  int quality = 0;                              ///< index of the present one
  double videoSeconds = -1.0;                   ///< length of the video that is written [s]; below 0 = none
  double insetWidth = 0.0, insetHeight = 0.0;   ///< of Scene::inset at the lower right [pixels]; 0 = none
  bool grains = false;                          ///< there is sand or water
  std::string_view notice = {};                 ///< temporary message; empty = none
  std::optional<std::string_view> typed = {};  ///< the path of a file that the user types; none = that is not asked for
  bool problem = false;                        ///< it says what failed

  /// Whether nothing has been loaded yet.
  [[nodiscard]] bool empty() const { return !loading.empty() && parts == 0; }
  /// Calls visit(std::string_view) for each text.
  template <typename Visit>
  void eachText(const Visit& visit) const {
    for (const std::string_view text : {name, status, hint, loading, notice, typed.value_or("")}) visit(text);
    for (const auto& texts : {scenes, expressions, warnings, avatars, characters, motions, clips, people, recent}) {
      for (const std::string& text : texts) visit(std::string_view(text));
    }
    for (const TargetScore& target : hits) visit(std::string_view(target.name));
  }
};
/// WindowValues::expression: those that the command gave, or that the source of the motion sends.
inline constexpr int kExpressionsAsGiven = -2;

/// What a hand does. Hand 0 is the mouse or the left controller, 1 the right one; others belong to who else watches.
struct HandRequests {
  std::optional<Ray> pressed;      ///< wants the prop that this meets; the left button was pressed outside the panels
  bool released = false;           ///< lets go, after what was pressed
  Vec3 throwsWith = Vec3::Zero();  ///< velocity of a prop that is released [m/s]; 0 = its own
};

/// Requests of the user since the last call, except those that the window handles itself.
struct WindowRequests {
  std::optional<double> seekTo;    ///< this time of the recording [s]
  std::optional<int> parts;        ///< another level of detail
  std::optional<int> scene;        ///< another of WindowValues::scenes
  std::optional<int> expression;   ///< another of WindowValues::expressions, or -1 = none
  bool nextExpression = false;     ///< the one after the current one; after the last none
  std::optional<int> avatar;       ///< follow another of WindowValues::avatars, or -1 = all
  std::optional<int> clip;         ///< another of WindowValues::clips
  std::optional<int> person;       ///< another of WindowValues::people, or -1 = everyone
  std::vector<std::string> files;  ///< open these, which were dropped on the window
  std::string received;            ///< open this, which somebody sent who watches elsewhere; empty = nothing
  bool choose = false;             ///< let the user choose files to open
  bool cancel = false;             ///< what is loading
  bool throwBall = false;
  std::optional<Camera> thrower;  ///< throws from here at its target; none = the screen's, at what it follows
  std::optional<bool> record;     ///< begin a recording, with the session at its start, or end it
  bool findCamera = false;        ///< find anew how the headset lies to the depth camera
  bool undo = false;              ///< take back what was thrown or dragged last
  std::optional<Ray> clicked;     ///< the left button was pressed and released at one place, not on a held prop
  std::array<HandRequests, World::kMaxHands> hands;
};

}  // namespace lorica
