#include "viewer/pictures/image_files.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "viewer/renderer/text.h"

#include <fmt/format.h>

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace lorica {
namespace {

bool consistent(const Image& image) {
  return image.width > 0 && image.height > 0 && image.rgba.size() == image.byteCount();
}

/// Blends a colour into a pixel. Coverage is 0 to 255.
void blend(std::uint8_t* pixel, const std::array<int, 3>& color, int coverage) {
  for (std::size_t c = 0; c < 3; ++c) {
    pixel[c] = (pixel[c] * (255 - coverage) + color[c] * coverage + 127) / 255;
  }
}

/// Checks all chunks of a PNG file, because libpng stops reading after the last row.
/// @return empty if all are intact, otherwise what is wrong
std::string damageOf(std::string_view png) {
  constexpr std::size_t kSignature = 8;
  if (png.size() < kSignature || png_sig_cmp(reinterpret_cast<png_const_bytep>(png.data()), 0, kSignature) != 0) {
    return "not a PNG file";
  }
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n = n << 8 | static_cast<std::uint8_t>(png[at + i]);
    return n;
  };
  std::size_t at = kSignature;
  while (at + 12 <= png.size()) {
    const std::size_t length = number(at);
    if (length > png.size() - at - 12) break;
    const std::string_view typeAndData = png.substr(at + 4, length + 4);
    const uLong crc = ::crc32(0, reinterpret_cast<const Bytef*>(typeAndData.data()), length + 4);
    if (crc != number(at + 8 + length)) return fmt::format("wrong checksum in the chunk at byte {}", at);
    if (typeAndData.starts_with("IEND")) return {};
    at += 12 + length;
  }
  return fmt::format("truncated in the chunk at byte {} of {}", at, png.size());
}

}  // namespace

Result<void> writePng(const std::filesystem::path& file, const Image& image, NamedBy by) {
  if (!consistent(image)) {
    return invalidArgument("{}: picture of {} x {} pixels has {} bytes, expected {} and a size above 0", file.string(),
                           image.width, image.height, image.rgba.size(),
                           static_cast<long long>(image.width) * image.height * 4);
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  png.format = PNG_FORMAT_RGBA;
  png.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr) == 0) {
    return unwritable("{}: PNG encoding failed: {}", file.string(), png.message);
  }
  bytes.resize(size);
  return writeFileAtomically(file, bytes, by);
}

Result<Image> readPng(const std::filesystem::path& file) {
  LORICA_TRY(const std::string content, readFile(file));
  if (const std::string damage = damageOf(content); !damage.empty()) {
    return badFormat("{}: {}", file.string(), damage);
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto damaged = [&] {
    png_image_free(&png);
    return badFormat("{}: damaged PNG file: {}", file.string(), png.message);
  };
  if (png_image_begin_read_from_memory(&png, content.data(), content.size()) == 0) return damaged();
  png.format = PNG_FORMAT_RGBA;
  png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // for 16-bit images without a colour space
  Image image;
  image.width = png.width;
  image.height = png.height;
  image.rgba.resize(PNG_IMAGE_SIZE(png));
  if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0) return damaged();
  return image;
}

Image contactSheet(std::span<const Image> images, std::span<const std::string> labels, int columns) {
  constexpr int kMargin = 8;
  if (images.empty()) return {};
  columns = std::clamp(columns, 1, countOf(images));
  const int rows = (countOf(images) + columns - 1) / columns;
  int cellWidth = 1;
  int cellHeight = 1;
  for (const Image& image : images) {
    cellWidth = std::max(cellWidth, image.width);
    cellHeight = std::max(cellHeight, image.height);
  }
  const int labelHeight = labels.empty() ? 0 : std::clamp(cellHeight / 16, 18, 40);
  Image sheet = Image::filled(kMargin + columns * (cellWidth + kMargin),
                              kMargin + rows * (cellHeight + labelHeight + kMargin), 255);

  for (int i = 0; i < countOf(images); ++i) {
    const int left = kMargin + i % columns * (cellWidth + kMargin);
    const int top = kMargin + i / columns * (cellHeight + labelHeight + kMargin);
    const Image& image = images[i];
    if (consistent(image)) {
      // Images smaller than their cell are centred.
      const int x = left + (cellWidth - image.width) / 2;
      const int y = top + (cellHeight - image.height) / 2;
      const std::size_t rowBytes = std::size_t{4} * image.width;
      for (int row = 0; row < image.height; ++row) {
        std::copy_n(image.rgba.data() + row * rowBytes, rowBytes, sheet.pixel(x, y + row));
      }
    }
    if (i >= countOf(labels) || labels[i].empty()) continue;
    const TextMask text = drawText(labels[i], labelHeight);
    const int textWidth = std::min(text.width, cellWidth);
    const int x = left + (cellWidth - textWidth) / 2;
    for (int row = 0; row < std::min(text.height, labelHeight); ++row) {
      for (int column = 0; column < textWidth; ++column) {
        blend(sheet.pixel(x + column, top + cellHeight + row), {40, 46, 56},
              text.coverage[static_cast<std::size_t>(row) * text.width + column]);
      }
    }
  }
  return sheet;
}

}  // namespace lorica
