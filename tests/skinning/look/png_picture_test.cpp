#include "tests/skinning/look/picture_samples.h"

#include "skinning/look/picture_shrink.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <webp/encode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>

namespace lorica::test {
namespace {

constexpr int kColors = 11;  // of each palette

/// Red, green, blue, alpha of a palette's colour. The last three have no entry in tRNS and are opaque.
std::array<int, 4> paletteColor(int index) {
  return {10 + 20 * index, 250 - 7 * index, 3 * index, index < kColors - 3 ? 25 * index : 255};
}

PngSample randomSample(int width, int height, int colorType, int bits, std::uint32_t seed) {
  std::mt19937 random(seed);
  PngSample sample{width, height, colorType, bits, false, {}, {}};
  const int count = colorType == 3 ? std::min(kColors, 1 << bits) : 1 << bits;
  for (int i = 0; i < width * height * channelCount(colorType); ++i) {
    sample.samples.push_back(static_cast<int>(random() % static_cast<unsigned int>(count)));
  }
  if (colorType == 3) {
    std::string colors;
    for (int i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3; ++c) colors += static_cast<char>(paletteColor(i)[c]);
    }
    sample.chunks = pngChunk("PLTE", colors);
  }
  return sample;
}

/// Makes the sample's first pixel's colour, or a palette's first colours, transparent.
void addTransparency(PngSample& sample) {
  std::string data;
  if (sample.colorType == 3) {
    for (int i = 0; i < std::min(kColors - 3, 1 << sample.bits); ++i) data += static_cast<char>(paletteColor(i)[3]);
  } else {
    for (int c = 0; c < channelCount(sample.colorType); ++c) {
      data += static_cast<char>(sample.samples[static_cast<std::size_t>(c)] >> 8);
      data += static_cast<char>(sample.samples[static_cast<std::size_t>(c)]);
    }
  }
  sample.chunks += pngChunk("tRNS", data);
}

Picture expected(const PngSample& sample, bool transparency) {
  Picture picture{sample.width, sample.height, {}};
  const auto channels = static_cast<std::size_t>(channelCount(sample.colorType));
  const auto to8 = [&](int value) {
    return static_cast<std::uint8_t>(std::lround(value * 255.0 / ((1 << sample.bits) - 1)));
  };
  for (std::size_t i = 0; i < sample.samples.size(); i += channels) {
    const int* values = &sample.samples[i];
    if (sample.colorType == 3) {
      const auto color = paletteColor(values[0]);
      for (std::size_t c = 0; c < 3; ++c) picture.rgba.push_back(static_cast<std::uint8_t>(color[c]));
      picture.rgba.push_back(transparency ? static_cast<std::uint8_t>(color[3]) : 255);
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) picture.rgba.push_back(to8(values[channels >= 3 ? c : 0]));
    if (channels % 2 == 0) {
      picture.rgba.push_back(to8(values[channels - 1]));
    } else {
      picture.rgba.push_back(transparency && std::equal(values, values + channels, sample.samples.data()) ? 0 : 255);
    }
  }
  return picture;
}

void expectDecodesTo(const PngSample& sample, const Picture& wanted) {
  const Picture picture = valueOf(decoded(pngOf(sample)));
  EXPECT_EQ(picture.width, wanted.width);
  EXPECT_EQ(picture.height, wanted.height);
  EXPECT_EQ(picture.rgba, wanted.rgba);
}

TEST(PngPicture, EveryColourTypeAndDepthInterlacedOrNot) {
  constexpr std::pair<int, int> kKinds[] = {{0, 1}, {0, 2}, {0, 4}, {0, 8}, {0, 16}, {2, 8}, {2, 16}, {3, 1},
                                            {3, 2}, {3, 4}, {3, 8}, {4, 8}, {4, 16}, {6, 8}, {6, 16}};
  std::uint32_t seed = 1;
  for (const auto& [colorType, bits] : kKinds) {
    for (const bool interlaced : {false, true}) {
      for (const auto& [width, height] : {std::pair(1, 1), std::pair(13, 7), std::pair(3, 40)}) {
        SCOPED_TRACE(testing::Message() << "type " << colorType << " bits " << bits << " interlaced " << interlaced
                                        << " size " << width << " x " << height << " seed " << seed);
        PngSample sample = randomSample(width, height, colorType, bits, seed++);
        sample.interlaced = interlaced;
        expectDecodesTo(sample, expected(sample, false));
        if (colorType >= 4) continue;
        addTransparency(sample);
        expectDecodesTo(sample, expected(sample, true));
      }
    }
  }
}

TEST(PngPicture, All16BitValuesRoundToTheNearest) {
  PngSample sample{256, 256, 0, 16, false, {}, {}};
  for (int i = 0; i < 65536; ++i) sample.samples.push_back(i);
  expectDecodesTo(sample, expected(sample, false));
}

TEST(PngPicture, ColourSpacesAreIgnored) {
  for (const int bits : {8, 16}) {
    PngSample sample = randomSample(9, 9, 2, bits, 7);
    const Picture wanted = expected(sample, false);
    const std::string primaries(32, '\x11');
    for (const std::string& chunks :
         {pngChunk("gAMA", {"\0\x01\x86\xa0", 4}), pngChunk("gAMA", {"\0\0\xb1\x8f", 4}) + pngChunk("cHRM", primaries),
          pngChunk("sRGB", {"\0", 1}), pngChunk("iCCP", "no profile"), pngChunk("sBIT", "\1\1\1"),
          pngChunk("bKGD", {"\0\1\0\1\0\1", 6}), pngChunk("loRi", "nobody knows it")}) {
      sample.chunks = chunks;
      expectDecodesTo(sample, wanted);
    }
  }
}

TEST(PngPicture, EveryTruncationFails) {
  for (const bool interlaced : {false, true}) {
    const std::string file = pngOf(noisePicture(9, 5, 3), interlaced);
    ASSERT_TRUE(decoded(file).ok());
    for (std::size_t size = 0; size < file.size(); ++size) {
      SCOPED_TRACE(size);
      EXPECT_FALSE(decoded(file.substr(0, size)).ok());
      EXPECT_FALSE(decoded(file.substr(0, size), 4).ok());
    }
    EXPECT_TRUE(decoded(file + "what comes after the end").ok());
  }
}

TEST(PngPicture, EveryDamagedByteGivesAPictureOfThatSizeOrASentence) {
  const std::string file = pngOf(smoothPicture(6, 5));
  for (std::size_t at = 8; at < file.size(); ++at) {
    for (const int flip : {0x01, 0x20, 0xff}) {
      std::string damaged = file;
      damaged[at] = static_cast<char>(damaged[at] ^ flip);
      const Result<Picture> picture = decoded(damaged, 4);
      if (!picture) {
        EXPECT_EQ(picture.error().message.find('\n'), std::string::npos);
        continue;
      }
      EXPECT_EQ(picture->rgba, decoded(file, 4)->rgba) << "byte " << at << " changes the picture and goes unnoticed";
    }
  }
}

TEST(PngPicture, DamageIsNamed) {
  const std::string file = pngOf(smoothPicture(6, 5));
  expectRefused(decoded(file.substr(0, 20)), ErrorCode::kBadFormat, "expected a chunk IHDR of 13 bytes");
  expectRefused(decoded(file.substr(0, 50)), ErrorCode::kBadFormat, "the file ends early");
  std::string damaged = file;
  damaged[60] ^= 1;
  expectRefused(decoded(damaged), ErrorCode::kBadFormat, "of 193: IDAT");
  PngSample fewRows = {6, 5, 0, 8, false, std::vector<int>(30, 9), {}};
  std::string pixels = pngOf(fewRows);
  fewRows.height = 6;
  fewRows.samples.resize(36);
  // The head of six rows before the pixels of five.
  expectRefused(decoded(pngOf(fewRows).substr(0, 33) + pixels.substr(33)), ErrorCode::kBadFormat, "PNG picture");
}

TEST(PngPicture, PaletteThatIsMissingOrTooShort) {
  PngSample sample = randomSample(5, 5, 3, 8, 2);
  sample.samples[7] = 200;
  const Result<Picture> beyond = decoded(pngOf(sample));  // libpng takes the missing colours as black
  EXPECT_TRUE(beyond.ok() || beyond.error().code == ErrorCode::kBadFormat);
  sample.chunks.clear();
  expectRefused(decoded(pngOf(sample)), ErrorCode::kBadFormat, "PLTE");
}

TEST(PngPicture, ReducingRowByRowEqualsReducingTheWhole) {
  const Picture picture = noisePicture(37, 23, 11);
  for (const int side : {1, 5, 12, 36, 37}) {
    const Result<Picture> rows = decoded(pngOf(picture, false), side);
    const Result<Picture> whole = decoded(pngOf(picture, true), side);
    ASSERT_TRUE(rows.ok() && whole.ok());
    EXPECT_EQ(rows->width, side);
    EXPECT_EQ(rows->height, whole->height);
    EXPECT_EQ(rows->rgba, whole->rgba);
  }
}

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

std::string webpOf(const Picture& picture, bool lossless) {
  std::uint8_t* bytes = nullptr;
  const std::size_t size =
      lossless ? WebPEncodeLosslessRGBA(picture.rgba.data(), picture.width, picture.height, 4 * picture.width, &bytes)
               : WebPEncodeRGBA(picture.rgba.data(), picture.width, picture.height, 4 * picture.width, 90.0F, &bytes);
  std::string file(reinterpret_cast<const char*>(bytes), size);
  WebPFree(bytes);
  return file;
}

TEST(WebpPicture, LosslessOnesAreExactAndLossyOnesClose) {
  Picture picture = smoothPicture(37, 21);
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 255;
  EXPECT_EQ(valueOf(decoded(webpOf(picture, true))).rgba, picture.rgba);
  const Picture lossy = valueOf(decoded(webpOf(picture, false)));
  ASSERT_EQ(lossy.rgba.size(), picture.rgba.size());
  int farthest = 0;
  for (std::size_t i = 0; i < lossy.rgba.size(); ++i) {
    farthest = std::max(farthest, std::abs(int{lossy.rgba[i]} - int{picture.rgba[i]}));
  }
  EXPECT_LE(farthest, 40);
}

TEST(WebpPicture, ItsSizeIsKnownAndLimited) {
  const std::string file = webpOf(smoothPicture(64, 32), true);
  const PictureSize size = valueOf(readPictureSize(exactBytes(file), "a"));
  EXPECT_EQ(size.width, 64);
  EXPECT_EQ(size.height, 32);
  EXPECT_EQ(valueOf(decoded(file, 16)).width, 16);
}

TEST(WebpPicture, EveryTruncatedPrefixIsRefused) {
  const std::string file = webpOf(smoothPicture(16, 16), true);
  for (std::size_t length = 12; length + 1 < file.size(); ++length) {
    EXPECT_FALSE(decoded(file.substr(0, length)).ok()) << length;
  }
  expectRefused(decoded("RIFF....WEBPVP8 "), ErrorCode::kBadFormat, "a WebP picture of 16 bytes that is damaged");
}

}  // namespace
}  // namespace lorica::test
