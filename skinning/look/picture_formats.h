#pragma once

#include "geometry/result.h"
#include "skinning/look/picture.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace lorica {

/// What the head of a picture file claims, before anything is decoded.
struct PictureClaim {
  std::uint32_t width = 0;        ///< pixels
  std::uint32_t height = 0;       ///< pixels
  std::uint64_t fewestBytes = 0;  ///< no complete file of this size and kind has fewer
};

/// Checks a claim against the limits and the size of the file.
[[nodiscard]] Result<void> checkClaim(const PictureClaim& claim, std::size_t fileBytes, const std::string& name);

/// What a file that begins with PNG's signature, JPEG's first marker, or WebP's, claims; not yet checked with
/// checkClaim().
[[nodiscard]] Result<PictureClaim> pngClaim(std::span<const std::byte> bytes, const std::string& name);
[[nodiscard]] Result<PictureClaim> jpegClaim(std::span<const std::byte> bytes, const std::string& name);
[[nodiscard]] Result<PictureClaim> webpClaim(std::span<const std::byte> bytes, const std::string& name);

/// Decodes a file that begins with PNG's signature.
[[nodiscard]] Result<Picture> decodePng(std::span<const std::byte> bytes, const std::string& name,
                                        const PictureLimits& limits);

/// Decodes a file that begins with JPEG's first marker.
[[nodiscard]] Result<Picture> decodeJpeg(std::span<const std::byte> bytes, const std::string& name,
                                         const PictureLimits& limits);

/// Decodes a file that begins as WebP: lossy or lossless, not animated.
[[nodiscard]] Result<Picture> decodeWebp(std::span<const std::byte> bytes, const std::string& name,
                                         const PictureLimits& limits);

}  // namespace lorica
