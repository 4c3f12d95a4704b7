#include "tests/apps/window_at_play.h"

namespace lorica::test {
namespace {

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
