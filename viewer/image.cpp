#include "viewer/image.h"

#include "geometry/files.h"
#include "viewer/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

namespace lorica {
namespace {

bool consistent(const Image& image) {
  return image.width > 0 && image.height > 0 &&
         image.rgba.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4;
}

/// Mixes a colour into a pixel by coverage 0 to 255.
void blend(std::uint8_t* pixel, const std::array<int, 3>& color, int coverage) {
  for (std::size_t c = 0; c < 3; ++c) {
    pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - coverage) + color[c] * coverage + 127) / 255);
  }
}

/// CRC-32 of ISO 3309, as PNG uses it.
std::uint32_t crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      t[n] = n;
      for (int k = 0; k < 8; ++k) t[n] = (t[n] & 1u) ? 0xedb88320u ^ (t[n] >> 1) : t[n] >> 1;
    }
    return t;
  }();
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) crc = table[(crc ^ static_cast<std::uint8_t>(c)) & 0xffu] ^ (crc >> 8);
  return ~crc;
}

/// Walks the chunks of a PNG file, because libpng writes its complaints to the console by itself.
/// @return empty when all are whole, else what is wrong
std::string damageOf(std::string_view png) {
  constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
  if (!png.starts_with(kSignature)) return "not a PNG file";
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n = n << 8 | static_cast<std::uint8_t>(png[at + i]);
    return n;
  };
  std::size_t at = kSignature.size();
  while (at + 12 <= png.size()) {
    const std::size_t length = number(at);
    if (length > png.size() - at - 12) break;
    const std::string_view typeAndData = png.substr(at + 4, length + 4);
    if (crc32(typeAndData) != number(at + 8 + length)) return fmt::format("checksum wrong in the chunk at byte {}", at);
    if (typeAndData.starts_with("IEND")) return {};
    at += 12 + length;
  }
  return fmt::format("cut off in the chunk at byte {} of {}", at, png.size());
}

}  // namespace

Result<void> writePng(const std::filesystem::path& file, const Image& image) {
  if (!consistent(image)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: picture of {} x {} pixels has {} bytes, expected {} and a size above 0",
                             file.string(), image.width, image.height, image.rgba.size(),
                             static_cast<long long>(image.width) * image.height * 4)};
  }
  std::vector<unsigned char> png;
  try {
    const cv::Mat rgba(image.height, image.width, CV_8UC4, const_cast<std::uint8_t*>(image.rgba.data()));
    cv::Mat bgra;
    cv::cvtColor(rgba, bgra, cv::COLOR_RGBA2BGRA);
    if (!cv::imencode(".png", bgra, png)) {
      return Error{ErrorCode::kUnwritable, fmt::format("{}: OpenCV cannot encode PNG", file.string())};
    }
  } catch (const std::exception& e) {
    return Error{ErrorCode::kUnwritable, fmt::format("{}: PNG encoding failed: {}", file.string(), e.what())};
  }
  return writeFileAtomically(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

Result<Image> readPng(const std::filesystem::path& file) {
  const Result<std::string> content = readFile(file);
  if (!content.ok()) return content.error();
  if (const std::string damage = damageOf(content.value()); !damage.empty()) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: {}", file.string(), damage)};
  }
  const cv::utils::logging::LogLevel before = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::Mat decoded;
  try {
    // IMREAD_UNCHANGED keeps the alpha channel; 16-bit pictures are brought to 8 below.
    const cv::Mat bytes(1, static_cast<int>(content->size()), CV_8U, const_cast<char*>(content->data()));
    decoded = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    if (decoded.depth() == CV_16U) decoded.convertTo(decoded, CV_8U, 1.0 / 257.0);
    if (decoded.channels() == 1) cv::cvtColor(decoded, decoded, cv::COLOR_GRAY2RGBA);
    if (decoded.channels() == 3)
      cv::cvtColor(decoded, decoded, cv::COLOR_BGR2RGBA);
    else if (decoded.channels() == 4 && !decoded.empty())
      cv::cvtColor(decoded, decoded, cv::COLOR_BGRA2RGBA);
  } catch (const std::exception&) {
    decoded.release();
  }
  cv::utils::logging::setLogLevel(before);
  if (decoded.empty() || decoded.type() != CV_8UC4) {
    return Error{ErrorCode::kBadFormat,
                 fmt::format("{}: damaged PNG file of {} bytes", file.string(), content->size())};
  }
  Image image;
  image.width = decoded.cols;
  image.height = decoded.rows;
  image.rgba.assign(decoded.datastart, decoded.dataend);
  return image;
}

Image contactSheet(std::span<const Image> images, std::span<const std::string> labels, int columns) {
  constexpr int kMargin = 8;
  Image sheet;
  if (images.empty()) return sheet;
  columns = std::clamp(columns, 1, static_cast<int>(images.size()));
  const int rows = (static_cast<int>(images.size()) + columns - 1) / columns;
  int cellWidth = 1;
  int cellHeight = 1;
  for (const Image& image : images) {
    cellWidth = std::max(cellWidth, image.width);
    cellHeight = std::max(cellHeight, image.height);
  }
  const int labelHeight = labels.empty() ? 0 : std::clamp(cellHeight / 16, 18, 40);
  sheet.width = kMargin + columns * (cellWidth + kMargin);
  sheet.height = kMargin + rows * (cellHeight + labelHeight + kMargin);
  sheet.rgba.assign(static_cast<std::size_t>(sheet.width) * sheet.height * 4, 255);
  const auto pixel = [&](int x, int y) {
    return sheet.rgba.data() + (static_cast<std::size_t>(y) * sheet.width + static_cast<std::size_t>(x)) * 4;
  };

  for (std::size_t i = 0; i < images.size(); ++i) {
    const int left = kMargin + static_cast<int>(i) % columns * (cellWidth + kMargin);
    const int top = kMargin + static_cast<int>(i) / columns * (cellHeight + labelHeight + kMargin);
    const Image& image = images[i];
    if (consistent(image)) {
      // A picture smaller than its cell sits in the middle of it.
      const int x = left + (cellWidth - image.width) / 2;
      const int y = top + (cellHeight - image.height) / 2;
      const std::size_t rowBytes = static_cast<std::size_t>(image.width) * 4;
      for (int row = 0; row < image.height; ++row) {
        std::copy_n(image.rgba.data() + static_cast<std::size_t>(row) * rowBytes, rowBytes, pixel(x, y + row));
      }
    }
    if (i >= labels.size() || labels[i].empty()) continue;
    const TextMask text = drawText(labels[i], labelHeight);
    const int textWidth = std::min(text.width, cellWidth);
    const int x = left + (cellWidth - textWidth) / 2;
    for (int row = 0; row < std::min(text.height, labelHeight); ++row) {
      for (int column = 0; column < textWidth; ++column) {
        blend(pixel(x + column, top + cellHeight + row), {40, 46, 56},
              text.coverage[static_cast<std::size_t>(row) * text.width + column]);
      }
    }
  }
  return sheet;
}

}  // namespace lorica
