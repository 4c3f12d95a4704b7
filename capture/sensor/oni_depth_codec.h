#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Packing of a depth image in an .oni recording: the four letters of its name, the first in the lowest byte.
enum class OniCodec : std::uint32_t {
  kRaw = 0x454e4f4e,     ///< "NONE": 16 bits per pixel
  kPacked = 0x507a3631,  ///< "16zP": differences from pixel to pixel, half a byte each if they are small
  kTable = 0x547a3631,   ///< "16zT": the same with indices into a table of the occurring depths, which is stored first
};

/// A run of 30 equal pixels is one byte, and no packing is denser. This bounds the image size that a small file can
/// produce.
inline constexpr std::size_t kOniPixelsPerByte = 30;

/// Unpacks depth images of .oni recordings. Never reads or writes out of bounds, whatever the input.
class OniDepthDecoder {
 public:
  /// @param packed  one image as stored in the file
  /// @param depths  of all pixels, in the file's unit; undefined after an error
  /// @return an error without a file name if the bytes are damaged or do not make exactly the image
  [[nodiscard]] Result<void> decode(OniCodec codec, std::span<const std::uint8_t> packed,
                                    std::span<std::uint16_t> depths);

 private:
  std::vector<std::uint16_t> table_;
};

/// Packs a depth image like OpenNI's recorders. For kTable the table comes first.
/// @param depths  at least one
[[nodiscard]] std::string packOniDepth(OniCodec codec, std::span<const std::uint16_t> depths);

}  // namespace lorica
