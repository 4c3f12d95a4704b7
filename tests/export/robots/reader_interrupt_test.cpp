#include "geometry/interrupt.h"
#include "tests/export/robots/outside_readers.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lorica::test {
namespace {

/// How often a reader asks whether to stop, and how it ends if that is so from one asking on.
struct Asked {
  int times = 0, afterwards = 0;
  Result<void> result;
};

Asked readAsking(const OutsideReader& reader, const std::string& file, int stopAt) {
  Asked asked;
  const Interrupt stops = [&] {
    const bool stop = asked.times++ >= stopAt;
    asked.afterwards += stop ? 1 : 0;
    return stop;
  };
  const InterruptScope scope(&stops);
  asked.result = reader.read(file);
  return asked;
}

TEST(ReaderInterrupt, EveryReaderStopsWhereverItAsks) {
  constexpr int kNever = 1 << 30, kMostAfterwards = 40;  // a few for each layout of joints
  const TemporaryFolder folder;
  for (const OutsideReader& reader : outsideReaders(folder)) {
    if (reader.name == "picture") continue;  // of several, see below
    for (const std::string& seed : reader.seeds) {
      ASSERT_TRUE(reader.read(seed)) << reader.name << ": " << reader.read(seed).error().message;
      const Asked whole = readAsking(reader, seed, kNever);
      EXPECT_TRUE(whole.result) << reader.name;
      EXPECT_GT(whole.times, 0) << reader.name << " does not ask";
      for (int stopAt = 0; stopAt < whole.times; stopAt += 1 + whole.times / 20) {
        const Asked stopped = readAsking(reader, seed, stopAt);
        ASSERT_FALSE(stopped.result) << reader.name << ", stopped at " << stopAt << " of " << whole.times;
        EXPECT_EQ(stopped.result.error().code, ErrorCode::kCancelled) << stopped.result.error().message;
        EXPECT_LE(stopped.afterwards, kMostAfterwards) << reader.name << " goes on";
      }
    }
  }
}

/// Long files are asked about all the way, not at their ends only.
TEST(ReaderInterrupt, LongFilesAreAskedAboutOften) {
  constexpr int kNever = 1 << 30, kCopies = 200;
  const TemporaryFolder folder;
  int read = 0;
  for (const OutsideReader& reader : outsideReaders(folder)) {
    if (reader.name != "obj" && reader.name != "joints" && reader.name != "bvh") continue;
    for (const std::string& seed : reader.seeds) {
      const std::size_t last = seed.find_last_of("\r\n", seed.find_last_not_of("\r\n")) + 1;  // of its lines
      std::string file = seed;
      if (file.back() != '\n' && file.back() != '\r') file += '\n';
      for (int copy = 0; copy < kCopies; ++copy) file += seed.substr(last) + (seed.back() == '\n' ? "" : "\n");
      const Asked asked = readAsking(reader, file, kNever);
      if (!asked.result) continue;  // some formats refuse the same line again
      ++read;
      EXPECT_GT(asked.times, kCopies / 4) << reader.name << ": " << seed.substr(0, 60);
    }
  }
  EXPECT_GE(read, 10);
}

}  // namespace
}  // namespace lorica::test
