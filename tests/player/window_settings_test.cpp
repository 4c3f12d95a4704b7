#include "player/window_settings.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lorica {
namespace {

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

TEST(WindowTreatment, WhatTheCommandSaysWinsOverWhatIsKept) {
  const WindowTreatment kept{true, 3, 0};
  MotionOptions options;
  EXPECT_EQ(allowed(treatmentControl(options, true), kept), kept);
  options.mirror = true;
  options.smooth = "one-euro";
  options.smoothGiven = true;
  const TreatmentControl given = treatmentControl(options, true);
  EXPECT_EQ(allowed(given, {false, 3, 0}), (WindowTreatment{true, kSmoothingAsGiven, 0}));
  options.oneEuro.minCutoff = 0.9;
  EXPECT_EQ(treated(options, allowed(given, kept)).oneEuro.minCutoff, 0.9);
  EXPECT_EQ(treated(MotionOptions(), {false, 2, 2}).oneEuro.minCutoff, OneEuroSettings().minCutoff);
  EXPECT_EQ(treated(MotionOptions(), {false, 2, 2}).smooth, "one-euro");
  EXPECT_EQ(treated(MotionOptions(), {}).smooth, "off");
  TreatmentControl written = treatmentControl(MotionOptions(), true);
  written.fix("what is written");
  EXPECT_EQ(allowed(written, kept), WindowTreatment());
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
}  // namespace lorica
