#include "capture/sensor/oni_file.h"
#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/random_numbers.h"
#include "tests/capture/sensor/oni_writer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

extern char** environ;

namespace lorica {
namespace {

/// Max number of images compared per file: the stock player is slow.
constexpr int kMaxFrames = 12;

/// Frames of the stock player, run in a child process: it is the reference here, but it crashes occasionally.
Result<std::string> playStock(const std::filesystem::path& file, const std::filesystem::path& out) {
  const std::string player = test::built("oni_stock_player");
  std::string arguments[4] = {player, file.string(), out.string(), std::to_string(kMaxFrames)};
  char* argv[5] = {arguments[0].data(), arguments[1].data(), arguments[2].data(), arguments[3].data(), nullptr};
  for (int attempt = 0; attempt < 10; ++attempt) {
    pid_t child = 0;
    if (posix_spawn(&child, player.c_str(), nullptr, nullptr, argv, environ) != 0) break;
    int status = 0;
    pid_t ended = 0;
    for (int waited = 0; ended == 0 && waited < 6000; ++waited) {  // it blocks forever if it loses a frame
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      ended = waitpid(child, &status, WNOHANG);
    }
    if (ended == 0) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
    }
    if (status == 0) return readFile(out);
  }
  return Error{ErrorCode::kUnreadable, "the stock player failed ten times"};
}

/// Checks that the stock player returns the same frames and times as the file reader, bit for bit.
void expectStockGivesTheSame(const std::filesystem::path& path) {
  const test::TemporaryFolder folder;
  const Result<std::string> stock = playStock(path, folder.path() / "frames");
  ASSERT_TRUE(stock) << stock.error().message;
  Result<OniFile> file = OniFile::open(path);
  ASSERT_TRUE(file) << file.error().message;
  const auto width = static_cast<std::ptrdiff_t>(file->info().camera.width);
  const auto height = static_cast<std::ptrdiff_t>(file->info().camera.height);
  const std::size_t bytesPerFrame = 16 + 2 * static_cast<std::size_t>(width * height);
  const int frames = std::min(file->info().frameCount, kMaxFrames);
  ASSERT_EQ(stock->size(), bytesPerFrame * static_cast<std::size_t>(frames));
  DepthFrame frame;
  for (int i = 0; i < frames; ++i) {
    const char* at = stock->data() + bytesPerFrame * static_cast<std::size_t>(i);
    ASSERT_TRUE(file->read(i, frame));
    EXPECT_EQ(frame.time, 1e-6 * static_cast<double>(loadBytes<std::uint64_t>(at, std::endian::native)));
    if (file->info().mirrored) {  // the stock player leaves that to its user
      for (auto row = frame.depthMm.begin(); row != frame.depthMm.end(); row += width) std::reverse(row, row + width);
    }
    EXPECT_TRUE(std::equal(frame.depthMm.begin(), frame.depthMm.end(), reinterpret_cast<const std::uint16_t*>(at + 16)))
        << "frame " << i;
  }
}

TEST(OniStock, PlaysWhatOurWriterWritesAsWeDo) {
  const test::TemporaryFolder folder;
  RandomNumbers random(21);
  for (const OniCodec codec : {OniCodec::kRaw, OniCodec::kPacked, OniCodec::kTable}) {
    for (const bool mirrored : {false, true}) {
      test::OniWriterSettings settings;
      settings.width = 64;
      settings.height = 48;
      settings.codec = codec;
      settings.mirrored = mirrored;
      test::OniWriter writer(settings);
      std::vector<std::uint16_t> depths(64 * 48, 3000);
      for (int i = 0; i < 5; ++i) {
        for (std::size_t p = 0; p < depths.size(); p += 1 + random.bits() % 40) {
          depths[p] = static_cast<std::uint16_t>(random.unit() < 0.3 ? 0.0 : random.between(400.0, 9000.0));
        }
        writer.addFrame(33333 * std::uint64_t(i + 1), depths);
      }
      expectStockGivesTheSame(folder.write("body.oni", writer.finished()));
    }
  }
}

TEST(OniStock, PlaysTheShippedRecordingsAsWeDo) {
  int files = 0;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(test::recordingsFolder())) {
    if (entry.path().extension() != ".oni") continue;
    SCOPED_TRACE(entry.path());
    expectStockGivesTheSame(entry.path());
    ++files;
  }
  EXPECT_GT(files, 0);
}

TEST(OniStock, PlaysARealKinectRecordingAsWeDo) {
  LORICA_REQUIRE_DATASET(path, "oni/3DJ_Test/test.oni");
  expectStockGivesTheSame(path);
}

}  // namespace
}  // namespace lorica
