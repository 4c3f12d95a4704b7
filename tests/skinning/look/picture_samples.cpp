#include "tests/skinning/look/picture_samples.h"

#include <gtest/gtest.h>

#include <turbojpeg.h>
#include <zlib.h>

#include <random>

namespace lorica::test {
namespace {

std::string bigEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

/// The rows of every stepX-th pixel of every stepY-th row, each after its filter type 0.
std::string rowsOf(const PngSample& sample, int fromX, int fromY, int stepX, int stepY) {
  const int channels = channelCount(sample.colorType);
  std::string rows;
  if (fromX >= sample.width) return rows;
  for (int y = fromY; y < sample.height; y += stepY) {
    rows += '\0';
    unsigned int pending = 0;
    int pendingBits = 0;
    for (int x = fromX; x < sample.width; x += stepX) {
      for (int c = 0; c < channels; ++c) {
        const int value = sample.samples[static_cast<std::size_t>((y * sample.width + x) * channels + c)];
        pending = pending << sample.bits | static_cast<unsigned int>(value);
        for (pendingBits += sample.bits; pendingBits >= 8; pendingBits -= 8) {
          rows += static_cast<char>(pending >> (pendingBits - 8));
        }
      }
    }
    if (pendingBits > 0) rows += static_cast<char>(pending << (8 - pendingBits));
  }
  return rows;
}

}  // namespace

int channelCount(int colorType) {
  return colorType == 2 ? 3 : colorType == 4 ? 2 : colorType == 6 ? 4 : 1;
}

std::string pngChunk(std::string_view type, std::string_view data) {
  std::string typeAndData(type);
  typeAndData += data;
  const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(typeAndData.data()), static_cast<uInt>(typeAndData.size()));
  return bigEndian(static_cast<std::uint32_t>(data.size())) + typeAndData + bigEndian(static_cast<std::uint32_t>(crc));
}

std::string pngOf(const PngSample& sample) {
  std::string rows;
  if (sample.interlaced) {
    // Adam7: https://www.w3.org/TR/png-3/#8Interlace
    constexpr int kPasses[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                   {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
    for (const auto& pass : kPasses) rows += rowsOf(sample, pass[0], pass[1], pass[2], pass[3]);
  } else {
    rows = rowsOf(sample, 0, 0, 1, 1);
  }
  uLongf packedSize = compressBound(rows.size());
  std::string packed(packedSize, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &packedSize, reinterpret_cast<const Bytef*>(rows.data()),
           rows.size());
  packed.resize(packedSize);
  std::string head =
      bigEndian(static_cast<std::uint32_t>(sample.width)) + bigEndian(static_cast<std::uint32_t>(sample.height));
  head += static_cast<char>(sample.bits);
  head += static_cast<char>(sample.colorType);
  head += std::string(2, '\0');
  head += sample.interlaced ? '\1' : '\0';
  return std::string("\x89PNG\r\n\x1a\n", 8) + pngChunk("IHDR", head) + sample.chunks + pngChunk("IDAT", packed) +
         pngChunk("IEND", {});
}

std::string pngOf(const Picture& picture, bool interlaced) {
  PngSample sample{picture.width, picture.height, 6, 8, interlaced, {}, {}};
  sample.samples.assign(picture.rgba.begin(), picture.rgba.end());
  return pngOf(sample);
}

std::string jpegOf(const Picture& picture, JpegKind kind, JpegChroma chroma, int quality) {
  const tjhandle encoder = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int subsampling = chroma == JpegChroma::kQuarter ? TJSAMP_420
                          : chroma == JpegChroma::kGray  ? TJSAMP_GRAY
                                                         : TJSAMP_444;
  const int failed = tjCompress2(encoder, picture.rgba.data(), picture.width, 0, picture.height,
                                 chroma == JpegChroma::kFourChannels ? TJPF_CMYK : TJPF_RGBA, &bytes, &size,
                                 subsampling, quality, kind == JpegKind::kProgressive ? TJFLAG_PROGRESSIVE : 0);
  EXPECT_EQ(failed, 0) << tjGetErrorStr2(encoder);
  std::string file(reinterpret_cast<const char*>(bytes), size);
  tjFree(bytes);
  tjDestroy(encoder);
  return file;
}

Picture smoothPicture(int width, int height) {
  Picture picture{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.rgba.push_back(static_cast<std::uint8_t>(20 + 200 * x / width));
      picture.rgba.push_back(static_cast<std::uint8_t>(230 - 200 * y / height));
      picture.rgba.push_back(static_cast<std::uint8_t>(40 + 80 * x / width + 80 * y / height));
      picture.rgba.push_back(static_cast<std::uint8_t>(255 - 100 * y / height));
    }
  }
  return picture;
}

Picture noisePicture(int width, int height, std::uint32_t seed) {
  std::mt19937 random(seed);
  Picture picture{width, height, {}};
  for (int i = 0; i < width * height * 4; ++i) picture.rgba.push_back(static_cast<std::uint8_t>(random() >> 8));
  return picture;
}

std::vector<std::byte> exactBytes(std::string_view content) {
  const auto bytes = std::as_bytes(std::span(content));
  return {bytes.begin(), bytes.end()};
}

Result<Picture> decoded(std::string_view content, int largestSide) {
  return decodePicture(exactBytes(content), "sample", largestSide);
}

void expectRefused(const Result<Picture>& result, ErrorCode code, std::string_view words) {
  ASSERT_FALSE(result.ok()) << "expected: " << words;
  EXPECT_EQ(result.error().code, code) << result.error().message;
  EXPECT_TRUE(result.error().message.starts_with("sample: ")) << result.error().message;
  EXPECT_EQ(result.error().message.find('\n'), std::string::npos) << result.error().message;
  EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
}

}  // namespace lorica::test
