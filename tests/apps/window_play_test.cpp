#include "tests/apps/mannequin_glb.h"
#include "tests/apps/window_at_play.h"

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

}  // namespace
}  // namespace lorica::test
