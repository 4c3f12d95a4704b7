// Springs on the command line, on a character that nobody here made.
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

constexpr const char* kGodette = "characters/godette/Godette_vrm_v4.vrm";

TEST(Springs, InfoCountsThem) {
  LORICA_REQUIRE_DATASET(godette, kGodette);
  const CommandResult told = runLorica({"info", godette, "--json", "-"});
  ASSERT_EQ(told.exitCode, 0) << told.err;
  const nlohmann::json expected = {{"chains", 8}, {"joints", 16}, {"colliders", 4}, {"constraints", 0}};
  EXPECT_EQ(told.json()["springs"], expected);
  const CommandResult shown = runLorica({"info", godette});
  EXPECT_NE(shown.out.find("8 strands with 16 joints, 4 colliders"), std::string::npos) << shown.out;
}

TEST(Springs, AnUnknownModeIsRefused) {
  const CommandResult refused = runLorica({"play", "walk", "--springs", "both"});
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_NE(refused.err.find("found `both`, expected none, file, body"), std::string::npos) << refused.err;
}

TEST(Springs, EachModeMovesTheHullsInItsOwnWayAndIsReplayed) {
  LORICA_REQUIRE_DATASET(godette, kGodette);
  const TemporaryFolder folder;
  const std::string body = (folder.path() / "body.lorica").string();
  const CommandResult made = runLorica({"decompose", godette, "--parts", "8", "--keyframes", "2", "-o", body});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const auto hashWith = [&](std::vector<std::string> springs) {
    const std::string session = (folder.path() / "s.lsession").string();
    std::vector<std::string> arguments = {"play",     "walk", "--character", godette, "--decomposition", body,
                                          "--frames", "40",   "--record",    session, "--force",         "--json",
                                          "-"};
    arguments.insert(arguments.end(), springs.begin(), springs.end());
    const CommandResult played = runLorica(arguments);
    EXPECT_EQ(played.exitCode, 0) << played.err;
    const CommandResult again = runLorica({"replay", session, "--character", godette, "--json", "-"});
    EXPECT_EQ(again.exitCode, 0) << again.err;
    EXPECT_EQ(again.json()["hash"], played.json()["hash"]);
    return played.json()["hash"].get<std::string>();
  };
  const std::string usual = hashWith({});
  EXPECT_EQ(hashWith({"--springs", "file"}), usual) << "the file has colliders";
  EXPECT_NE(hashWith({"--springs", "body"}), usual);
  EXPECT_NE(hashWith({"--springs", "none"}), usual);
}

}  // namespace
}  // namespace lorica::test
