#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/random_numbers.h"
#include "sensor/oni_file.h"
#include "tests/sensor/oni_writer.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <string>
#include <vector>

extern char** environ;

namespace lorica {
namespace {

/// Frames of the stock player, by a child process: it is the truth here, but it crashes now and then.
Result<std::string> playStock(const std::filesystem::path& file, const std::filesystem::path& out) {
  const std::string player = LORICA_STOCK_PLAYER;
  std::string arguments[3] = {player, file.string(), out.string()};
  char* argv[4] = {arguments[0].data(), arguments[1].data(), arguments[2].data(), nullptr};
  for (int attempt = 0; attempt < 3; ++attempt) {
    pid_t child = 0;
    if (posix_spawn(&child, player.c_str(), nullptr, nullptr, argv, environ) != 0) break;
    int status = 0;
    waitpid(child, &status, 0);
    if (status == 0) return readFile(out);
  }
  return Error{ErrorCode::kUnreadable, "the stock player failed three times"};
}

/// Every frame of the file, and its time, as the stock player gives them, to the last bit.
void expectStockGivesTheSame(const std::filesystem::path& path) {
  const test::TemporaryFolder folder;
  const Result<std::string> stock = playStock(path, folder.path() / "frames");
  ASSERT_TRUE(stock) << stock.error().message;
  Result<OniFile> file = OniFile::open(path);
  ASSERT_TRUE(file) << file.error().message;
  const auto width = static_cast<std::ptrdiff_t>(file->info().camera.width);
  const auto height = static_cast<std::ptrdiff_t>(file->info().camera.height);
  const std::size_t bytesPerFrame = 16 + 2 * static_cast<std::size_t>(width * height);
  ASSERT_EQ(stock->size(), bytesPerFrame * static_cast<std::size_t>(file->info().frameCount));
  DepthFrame frame;
  for (int i = 0; i < file->info().frameCount; ++i) {
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

TEST(OniStock, PlaysARealKinectRecordingAsWeDo) {
  LORICA_REQUIRE_DATASET(path, "oni/3DJ_Test/test.oni");
  expectStockGivesTheSame(path);
}

}  // namespace
}  // namespace lorica
