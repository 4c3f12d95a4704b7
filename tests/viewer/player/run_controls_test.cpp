#include "geometry/errors.h"
#include "geometry/files.h"
#include "session/prepare/cast.h"
#include "session/prepare/live_cast.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"
#include "viewer/player/run.h"
#include "viewer/player/snapshots.h"
#include "viewer/player/window_opener.h"
#include "viewer/player/window_settings.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

using test::valueOf;

// What people at a screen ask for in one turn of a run.

/// A screen at which one turn after the other is as the test wants it.
class ScriptedScreen final : public Screen {
 public:
  /// @return what is asked for in this turn; it may end the run
  std::function<std::vector<Change>(ScriptedScreen&)> turn;
  bool ended = false;
  std::vector<std::string> said;
  Controls controls;  // as shown last
  HandAim pointed;

  [[nodiscard]] bool open() const override { return !ended; }
  void show(const Scene&, const WindowValues& values) override {
    if (values.controls != nullptr) controls = *values.controls;
  }
  void rest(double) override {}
  [[nodiscard]] std::vector<Change> takeChanges() override { return turn(*this); }
  [[nodiscard]] HandAim aim(int) const override { return pointed; }
  [[nodiscard]] Camera camera() const override { return {}; }
  void setCamera(const Camera&) override {}
  void addTimes(std::span<const TimedStage>) override {}
  void notice(std::string sentence, double) override { said.push_back(std::move(sentence)); }
  void problem(std::string sentence) override { said.push_back(std::move(sentence)); }
  void setTitle(const std::string&) override {}
};

/// Live nothing can be undone: that is said, and what else was asked for in the same turn is done. A prop that was let
/// go must not hang on a hand that is not there.
TEST(RunControls, AnUndoThatCannotBeDoneSwallowsNoRelease) {
  const test::TemporaryFolder home;
  ::setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  Host host;
  CastRequest request;
  LiveRequest live;
  live.depth.virtualCamera = true;
  const auto run = valueOf(Run::start(valueOf(prepareLiveCast(request, live, host)), {}, host));
  const World& world = run->session.world();
  Ray down{Vec3::Zero(), -Vec3::UnitY()};
  for (std::size_t i = 0; i < world.props().size(); ++i) {
    down.origin = world.props()[i].worldFromProp.translation() + Vec3(0.0, 3.0, 0.0);
    const std::optional<PropPick> pick = world.pick(down);
    if (world.props()[i].mass > 0.0 && pick && pick->prop == static_cast<int>(i)) break;
  }
  ScriptedScreen screen;
  screen.pointed = {down, down.direction};
  bool held = false;
  int turns = 0, frame = 0;
  screen.turn = [&](ScriptedScreen& self) {
    std::vector<Change> changes;
    if (turns > 0 && run->session.frameCount() == frame) return changes;  // actions are done with the next frame
    frame = run->session.frameCount();
    const bool holds = run->session.world().held(0).has_value();
    if (turns == 0) changes = {{.id = ControlId::kPress, .ray = down}};
    if (turns == 1) {
      held = holds;
      changes = {{.id = ControlId::kUndo}, {.id = ControlId::kRelease}};
    }
    if (turns == 2) {
      EXPECT_FALSE(holds) << "it was let go";
      self.ended = true;
    }
    ++turns;
    return changes;
  };
  Shown shown{&screen, {}, nullptr, {}};
  EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kClosed);
  EXPECT_TRUE(held) << "there was something to let go";
  EXPECT_EQ(screen.said, std::vector<std::string>{"what happened live cannot be undone"});
}

TEST(RunControls, ADarkRoomIsKeptUntilTheCommandSaysOtherwise) {
  const test::TemporaryFolder home;
  ::setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  // @return whether the room was dark at first
  const auto wasDark = [](const Background* background, double chosen) {
    Host host;
    CastRequest request;
    request.motion = "walk";
    const auto run = valueOf(Run::start(valueOf(prepareCast(request, host)), {}, host));
    ScriptedScreen screen;
    bool dark = false;
    int turns = 0;
    screen.turn = [&](ScriptedScreen& self) -> std::vector<Change> {
      if (turns == 0) dark = self.choices().show.dark;
      if (turns == 0) self.asked().ask({.id = ControlId::kBackground, .to = chosen});
      self.ended = ++turns > 1;
      return {};
    };
    Shown shown{&screen, {}, nullptr, {}};
    shown.background = background;
    EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kClosed);
    return dark;
  };
  const Background light;
  EXPECT_FALSE(wasDark(nullptr, 1.0));
  EXPECT_TRUE(wasDark(nullptr, 1.0)) << "chosen in the window before";
  EXPECT_FALSE(wasDark(&light, 0.0));
}

/// What a run cannot do is greyed, and what it does not have is absent; neither is done, whoever asks for it.
TEST(RunControls, WhatCannotBeDoneIsNotDone) {
  const test::TemporaryFolder home;
  ::setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  Host host;
  CastRequest request;
  request.motion = "walk";
  RunSetting setting;
  setting.record = home.path() / "walk.lsession";
  const auto run = valueOf(Run::start(valueOf(prepareCast(request, host)), setting, host));
  ScriptedScreen screen;
  int turns = 0;
  screen.turn = [&](ScriptedScreen& self) -> std::vector<Change> {
    self.ended = ++turns > 3;
    if (turns == 1) self.asked().ask({.id = ControlId::kMirror, .to = 1.0});
    if (turns != 2) return {};
    const Controls& controls = self.controls;
    EXPECT_FALSE(controls[ControlId::kMirror].whyNot.empty()) << "what is written is as it was begun";
    EXPECT_EQ(controls[ControlId::kMirror].value, 0.0);
    EXPECT_FALSE(controls[ControlId::kUndo].whyNot.empty());
    EXPECT_TRUE(controls[ControlId::kClick].absent) << "there is one avatar";
    EXPECT_TRUE(controls[ControlId::kExpression].absent) << "without a face";
    EXPECT_EQ(controls[ControlId::kSeek].most, run->duration());
    return {{.id = ControlId::kScene, .to = 100.0},
            {.id = ControlId::kParts, .to = 1e6},
            {.id = ControlId::kExpression},
            {.id = ControlId::kOpen, .files = {"walk.bvh"}},
            {.id = ControlId::kRecord, .to = 1.0}};
  };
  Shown shown{&screen, {}, nullptr, {}};
  EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kClosed);
  EXPECT_EQ(screen.said, (std::vector<std::string>{"files can be opened in the window of lorica play",
                                                   "a recorded session is not recorded again"}));
}

struct Listening final : Host {
  std::vector<std::string> warnings;
  void warn(const std::string& sentence) override { warnings.push_back(sentence); }
};

Result<Cast> openedBy(WindowOpener& opener, const std::filesystem::path& file) {
  LORICA_TRY_DO(opener.open({file.string()}));
  while (true) {
    if (std::optional<Result<Cast>> cast = opener.take()) return std::move(*cast);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(WindowOpener, OptionsForOneCharacterYieldToAnother) {
  const TemporaryFolder folder;
  const std::filesystem::path box = folder.write("box.glb", smallCharacter().glb());
  Listening host;
  CastRequest present;
  present.reading.expressions = {"Joy=1"};
  present.performing.clip = "Nod";
  WindowOpener opener(present, host);
  const Result<Cast> cast = openedBy(opener, box);
  ASSERT_TRUE(cast) << cast.error().message;
  EXPECT_EQ(cast->avatars.front().character().name, "box");
  EXPECT_TRUE(cast->request.reading.expressions.empty());
  EXPECT_EQ(host.warnings,
            std::vector<std::string>{"--expression and --clip do not fit what was opened and are left out"});
}

TEST(WindowOpener, WhatItDoesNotOpenIsNamed) {
  const TemporaryFolder folder;
  Listening host;
  CastRequest present;
  present.motion = "walk";
  WindowOpener opener(present, host);
  const Result<Cast> cast = openedBy(opener, folder.write("photo.jpg", "\xff\xd8\xff\xe0"));
  ASSERT_FALSE(cast);
  EXPECT_NE(cast.error().message.find("found a JPEG picture; Lorica opens characters"), std::string::npos);
  EXPECT_TRUE(host.warnings.empty());
}

/// Files that somebody sent: one that is given up for another, fails or is cancelled is removed, one that was opened is
/// listed behind the user's own and never among them.
TEST(WindowOpener, SentFilesAreKeptOnlyIfTheyAreOpened) {
  const TemporaryFolder folder;
  Listening host;
  std::atomic<bool> waits = true, fails = false;
  WindowOpener opener(CastRequest(), host, "",
                      [&](const std::vector<CastRequest>& attempts, Host& loading) -> Result<Cast> {
                        while (waits && !loading.cancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                        if (fails) return badFormat("no such thing");
                        Cast cast;
                        cast.request = attempts.front();
                        return cast;
                      });
  const auto taken = [&] {
    for (;;) {
      if (std::optional<Result<Cast>> cast = opener.take()) return cast->ok();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  std::filesystem::create_directory(folder.path() / kSentFolder);
  const auto sent = [&](const std::string& name) {
    return std::filesystem::path(folder.write(std::string(kSentFolder) + "/" + name, name));
  };
  const std::filesystem::path first = sent("1.glb"), second = sent("2.glb"), third = sent("3.bvh"), bad = sent("4.bvh"),
                              late = sent("5.bvh"), own = folder.write("own.glb", "own");
  opener.recordInto(folder.path());
  ASSERT_TRUE(opener.openReceived(first));
  ASSERT_TRUE(opener.openReceived(second));
  EXPECT_FALSE(exists(first)) << "another one took its place";
  waits = false;
  EXPECT_TRUE(taken());
  ASSERT_TRUE(opener.openReceived(third));
  EXPECT_TRUE(taken());
  fails = true;
  ASSERT_TRUE(opener.openReceived(bad));
  EXPECT_FALSE(taken());
  waits = true;
  ASSERT_TRUE(opener.openReceived(late));
  opener.cancel();
  EXPECT_FALSE(taken());
  waits = fails = false;
  ASSERT_TRUE(opener.open({own.string()}));
  EXPECT_TRUE(taken());
  ASSERT_TRUE(opener.open({second.string()})) << "again, from the list";
  EXPECT_TRUE(taken());
  for (const auto& kept : {second, third, own}) EXPECT_TRUE(exists(kept)) << kept;
  for (const auto& removed : {bad, late}) EXPECT_FALSE(exists(removed)) << removed;
  EXPECT_EQ(opener.opened(), std::vector<std::string>{own.string()});
  opener.list({own.string()});
  const auto choicesOf = [&](ControlId id) {
    Controls controls;
    opener.listControls(controls);
    return std::vector<std::string>(controls[id].choices.begin(), controls[id].choices.end());
  };
  EXPECT_EQ(choicesOf(ControlId::kCharacter), (std::vector<std::string>{own.string(), second.string(), "mannequin"}));
  EXPECT_EQ(choicesOf(ControlId::kRecent), std::vector<std::string>{third.string()});
  EXPECT_EQ(choicesOf(ControlId::kSent), std::vector<std::string>{third.string()});
}

/// Opened once, a file may name others that only --trust-paths lets it have.
TEST(WindowOpener, SentFilesAreNotListedWhereTheyMayNameAnyOther) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / kSentFolder);
  const std::string file = folder.write(std::string(kSentFolder) + "/1.bvh", "1");
  folder.write(std::string(kSentFolder) + "/2.bvh.tmp-1-1", "half of it");
  for (const PathTrust paths : {PathTrust::kBeneath, PathTrust::kAnywhere}) {
    Host host;
    host.paths = paths;
    WindowOpener opener(CastRequest(), host);
    opener.recordInto(folder.path());
    opener.list({});
    Controls controls;
    opener.listControls(controls);
    const std::span<const std::string> recent = controls[ControlId::kRecent].choices;
    EXPECT_EQ(std::vector<std::string>(recent.begin(), recent.end()),
              paths == PathTrust::kBeneath ? std::vector<std::string>{file} : std::vector<std::string>());
  }
}

TEST(WindowSettings, AreReadAsTheyWereWritten) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "lorica" / "window.json";
  EXPECT_EQ(readWindowSettings(file).value(), WindowSettings()) << "there are none yet";
  WindowSettings settings;
  settings.choices.loop = false;
  settings.choices.scale = 1.5625;
  settings.choices.treatment = {true, 2, 1};
  settings.shown = {{"hulls", false}, {"bones", true}};
  addRecent("/home/a name/hero.glb", settings);
  addRecent("walk", settings);
  addRecent("/home/a name/hero.glb", settings);
  ASSERT_EQ(settings.recent, (std::vector<std::string>{"/home/a name/hero.glb", "walk"})) << "the last one first";
  ASSERT_TRUE(writeWindowSettings(file, settings).ok());
  EXPECT_EQ(readWindowSettings(file).value(), settings);
  for (int i = 0; i < 30; ++i) addRecent(std::to_string(i), settings);
  EXPECT_EQ(settings.recent.size(), kMaxRecent);
}

TEST(WindowSettings, DamagedOnesAreASentence) {
  const test::TemporaryFolder folder;
  const std::string fine = R"({"format": "lorica window 1", "loop": false, "scale": 2, "recent": ["a"]})";
  EXPECT_FALSE(readWindowSettings(folder.write("fine", fine)).value().choices.loop);
  for (const char* damaged :
       {"", "[]", "{}", "nonsense", R"({"format": "lorica window 2"})", R"({"format": "lorica window 1", "loop": 1})",
        R"({"format": "lorica window 1", "mirror": "yes"})", R"({"format": "lorica window 1", "gravity": 9.81})",
        R"({"format": "lorica window 1", "smoothing": "very"})", R"({"format": "lorica window 1", "shown": []})",
        R"({"format": "lorica window 1", "shown": {"hulls": 1}})", R"({"format": "lorica window 1", "scale": 1e9})",
        R"({"format": "lorica window 1", "scale": "big"})", R"({"format": "lorica window 1", "recent": [1]})",
        R"({"format": "lorica window 1", "recent": "a"})"}) {
    const Result<WindowSettings> read = readWindowSettings(folder.write("damaged", damaged));
    ASSERT_FALSE(read.ok()) << damaged;
    EXPECT_NE(read.error().message.find("damaged"), std::string::npos) << read.error().message;
  }
  for (std::size_t length = 0; length + 1 < fine.size(); ++length) {
    EXPECT_FALSE(readWindowSettings(folder.write("cut", fine.substr(0, length))).ok()) << length;
  }
}

TEST(WindowSettings, OnlyLayersThatTheUserSwitchedAreKept) {
  WindowSettings settings;
  SceneOptions before, now;
  now.bones = true;
  now.hulls = false;
  keepShown(before, now, settings);
  EXPECT_EQ(settings.shown, (std::map<std::string, bool>{{"bones", true}, {"hulls", false}}));
  SceneOptions other;
  other.colorSkinByPart = false;  // as another character is usually shown
  showKept(settings, other);
  EXPECT_TRUE(other.bones);
  EXPECT_FALSE(other.hulls);
  EXPECT_FALSE(other.colorSkinByPart);
}

TEST(Treatment, WhatTheCommandSaysWinsOverWhatIsKept) {
  const Treatment kept{true, 3, 0};
  MotionOptions options;
  EXPECT_EQ(allowed(treatmentControl(options, true), kept), kept);
  options.mirror = true;
  options.smooth = MotionOptions::Smoothing::kOneEuro;
  options.smoothGiven = true;
  const TreatmentControl given = treatmentControl(options, true);
  EXPECT_EQ(allowed(given, {false, 3, 0}), (Treatment{true, kSmoothingAsGiven, 0}));
  options.oneEuro.minCutoff = 0.9;
  EXPECT_EQ(treated(options, allowed(given, kept)).oneEuro.minCutoff, 0.9);
  EXPECT_EQ(treated(MotionOptions(), {false, 2, 2}).oneEuro.minCutoff, OneEuroSettings().minCutoff);
  EXPECT_EQ(treated(MotionOptions(), {false, 2, 2}).smooth, MotionOptions::Smoothing::kOneEuro);
  EXPECT_EQ(treated(MotionOptions(), {}).smooth, MotionOptions::Smoothing::kOff);
  TreatmentControl written = treatmentControl(MotionOptions(), true);
  written.fix("what is written");
  EXPECT_EQ(allowed(written, kept), Treatment());
}

TEST(WindowSettings, LieInTheUsersConfigurationFolder) {
  const char* before = std::getenv("XDG_CONFIG_HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_CONFIG_HOME", "/somewhere", 1);
  EXPECT_EQ(windowSettingsFile(), "/somewhere/lorica/window.json");
  setenv("XDG_CONFIG_HOME", "relative", 1);
  setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(windowSettingsFile(), "/home/someone/.config/lorica/window.json");
  setenv("XDG_CONFIG_HOME", kept.c_str(), 1);
}

}  // namespace
}  // namespace lorica::test
