#pragma once

#include "collision/world/world.h"
#include "viewer/renderer/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// What people can do, said once. Panels, pages, headsets, keys and help are drawn from a list of controls, and what
// somebody does comes back as a Change. A switch is a row of kControlRows and a field of Choices; what the run itself
// does is a row, and its value and its deed in viewer/player/run_controls.cpp.

namespace lorica {

/// A value that the user may choose by name.
struct NamedFactor {
  const char* name = "";
  double factor = 1.0;
};
inline constexpr std::array<NamedFactor, 4> kSpeeds = {{{"1/4", 0.25}, {"1/2", 0.5}, {"1", 1.0}, {"2", 2.0}}};
inline constexpr int kUsualSpeed = 2;  ///< as recorded
/// Times the gravity of the scene.
inline constexpr std::array<NamedFactor, 4> kGravities = {
    {{"none", 0.0}, {"moon", 1.0 / 6.0}, {"usual", 1.0}, {"double", 2.0}}};
/// Of tracked joints: OneEuroSettings::minCutoff [Hz]; 0 = no smoothing.
inline constexpr std::array<NamedFactor, 4> kSmoothings = {
    {{"off", 0.0}, {"light", 3.0}, {"medium", 1.5}, {"strong", 0.75}}};
/// Of the picture.
inline constexpr std::array<NamedFactor, 3> kQualities = {{{"low"}, {"medium"}, {"high"}}};
/// Treatment::smoothing: the filter of the command line.
inline constexpr int kSmoothingAsGiven = -1;

/// What may be behind the picture.
struct BackgroundChoice {
  const char* name = "";
  std::optional<Vec3f> color = {};  ///< see SceneOptions
  bool transparent = false;
  bool dark = false;
};
inline const std::array<BackgroundChoice, 6> kBackgrounds = {{{"light"},
                                                              {"dark", {}, false, true},
                                                              {"white", Vec3f(1.0f, 1.0f, 1.0f)},
                                                              {"black", Vec3f(0.0f, 0.0f, 0.0f)},
                                                              {"green", Vec3f(0.0f, 1.0f, 0.0f)},
                                                              {"transparent", {}, true}}};

/// How the motion and the world are treated.
struct Treatment {
  bool mirror = false;
  int smoothing = 0;  ///< index of kSmoothings or kSmoothingAsGiven
  int gravity = 2;    ///< index of kGravities

  [[nodiscard]] bool operator==(const Treatment&) const = default;
};

/// What the user chose and keeps from one run to the next.
struct KeptChoices {
  bool loop = true;    ///< at the end of a recording it starts again; else the world continues and the avatar stands
  bool follow = true;  ///< the camera moves with WindowValues::focus
  double scale = 1.0;  ///< of text and panels, times the system's; kSmallestScale to kLargestScale
  Treatment treatment;

  [[nodiscard]] bool operator==(const KeptChoices&) const = default;
};
inline constexpr double kSmallestScale = 0.5, kLargestScale = 4.0;

/// What the user chose on a screen.
struct Choices : KeptChoices {
  SceneOptions show;  ///< the layers that are drawn
  bool paused = false;
  int steps = 0;            ///< single steps that were asked for
  bool scrubbing = false;   ///< the timeline is dragged: playback is suspended
  int speed = kUsualSpeed;  ///< of playback: index of kSpeeds
  bool help = false;
  bool panels = true;
  int quality = -1;                                 ///< of the picture; -1 = automatic
  bool inside = false;                              ///< a headset sees through the avatar's eyes, else from beside it
  bool picture = false, pictureWithPanels = false;  ///< to be saved
  bool video = false;                               ///< to be started or stopped

  [[nodiscard]] double speedFactor() const { return kSpeeds[speed].factor; }
};

/// What can be done: rows of kControlRows, in its order.
enum class ControlId : std::uint8_t {
  kPress,
  kPan,
  kZoom,
  kLookFrom,
  kReset,
  kClick,
  kInside,
  kPause,
  kStep,
  kRestart,
  kSeek,
  kSpeed,
  kCharacter,
  kMotion,
  kClip,
  kPerson,
  kExpression,
  kScene,
  kRecent,
  kSent,
  kOpen,
  kMirror,
  kSmoothing,
  kGravity,
  kLoop,
  kThrow,
  kUndo,
  kRecord,
  kSkin,
  kHulls,
  kBones,
  kProps,
  kContacts,
  kGround,
  kGrains,
  kDepth,
  kColors,
  kFollow,
  kAvatar,
  kParts,
  kBackground,
  kQuality,
  kPicture,
  kVideo,
  kPanels,
  kTextSize,
  kHelp,
  kEscape,
  kFindCamera,
  kCancel,
  kRelease
};
inline constexpr std::size_t kControlCount = static_cast<std::size_t>(ControlId::kRelease) + 1;

/// How a control is operated.
enum class ControlKind : std::uint8_t {
  kToggle,
  kButton,
  kList,    ///< one of several names
  kFiles,   ///< one of several files, shown without their folders
  kNumber,  ///< within a range
  kOther    ///< by keys and mouse that a screen knows itself: only help has it
};

/// Where a control is found.
enum class ControlGroup : std::uint8_t { kCamera, kTime, kThings, kLook, kScreen, kNowhere };
inline constexpr std::array<const char*, 5> kControlGroups = {"Camera", "Time", "Things and files", "Look", "Screen"};

/// Where a control is found, and how: bits of Control::on.
namespace on_screen {
inline constexpr unsigned kWindow = 1, kPage = 2, kHeadset = 4;
inline constexpr unsigned kOwn = 8;       ///< each window and page has it for itself
inline constexpr unsigned kRepeats = 16;  ///< while its key is held
}  // namespace on_screen

/// Something that people can do or choose, and what it is now.
struct Control {
  ControlId id = ControlId::kCancel;
  const char* name = "";   ///< in the wire
  const char* label = "";  ///< in panels
  /// Does it: another state of a switch, the next of a list, which begins again at its end. Two keys, "- +": the one
  /// before and the next, as far as there are any.
  const char* keys = "";
  const char* help = "";  ///< what they do; empty = as the label
  ControlKind kind = ControlKind::kButton;
  ControlGroup group = ControlGroup::kNowhere;
  unsigned on = 0;  ///< see on_screen
  // What a screen keeps in Choices; null = the run has it.
  bool& (*flag)(Choices&) = nullptr;
  int& (*index)(Choices&) = nullptr;
  std::span<const std::string> (*names)() = nullptr;  ///< for `index`

  // What it is now. Texts and lists are borrowed while they are drawn.
  const char* none = "another";               ///< what -1 of a list is called
  double least = 0.0, most = 0.0;             ///< of a number; `least` of a list: -1 = none can be chosen
  double value = 0.0;                         ///< 0 or 1, an index, -1 = none or another, or a number
  std::span<const std::string> choices = {};  ///< of a list
  std::string_view whyNot = {};               ///< it cannot be done; empty = it can
  bool absent = false;                        ///< there is nothing to choose here: only help has it, in grey

  [[nodiscard]] bool isOn(unsigned bits) const { return (on & bits) == bits; }
  /// The key for the one before and that for the next.
  [[nodiscard]] std::string_view back() const;
  [[nodiscard]] std::string_view key() const;
};

/// The names of one of the lists above.
template <const auto& kList>
[[nodiscard]] std::span<const std::string> choiceNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& choice : kList) all.emplace_back(choice.name);
    return all;
  }();
  return names;
}

namespace control_rows {
using enum ControlId;
using enum ControlKind;
using enum ControlGroup;
using namespace on_screen;
using C = Choices;
inline constexpr unsigned kBoth = kWindow | kPage, kEach = kBoth | kOwn;

inline constexpr std::array<Control, kControlCount> kRows = {{
    {kPress, "press", "", "left drag", "turn, or move a prop", kOther, kCamera, kWindow},
    {kPan, "pan", "", "right drag", "shift", kOther, kCamera, kWindow},
    {kZoom, "zoom", "", "wheel", "zoom", kOther, kCamera, kWindow},
    {kLookFrom, "look", "", "F2 F3 F4 F5", "front, side, back, top", kOther, kCamera, kWindow},
    {kReset, "reset", "", "R", "the camera as at first", kOther, kCamera, kEach},
    {kClick, "click", "", "click", "follow an avatar, or all", kOther, kCamera, kWindow},
    {kInside, "inside", "see through the avatar's eyes", "I", "headset: inside the avatar, beside it", kToggle, kCamera,
     kWindow | kHeadset | kOwn, [](C& c) -> bool& { return c.inside; }},

    {kPause, "pause", "pause", "space", "pause, go on", kToggle, kTime, kBoth | kHeadset,
     [](C& c) -> bool& { return c.paused; }},
    {kStep, "step", "step", "N", "one frame", kButton, kTime, kBoth | kRepeats},
    {kRestart, "restart", "restart", "home", "start again", kButton, kTime, kBoth | kHeadset},
    {kSeek, "seek", "time", "left right", "1 s back, ahead", kNumber, kTime, kBoth | kRepeats},
    {kSpeed, "speed", "speed", "- +", "slower, faster", kList, kTime, kBoth, nullptr,
     [](C& c) -> int& { return c.speed; }, choiceNames<kSpeeds>},

    {kCharacter, "avatar", "avatar", "", "", kFiles, kThings, kBoth},
    {kMotion, "motion", "motion", "", "", kFiles, kThings, kBoth},
    {kClip, "clip", "clip", "", "", kList, kThings, kBoth},
    {kPerson, "person", "person", "", "", kList, kThings, kBoth},
    {kExpression, "expression", "expression", "E", "next expression", kList, kThings, kBoth},
    {kScene, "scene", "scene", "", "", kList, kThings, kBoth | kHeadset},
    // Those of the window's user are nobody else's business.
    {kRecent, "recent", "recent files", "", "", kFiles, kThings, kWindow},
    {kSent, "sent", "recent files", "", "", kFiles, kThings, kPage},
    {kOpen, "open", "open a file ...", "O", "open files; or drop them", kButton, kThings, kBoth},
    {kMirror, "mirror", "mirror", "", "", kToggle, kThings, kBoth, [](C& c) -> bool& { return c.treatment.mirror; }},
    {kSmoothing, "smoothing", "smoothing", "", "", kList, kThings, kBoth, nullptr,
     [](C& c) -> int& { return c.treatment.smoothing; }, choiceNames<kSmoothings>, "as given"},
    {kGravity, "gravity", "gravity", "", "", kList, kThings, kBoth, nullptr,
     [](C& c) -> int& { return c.treatment.gravity; }, choiceNames<kGravities>},
    {kLoop, "loop", "start again at the end", "L", "start again at the end, or not", kToggle, kThings, kBoth,
     [](C& c) -> bool& { return c.loop; }},
    {kThrow, "throw", "throw a ball", "B", "", kButton, kThings, kBoth},
    {kUndo, "undo", "undo", "U", "undo the last throw or drag", kButton, kThings, kBoth},
    {kRecord, "record", "record from the start", "", "", kButton, kThings, kPage},

    {kSkin, "character", "character", "1", "", kToggle, kLook, kEach, [](C& c) -> bool& { return c.show.skin; }},
    {kHulls, "hulls", "hulls", "2", "", kToggle, kLook, kEach | kHeadset, [](C& c) -> bool& { return c.show.hulls; }},
    {kBones, "bones", "bones", "3", "", kToggle, kLook, kEach, [](C& c) -> bool& { return c.show.bones; }},
    {kProps, "props", "props", "4", "", kToggle, kLook, kEach, [](C& c) -> bool& { return c.show.props; }},
    {kContacts, "contacts", "contacts", "5", "", kToggle, kLook, kEach, [](C& c) -> bool& { return c.show.contacts; }},
    {kGround, "ground", "ground", "6", "", kToggle, kLook, kEach, [](C& c) -> bool& { return c.show.ground; }},
    {kGrains, "particles", "grains", "7", "", kToggle, kLook, kEach, [](C& c) -> bool& { return c.show.particles; }},
    {kDepth, "depth", "depth", "8", "depth image", kToggle, kLook, kPage | kOwn},
    {kColors, "colors", "by part", "C", "colours by part", kToggle, kLook, kEach,
     [](C& c) -> bool& { return c.show.colorSkinByPart; }},
    {kFollow, "follow", "follow with the camera", "F", "follow the avatars, or not", kToggle, kLook, kEach,
     [](C& c) -> bool& { return c.follow; }},
    {kAvatar, "followed", "follow", "", "", kList, kLook, kWindow, nullptr, nullptr, nullptr, "all avatars", -1.0},
    {kParts, "parts", "parts", "[ ]", "fewer, more parts", kNumber, kLook, kBoth},
    {kBackground, "background", "background", "", "", kList, kLook, kWindow | kOwn},
    {kQuality, "quality", "quality", "", "", kList, kLook, kWindow | kOwn, nullptr,
     [](C& c) -> int& { return c.quality; }, choiceNames<kQualities>, "auto", -1.0},
    {kPicture, "picture", "save a picture", "P", "save a picture; shift: with panels", kButton, kLook, kEach,
     [](C& c) -> bool& { return c.picture; }},
    {kVideo, "video", "start a video", "V", "start, stop a video", kButton, kLook, kEach,
     [](C& c) -> bool& { return c.video; }},

    {kPanels, "panels", "", "tab", "hide, show the panels", kToggle, kScreen, kWindow | kOwn,
     [](C& c) -> bool& { return c.panels; }},
    {kTextSize, "text", "", "ctrl + - 0", "size of the text", kOther, kScreen, kWindow | kOwn},
    {kHelp, "help", "", "H", "this help", kToggle, kScreen, kEach, [](C& c) -> bool& { return c.help; }},
    {kEscape, "escape", "", "esc", "close this help, then the window; twice if it is live", kOther, kScreen, kWindow},

    {kFindCamera, "find", "find the camera again: walk a curve", "", "", kButton, kNowhere, kHeadset},
    {kCancel, "cancel", "", "", "", kButton, kNowhere, kPage},
    {kRelease, "release", "", "", "", kOther},
}};

/// Whether rows are in the order of their names.
constexpr bool inOrder() {
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    if (static_cast<std::size_t>(kRows[i].id) != i) return false;
  }
  return true;
}
static_assert(inOrder());
}  // namespace control_rows

/// All controls, by ControlId.
struct Controls : std::array<Control, kControlCount> {
  using std::array<Control, kControlCount>::operator[];
  [[nodiscard]] Control& operator[](ControlId id) { return (*this)[static_cast<std::size_t>(id)]; }
  [[nodiscard]] const Control& operator[](ControlId id) const { return (*this)[static_cast<std::size_t>(id)]; }
  /// It can be chosen or done: a run has it.
  Control& offer(ControlId id) {
    (*this)[id].absent = false;
    return (*this)[id];
  }
  /// It can be chosen, if there is anything to choose from.
  void offer(ControlId id, std::span<const std::string> choices, int value) {
    Control& control = offer(id);
    control.choices = choices;
    control.value = value;
    control.absent = choices.empty();
  }
};

/// Something that somebody did.
struct Change {
  ControlId id = ControlId::kCancel;
  std::optional<double> to = {};        ///< the new value; none: the value goes on by `by`
  double by = 1.0;                      ///< another state of a switch, the next of a list; below 0 = back
  int client = 0;                       ///< of a page; 0 = at the screen itself
  std::vector<std::string> files = {};  ///< kOpen: these; none = the user is to choose some
  int hand = 0;                         ///< kPress, kRelease: 0 is the mouse or the left controller, 1 the right one;
                                        ///< others belong to who else watches
  Ray ray = {};                         ///< kPress, kClick; kThrow from there, if it has `at`
  std::optional<Vec3> at = {};          ///< kThrow: none = from the screen's camera at what it follows
  Vec3 velocity = Vec3::Zero();         ///< kRelease: of what is let go [m/s]; 0 = its own
};

/// The control of this name in the wire; null if there is none.
[[nodiscard]] const Control* controlNamed(std::string_view name);

/// The list as a screen has it: what the run adds is absent.
void listChoices(const Choices& choices, Controls& controls);

/// The value after a change. @return none if it cannot be: it is out of range, or not in the list
[[nodiscard]] std::optional<double> valueAfter(const Control& control, const Change& change);

/// Does what concerns only choices. @return whether it did
bool choose(const Change& change, Choices& choices);

/// Adds a change to those of a turn: of a control the last value counts, and steps add up; what hands do stays in
/// order.
void addTo(std::vector<Change>& changes, Change change);

/// What the user chose on a screen, and what is asked for in this turn.
struct Asked {
  Choices choices;
  std::vector<Change> changes;

  /// Does what concerns the choices alone; the rest becomes a change.
  void ask(Change change) {
    if (!choose(change, choices)) addTo(changes, std::move(change));
  }
};

/// While nothing can be asked for but to give up what loads: forgets all changes but files, and what hands let go.
/// @return whether to cancel
[[nodiscard]] bool takeCancelFrom(std::vector<Change>& changes);

}  // namespace lorica
