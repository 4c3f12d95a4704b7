#include "capture/sensor/oni_file.h"

#include "geometry/files.h"
#include "geometry/random_numbers.h"
#include "tests/capture/sensor/oni_writer.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::OniWriter;
using test::OniWriterSettings;

/// Frames that differ from each other and from their mirror images.
std::vector<std::uint16_t> someFrame(int width, int height, int number) {
  std::vector<std::uint16_t> depths;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      depths.push_back(static_cast<std::uint16_t>(500 + 100 * number + 10 * row + column * column));
    }
  }
  return depths;
}

std::string someFile(const OniWriterSettings& settings, int frames) {
  OniWriter writer(settings);
  for (int i = 0; i < frames; ++i) {
    writer.addFrame(1000 + 33333 * std::uint64_t(i), someFrame(settings.width, settings.height, i));
  }
  return writer.finished();
}

std::vector<DepthFrame> allFramesOf(OniFile& file) {
  std::vector<DepthFrame> frames(static_cast<std::size_t>(file.info().frameCount));
  for (int i = 0; i < file.info().frameCount; ++i) {
    const Result<void> read = file.read(i, frames[i]);
    EXPECT_TRUE(read) << read.error().message;
  }
  return frames;
}

TEST(OniFile, WhatWasWrittenIsRead) {
  for (const OniCodec codec : {OniCodec::kRaw, OniCodec::kPacked, OniCodec::kTable}) {
    for (const bool old : {false, true}) {
      OniWriterSettings settings;
      settings.codec = codec;
      settings.oldVersion = old;
      const std::string bytes = someFile(settings, 5);
      OniFile file = test::valueOf(OniFile::parse(bytes, "a.oni"));
      const OniInfo& info = file.info();
      EXPECT_EQ(info.version, old ? "1.0.0.6" : "1.0.1.0");
      EXPECT_EQ(info.device, "a test's");
      EXPECT_EQ(info.codec, codec);
      EXPECT_EQ(info.camera, (DepthCamera{8, 6, 1.0, 0.8}));
      EXPECT_EQ(info.frameCount, 5);
      EXPECT_EQ(info.colorFrameCount, 5);
      EXPECT_NEAR(info.duration, 4 * 0.033333, 1e-12);
      EXPECT_FALSE(info.cutOff);
      EXPECT_EQ(info.end, bytes.size());
      const std::vector<DepthFrame> frames = allFramesOf(file);
      for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(frames[std::size_t(i)].time, 0.001 + 0.033333 * i, 1e-12);
        EXPECT_EQ(frames[std::size_t(i)].depthMm, someFrame(8, 6, i));
      }
    }
  }
}

TEST(OniFile, MirroredFramesAreTurnedBack) {
  OniWriterSettings settings;
  settings.mirrored = true;
  const std::string bytes = someFile(settings, 2);
  OniFile file = test::valueOf(OniFile::parse(bytes, "a.oni"));
  EXPECT_TRUE(file.info().mirrored);
  const std::vector<DepthFrame> frames = allFramesOf(file);
  const std::vector<std::uint16_t> written = someFrame(8, 6, 1);
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 8; ++column) {
      EXPECT_EQ(frames[1].depthMm[8 * row + column], written[8 * row + 7 - column]);
    }
  }
}

TEST(OniFile, CroppedFramesLieInTheWholeImage) {
  OniWriterSettings settings;
  settings.crop = test::OniCrop{2, 1, 3, 4};
  OniWriter writer(settings);
  writer.addFrame(1, someFrame(3, 4, 0));
  const std::string bytes = writer.finished();
  OniFile file = test::valueOf(OniFile::parse(bytes, "a.oni"));
  const std::vector<std::uint16_t> image = allFramesOf(file)[0].depthMm;
  const std::vector<std::uint16_t> part = someFrame(3, 4, 0);
  ASSERT_EQ(image.size(), 48u);
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 8; ++column) {
      const bool inside = row >= 1 && row < 5 && column >= 2 && column < 5;
      EXPECT_EQ(image[8 * row + column], inside ? part[3 * (row - 1) + column - 2] : 0);
    }
  }
}

TEST(OniFile, TenthsOfMillimetresAreRounded) {
  OniWriterSettings settings;
  settings.tenths = true;
  OniWriter writer(settings);
  std::vector<std::uint16_t> depths(48, 0);
  depths[1] = 12344;
  depths[2] = 12345;
  depths[3] = 65535;
  writer.addFrame(1, depths);
  const std::string bytes = writer.finished();
  OniFile file = test::valueOf(OniFile::parse(bytes, "a.oni"));
  const std::vector<std::uint16_t> image = allFramesOf(file)[0].depthMm;
  EXPECT_EQ((std::vector<std::uint16_t>(image.begin(), image.begin() + 4)),
            (std::vector<std::uint16_t>{0, 1234, 1235, 6554}));
}

TEST(OniFile, ARecorderThatWasKilledLeavesItsWholeFrames) {
  OniWriter writer({});
  for (int i = 0; i < 3; ++i) writer.addFrame(100 * std::uint64_t(i), someFrame(8, 6, i));
  for (const std::string& tail : {std::string(), std::string("NIR\0\x0a\0\0", 7), std::string(5000, '\0')}) {
    const std::string bytes = writer.unfinished() + tail;
    OniFile file = test::valueOf(OniFile::parse(bytes, "a.oni"));
    EXPECT_TRUE(file.info().cutOff);
    EXPECT_EQ(file.info().end, writer.unfinished().size());
    EXPECT_EQ(allFramesOf(file).size(), 3u);
  }
  const Result<OniFile> rubbish = OniFile::parse(writer.unfinished() + std::string(100, 'x'), "a.oni");
  EXPECT_FALSE(rubbish);
}

TEST(OniFile, ZerosBehindTheEndAreNoHarm) {
  const std::string bytes = someFile({}, 2);
  EXPECT_TRUE(OniFile::parse(bytes + std::string(70000, '\0'), "a.oni"));
  EXPECT_FALSE(OniFile::parse(bytes + "more", "a.oni"));
}

TEST(OniFile, ATruncatedFileIsItsWholeFramesOrASentence) {
  OniWriter writer({});
  for (int i = 0; i < 3; ++i) writer.addFrame(100 * std::uint64_t(i), someFrame(8, 6, i));
  for (const std::string& bytes : {writer.unfinished(), writer.finished()}) {
    int frames = 0;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      Result<OniFile> file = OniFile::parse(std::string_view(bytes).substr(0, size), "a.oni");
      if (!file) {
        EXPECT_EQ(frames, 0) << "a longer file is refused";
        EXPECT_EQ(file.error().message.rfind("a.oni", 0), 0u) << file.error().message;
        EXPECT_NE(file.error().message.find("expected"), std::string::npos) << file.error().message;
        continue;
      }
      EXPECT_TRUE(file->info().cutOff);
      EXPECT_GE(file->info().frameCount, frames) << "a longer file has fewer frames";
      frames = file->info().frameCount;
      const std::vector<DepthFrame> read = allFramesOf(*file);
      for (int i = 0; i < frames; ++i) EXPECT_EQ(read[std::size_t(i)].depthMm, someFrame(8, 6, i));
    }
    EXPECT_GE(frames, 2);
  }
}

/// Opens the file, reads all frames, and checks that accepted data is valid.
void expectFramesOrSentence(const std::string& bytes) {
  Result<OniFile> file = OniFile::parse(bytes, "a.oni");
  if (!file) {
    ASSERT_EQ(file.error().message.rfind("a.oni", 0), 0u) << file.error().message;
    return;
  }
  const OniInfo& info = file->info();
  ASSERT_GT(info.frameCount, 0);
  ASSERT_LE(std::max(info.camera.width, info.camera.height), 2048)
      << "the size that a small file can request is limited";
  DepthFrame frame;
  double last = -1.0;
  for (int i = 0; i < info.frameCount; ++i) {
    const Result<void> read = file->read(i, frame);
    ASSERT_GT(frame.time, last);
    last = frame.time;
    if (read) {
      ASSERT_EQ(frame.depthMm.size(),
                static_cast<std::size_t>(info.camera.width) * static_cast<std::size_t>(info.camera.height));
    }
  }
}

TEST(OniFile, FlippedBytesGiveFramesOrASentence) {
  RandomNumbers random(11);
  for (const OniCodec codec : {OniCodec::kRaw, OniCodec::kPacked, OniCodec::kTable}) {
    OniWriterSettings settings;
    settings.codec = codec;
    const std::string good = someFile(settings, 4);
    for (int i = 0; i < 3000; ++i) {
      std::string bytes = good;
      for (int flips = 1 + i % 3; flips > 0; --flips) {
        bytes[random.bits() % bytes.size()] ^= static_cast<char>(1 + random.bits() % 255);
      }
      expectFramesOrSentence(bytes);
    }
  }
}

TEST(OniFile, WhatTheFuzzerStartsFromIsRead) {
  const std::filesystem::path folder = test::recordingsFolder().parent_path() / "tests" / "fuzz" / "corpus" / "oni";
  int files = 0;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder)) {
    OniFile file = test::valueOf(OniFile::open(entry.path()));
    EXPECT_EQ(allFramesOf(file).size(), 2u) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 9);
}

TEST(OniFile, ADamagedFrameIsASentenceAndTheOthersAreThere) {
  OniWriterSettings settings;
  settings.codec = OniCodec::kPacked;
  std::string bytes = someFile(settings, 2);
  const std::string second = packOniDepth(OniCodec::kPacked, someFrame(8, 6, 1));
  const std::size_t at = bytes.find(second);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 2] = '\xf3';
  OniFile file = test::valueOf(OniFile::parse(bytes, "a.oni"));
  DepthFrame frame;
  EXPECT_TRUE(file.read(0, frame));
  const Result<void> damaged = file.read(1, frame);
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().message.find("a.oni, depth frame 1 at byte "), std::string::npos)
      << damaged.error().message;
  EXPECT_NE(damaged.error().message.find("0xf3"), std::string::npos) << damaged.error().message;
}

TEST(OniFile, FilesThatAreNoneAreSentences) {
  const test::TemporaryFolder folder;
  const Result<OniFile> missing = OniFile::open(folder.path() / "none.oni");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(OniFile::open(folder.path()));
  EXPECT_FALSE(OniFile::open(folder.write("empty.oni", "")));
  const Result<OniFile> text = OniFile::open(folder.write("text.oni", "this is a text and no recording"));
  ASSERT_FALSE(text);
  EXPECT_NE(text.error().message.find("found \"this\", expected \"NI10\""), std::string::npos) << text.error().message;
}

TEST(OniFile, GivesEveryFrameOnceInOrder) {
  const test::TemporaryFolder folder;
  const std::unique_ptr<DepthSource> source = test::valueOf(openOni(folder.write("body.oni", someFile({}, 7))));
  EXPECT_EQ(source->name(), "body.oni");
  DepthFrame frame;
  for (int i = 0; i < 7; ++i) {
    const DepthRead read = test::valueOf(source->next(frame));
    ASSERT_EQ(read, DepthRead::kFrame);
    EXPECT_EQ(frame.depthMm, someFrame(8, 6, i));
  }
  for (int i = 0; i < 2; ++i) {
    const DepthRead read = test::valueOf(source->next(frame));
    EXPECT_EQ(read, DepthRead::kEnd);
    EXPECT_EQ(frame.depthMm, someFrame(8, 6, 6)) << "unchanged at the end";
  }
}

TEST(OniFile, SeekingGivesTheFramesOfReadingThrough) {
  const test::TemporaryFolder folder;
  const std::unique_ptr<OniFile> source = test::valueOf(openOni(folder.write("body.oni", someFile({}, 7))));
  DepthFrame frame;
  for (const int wanted : {6, 0, 3, 3, 5}) {
    source->seek(wanted);
    const Result<DepthRead> read = source->next(frame);
    ASSERT_TRUE(read && *read == DepthRead::kFrame);
    EXPECT_EQ(frame.depthMm, someFrame(8, 6, wanted));
    EXPECT_EQ(source->position(), wanted + 1);
  }
  source->seek(100);
  EXPECT_EQ(source->position(), 7);
  source->seek(-5);
  EXPECT_EQ(source->position(), 0);
}

TEST(OniFile, ADamagedFrameLeavesTheCallersAlone) {
  const test::TemporaryFolder folder;
  OniWriterSettings settings;
  settings.codec = OniCodec::kPacked;
  std::string bytes = someFile(settings, 2);
  bytes[bytes.find(packOniDepth(OniCodec::kPacked, someFrame(8, 6, 1))) + 2] = '\xf3';
  const std::unique_ptr<DepthSource> source = test::valueOf(openOni(folder.write("body.oni", bytes)));
  DepthFrame frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_FALSE(source->next(frame));
  EXPECT_EQ(frame.depthMm, someFrame(8, 6, 0));
}

TEST(OniFile, ARealKinectRecordingIsRead) {
  LORICA_REQUIRE_DATASET(path, "oni/3DJ_Test/test.oni");
  OniFile file = test::valueOf(OniFile::open(path));
  const OniInfo& info = file.info();
  EXPECT_EQ(info.version, "1.0.1.0");
  EXPECT_EQ(info.device, "SensorKinect");
  EXPECT_EQ(info.codec, OniCodec::kTable);
  EXPECT_EQ(info.frameCount, 12);
  EXPECT_EQ(info.colorFrameCount, 12);
  EXPECT_NEAR(info.duration, 0.367062, 1e-9);
  EXPECT_TRUE(info.mirrored);
  EXPECT_FALSE(info.cutOff);
  EXPECT_EQ(info.camera.width, 640);
  EXPECT_NEAR(info.camera.horizontalFov, DepthCamera{}.horizontalFov, 1e-6);
  EXPECT_NEAR(info.camera.verticalFov, DepthCamera{}.verticalFov, 1e-6);
  // A Kinect returns 0, or 0.4 to 10 m.
  for (const DepthFrame& frame : allFramesOf(file)) {
    const auto seen = std::count_if(frame.depthMm.begin(), frame.depthMm.end(), [](std::uint16_t d) { return d > 0; });
    EXPECT_GT(seen, 640 * 480 / 2);
    for (const std::uint16_t depth : frame.depthMm) ASSERT_TRUE(depth == 0 || (depth > 300 && depth <= 10000)) << depth;
  }
}

TEST(OniFile, ADamagedRealRecordingGivesFramesOrASentence) {
  LORICA_REQUIRE_DATASET(path, "oni/3DJ_Test/test.oni");
  const std::string good = test::valueOf(readFile(path));
  RandomNumbers random(12);
  std::string bytes = good;
  for (int i = 0; i < 300; ++i) {
    // In record headers and properties most flips have an effect.
    const std::size_t at = i % 4 == 0 ? random.bits() % bytes.size() : random.bits() % 32000;
    const char was = bytes[at];
    bytes[at] ^= static_cast<char>(1 + random.bits() % 255);
    const Result<OniFile> file = OniFile::parse(bytes, "a.oni");
    if (file) {
      EXPECT_EQ(file->info().frameCount, 12);
    }
    bytes[at] = was;
  }
}

}  // namespace
}  // namespace lorica
