#include "bake/claims.h"

#include "tests/bake/faulty_files.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// A folder, and a clock that the test turns.
struct Shared {
  TemporaryFolder folder;
  FaultyFiles files;
  Claims::Clock::time_point now{};

  Claims worker() {
    Result<Claims> claims = Claims::open(files, folder.path(), 60.0, [this] { return now; });
    return std::move(*claims);
  }
  void wait(double seconds) { now += std::chrono::milliseconds(static_cast<long>(1000 * seconds)); }
};

std::optional<int> claimed(Claims& claims, const std::string& key) {
  const Result<std::optional<int>> result = claims.claim(key);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return result ? *result : std::nullopt;
}

TEST(Claims, OneOfTwoWorkersGetsAnItem) {
  Shared shared;
  Claims first = shared.worker(), second = shared.worker();
  EXPECT_EQ(claimed(first, "a"), 0);
  EXPECT_EQ(claimed(second, "a"), std::nullopt);
  EXPECT_EQ(claimed(second, "b"), 0);
  EXPECT_EQ(claimed(first, "b"), std::nullopt);
}

TEST(Claims, OfManyProcessesAtOnceEachItemGoesToOne) {
  const Shared shared;
  constexpr int kProcesses = 6;
  constexpr int kItems = 40;
  std::vector<pid_t> children;
  for (int p = 0; p < kProcesses; ++p) {
    const pid_t child = fork();
    if (child == 0) {
      FileLayer files;
      Result<Claims> claims = Claims::open(files, shared.folder.path(), 60.0);
      if (!claims) _exit(1);
      for (int i = 0; i < kItems; ++i) {
        const std::string key = std::to_string(i);
        const Result<std::optional<int>> got = claims->claim(key);
        if (!got) _exit(1);
        // A second winner would find the file of the first.
        if (*got && files.create(shared.folder.path() / ("won-" + key), "") != 0) _exit(1);
      }
      // Whoever ends is lost, and its items would be free again.
      if (files.create(shared.folder.path() / ("all-asked-" + std::to_string(p)), "") != 0) _exit(1);
      while (true) ::pause();
    }
    children.push_back(child);
  }
  for (int p = 0; p < kProcesses; ++p) {
    const fs::path asked = shared.folder.path() / ("all-asked-" + std::to_string(p));
    for (int i = 0; i < 2000 && !fs::exists(asked); ++i) ::usleep(5000);
    EXPECT_TRUE(fs::exists(asked)) << "process " << p << " found an item that was won twice";
  }
  for (const pid_t child : children) {
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  for (int i = 0; i < kItems; ++i) EXPECT_TRUE(fs::exists(shared.folder.path() / ("won-" + std::to_string(i))));
}

TEST(Claims, AWorkerThatLivesKeepsItsItems) {
  Shared shared;
  Claims first = shared.worker(), second = shared.worker();
  EXPECT_EQ(claimed(first, "a"), 0);
  for (int i = 0; i < 30; ++i) {
    shared.wait(11.0);
    first.beat();
    EXPECT_EQ(claimed(second, "a"), std::nullopt) << "after " << 11 * i << " s";
  }
}

TEST(Claims, AWorkerThatSaysNothingForLongIsLost) {
  Shared shared;
  Claims first = shared.worker(), second = shared.worker();
  Claims third = shared.worker();
  EXPECT_EQ(claimed(first, "a"), 0);
  EXPECT_EQ(claimed(second, "a"), std::nullopt);
  shared.wait(59.0);
  EXPECT_EQ(claimed(second, "a"), std::nullopt);
  shared.wait(2.0);
  EXPECT_EQ(claimed(second, "a"), 1);
  EXPECT_EQ(claimed(third, "a"), std::nullopt) << "the new owner lives";
}

TEST(Claims, TimesOfFilesAreNotBelieved) {
  // The clock of the machine that writes is a quarter of an hour off, either way.
  for (const std::chrono::minutes off : {std::chrono::minutes(-15), std::chrono::minutes(15)}) {
    Shared shared;
    Claims first = shared.worker();
    Claims second = shared.worker();
    const fs::path file = shared.folder.path() / "workers" / first.worker();
    EXPECT_EQ(claimed(first, "a"), 0);
    for (int i = 0; i < 10; ++i) {
      shared.wait(11.0);
      first.beat();
      fs::last_write_time(file, fs::file_time_type::clock::now() + off);
      fs::last_write_time(shared.folder.path() / "claims" / "a.0", fs::file_time_type::clock::now() + off);
      EXPECT_EQ(claimed(second, "a"), std::nullopt);
    }
  }
}

TEST(Claims, WhatAnEndedWorkerHadIsFreeAtOnce) {
  Shared shared;
  Claims first = shared.worker(), second = shared.worker();
  EXPECT_EQ(claimed(first, "a"), 0);
  first.end();
  EXPECT_EQ(claimed(second, "a"), 1);
}

TEST(Claims, NothingIsLeftOfWhatIsDone) {
  Shared shared;
  Claims first = shared.worker(), second = shared.worker(), third = shared.worker();
  EXPECT_EQ(claimed(first, "a"), 0);
  first.end();
  EXPECT_EQ(claimed(second, "a"), 1);
  second.release("a");
  second.release("b");  // claimed by nobody
  EXPECT_EQ(claimed(third, "a"), 0) << "whoever claims what is done must look whether it is";
  EXPECT_TRUE(fs::exists(shared.folder.path() / "workers" / first.worker())) << "its claim was not released";
  fs::remove(shared.folder.path() / "workers" / first.worker());
  second.end();
  third.release("a");
  EXPECT_TRUE(fs::exists(shared.folder.path() / "workers"));
  third.end();
  for (const char* folder : {"claims", "workers"}) EXPECT_FALSE(fs::exists(shared.folder.path() / folder)) << folder;
  Claims later = shared.worker();
  fs::remove(shared.folder.path() / "claims");
  EXPECT_EQ(claimed(later, "a"), 0) << "a folder that was removed meanwhile";
}

TEST(Claims, WhatAKilledProcessOfThisMachineHadIsFreeAtOnce) {
  Shared shared;
  const pid_t child = fork();
  if (child == 0) {
    Claims claims = shared.worker();
    _exit(claimed(claims, "a") == 0 ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  Claims second = shared.worker();
  EXPECT_EQ(claimed(second, "a"), 1);
}

TEST(Claims, AnAnswerThatIsLostDoesNotLoseTheItem) {
  Shared shared;
  Claims first = shared.worker();
  shared.files.loseCreateAnswers = 1;
  EXPECT_EQ(claimed(first, "a"), 0);
}

TEST(Claims, AClaimThatIsNotSeenYetIsNotTakenTwice) {
  Shared shared;
  Claims first = shared.worker(), second = shared.worker();
  EXPECT_EQ(claimed(first, "a"), 0);
  shared.files.notSeen = {shared.folder.path() / "claims" / "a.0", shared.folder.path() / "workers" / first.worker()};
  const Result<std::optional<int>> stale = second.claim("a");
  EXPECT_FALSE(stale && *stale) << "claimed twice";
}

TEST(Claims, AClaimWithoutANameIsWatchedByItself) {
  Shared shared;
  Claims second = shared.worker();
  const auto leave = [&](const char* name) { shared.folder.write(std::string("claims/") + name, ""); };
  leave("a.0");  // its process crashed between creating and writing
  EXPECT_EQ(claimed(second, "a"), std::nullopt);
  shared.wait(61.0);
  leave("b.0");
  EXPECT_EQ(claimed(second, "b"), std::nullopt);
  EXPECT_EQ(claimed(second, "a"), 1);
}

TEST(Claims, AFullOrReadOnlyFolderIsAnError) {
  Shared shared;
  Claims first = shared.worker();
  shared.files.createError = ENOSPC;
  EXPECT_EQ(first.claim("a").error().message,
            (shared.folder.path() / "claims" / "a.0").string() + ": cannot be written: No space left on device");
  shared.files.createError = EROFS;
  EXPECT_EQ(Claims::open(shared.files, shared.folder.path(), 60.0).error().code, ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace lorica::test
