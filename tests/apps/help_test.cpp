#include "tests/apps/run_command.h"
#include "tests/support/has.h"

#include <gtest/gtest.h>

#include <sstream>

namespace lorica::test {
namespace {

using testing::TestWithParam;

class Help : public TestWithParam<const char*> {};

TEST_P(Help, TeachesByExample) {
  const CommandResult result = runLorica({GetParam(), "--help"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(has(result.out, "Examples:\n  lorica "));
  EXPECT_TRUE(has(result.out, std::string("  lorica ") + GetParam()));
  EXPECT_TRUE(has(result.out, "--json"));
  EXPECT_TRUE(has(result.out, "--threads"));
}

TEST_P(Help, IsThereInShortWithTheNamesOfAllOptions) {
  const std::string all = runLorica({GetParam(), "--help"}).out;
  const CommandResult brief = runLorica({GetParam(), "-h"});
  EXPECT_EQ(brief.exitCode, 0);
  EXPECT_LT(brief.out.size(), all.size());
  std::istringstream help(all);
  int options = 0;
  for (std::string line; std::getline(help, line) && line != "Examples:";) {
    const std::size_t at = line.find("--");
    if (at == std::string::npos || line.substr(0, 3) != "  -") continue;
    ++options;
    EXPECT_TRUE(has(brief.out, line.substr(at, line.find_first_of(" ,", at) - at))) << line;
  }
  EXPECT_GT(options, 5);
}

INSTANTIATE_TEST_SUITE_P(Command, Help,
                         testing::Values("demo", "decompose", "score", "play", "info", "bake", "contacts"),
                         [](const auto& chosen) { return std::string(chosen.param); });

TEST(Command, HelpListsEveryCommand) {
  const CommandResult result = runLorica({"--help"});
  EXPECT_EQ(result.exitCode, 0);
  for (const char* name : {"demo", "decompose", "score", "play", "info", "bake", "contacts"}) {
    EXPECT_TRUE(has(result.out, std::string("\n  ") + name + " "));
  }
}

TEST(Command, HelpSeparatesOptionsFromTheirDescriptions) {
  const std::string help = runLorica({"snapshot", "--help"}).out;
  EXPECT_TRUE(has(help, "  --target X,Y,Z Needs: --eye\n"));
  EXPECT_TRUE(has(help, "  --strip                     Combine"));
}

TEST(Command, HelpFitsTheWidth) {
  for (const char* command : {"play", "live", "decompose", "bake", "contacts"}) {
    std::istringstream help(runLorica({command, "--help"}).out);
    std::string line;
    while (std::getline(help, line) && line != "Examples:") EXPECT_LE(line.size(), 100u) << line;
    EXPECT_EQ(line, "Examples:");
  }
}

TEST(Command, HelpIsACommandToo) {
  EXPECT_EQ(runLorica({"help", "play"}).out, runLorica({"play", "--help"}).out);
  EXPECT_EQ(runLorica({"help"}).out, runLorica({"--help"}).out);
  const CommandResult unknown = runLorica({"help", "plya"});
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_TRUE(has(unknown.err, "plya: unknown command; did you mean \"play\"?"));
}

TEST(Command, MisspeltOptionsAreRecognised) {
  const CommandResult result = runLorica({"play", "walk", "--windw"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.err, "lorica: --windw: unknown option; did you mean \"--window\"?\nTry `lorica play --help`.\n");
  EXPECT_EQ(runLorica({"play", "walk", "--quarterstaff=3"}).err,
            "lorica: --quarterstaff: unknown option\nTry `lorica play --help`.\n");
}

TEST(Command, SaysItsVersion) {
  const CommandResult result = runLorica({"--version"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.out.rfind("lorica ", 0), 0u) << result.out;
}

TEST(Command, WithoutArgumentsListsTheCommands) {
  const CommandResult result = runLorica({});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(has(result.err, "expected one of demo, play, live, serve, replay, snapshot, decompose, export"));
}

TEST(Command, UnknownCommandIsRefused) {
  const CommandResult result = runLorica({"decompoes", "bunny.off"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_TRUE(has(result.err, "decompoes: unknown command; did you mean \"decompose\"?"));
  // What ships can be opened without a command: `lorica walk`.
  EXPECT_TRUE(has(runLorica({"--versoin"}).err, "--versoin: unknown option; did you mean \"--version\"?"));
  EXPECT_TRUE(has(runLorica({"--character", "hero.glb", "play", "walk"}).err,
                  "--character: stands before the command, expected `lorica play --character`"));
  EXPECT_TRUE(has(runLorica({"wlak"}).err, "wlak: unknown command; did you mean \"walk\"?"));
  EXPECT_TRUE(has(runLorica({"manequin"}).err, "; did you mean \"mannequin\"?"));
  EXPECT_FALSE(has(runLorica({"help", "wlak"}).err, "walk"));
  const CommandResult unlike = runLorica({"quarterstaff"});
  EXPECT_TRUE(has(unlike.err, "quarterstaff: unknown command, expected one of demo, play, live, "));
}

}  // namespace
}  // namespace lorica::test
