#include "viewer/pictures/image_files.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/pictures/video_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <opencv2/videoio.hpp>

#include <fstream>

namespace lorica {
namespace {

/// All pixels differ, including alpha.
Image gradient(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const int value : {x * 7, y * 11, x * y, 255 - x}) image.rgba.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return image;
}

int filesIn(const std::filesystem::path& folder) {
  return static_cast<int>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(Png, RoundTripKeepsEveryByte) {
  const test::TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {64, 48}, {257, 1}}) {
    const Image image = gradient(width, height);
    const auto file = folder.path() / "picture.png";
    const Result<void> written = writePng(file, image);
    ASSERT_TRUE(written.ok()) << written.error().message;
    const Image read = test::valueOf(readPng(file));
    EXPECT_EQ(read.width, width);
    EXPECT_EQ(read.height, height);
    EXPECT_EQ(read.rgba, image.rgba);
  }
  EXPECT_EQ(filesIn(folder.path()), 1);
}

TEST(Png, ImpossibleTargetsGiveASentenceAndLeaveNothing) {
  const test::TemporaryFolder folder;
  const Image image = gradient(4, 4);
  const Error nowhere = test::errorOf(writePng(folder.path() / "missing" / "a.png", image));
  EXPECT_EQ(nowhere.code, ErrorCode::kUnwritable);
  EXPECT_TRUE(test::has(nowhere.message, "missing"));
  EXPECT_EQ(filesIn(folder.path()), 0);
}

TEST(Png, InconsistentPicturesAreRefused) {
  const test::TemporaryFolder folder;
  Image image = gradient(4, 4);
  image.rgba.pop_back();
  EXPECT_EQ(writePng(folder.path() / "a.png", image).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(writePng(folder.path() / "a.png", Image{}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(filesIn(folder.path()), 0);
}

TEST(Png, MissingAndForeignFilesAreErrors) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(readPng(folder.path() / "none.png").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(readPng(folder.write("text.png", "hello")).error().code, ErrorCode::kBadFormat);
  EXPECT_EQ(readPng(folder.write("empty.png", "")).error().code, ErrorCode::kBadFormat);
}

TEST(Png, EveryTruncatedPrefixAndEveryFlippedBitFailsCleanly) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writePng(folder.path() / "whole.png", gradient(5, 4)).ok());
  std::ifstream in(folder.path() / "whole.png", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const Result<Image> cut = readPng(folder.write("cut.png", std::string_view(bytes).substr(0, n)));
    ASSERT_FALSE(cut.ok()) << "truncated at " << n;
    EXPECT_EQ(cut.error().code, ErrorCode::kBadFormat);
    std::string flipped = bytes;
    flipped[n] = static_cast<char>(flipped[n] ^ (1 << n % 8));
    const Result<Image> read = readPng(folder.write("flipped.png", flipped));
    ASSERT_FALSE(read.ok()) << "flipped at " << n;
    EXPECT_EQ(read.error().code, ErrorCode::kBadFormat);
  }
}

TEST(ContactSheet, HoldsEveryPictureInRowsWithRoomForLabels) {
  std::vector<Image> images;
  for (int i = 0; i < 5; ++i) {
    Image image{40, 30, {}};
    for (int p = 0; p < 40 * 30; ++p) {
      for (const int v : {10 + i, 20, 30, 255}) image.rgba.push_back(static_cast<std::uint8_t>(v));
    }
    images.push_back(image);
  }
  const std::vector<std::string> labels = {"a", "b", "c", "d", "e"};
  const Image sheet = contactSheet(images, labels, 3);
  EXPECT_EQ(sheet.rgba.size(), static_cast<std::size_t>(sheet.width) * sheet.height * 4);
  EXPECT_EQ(sheet.width, 3 * 40 + 4 * 8);
  EXPECT_GT(sheet.height, 2 * 30 + 3 * 8);
  std::array<int, 5> pixels{};
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      const auto p = test::pixelAt(sheet, x, y);
      if (p[1] == 20 && p[2] == 30 && p[0] >= 10 && p[0] < 15) ++pixels[p[0] - 10];
    }
  }
  for (const int n : pixels) EXPECT_EQ(n, 40 * 30);
}

TEST(ContactSheet, LabelsAreDrawnUnderTheirPictures) {
  const std::vector<Image> images(2, gradient(80, 40));
  const Image without = contactSheet(images, std::vector<std::string>{"", ""}, 2);
  const Image with = contactSheet(images, std::vector<std::string>{"walking", ""}, 2);
  ASSERT_EQ(with.width, without.width);
  int changed = 0;
  for (int y = 0; y < with.height; ++y) {
    for (int x = 0; x < with.width; ++x) {
      if (test::pixelAt(with, x, y) == test::pixelAt(without, x, y)) continue;
      ++changed;
      EXPECT_LT(x, 8 + 80);
      EXPECT_GE(y, 8 + 40);
    }
  }
  EXPECT_GT(changed, 30);
}

TEST(ContactSheet, OddInputIsNoTrouble) {
  EXPECT_TRUE(contactSheet({}, {}, 3).rgba.empty());
  const std::vector<Image> images = {gradient(8, 8), Image{}, gradient(3, 9)};
  const std::vector<std::string> labels = {std::string(500, 'w')};
  for (const int columns : {-1, 0, 1, 2, 99}) {
    const Image sheet = contactSheet(images, labels, columns);
    EXPECT_EQ(sheet.rgba.size(), static_cast<std::size_t>(sheet.width) * sheet.height * 4);
  }
}

Image plain(int width, int height, int red, int green, int blue) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    for (const int v : {red, green, blue, 255}) image.rgba.push_back(static_cast<std::uint8_t>(v));
  }
  return image;
}

TEST(VideoWriter, WritesWhatAReaderFinds) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "film.mp4";
  VideoWriter writer = test::valueOf(VideoWriter::create(file, 160, 120, 30.0));
  for (int i = 0; i < 20; ++i) {
    const Result<void> added = writer.add(plain(160, 120, 220, 40 + 5 * i, 30));
    ASSERT_TRUE(added.ok()) << added.error().message;
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  const Result<void> finished = writer.finish();
  ASSERT_TRUE(finished.ok()) << finished.error().message;
  EXPECT_EQ(filesIn(folder.path()), 1);

  cv::VideoCapture reader(file.string(), cv::CAP_FFMPEG);
  ASSERT_TRUE(reader.isOpened());
  EXPECT_NEAR(reader.get(cv::CAP_PROP_FPS), 30.0, 0.01);
  cv::Mat frame;
  int frames = 0;
  while (reader.read(frame)) {
    ASSERT_EQ(frame.cols, 160);
    ASSERT_EQ(frame.rows, 120);
    const cv::Vec3b middle = frame.at<cv::Vec3b>(60, 80);
    EXPECT_NEAR(middle[2], 220, 12);
    EXPECT_NEAR(middle[1], 40 + 5 * frames, 12);
    EXPECT_NEAR(middle[0], 30, 12);
    ++frames;
  }
  EXPECT_EQ(frames, 20);
}

TEST(VideoWriter, NothingRemainsWithoutFinish) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("film.mp4", "an older film");
  {
    VideoWriter writer = test::valueOf(VideoWriter::create(file, 64, 64, 25.0));
    ASSERT_TRUE(writer.add(plain(64, 64, 1, 2, 3)).ok());
    EXPECT_EQ(filesIn(folder.path()), 2);
  }
  EXPECT_EQ(filesIn(folder.path()), 1);
  EXPECT_EQ(std::filesystem::file_size(file), 13u) << "the older video stays";
}

TEST(VideoWriter, ALinkOfTheTemporaryNameIsNotFollowed) {
  const test::TemporaryFolder folder;
  const auto victim = folder.write("victim", "to be kept");
  std::filesystem::create_symlink(victim, folder.path() / fmt::format(".film.{}.partial.mp4", ::getpid()));
  VideoWriter writer = test::valueOf(VideoWriter::create(folder.path() / "film.mp4", 64, 64, 25.0));
  ASSERT_TRUE(writer.add(plain(64, 64, 1, 2, 3)).ok());
  EXPECT_TRUE(writer.finish().ok());
  EXPECT_EQ(readFile(victim).value(), "to be kept");
  EXPECT_EQ(filesIn(folder.path()), 2);
}

TEST(VideoWriter, AFilmWithoutFramesIsAnError) {
  const test::TemporaryFolder folder;
  {
    VideoWriter writer = test::valueOf(VideoWriter::create(folder.path() / "film.mp4", 64, 64, 25.0));
    EXPECT_FALSE(writer.finish().ok());
  }
  EXPECT_EQ(filesIn(folder.path()), 0);
}

TEST(VideoWriter, FramesOfAnotherSizeAreRefused) {
  const test::TemporaryFolder folder;
  VideoWriter writer = test::valueOf(VideoWriter::create(folder.path() / "film.mp4", 64, 48, 25.0));
  EXPECT_TRUE(test::has(test::errorOf(writer.add(plain(48, 64, 0, 0, 0))).message, "48 x 64"));
}

TEST(VideoWriter, ImpossibleFilmsGiveASentence) {
  const test::TemporaryFolder folder;
  const auto code = [&](const char* name, int width, int height, double rate) {
    const Result<VideoWriter> writer = VideoWriter::create(folder.path() / name, width, height, rate);
    EXPECT_FALSE(writer.ok());
    if (writer.ok()) return ErrorCode::kCancelled;
    EXPECT_TRUE(test::has(writer.error().message, name));
    return writer.error().code;
  };
  EXPECT_EQ(code("a.avi", 64, 64, 25), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("a.mp4", 63, 64, 25), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("a.mp4", 64, 0, 25), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("a.mp4", 64, 64, 0), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("a.mp4", 64, 64, std::numeric_limits<double>::quiet_NaN()), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code("missing/a.mp4", 64, 64, 25), ErrorCode::kUnwritable);
  std::filesystem::create_directory(folder.path() / "b.mp4");
  EXPECT_EQ(code("b.mp4", 64, 64, 25), ErrorCode::kUnwritable);
  EXPECT_EQ(filesIn(folder.path()), 1);
}

TEST(VideoWriter, AFolderWithoutPermissionGivesASentence) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  const test::TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const Result<VideoWriter> writer = VideoWriter::create(folder.path() / "film.mp4", 64, 64, 25.0);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  ASSERT_FALSE(writer.ok());
  EXPECT_EQ(writer.error().code, ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace lorica
