#include "viewer/pictures/gif_writer.h"

#include "geometry/random_numbers.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/videoio.hpp>

namespace lorica {
namespace {

constexpr int kWidth = 90;
constexpr int kHeight = 70;

/// Decodes an animation with FFmpeg, an independent reader.
std::vector<cv::Mat> readAll(const std::filesystem::path& file) {
  std::vector<cv::Mat> frames;
  cv::VideoCapture reader(file.string(), cv::CAP_FFMPEG);
  cv::Mat frame;
  while (reader.isOpened() && reader.read(frame)) frames.push_back(frame.clone());
  return frames;
}

int largestDifference(const Image& image, const cv::Mat& bgr) {
  int largest = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const int given = image.rgba[(y * image.width + x) * 4 + c];
        largest = std::max(largest, std::abs(given - bgr.at<cv::Vec3b>(y, x)[2 - c]));
      }
    }
  }
  return largest;
}

/// Noise of few colours, so that the palette has them all and the LZW table fills up and is reset.
Image noise(std::uint64_t seed) {
  RandomNumbers random(seed);
  Image image{kWidth, kHeight, {}};
  for (int i = 0; i < kWidth * kHeight; ++i) {
    for (int c = 0; c < 3; ++c) image.rgba.push_back(static_cast<std::uint8_t>(40 * (random.bits() % 6)));
    image.rgba.push_back(255);
  }
  return image;
}

TEST(GifWriter, AnotherReaderFindsWhatWasWritten) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "film.gif";
  Result<GifWriter> writer = GifWriter::create(file, kWidth, kHeight, 10.0);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  std::vector<Image> images = {noise(1), noise(2)};
  images.push_back(images.back());  // no change
  images.push_back(images.back());  // one corner changes
  for (std::size_t i = 0; i < 400; ++i) images.back().rgba[i] = static_cast<std::uint8_t>(255 - images.back().rgba[i]);
  for (const Image& image : images) ASSERT_TRUE(writer->add(image).ok());
  EXPECT_FALSE(std::filesystem::exists(file));
  ASSERT_TRUE(writer->finish().ok());

  const std::vector<cv::Mat> frames = readAll(file);
  ASSERT_EQ(frames.size(), images.size());
  for (std::size_t i = 0; i < images.size(); ++i) EXPECT_LE(largestDifference(images[i], frames[i]), 5) << i;
}

TEST(GifWriter, ManyColoursComeClose) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "colours.gif";
  Image image{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (const int v : {255 * x / kWidth, 255 * y / kHeight, 128 + 60 * ((x / 8 + y / 8) % 2), 255}) {
        image.rgba.push_back(static_cast<std::uint8_t>(v));
      }
    }
  }
  Result<GifWriter> writer = GifWriter::create(file, kWidth, kHeight, 10.0);
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer->add(image).ok());
  ASSERT_TRUE(writer->finish().ok());
  const std::vector<cv::Mat> frames = readAll(file);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_LE(largestDifference(image, frames[0]), 24);
}

TEST(GifWriter, BadNamesSizesAndRatesAreRefused) {
  for (const auto& [name, width, rate] : {std::tuple{"a.mp4", 10, 10.0},
                                          {"a.gif", 0, 10.0},
                                          {"a.gif", 70000, 10.0},
                                          {"a.gif", 10, 0.0},
                                          {"a.gif", 10, 51.0},
                                          {"a.gif", 10, std::nan("")}}) {
    EXPECT_FALSE(GifWriter::create(name, width, 10, rate).ok()) << name << ", " << width << ", " << rate;
  }
  Result<GifWriter> writer = GifWriter::create("/nowhere/at/all.gif", 4, 4, 10.0);
  ASSERT_TRUE(writer.ok());
  EXPECT_FALSE(writer->finish().ok()) << "no frames";
  EXPECT_FALSE(writer->add(noise(1)).ok()) << "another size";
  ASSERT_TRUE(writer->add(Image{4, 4, std::vector<std::uint8_t>(64, 7)}).ok());
  EXPECT_FALSE(writer->finish().ok());
}

}  // namespace
}  // namespace lorica
