#include "geometry/files.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

std::vector<nlohmann::json> linesOf(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

TEST(Events, PlayWritesEachContactAsLinesAndReplayWritesTheSame) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder, 8);
  const std::string events = folder.path() / "kick.jsonl";
  const std::string session = folder.path() / "kick.lsession";
  const CommandResult played = runLorica({"play", "punch_and_kick", "--frames", "200", "--decomposition", body,
                                          "--events", events, "--record", session, "--json", "-"});
  ASSERT_EQ(played.exitCode, 0) << played.err;
  const std::string written = readFile(events).value();
  const std::vector<nlohmann::json> lines = linesOf(written);
  ASSERT_FALSE(lines.empty());
  int begins = 0, ends = 0;
  for (const nlohmann::json& line : lines) {
    begins += line["event"] == "begin" ? 1 : 0;
    ends += line["event"] == "end" ? 1 : 0;
    EXPECT_EQ(line.contains("prop"), line["kind"] == "prop");
    EXPECT_EQ(line.contains("otherPart"), line["kind"] == "self");
    EXPECT_EQ(line["point"].size(), 3U);
    EXPECT_GE(line["strength"].get<double>(), 0.0);
    EXPECT_LE(line["began"].get<double>(), line["touched"].get<double>());
    EXPECT_LE(line["touched"].get<double>(), line["time"].get<double>());
    EXPECT_TRUE(line["bone"].is_string());
  }
  EXPECT_GT(begins, 0);
  EXPECT_EQ(begins, ends);
  // Times have at most six decimals.
  EXPECT_FALSE(
      std::regex_search(written, std::regex("(time|began|touched)..[0-9]+[.][0-9][0-9][0-9][0-9][0-9][0-9][0-9]")));
  EXPECT_EQ(filesIn(folder.path()), (std::vector<std::string>{"body.lorica", "kick.jsonl", "kick.lsession"}));

  const CommandResult replayed = runLorica({"replay", session, "--events", "-"});
  ASSERT_EQ(replayed.exitCode, 0) << replayed.err;
  EXPECT_EQ(replayed.out, written);
  EXPECT_NE(replayed.err.find("all steps are bit-identical"), std::string::npos) << replayed.err;
}

TEST(Events, BadOutputsAreASentence) {
  const TemporaryFolder folder;
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& found) {
    const CommandResult result = runLorica(arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(found), std::string::npos) << result.err;
  };
  refused({"play", "walk", "--events", "-", "--json", "-"},
          "--events and --json cannot both use standard output: give a file for one of them");
  refused({"play", "walk", "--events", folder.path() / "none" / "e.jsonl"}, "--events: ");
  refused({"play", "walk", "--events", folder.path()}, "is a folder, expected a file");
  const std::string same = folder.path() / "same";
  refused({"play", "walk", "--events", same, "--json", same}, "--events: " + same + " is also an input");
  refused({"live", "--virtual", "--headless", "--events", "-", "--json", "-"}, "--events and --json cannot both");
  EXPECT_TRUE(filesIn(folder.path()).empty());
}

}  // namespace
}  // namespace lorica::test
