#include "skinning/look/picture.h"

#include "geometry/errors.h"
#include "geometry/parallel_progress.h"
#include "geometry/work_budgets.h"
#include "skinning/look/picture_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <string_view>

namespace lorica {
namespace {

/// What a file is, by the bytes at one place in it.
struct Signature {
  std::size_t at;
  std::string_view bytes;
  const char* name;
};

/// A type that is decoded.
struct Format {
  Signature signature;
  Result<PictureClaim> (*claim)(std::span<const std::byte> bytes, const std::string& name);
  Result<Picture> (*decode)(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits);
};

constexpr Format kFormats[] = {
    {{0, {"\x89PNG\r\n\x1a\n", 8}, "PNG"}, pngClaim, decodePng},
    {{0, {"\xff\xd8\xff", 3}, "JPEG"}, jpegClaim, decodeJpeg},
    {{8, "WEBP", "WebP"}, webpClaim, decodeWebp},
};

// What else is found in place of a picture, most of it in avatars.
constexpr Signature kRefused[] = {
    {0, {"\xabKTX 20\xbb\r\n\x1a\n", 12}, "a KTX2 picture"},
    {0, {"\xabKTX 11\xbb\r\n\x1a\n", 12}, "a KTX picture"},
    {0, {"sB\x13\0", 4}, "a Basis picture"},  // the last two bytes are its version
    {4, "ftypavif", "an AVIF picture"},
    {4, "ftypavis", "an AVIF picture"},
    {4, "ftyphei", "a HEIF picture"},
    {4, "ftypmif1", "a HEIF picture"},
    {0, "GIF8", "a GIF picture"},
    {0, "DDS ", "a DDS picture"},
    {0, "8BPS", "a Photoshop picture"},
    {0, {"II*\0", 4}, "a TIFF picture"},
    {0, {"MM\0*", 4}, "a TIFF picture"},
    {0, "#?RADIANCE", "a Radiance HDR picture"},
    {0, "v/1\x01", "an OpenEXR picture"},
    {0, "BM", "a BMP picture"},
};

bool has(std::string_view content, const Signature& signature) {
  return content.size() > signature.at && content.substr(signature.at).starts_with(signature.bytes);
}

std::string whatIs(std::string_view content) {
  if (content.empty()) return "no bytes";
  for (const Signature& known : kRefused) {
    if (has(content, known)) return known.name;
  }
  std::string text = "unknown content that begins with the bytes";
  for (const char c : content.substr(0, 4)) text += fmt::format(" {:02x}", static_cast<unsigned char>(c));
  return text;
}

Result<const Format*> formatOf(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const Format& format : kFormats) {
    if (has(content, format.signature)) return &format;
  }
  return unsupported("{}: {}, expected a PNG, JPEG or WebP picture", name, whatIs(content));
}

std::uint64_t pixelsOf(const PictureSize& size) {
  return std::uint64_t(size.width) * std::uint64_t(size.height);
}

// What a few bytes claim is reduced further, and decoded one at a time: they may claim to be one colour.
constexpr std::uint64_t kTexelsOfAByte = 32;      // of all pictures as they are drawn
constexpr std::uint64_t kTexelsOfFew = 1U << 25;  // and at least
constexpr std::uint64_t kLargePicture = 1U << 24;

/// The largest side at which all pictures together have few enough pixels.
int sideThatFits(std::span<const EncodedPicture> pictures, int largestSide) {
  std::uint64_t bytes = 0;
  for (const EncodedPicture& picture : pictures) bytes += picture.bytes.size();
  const std::uint64_t most = std::clamp(kTexelsOfAByte * bytes, kTexelsOfFew, kMaxKeptTexels);
  for (int side = largestSide;; side = side == 0 ? kMaxPictureSide / 2 : side / 2) {
    std::uint64_t kept = 0;
    for (const EncodedPicture& picture : pictures) {
      const Result<PictureSize> size = readPictureSize(picture.bytes, picture.name);
      if (size) kept += pixelsOf(limitedSize(*size, side));
    }
    if (kept <= most || side == 1) return side;
  }
}

}  // namespace

Result<void> checkClaim(const PictureClaim& claim, std::size_t fileBytes, const std::string& name) {
  if (claim.width == 0 || claim.height == 0) {
    return badFormat("{}: a picture of {} x {} pixels, expected 1 to {} on each side", name, claim.width, claim.height,
                     kMaxPictureSide);
  }
  if (std::max(claim.width, claim.height) > kMaxPictureSide ||
      std::int64_t{claim.width} * claim.height > kMaxPicturePixels) {
    return unsupported("{}: a picture of {} x {} pixels, expected 1 to {} on each side and at most {} in all", name,
                       claim.width, claim.height, kMaxPictureSide, kMaxPicturePixels);
  }
  if (fileBytes < claim.fewestBytes) {
    return badFormat("{}: {} bytes for a picture of {} x {} pixels, expected at least {}", name, fileBytes, claim.width,
                     claim.height, claim.fewestBytes);
  }
  return {};
}

Result<Picture> decodePicture(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits) {
  if (limits.largestSide < 0) {
    return invalidArgument("{}: largest side of {} pixels, expected 0 or more", name, limits.largestSide);
  }
  LORICA_TRY(const Format* format, formatOf(bytes, name));
  return format->decode(bytes, name, limits);
}

Result<PictureSize> readPictureSize(std::span<const std::byte> bytes, const std::string& name) {
  LORICA_TRY(const Format* format, formatOf(bytes, name));
  LORICA_TRY(const PictureClaim claim, format->claim(bytes, name));
  LORICA_TRY_DO(checkClaim(claim, bytes.size(), name));
  return PictureSize{static_cast<int>(claim.width), static_cast<int>(claim.height)};
}

std::vector<Result<Picture>> decodePictures(std::span<const EncodedPicture> pictures, const DecodeSettings& settings) {
  std::vector<Result<Picture>> decoded;
  decoded.reserve(pictures.size());
  for (const EncodedPicture& picture : pictures) {
    decoded.emplace_back(Error{ErrorCode::kCancelled, fmt::format("{}: cancelled", picture.name)});
  }
  std::vector<char> beyond(pictures.size(), 0), large(pictures.size(), 0);
  const int largestSide = sideThatFits(pictures, settings.largestSide);
  std::uint64_t stored = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Result<PictureSize> size = readPictureSize(pictures[i].bytes, pictures[i].name);
    if (!size) continue;  // decoding it says why
    const std::uint64_t pixels = pixelsOf(*size);
    beyond[i] = stored + pixels > kMaxStoredTexels ? 1 : 0;
    large[i] = pixels > kLargePicture ? 1 : 0;
    if (beyond[i] == 0) {
      stored += pixels;
    } else {
      decoded[i] = unsupported("{}: with it, the pictures have {} pixels, expected at most {}", pictures[i].name,
                               stored + pixels, kMaxStoredTexels);
    }
  }
  std::mutex oneLarge;
  (void)inParallel(pictures.size(), settings.threads, settings.progress, [&](std::size_t i) {
    std::unique_lock lock(oneLarge, std::defer_lock);
    if (large[i] != 0) lock.lock();
    if (beyond[i] == 0) decoded[i] = decodePicture(pictures[i].bytes, pictures[i].name, {largestSide});
  });
  return decoded;
}

}  // namespace lorica
