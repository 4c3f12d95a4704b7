// What performs and how it is treated, chosen in the window while it runs.

#include "tests/apps/window_at_play.h"

#include <fstream>

namespace lorica::test {
namespace {

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
  click(31, 226);  // mirror
  hands.pictureUnlike(1, 500);
  click(31, 226);
  hands.pictureWhen([&](const Image& now) { return differing(hands.pictureNumber(1), now) == 0; });
  click(140, 277);  // the list of gravities
  click(100, 305);  // none
  hands.press("Right");
  hands.pictureUnlike(1, 500);
  click(140, 277);
  hands.press("Escape");  // closes the list, not the window
  hands.handled();
  click(140, 104);  // the list of people
  click(100, 130);  // everyone
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

}  // namespace
}  // namespace lorica::test
