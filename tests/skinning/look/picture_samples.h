#pragma once

#include "skinning/look/picture.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica::test {

/// A PNG file to be written, byte by byte and without libpng. Rows are not filtered.
struct PngSample {
  int width = 0, height = 0;
  int colorType = 6;  ///< 0 gray, 2 RGB, 3 palette, 4 gray and alpha, 6 RGBA
  int bits = 8;       ///< a sample: 1, 2, 4, 8, 16
  bool interlaced = false;
  std::vector<int> samples;  ///< height x width x channels
  std::string chunks;        ///< between the head and the pixels, see pngChunk()
};

[[nodiscard]] int channelCount(int colorType);
/// A chunk with its length and checksum.
[[nodiscard]] std::string pngChunk(std::string_view type, std::string_view data);
[[nodiscard]] std::string pngOf(const PngSample& sample);
/// An RGBA picture as a PNG file of 8 bits a channel.
[[nodiscard]] std::string pngOf(const Picture& picture, bool interlaced = false);

enum class JpegKind { kBaseline, kProgressive };
enum class JpegChroma { kFull, kQuarter, kGray, kFourChannels };
[[nodiscard]] std::string jpegOf(const Picture& picture, JpegKind kind, JpegChroma chroma, int quality = 95);

/// Smooth ramps of all four channels, which JPEG keeps to a few values.
[[nodiscard]] Picture smoothPicture(int width, int height);
/// Unrelated values in all channels.
[[nodiscard]] Picture noisePicture(int width, int height, std::uint32_t seed);

/// A copy on the heap of exactly the content's size, so that sanitizers see a read past its end.
[[nodiscard]] std::vector<std::byte> exactBytes(std::string_view content);

/// Decodes from such a copy.
[[nodiscard]] Result<Picture> decoded(std::string_view content, int largestSide = 0);

/// Expects a failure with one sentence on one line that begins with the name.
void expectRefused(const Result<Picture>& result, ErrorCode code, std::string_view words);

}  // namespace lorica::test
