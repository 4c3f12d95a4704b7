#include "geometry/files.h"
#include "session/recording/session_file.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// A body that is quick to make, for all tests here.
class Replay : public testing::Test {
 protected:
  [[nodiscard]] CommandResult record(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"record", "--force", session.string(), "--decomposition", body.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runLorica(arguments);
  }

  const TemporaryFolder folder;
  const fs::path body = mannequinBody(folder), session = folder.path() / "s.lsession";
};

TEST_F(Replay, ARecordedSessionComesOutTheSame) {
  const CommandResult made =
      record({"punch_and_kick", "--frames", "60", "--scene", "bowling", "--inject", "dropout=0.1,late,seed=7",
              "--smooth", "one-euro", "--threads", "2", "--json", "-"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  EXPECT_EQ(made.json()["recorded"], 60);
  EXPECT_EQ(filesIn(folder.path()), (std::vector<std::string>{"body.lorica", "s.lsession"}));
  const nlohmann::json again = jsonOf({"replay", session.string(), "--threads", "1"});
  EXPECT_EQ(again["same"], true);
  EXPECT_EQ(again["replayed"], 60);
  EXPECT_EQ(again["hash"], made.json()["hash"]);
}

TEST_F(Replay, WithoutThePersonsLegsItIsTheSameToo) {
  const CommandResult made = record({"squat_and_reach", "--frames", "60", "--upper-body", "--json", "-"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const nlohmann::json again = jsonOf({"replay", session.string()});
  EXPECT_EQ(again["hash"], made.json()["hash"]);
  // Squatting with legs of one's own is another session.
  const CommandResult whole =
      runLorica({"play", "squat_and_reach", "--frames", "60", "--decomposition", body.string(), "--json", "-"});
  EXPECT_NE(whole.json()["hash"], made.json()["hash"]);
}

TEST_F(Replay, WhatPlayRecordsIsTheSameSession) {
  const nlohmann::json played =
      jsonOf({"play", "wave", "--frames", "20", "--decomposition", body.string(), "--record", session.string()});
  const nlohmann::json again = jsonOf({"replay", session.string()});
  EXPECT_EQ(again["hash"], played["hash"]);
}

TEST_F(Replay, AVirtualPersonBeforeACameraIsReplayed) {
  const CommandResult made =
      record({"--virtual", "--motion", "wave", "--frames", "20", "--inject", "jitter=0.01", "--json", "-"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  const nlohmann::json again = jsonOf({"replay", session.string()});
  EXPECT_EQ(again["replayed"], 20);
  EXPECT_EQ(again["hash"], made.json()["hash"]);
}

TEST_F(Replay, TheShippedDepthIsTrackedAndReplayedTheSameOnOneThreadAndTwo) {
  const CommandResult made = record({"wave_depth", "--frames", "40", "--threads", "2", "--json", "-"});
  ASSERT_EQ(made.exitCode, 0) << made.err;
  EXPECT_EQ(made.json()["recorded"], 40);
  const nlohmann::json again = jsonOf({"replay", session.string(), "--threads", "1"});
  EXPECT_EQ(again["hash"], made.json()["hash"]);
  const CommandResult second = record({"wave_depth", "--frames", "40", "--threads", "1", "--json", "-"});
  ASSERT_EQ(second.exitCode, 0) << second.err;
  EXPECT_EQ(second.json()["hash"], made.json()["hash"]) << "tracking is deterministic";
}

/// A killed recording contains every completed step.
TEST_F(Replay, AKilledRecordingIsReplayedAsFarAsItWent) {
  const fs::path part = folder.path() / "s.part.lsession";
  constexpr std::uintmax_t kEnough = 20000;  // about 20 steps
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    setenv("LORICA_RECORDINGS", recordingsFolder().c_str(), 1);
    execl(built("lorica").c_str(), "lorica", "record", session.c_str(), "walk", "--decomposition", body.c_str(),
          nullptr);
    _exit(127);
  }
  std::error_code error;
  int status = 0;
  bool ended = false;
  while (!(fs::file_size(part, error) > kEnough && !error) && !ended) {
    ended = waitpid(child, &status, WNOHANG) == child;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (!ended) {
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
  }
  ASSERT_TRUE(WIFSIGNALED(status)) << "it ended before it could be killed";
  EXPECT_FALSE(fs::exists(session));
  const nlohmann::json again = jsonOf({"replay", part.string()});
  EXPECT_EQ(again["same"], true);
  EXPECT_EQ(again["finished"], false);
  EXPECT_GE(again["replayed"].get<int>(), static_cast<int>(kEnough / 1100));
}

TEST_F(Replay, WhatDiffersOrIsMissingIsReported) {
  ASSERT_EQ(record({"wave", "--frames", "5"}).exitCode, 0);
  const auto sentence = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"replay", session.string()});
    const CommandResult result = runLorica(more);
    EXPECT_EQ(result.exitCode, 2) << result.out;
    return result.err;
  };
  const fs::path other = folder.path() / "other.lorica";
  ASSERT_EQ(runLorica({"decompose", "mannequin", "--parts", "4", "--keyframes", "2", "-o", other.string()}).exitCode,
            0);
  EXPECT_TRUE(has(sentence({"--decomposition", other.string()}), "recorded with another decomposition"));
  EXPECT_TRUE(has(sentence({"--character", "nobody.glb"}), "nobody.glb"));
  fs::remove(body);
  EXPECT_TRUE(has(sentence({}), "give its file with --decomposition"));
  std::string bytes = readFile(session).value();
  bytes[bytes.size() / 2] ^= 1;
  ASSERT_TRUE(writeFileAtomically(session, bytes).ok());
  EXPECT_TRUE(has(sentence({}), "checksum is wrong"));
}

TEST_F(Replay, ASessionWhoseMotionEndsEarlyIsRefused) {
  ASSERT_EQ(record({"walk", "--frames", "20"}).exitCode, 0);
  const std::string bytes = *readFile(session);
  std::string shortened(kSessionMagic);
  std::uint64_t chain = 0;
  int steps = 0;
  const Result<Blocks> blocks = readBlocks(bytes, "s");
  ASSERT_TRUE(blocks.ok());
  for (const Block& block : blocks->blocks) {
    constexpr std::size_t kBeforeFrames = 36;  // time, hashes, number of actions
    const bool emptied = block.kind == BlockKind::kStep && ++steps > 10;
    appendBlock(block.kind,
                emptied ? std::string(block.payload.substr(0, kBeforeFrames)) + std::string(4, '\0')
                        : std::string(block.payload),
                chain, shortened);
  }
  ASSERT_EQ(steps, 20);
  const std::string file = folder.write("short.lsession", shortened);
  const CommandResult replayed = runLorica({"replay", file});
  EXPECT_EQ(replayed.exitCode, 2) << replayed.err;
  EXPECT_TRUE(has(replayed.err, "step 10 comes after the last of 10 frames"));
}

/// A recorded session with another text in its header, and the right checksums.
std::string withHeader(const std::string& bytes, const std::string& found, const std::string& instead) {
  std::string changed(kSessionMagic);
  std::uint64_t chain = 0;
  const Result<Blocks> read = readBlocks(bytes, "s");
  for (const Block& block : read->blocks) {
    std::string payload(block.payload);
    if (block.kind == BlockKind::kHeader) payload.replace(payload.find(found), found.size(), instead);
    appendBlock(block.kind, payload, chain, changed);
  }
  return changed;
}

TEST_F(Replay, ACoverThatWouldTakeMinutesIsRefused) {
  ASSERT_EQ(record({"walk", "--frames", "2", "--cover", "0.01"}).exitCode, 0);
  const std::string bytes = *readFile(session);
  struct Case {
    const char* cover;
    const char* sentence;
  };
  for (const Case& c :
       {Case{"1e-300", "1e-300 m, expected exact, or at least"}, {"999.0", "999 m, expected at most"}}) {
    const std::string file =
        folder.write("cover.lsession", withHeader(bytes, "\"cover\": 0.01", "\"cover\": " + std::string(c.cover)));
    const CommandResult replayed = runLorica({"replay", file, "--decomposition", body.string()});
    EXPECT_EQ(replayed.exitCode, 2);
    EXPECT_TRUE(has(replayed.err, c.sentence));
  }
}

}  // namespace
}  // namespace lorica::test
