#include "skinning/look/picture.h"

#include "geometry/errors.h"
#include "geometry/parallel_progress.h"
#include "geometry/work_budgets.h"
#include "skinning/look/picture_shrink.h"

#include <fmt/format.h>
#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <mutex>
#include <string_view>

namespace lorica {
namespace {

/// What the head of a picture file claims, before anything is decoded.
struct PictureClaim {
  std::uint32_t width = 0;        ///< pixels
  std::uint32_t height = 0;       ///< pixels
  std::uint64_t fewestBytes = 0;  ///< no complete file of this size and kind has fewer
};

/// Checks a claim against the limits and the size of the file.
[[nodiscard]] Result<void> checkClaim(const PictureClaim& claim, std::size_t fileBytes, const std::string& name) {
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

std::uint32_t byteAt(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint32_t>(bytes[at]);
}

std::uint32_t pairAt(std::span<const std::byte> bytes, std::size_t at) {
  return byteAt(bytes, at) << 8 | byteAt(bytes, at + 1);
}

const std::uint8_t* dataOf(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

Error damagedWebp(std::span<const std::byte> bytes, const std::string& name) {
  return badFormat("{}: a WebP picture of {} bytes that is damaged or cut off", name, bytes.size());
}

/// What libpng reads from, and what it says when it gives up.
struct PngReader {
  std::span<const std::byte> bytes;
  std::size_t at = 0;
  char message[200] = {};
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit PngReader(std::span<const std::byte> file) : bytes(file) {}
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

[[noreturn]] void onError(png_structp png, png_const_charp message) {
  auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
  std::strncpy(reader->message, message, sizeof(reader->message) - 1);
  png_longjmp(png, 1);
}

void onWarning(png_structp /*png*/, png_const_charp /*message*/) {}

void onRead(png_structp png, png_bytep out, std::size_t count) {
  auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
  if (count > reader->bytes.size() - reader->at) png_error(png, "the file ends early");
  std::memcpy(out, reader->bytes.data() + reader->at, count);
  reader->at += count;
}

// libpng leaves the next functions by longjmp, which runs no destructors: nothing in them may have one.

/// Reads what comes before the pixels and asks for 8-bit RGBA.
bool readHead(PngReader& reader, int& passes) {
  png_structp png = reader.png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, &reader, onRead);
  png_set_user_limits(png, kMaxPictureSide, kMaxPictureSide);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);  // all but the pixels, palette and its alpha
  png_read_info(png, reader.info);
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  passes = png_set_interlace_handling(png);
  png_read_update_info(png, reader.info);
  return true;
}

/// Reads all rows, each to its place.
bool readPicture(PngReader& reader, int passes, Picture& picture) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  const std::size_t rowBytes = static_cast<std::size_t>(picture.width) * 4;
  for (int pass = 0; pass < passes; ++pass) {
    png_bytep row = picture.rgba.data();
    for (int y = 0; y < picture.height; ++y, row += rowBytes) png_read_row(reader.png, row, nullptr);
  }
  png_read_end(reader.png, nullptr);
  return true;
}

/// Reads all rows of a picture that is not interlaced through one row.
bool readRows(PngReader& reader, int height, std::span<std::uint8_t> row, PictureShrink& shrink) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  for (int y = 0; y < height; ++y) {
    png_read_row(reader.png, row.data(), nullptr);
    shrink.add(row);
  }
  png_read_end(reader.png, nullptr);
  return true;
}

std::uint32_t bigEndian(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (const std::byte b : bytes.first(4)) value = value << 8 | std::to_integer<std::uint32_t>(b);
  return value;
}

/// The size that the first chunk, IHDR, claims (https://www.w3.org/TR/png-3/#11IHDR).
[[nodiscard]] Result<PictureClaim> pngClaim(std::span<const std::byte> bytes, const std::string& name) {
  constexpr std::size_t kHeadBytes = 33;  // signature, and IHDR with its length, name and checksum
  if (bytes.size() < kHeadBytes || std::memcmp(&bytes[8], "\0\0\0\x0dIHDR", 8) != 0) {
    return badFormat(
        "{}: a PNG picture of {} bytes that does not begin with its size, "
        "expected a chunk IHDR of 13 bytes",
        name, bytes.size());
  }
  PictureClaim claim{bigEndian(bytes.subspan(16)), bigEndian(bytes.subspan(20)), 0};
  if (claim.width > kMaxPictureSide || claim.height > kMaxPictureSide) return claim;
  const auto bits = std::to_integer<std::uint64_t>(bytes[24]);
  const auto colorType = std::to_integer<int>(bytes[25]);
  const std::uint64_t channels = colorType == 2 ? 3 : colorType == 4 ? 2 : colorType == 6 ? 4 : 1;
  // zlib packs at most 1032 bytes into one (https://zlib.net/zlib_tech.html).
  claim.fewestBytes = claim.height * ((claim.width * channels * bits + 7) / 8) / 1032;
  return claim;
}

/// Decodes a file that begins with PNG's signature.
[[nodiscard]] Result<Picture> decodePng(std::span<const std::byte> bytes, const std::string& name, PictureSize size,
                                        int largestSide) {
  PngReader reader(bytes);
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, onError, onWarning);
  if (reader.png != nullptr) reader.info = png_create_info_struct(reader.png);
  if (reader.info == nullptr) return unreadable("{}: libpng does not start", name);
  const auto damaged = [&] {
    return badFormat("{}: a PNG picture that is damaged at byte {} of {}: {}", name, reader.at, bytes.size(),
                     reader.message);
  };
  int passes = 0;
  if (!readHead(reader, passes)) return damaged();
  const std::size_t rowBytes = static_cast<std::size_t>(size.width) * 4;
  LORICA_CHECK(png_get_rowbytes(reader.png, reader.info) == rowBytes, "libpng gives rows of another length");

  // A picture that will be reduced is never held whole, unless its rows come in several passes.
  const PictureSize wanted = limitedSize(size, largestSide);
  if (passes == 1 && (wanted.width < size.width || wanted.height < size.height)) {
    PictureShrink shrink(size, wanted);
    std::vector<std::uint8_t> row(rowBytes);
    if (!readRows(reader, size.height, row, shrink)) return damaged();
    return shrink.take();
  }
  Picture picture{size.width, size.height, {}};
  picture.rgba.resize(rowBytes * size.height);
  if (!readPicture(reader, passes, picture)) return damaged();
  return shrunk(std::move(picture), largestSide);
}

[[nodiscard]] Result<PictureClaim> webpClaim(std::span<const std::byte> bytes, const std::string& name) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(dataOf(bytes), bytes.size(), &features) != VP8_STATUS_OK) return damagedWebp(bytes, name);
  if (features.has_animation != 0) return unsupported("{}: an animated WebP picture, expected a still one", name);
  PictureClaim claim{static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height), 0};
  // One copy in a lossless picture repeats at most 4096 pixels.
  claim.fewestBytes = std::uint64_t{claim.width} * claim.height / (4 * 4096);
  return claim;
}

/// Decodes a file that begins as WebP: lossy or lossless, not animated.
[[nodiscard]] Result<Picture> decodeWebp(std::span<const std::byte> bytes, const std::string& name, PictureSize size,
                                         int largestSide) {
  Picture picture{size.width, size.height, {}};
  picture.rgba.resize(std::size_t{4} * size.width * size.height);
  if (WebPDecodeRGBAInto(dataOf(bytes), bytes.size(), picture.rgba.data(), picture.rgba.size(), 4 * picture.width) ==
      nullptr) {
    return damagedWebp(bytes, name);
  }
  return shrunk(std::move(picture), largestSide);
}

/// The size in the frame header, and whether this kind of JPEG is decoded (ITU-T T.81, annex B:
/// https://www.w3.org/Graphics/JPEG/itu-t81.pdf).
[[nodiscard]] Result<PictureClaim> jpegClaim(std::span<const std::byte> bytes, const std::string& name) {
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

/// Decodes a file that begins with JPEG's first marker.
[[nodiscard]] Result<Picture> decodeJpeg(std::span<const std::byte> bytes, const std::string& name, PictureSize size,
                                         int largestSide) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  if (!decoder) return unreadable("{}: TurboJPEG does not start", name);
  const int by = shrinkOf(size, limitedSize(size, largestSide));
  Picture picture{size.width / by, size.height / by, {}};
  picture.rgba.resize(static_cast<std::size_t>(picture.width) * picture.height * 4);
  // libjpeg only warns of missing and damaged pixels. The limit of scans is against small files that take minutes.
  constexpr int kFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  if (tjDecompress2(decoder.get(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                    picture.rgba.data(), picture.width, 0, picture.height, TJPF_RGBA, kFlags) != 0) {
    return badFormat("{}: a JPEG picture of {} bytes that is damaged: {}", name, bytes.size(),
                     tjGetErrorStr2(decoder.get()));
  }
  return shrunk(std::move(picture), largestSide);
}

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
  Result<Picture> (*decode)(std::span<const std::byte> bytes, const std::string& name, PictureSize size,
                            int largestSide);
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

/// The size that a picture of this type claims to have, within the limits.
Result<PictureSize> sizeIn(const Format& format, std::span<const std::byte> bytes, const std::string& name) {
  LORICA_TRY(const PictureClaim claim, format.claim(bytes, name));
  LORICA_TRY_DO(checkClaim(claim, bytes.size(), name));
  return PictureSize{static_cast<int>(claim.width), static_cast<int>(claim.height)};
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

Result<Picture> decodePicture(std::span<const std::byte> bytes, const std::string& name, int largestSide) {
  if (largestSide < 0) {
    return invalidArgument("{}: largest side of {} pixels, expected 0 or more", name, largestSide);
  }
  LORICA_TRY(const Format* format, formatOf(bytes, name));
  LORICA_TRY(const PictureSize size, sizeIn(*format, bytes, name));
  return format->decode(bytes, name, size, largestSide);
}

Result<PictureSize> readPictureSize(std::span<const std::byte> bytes, const std::string& name) {
  LORICA_TRY(const Format* format, formatOf(bytes, name));
  return sizeIn(*format, bytes, name);
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
    if (beyond[i] == 0) decoded[i] = decodePicture(pictures[i].bytes, pictures[i].name, largestSide);
  });
  return decoded;
}

}  // namespace lorica
