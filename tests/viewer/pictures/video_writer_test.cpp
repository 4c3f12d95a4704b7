#include "viewer/pictures/video_writer.h"
#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"
#include "tests/viewer/renderer/pictures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <opencv2/videoio.hpp>

namespace lorica {
namespace {

Image plain(int width, int height, int red, int green, int blue) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    for (const int v : {red, green, blue, 255}) image.rgba.push_back(static_cast<std::uint8_t>(v));
  }
  return image;
}

int filesIn(const std::filesystem::path& folder) {
  return static_cast<int>(std::distance(std::filesystem::directory_iterator(folder), {}));
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
  const Result<void> added = writer.add(plain(48, 64, 0, 0, 0));
  ASSERT_FALSE(added.ok());
  EXPECT_NE(added.error().message.find("48 x 64"), std::string::npos) << added.error().message;
}

TEST(VideoWriter, ImpossibleFilmsGiveASentence) {
  const test::TemporaryFolder folder;
  const auto code = [&](const char* name, int width, int height, double rate) {
    const Result<VideoWriter> writer = VideoWriter::create(folder.path() / name, width, height, rate);
    EXPECT_FALSE(writer.ok());
    if (writer.ok()) return ErrorCode::kCancelled;
    EXPECT_NE(writer.error().message.find(name), std::string::npos) << writer.error().message;
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
