#include "skinning/look/picture_shrink.h"
#include "tests/skinning/look/picture_samples.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace lorica::test {
namespace {

/// Largest difference of the colours; alpha must be 255.
int colorDifference(const Picture& picture, const Picture& wanted) {
  EXPECT_EQ(picture.width, wanted.width);
  EXPECT_EQ(picture.height, wanted.height);
  if (picture.rgba.size() != wanted.rgba.size()) return 256;
  int largest = 0;
  for (std::size_t i = 0; i < wanted.rgba.size(); ++i) {
    if (i % 4 == 3) {
      EXPECT_EQ(picture.rgba[i], 255);
      continue;
    }
    largest = std::max(largest, std::abs(picture.rgba[i] - wanted.rgba[i]));
  }
  return largest;
}

/// Where the frame header's marker is.
std::size_t frameHeader(const std::string& file) {
  for (std::size_t at = 2; at + 4 < file.size();) {
    const auto marker = static_cast<unsigned char>(file[at + 1]);
    if (marker >= 0xc0 && marker <= 0xc2) return at;
    at += 2 + static_cast<unsigned char>(file[at + 2]) * 256U + static_cast<unsigned char>(file[at + 3]);
  }
  return std::string::npos;
}

std::string withSize(std::string file, std::uint32_t width, std::uint32_t height) {
  const std::size_t at = frameHeader(file);
  file[at + 5] = static_cast<char>(height >> 8);
  file[at + 6] = static_cast<char>(height);
  file[at + 7] = static_cast<char>(width >> 8);
  file[at + 8] = static_cast<char>(width);
  return file;
}

TEST(JpegPicture, BaselineAndProgressiveInColour) {
  for (const JpegKind kind : {JpegKind::kBaseline, JpegKind::kProgressive}) {
    for (const JpegChroma chroma : {JpegChroma::kFull, JpegChroma::kQuarter}) {
      for (const auto& [width, height] : {std::pair(1, 1), std::pair(64, 64), std::pair(67, 41)}) {
        const Picture original = smoothPicture(width, height);
        const Picture picture = valueOf(decoded(jpegOf(original, kind, chroma)));
        EXPECT_LE(colorDifference(picture, original), 8) << width << " x " << height;
      }
    }
  }
}

TEST(JpegPicture, GrayHasThreeEqualChannels) {
  const Picture original = smoothPicture(50, 30);
  Picture gray = original;
  for (std::size_t i = 0; i < gray.rgba.size(); i += 4) {
    // https://www.w3.org/Graphics/JPEG/jfif3.pdf
    const double luma = 0.299 * gray.rgba[i] + 0.587 * gray.rgba[i + 1] + 0.114 * gray.rgba[i + 2];
    for (std::size_t c = 0; c < 3; ++c) gray.rgba[i + c] = static_cast<std::uint8_t>(luma + 0.5);
  }
  for (const JpegKind kind : {JpegKind::kBaseline, JpegKind::kProgressive}) {
    const Picture picture = valueOf(decoded(jpegOf(original, kind, JpegChroma::kGray)));
    EXPECT_LE(colorDifference(picture, gray), 3);
    EXPECT_EQ(picture.rgba[0], picture.rgba[1]);
    EXPECT_EQ(picture.rgba[0], picture.rgba[2]);
  }
}

TEST(JpegPicture, OtherKindsAreRefused) {
  expectRefused(decoded(jpegOf(smoothPicture(8, 8), JpegKind::kBaseline, JpegChroma::kFourChannels)),
                ErrorCode::kUnsupported, "4 channels (CMYK), expected 1 (gray) or 3 (colour)");
  const std::string file = jpegOf(smoothPicture(8, 8), JpegKind::kBaseline, JpegChroma::kFull);
  const std::size_t at = frameHeader(file);
  std::string other = file;
  other[at + 1] = '\xc9';  // arithmetic coding
  expectRefused(decoded(other), ErrorCode::kUnsupported, "kind SOF9");
  other = file;
  other[at + 4] = 12;
  expectRefused(decoded(other), ErrorCode::kUnsupported, "12 bits");
}

TEST(JpegPicture, EveryTruncationFails) {
  for (const JpegKind kind : {JpegKind::kBaseline, JpegKind::kProgressive}) {
    const std::string file = jpegOf(noisePicture(20, 12, 5), kind, JpegChroma::kQuarter, 40);
    ASSERT_TRUE(decoded(file).ok());
    for (std::size_t size = 0; size < file.size(); ++size) {
      SCOPED_TRACE(size);
      EXPECT_FALSE(decoded(file.substr(0, size)).ok());
      EXPECT_FALSE(decoded(file.substr(0, size), 5).ok());
    }
    EXPECT_TRUE(decoded(file + "what comes after the end").ok());
  }
}

TEST(JpegPicture, EveryDamagedByteGivesAPictureOrASentence) {
  for (const JpegKind kind : {JpegKind::kBaseline, JpegKind::kProgressive}) {
    const std::string file = jpegOf(noisePicture(20, 12, 5), kind, JpegChroma::kQuarter, 40);
    for (std::size_t at = 0; at < file.size(); ++at) {
      for (const int flip : {0x01, 0x10, 0xff}) {
        std::string damaged = file;
        damaged[at] = static_cast<char>(damaged[at] ^ flip);
        const Result<Picture> picture = decoded(damaged);
        if (picture) {
          EXPECT_EQ(picture->rgba.size(), static_cast<std::size_t>(picture->width) * picture->height * 4);
        } else {
          EXPECT_EQ(picture.error().message.find('\n'), std::string::npos) << picture.error().message;
        }
      }
    }
  }
}

TEST(JpegPicture, SizesThatCannotBe) {
  const std::string file = jpegOf(smoothPicture(8, 8), JpegKind::kBaseline, JpegChroma::kFull);
  expectRefused(decoded(withSize(file, 0, 8)), ErrorCode::kBadFormat, "0 x 8 pixels, expected 1 to 16384");
  expectRefused(decoded(withSize(file, 8, 0)), ErrorCode::kBadFormat, "8 x 0 pixels");
  expectRefused(decoded(withSize(file, 65535, 65535)), ErrorCode::kUnsupported, "65535 x 65535 pixels");
  expectRefused(decoded(withSize(file, 16384, 16384)), ErrorCode::kUnsupported, "at most 67108864 in all");
  expectRefused(decoded(withSize(file, 8192, 8192)), ErrorCode::kBadFormat, "expected at least 32768");
  expectRefused(decoded(withSize(file, 200, 200)), ErrorCode::kBadFormat, "damaged");
}

TEST(JpegPicture, ReducedIsCloseToTheExactMean) {
  for (const auto& [width, height] : {std::pair(128, 64), std::pair(96, 120), std::pair(61, 37)}) {
    for (const JpegChroma chroma : {JpegChroma::kFull, JpegChroma::kQuarter, JpegChroma::kGray}) {
      const std::string file = jpegOf(smoothPicture(width, height), JpegKind::kBaseline, chroma);
      const Picture stored = valueOf(decoded(file));
      for (const int side : {1, 7, 8, 16, 20, 31, 60, 64, 200}) {
        const Picture small = valueOf(decoded(file, side));
        EXPECT_LE(std::max(small.width, small.height), side);
        EXPECT_LE(colorDifference(small, shrunk(stored, side)), 6) << width << " x " << height << " to " << side;
      }
    }
  }
}

}  // namespace
}  // namespace lorica::test
