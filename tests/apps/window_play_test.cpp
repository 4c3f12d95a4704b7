#include "tests/apps/mannequin_glb.h"

#include "tests/apps/window_at_play.h"

#include <fstream>

namespace lorica::test {
namespace {

/// A red box that floats before the camera; there is no gravity.
constexpr const char* kFloatingBox = R"({
  "format": "lorica scene 1", "name": "box", "gravity": [0, 0, 0],
  "props": [{ "shape": "box", "size": [0.4, 0.4, 0.4], "at": [0, 1.0, 1.6], "mass": 1, "color": "#e02020" }]
})";

TEST_F(WindowPlay, PauseStopsMotionAndAStepMovesItAndTheTimelineGoesBack) {
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("space");
  hands.pictureAtRest();  // the panels fold, and the picture is framed between them
  hands.picture();        // nothing moved
  hands.press("n n n n n n");
  hands.pictureAtRest();  // six frames later
  hands.press("Home");
  hands.pictureAtRest();  // the first frame
  hands.press("n n n n n n n n n n n n");
  hands.pictureAtRest();
  hands.press("Home");
  hands.pictureAtRest();  // and again
  hands.press("bracketleft bracketleft bracketleft bracketleft");
  hands.pictureUnlike(6, 2000);  // one part
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const Image still = hands.pictureNumber(1);
  EXPECT_EQ(differing(still, hands.pictureNumber(2)), 0);
  EXPECT_GT(differing(still, hands.pictureNumber(3)), 200);
  EXPECT_GT(differing(hands.pictureNumber(4), hands.pictureNumber(5)), 200);
  EXPECT_EQ(differing(hands.pictureNumber(4), hands.pictureNumber(6)), 0) << "the same run, bit for bit";
  EXPECT_GT(differing(hands.pictureNumber(6), hands.pictureNumber(7)), 2000) << "one hull, one colour";
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["frames"], 1) << "the last run stopped at its first frame";
}

TEST_F(WindowPlay, ThingsAreDraggedAndBallsThrown) {
  const std::filesystem::path scene = folder_.write("box.json", kFloatingBox);
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("Tab f r space 1 2 5 6 n");  // only the box, from where the camera was at first
  hands.pictureAtRest();
  hands.mouse("mousemove --window $w 390 184");
  hands.mouse("mousedown 1");
  hands.handled();
  hands.mouse("mousemove --window $w 300 184");
  for (int i = 0; i < 6; ++i) {
    hands.press("n n n n n n");
    hands.pictureAtRest();
  }
  hands.mouse("mouseup 1");
  hands.press("n b n");
  hands.pictureUnlike(7, 300);
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--scene", scene.string(), "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const Blob before = redIn(hands.pictureNumber(1));
  const Blob after = redIn(hands.pictureNumber(7));
  ASSERT_GT(before.count, 200);
  ASSERT_GT(after.count, 200);
  ASSERT_NEAR(before.x, 390.0, 15.0) << "else the mouse turns the camera instead";
  ASSERT_NEAR(before.y, 184.0, 15.0);
  EXPECT_NEAR(after.x - before.x, -90.0, 45.0) << "the grabbed point follows the mouse";
  EXPECT_NEAR(after.y, before.y, 40.0);
  EXPECT_GT(differing(hands.pictureNumber(7), hands.pictureNumber(8)), 300) << "a ball is visible";
}

TEST_F(WindowPlay, ACharacterIsShownAsItsMakerDrewItUntilItsPartsAreAskedFor) {
  GlbWriter writer = mannequinWriter(false);
  const nlohmann::json red = {{"pbrMetallicRoughness", {{"baseColorFactor", {0.8, 0.0, 0.0, 1.0}}}},
                              {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}};
  writer.document["meshes"][0]["primitives"][0]["material"] = writer.add("materials", red);
  const std::string character = folder_.write("red.glb", writer.glb()).string();
  const std::string body = (folder_.path() / "red.lorica").string();
  const CommandResult made = runLorica({"decompose", character, "--parts", "4", "--keyframes", "2", "-o", body});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("space 4 5");
  for (const char* keys : {"c", "c 2", "2"}) {
    hands.pictureAtRest();
    hands.press(keys);
  }
  hands.pictureAtRest();
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--character", character, "--decomposition", body, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const int whole = redIn(hands.pictureNumber(1)).count;
  EXPECT_GT(whole, 1000);
  EXPECT_LT(redIn(hands.pictureNumber(2)).count, whole / 2) << "its body in the colours of its parts";
  EXPECT_GT(differing(hands.pictureNumber(1), hands.pictureNumber(3)), whole / 2) << "hulls over it";
  EXPECT_LT(redIn(hands.pictureNumber(3)).count, whole * 19 / 20);
  EXPECT_NEAR(redIn(hands.pictureNumber(4)).count, whole, whole / 20);
}

// What performs and how it is treated, chosen in the window while it runs.

/// The walk, and a second person who waves from 0.5 s on.
std::string twoPeopleIn(const TemporaryFolder& folder) {
  std::ifstream walk(shipped("walk.csv")), wave(shipped("wave.csv"));
  std::string first, second, text;
  std::getline(walk, first);
  std::getline(wave, second);
  text = first + "\n";
  for (int frame = 0; frame < 60; ++frame) {
    std::getline(walk, first);
    std::getline(wave, second);
    text += first + "\n";
    if (frame >= 15) text += second.replace(second.find(','), 3, ",2,") + "\n";
  }
  return folder.write("two.csv", text).string();
}

TEST_F(WindowPlay, MirrorGravityAndPersonAreChosenByMouse) {
  Hands hands(folder_);
  hands.press("space Home");
  hands.pictureAtRest();
  const auto click = [&](int x, int y) {
    hands.mouse("mousemove --window $w " + std::to_string(x) + " " + std::to_string(y) + " click 1");
    hands.handled();
  };
  click(36, 276);  // mirror
  hands.pictureUnlike(1, 500);
  click(36, 276);
  hands.pictureWhen([&](const Image& now) { return differing(hands.pictureNumber(1), now) == 0; });
  click(200, 342);  // the list of gravities
  click(150, 375);  // none
  hands.press("Right");
  hands.pictureUnlike(1, 500);
  click(200, 342);
  hands.press("Escape");  // closes the list, not the window
  hands.handled();
  click(200, 131);  // the list of people
  click(150, 164);  // everyone
  hands.pictureUnlike(4, 500);
  const CommandResult result =
      hands.runWith({"play", twoPeopleIn(folder_), "--window", "--decomposition", body_, "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const Image first = hands.pictureNumber(1);
  EXPECT_GT(differing(first, hands.pictureNumber(2)), 500) << "mirrored";
  EXPECT_EQ(differing(first, hands.pictureNumber(3)), 0) << "the same run again, bit for bit";
  EXPECT_GT(differing(first, hands.pictureNumber(4)), 500);
  EXPECT_EQ(result.json()["avatars"].size(), 2u) << "everyone";
}

TEST_F(WindowPlay, AWarningThatRepeatsIsSaidOnce) {
  const std::filesystem::path scene = folder_.write(
      "wall.json",
      R"({"format": "lorica scene 1", "props": [{"shape": "box", "size": [2, 4, 2], "at": [0, 2, 0], "fixed": true}]})");
  Hands hands(folder_);
  for (int i = 0; i < 3; ++i) {
    hands.press("Home");
    hands.handled();
  }
  const CommandResult result =
      hands.runWith({"play", "walk", "--window", "--decomposition", body_, "--scene", scene.string()});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const std::size_t said = result.err.find("starts inside the fixed object");
  ASSERT_NE(said, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("starts inside the fixed object", said + 1), std::string::npos) << result.err;
}

/// A red box beside the avatar that needs 0.6 s to fall to the floor.
constexpr const char* kFallingBox = R"({
  "format": "lorica scene 1", "name": "box",
  "props": [{ "shape": "box", "size": [0.3, 0.3, 0.3], "at": [0.9, 1.8, 0.6], "mass": 1, "color": "#e02020" }]
})";

TEST_F(WindowPlay, AtTheEndTheMotionStartsAgainOrTheWorldGoesOnAroundTheLastPose) {
  const std::filesystem::path scene = folder_.write("box.json", kFallingBox);
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("Tab 2 5 6 space");
  hands.pictureAtRest();  // of the camera
  hands.press("space");
  hands.picture();
  hands.press("l");
  hands.pictureWhen([&](const Image& now) { return redIn(now).y > redIn(hands.pictureNumber(2)).y + 60.0; });
  hands.pictureAtRest();
  hands.picture();
  hands.press("b");
  hands.pictureUnlike(5, 100);
  hands.press("Home l");
  hands.pictureWhen([&](const Image& now) { return std::abs(redIn(now).y - redIn(hands.pictureNumber(2)).y) < 40.0; });
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--frames", "6", "--decomposition", body_,
                                              "--scene", scene.string(), "--json", "-"});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const Blob looping = redIn(hands.pictureNumber(2)), lying = redIn(hands.pictureNumber(4));
  ASSERT_GT(looping.count, 100);
  EXPECT_GT(lying.y, looping.y + 60.0) << "it falls on after the recording";
  EXPECT_LT(differing(hands.pictureNumber(4), hands.pictureNumber(5)), 20) << "the avatar stands";
  EXPECT_GT(differing(hands.pictureNumber(5), hands.pictureNumber(6)), 100) << "a ball can still be thrown";
  EXPECT_NEAR(redIn(hands.pictureNumber(7)).y, looping.y, 40.0) << "it starts again and again";
  EXPECT_LE(result.json()["frames"], 6) << "the report is about one run";
}

TEST_F(WindowPlay, WhatWasThrownIsTakenBack) {
  Hands hands(folder_);
  hands.mouse("windowsize --sync $w 480 360");
  hands.press("Tab space Home");
  hands.handled();
  hands.press("n n n n n n");
  hands.pictureAtRest();
  hands.press("Home");
  for (const char* keys : {"n n n", "b", "n n n"}) {
    hands.handled();
    hands.press(keys);
  }
  hands.pictureAtRest();
  hands.press("u");
  hands.pictureWhen([&](const Image& now) { return redIn(now).count < redIn(hands.pictureNumber(1)).count + 100; });
  const CommandResult result = hands.runWith({"play", "walk", "--window", "--decomposition", body_});
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const int none = redIn(hands.pictureNumber(1)).count;
  EXPECT_GT(redIn(hands.pictureNumber(2)).count, none + 300) << "a ball";
  EXPECT_NEAR(redIn(hands.pictureNumber(3)).count, none, 100);
}

}  // namespace
}  // namespace lorica::test
