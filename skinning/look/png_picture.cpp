#include "geometry/errors.h"
#include "geometry/work_budgets.h"
#include "skinning/look/picture_formats.h"
#include "skinning/look/picture_shrink.h"

#include <png.h>

#include <csetjmp>
#include <cstring>

namespace lorica {
namespace {

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

}  // namespace

/// The size that the first chunk, IHDR, claims (https://www.w3.org/TR/png-3/#11IHDR).
Result<PictureClaim> pngClaim(std::span<const std::byte> bytes, const std::string& name) {
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

Result<Picture> decodePng(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits) {
  LORICA_TRY(const PictureClaim claim, pngClaim(bytes, name));
  LORICA_TRY_DO(checkClaim(claim, bytes.size(), name));

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
  const PictureSize size{static_cast<int>(claim.width), static_cast<int>(claim.height)};
  const std::size_t rowBytes = static_cast<std::size_t>(size.width) * 4;
  LORICA_CHECK(png_get_rowbytes(reader.png, reader.info) == rowBytes, "libpng gives rows of another length");

  // A picture that will be reduced is never held whole, unless its rows come in several passes.
  const PictureSize wanted = limitedSize(size, limits.largestSide);
  if (passes == 1 && (wanted.width < size.width || wanted.height < size.height)) {
    PictureShrink shrink(size, wanted);
    std::vector<std::uint8_t> row(rowBytes);
    if (!readRows(reader, size.height, row, shrink)) return damaged();
    return shrink.take();
  }
  Picture picture{size.width, size.height, {}};
  picture.rgba.resize(rowBytes * size.height);
  if (!readPicture(reader, passes, picture)) return damaged();
  return shrunk(std::move(picture), limits.largestSide);
}

}  // namespace lorica
