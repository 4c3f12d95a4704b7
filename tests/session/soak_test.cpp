#include "session/scenes/demo_scene.h"
#include "session/scenes/scene_file.h"
#include "tests/session/small_session.h"
#include "tests/session/soak_run.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <memory>

namespace lorica {
namespace {

std::vector<test::SoakScene> twoScenes() {
  const std::filesystem::path scenes = test::recordingsFolder() / "scenes";
  const auto bowling = std::make_shared<const SceneFile>(readScene(scenes / "bowling.json").value());
  return {{"demo", makeDemoWorld}, {"bowling", [bowling](std::uint64_t) { return makeWorld(*bowling).value(); }}};
}

/// A short version of the one-hour run in tests/bench/soak.cpp. Frame times are not tested.
test::SoakSettings shortly() {
  test::SoakSettings settings;
  settings.seconds = 20.0;
  settings.budget = 1e6;
  return settings;
}

TEST(Soak, TwentySecondsBreakNothing) {
  const test::SoakResult result = test::soak(test::eightParts(), twoScenes(), shortly());
  for (const std::string& violation : result.violations) ADD_FAILURE() << violation;
  EXPECT_GE(result.seconds, 20.0);
  EXPECT_GT(result.frames, 500);
  EXPECT_GT(result.balls, 5);
  EXPECT_GT(result.grabs, 2);
  EXPECT_GE(result.worlds, 3);
  long contacts = 0;
  for (const test::SoakRow& row : result.rows) contacts += row.contacts;
  EXPECT_GT(contacts, 20);
}

TEST(Soak, SaysWhatBroke) {
  test::SoakSettings settings = shortly();
  settings.seconds = 2.0;
  World::Settings bottomless;
  bottomless.floor = false;
  const auto scene = [&](std::uint64_t) {
    World world(bottomless);
    world.addProp(Prop());
    return world;
  };
  const test::SoakResult falls = test::soak(test::eightParts(), {{"bottomless", scene}}, settings);
  ASSERT_FALSE(falls.violations.empty());
  EXPECT_NE(falls.violations[0].find("went through the floor"), std::string::npos);
  settings.budget = 1e-9;
  const test::SoakResult slow = test::soak(test::eightParts(), {{"demo", makeDemoWorld}}, settings);
  ASSERT_FALSE(slow.violations.empty());
  EXPECT_NE(slow.violations[0].find("of CPU time"), std::string::npos);
}

/// A short version of tests/bench/soak.cpp --avatars.
TEST(Soak, AvatarsThatComeAndGoBreakNothing) {
  test::AvatarSoakSettings settings;
  settings.seconds = 15.0;
  settings.places = 3;
  const test::AvatarSoakResult result = test::soakAvatars(test::eightParts(), settings);
  for (const std::string& violation : result.violations) ADD_FAILURE() << violation;
  EXPECT_EQ(result.frames, 450);
  EXPECT_GT(result.entries, 5);
  EXPECT_GT(result.exits, 3);
  EXPECT_GT(result.contacts, 10);
  EXPECT_GT(result.meetings, 10);
  EXPECT_GT(result.events, 10);
}

}  // namespace
}  // namespace lorica
