#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(KeyframesAuto, SaysWhichFramesOfWhichRecording) {
  const std::vector<std::string> command = {"decompose", "mannequin", "--parts", "1",        "--keyframes",
                                            "auto",      "--motion",  "wave",    "--motion", "walk"};
  std::vector<std::string> asJson = command;
  asJson.insert(asJson.end(), {"--json", "-"});
  const CommandResult result = runLorica(asJson);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  const nlohmann::json& chosen = json["chosenKeyframes"];
  ASSERT_GT(chosen.size(), 1u);
  ASSERT_LE(chosen.size(), 12u);
  EXPECT_EQ(json["keyframes"], chosen.size());
  EXPECT_EQ(chosen[0]["motion"], "wave");
  EXPECT_EQ(chosen[0]["frame"], 0);
  bool fromWalk = false;
  for (const nlohmann::json& frame : chosen) {
    fromWalk |= frame["motion"] == "walk";
    EXPECT_TRUE(frame["motion"] == "walk" || frame["motion"] == "wave") << frame;
    // Both were recorded at 30 frames a second.
    EXPECT_NEAR(frame["time"].get<double>(), frame["frame"].get<int>() / 30.0, 1e-3);
  }
  EXPECT_TRUE(fromWalk);
  const CommandResult text = runLorica(command);
  EXPECT_NE(text.out.find("These keyframes were chosen"), std::string::npos) << text.out;
}

TEST(KeyframesAuto, IsForCharacters) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const CommandResult result = runLorica({"decompose", mesh, "--keyframes", "auto"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("--keyframes is for characters"), std::string::npos) << result.err;
}

TEST(KeyframesAuto, OtherWordsAreRefused) {
  for (const char* bad : {"all", "Auto", "-1", "0", "12.5", ""}) {
    const CommandResult result = runLorica({"decompose", "mannequin", "--keyframes", bad});
    EXPECT_EQ(result.exitCode, 2) << bad;
    EXPECT_NE(result.err.find("expected a whole number from 1 to 1000000, or auto"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace lorica::test
