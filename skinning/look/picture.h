#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A decoded picture: 8 bits a channel, RGBA interleaved, row 0 at the top, alpha not multiplied into the colours. The
/// values are the file's: whether they are sRGB or linear is said by what uses the picture.
struct Picture {
  int width = 0;                   ///< pixels
  int height = 0;                  ///< pixels
  std::vector<std::uint8_t> rgba;  ///< four bytes a pixel, row by row from the top; sRGB, straight opacity
};

/// What a picture's header says.
struct PictureSize {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
};

/// The size in the same proportions whose largest side is at most `largestSide`, each side at least 1 and rounded to
/// the nearest. Unchanged if it fits or the limit is 0.
[[nodiscard]] PictureSize limitedSize(PictureSize size, int largestSide);

/// The size that a PNG, JPEG or WebP file claims to have, without decoding it. The rest of the file may be damaged.
/// @return the size, or an error as from decodePicture()
[[nodiscard]] Result<PictureSize> readPictureSize(std::span<const std::byte> bytes, const std::string& name);

/// Decodes a PNG, JPEG or WebP file. What it is is found from its content.
///
/// PNG: all colour types, 16 bits rounded to 8. JPEG: baseline and progressive, gray or three channels. WebP: still
/// ones. Profiles, gamma, chromaticities and orientation are ignored, as glTF asks
/// (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#images). A damaged or truncated file is an error even
/// where viewers would show a part of it.
///
/// Each pixel of a reduced picture is the mean over its exact area of the stored picture, with colours weighted by
/// alpha. A JPEG is first halved up to three times while it is decoded, as long as both sides stay whole and at least
/// as large as asked for; its values then differ slightly from the exact mean.
///
/// Memory: 4 bytes a pixel of the stored picture, in addition 6 for a progressive JPEG; a reduced PNG that is not
/// interlaced needs only some rows of it, a halved JPEG a quarter or less.
///
/// @param name         begins each error's sentence
/// @param largestSide  pixels; a larger picture is reduced to it, keeping its proportions. 0 = as stored
/// @return the picture, or kBadFormat (damaged, truncated, a wrong size), kUnsupported (another type, too large)
[[nodiscard]] Result<Picture> decodePicture(std::span<const std::byte> bytes, const std::string& name,
                                            int largestSide = 0);

/// A picture file in memory that somebody else owns.
struct EncodedPicture {
  std::span<const std::byte> bytes;  ///< of a PNG, JPEG or WebP file
  std::string name;                  ///< for messages
};

/// How pictures are decoded.
struct DecodeSettings {
  int largestSide = 0;  ///< see decodePicture()
  int threads = 0;      ///< 0 = all hardware threads; the result does not depend on it
  /// Called after each picture, one call at a time, from any thread; return false to cancel.
  std::function<bool(int done, int count)> progress = {};
};

/// Decodes several pictures at a time. Each thread needs the memory that decodePicture() names.
/// @return one result a picture, in their order; kCancelled for those that were not begun
[[nodiscard]] std::vector<Result<Picture>> decodePictures(std::span<const EncodedPicture> pictures,
                                                          const DecodeSettings& settings);

}  // namespace lorica
