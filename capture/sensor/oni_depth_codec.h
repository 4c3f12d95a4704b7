#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// How a depth image is packed in an .oni recording: the four letters of its name, the first lowest.
enum class OniCodec : std::uint32_t {
  kRaw = 0x454e4f4e,     ///< "NONE": 16 bits a pixel
  kPacked = 0x507a3631,  ///< "16zP": differences from pixel to pixel, half a byte each where they are small
  kTable = 0x547a3631,   ///< "16zT": the same of indices into a table of the depths that occur, which comes first
};

/// A run of 30 equal pixels is one byte, and nothing packs denser: what a small file can make large is bounded.
inline constexpr std::size_t kOniPixelsPerByte = 30;

/// Unpacks depth images of .oni recordings. Whatever the bytes are, nothing is read or written beyond them.
class OniDepthDecoder {
 public:
  /// @param packed  one image as it stands in the file
  /// @param depths  of all pixels, in the file's unit; undefined after an error
  /// @return a sentence without a file's name when the bytes are damaged or do not make exactly the image
  [[nodiscard]] Result<void> decode(OniCodec codec, std::span<const std::uint8_t> packed,
                                    std::span<std::uint16_t> depths);

 private:
  std::vector<std::uint16_t> table_;
};

}  // namespace lorica
