#include "tests/apps/run_command.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

using testing::TestWithParam;

class Help : public TestWithParam<const char*> {};

TEST_P(Help, TeachesByExample) {
  const CommandResult result = runLorica({GetParam(), "--help"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("Examples:\n  lorica "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(std::string("  lorica ") + GetParam()), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("--json"), std::string::npos);
  EXPECT_NE(result.out.find("--threads"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Command, Help, testing::Values("demo", "decompose", "score", "play", "info"),
                         [](const auto& chosen) { return std::string(chosen.param); });

TEST(Command, HelpListsEveryCommand) {
  const CommandResult result = runLorica({"--help"});
  EXPECT_EQ(result.exitCode, 0);
  for (const char* name : {"demo", "decompose", "score", "play", "info"}) {
    EXPECT_NE(result.out.find(std::string("\n  ") + name + " "), std::string::npos) << result.out;
  }
}

TEST(Command, HelpSeparatesOptionsFromTheirDescriptions) {
  const std::string help = runLorica({"snapshot", "--help"}).out;
  EXPECT_NE(help.find("  --target X,Y,Z Needs: --eye\n"), std::string::npos) << help;
  EXPECT_NE(help.find("  --strip                     Combine"), std::string::npos) << help;
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
  EXPECT_NE(result.err.find("expected one of demo, decompose, score, play, live, record, replay, info"),
            std::string::npos)
      << result.err;
}

TEST(Command, UnknownCommandIsRefused) {
  const CommandResult result = runLorica({"decompoes", "bunny.off"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("decompoes"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lorica::test
