#include "geometry/errors.h"
#include "skinning/look/picture_formats.h"
#include "skinning/look/picture_shrink.h"

#include <turbojpeg.h>

#include <memory>

namespace lorica {
namespace {

std::uint32_t byteAt(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint32_t>(bytes[at]);
}

std::uint32_t pairAt(std::span<const std::byte> bytes, std::size_t at) {
  return byteAt(bytes, at) << 8 | byteAt(bytes, at + 1);
}

}  // namespace

/// The size in the frame header, and whether this kind of JPEG is decoded (ITU-T T.81, annex B:
/// https://www.w3.org/Graphics/JPEG/itu-t81.pdf).
Result<PictureClaim> jpegClaim(std::span<const std::byte> bytes, const std::string& name) {
  const auto damaged = [&](std::size_t at, const char* expected) {
    return badFormat("{}: a JPEG picture that is damaged at byte {} of {}, expected {}", name, at, bytes.size(),
                     expected);
  };
  std::size_t at = 2;
  while (true) {
    while (at + 1 < bytes.size() && byteAt(bytes, at) == 0xff && byteAt(bytes, at + 1) == 0xff) ++at;  // padding
    if (at + 4 > bytes.size() || byteAt(bytes, at) != 0xff) return damaged(at, "a marker before the size");
    const std::uint32_t marker = byteAt(bytes, at + 1);
    const std::size_t length = pairAt(bytes, at + 2);
    if (marker < 0xc0 || (marker >= 0xd0 && marker <= 0xda)) return damaged(at, "a frame header");
    if (length < 2 || length > bytes.size() - at - 2) return damaged(at, "a segment that ends within the file");
    const bool isFrame = marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (!isFrame) {
      at += 2 + length;
      continue;
    }
    if (length < 8) return damaged(at, "a frame header of 8 bytes or more");
    const std::uint32_t bits = byteAt(bytes, at + 4);
    const std::uint32_t channels = byteAt(bytes, at + 9);
    if (marker > 0xc2 || bits != 8) {
      return unsupported(
          "{}: a JPEG picture of kind SOF{} with {} bits, expected kind 0, 1 or 2 (baseline, "
          "sequential, progressive) with 8 bits",
          name, marker - 0xc0, bits);
    }
    if (channels != 1 && channels != 3) {
      return unsupported("{}: a JPEG picture of {} channels{}, expected 1 (gray) or 3 (colour)", name, channels,
                         channels == 4 ? " (CMYK)" : "");
    }
    PictureClaim claim{pairAt(bytes, at + 7), pairAt(bytes, at + 5), 0};
    // Each block of 8 x 8 takes one bit or more. Channels may be stored smaller, but not all of them by more than 4.
    claim.fewestBytes = std::uint64_t{claim.width} * claim.height / (64 * 4 * 8);
    return claim;
  }
}

namespace {

/// By how much to shrink while decoding: 8, 4, 2 or 1.
int shrinkOf(PictureSize size, PictureSize wanted) {
  for (const int by : {8, 4, 2}) {
    if (size.width % by == 0 && size.height % by == 0 && size.width / by >= wanted.width &&
        size.height / by >= wanted.height) {
      return by;
    }
  }
  return 1;
}

}  // namespace

Result<Picture> decodeJpeg(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits) {
  LORICA_TRY(const PictureClaim claim, jpegClaim(bytes, name));
  LORICA_TRY_DO(checkClaim(claim, bytes.size(), name));

  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  if (!decoder) return unreadable("{}: TurboJPEG does not start", name);
  const PictureSize size{static_cast<int>(claim.width), static_cast<int>(claim.height)};
  const int by = shrinkOf(size, limitedSize(size, limits.largestSide));
  Picture picture{size.width / by, size.height / by, {}};
  picture.rgba.resize(static_cast<std::size_t>(picture.width) * picture.height * 4);
  // libjpeg only warns of missing and damaged pixels. The limit of scans is against small files that take minutes.
  constexpr int kFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  if (tjDecompress2(decoder.get(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                    picture.rgba.data(), picture.width, 0, picture.height, TJPF_RGBA, kFlags) != 0) {
    return badFormat("{}: a JPEG picture of {} bytes that is damaged: {}", name, bytes.size(),
                     tjGetErrorStr2(decoder.get()));
  }
  return shrunk(std::move(picture), limits.largestSide);
}

}  // namespace lorica
