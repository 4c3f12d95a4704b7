#include "capture/sensor/oni_depth_stream.h"

#include "geometry/errors.h"

#include <fmt/format.h>

#include <limits>

namespace lorica {
namespace {

/// The largest sensor images are 1600 x 1200.
constexpr std::uint32_t kLargestSide = 2048;

// Pixel formats as numbered in OniCEnums.h.
constexpr std::uint64_t kMillimetres = 100;
constexpr std::uint64_t kTenthsOfMillimetres = 101;

Error bad(const std::string& found, const std::string& expected) {
  return badFormat("found {}, expected {}", found, expected);
}
Error notHandled(const std::string& found, const std::string& expected) {
  return unsupported("found {}, expected {}", found, expected);
}

}  // namespace

Result<void> OniDepthStream::setCodec(std::uint32_t codec) {
  index_.info.codec = static_cast<OniCodec>(codec);
  switch (index_.info.codec) {
    case OniCodec::kRaw:
    case OniCodec::kPacked:
    case OniCodec::kTable:
      return {};
  }
  return notHandled(fmt::format("depth codec 0x{:08x}", codec), "NONE, 16zP or 16zT");
}

Result<void> OniDepthStream::setNumber(std::string_view name, std::uint64_t value) {
  if (name == "xnMirror") mirrored_ = value != 0;
  if (name == "oniPixelFormat") return setPixelFormat(value);
  return {};
}

Result<void> OniDepthStream::setGeneral(std::string_view name, OniFields value, std::uint32_t bytes) {
  if (name == "xnMapOutputMode") return setSize(value, bytes);
  if (name == "xnFOV") return setFieldOfView(value, bytes);
  if (name == "xnCropping") return setCrop(value, bytes);
  return {};
}

Result<void> OniDepthStream::setPixelFormat(std::uint64_t format) {
  if (format != kMillimetres && format != kTenthsOfMillimetres) {
    return notHandled(fmt::format("depth in pixel format {}", format), "100 (millimetres) or 101 (tenths)");
  }
  const bool tenths = format == kTenthsOfMillimetres;
  if (tenths != index_.tenths && !index_.frames.empty())
    return bad("a different depth unit", "the same for all frames");
  index_.tenths = tenths;
  return {};
}

Result<void> OniDepthStream::setSize(OniFields value, std::uint32_t bytes) {
  const std::uint32_t width = value.take<std::uint32_t>().value_or(0);
  const std::uint32_t height = value.take<std::uint32_t>().value_or(0);
  const bool sound = bytes == 12 && width > 0 && width <= kLargestSide && height > 0 && height <= kLargestSide;
  if (!sound) {
    return bad(fmt::format("images of {} x {} in {} bytes", width, height, bytes), "1 to 2048 pixels, in 12 bytes");
  }
  DepthCamera& camera = index_.info.camera;
  const bool same =
      static_cast<std::uint32_t>(camera.width) == width && static_cast<std::uint32_t>(camera.height) == height;
  if (!index_.frames.empty() && !same) {
    return notHandled(
        fmt::format("images of {} x {} after images of {} x {}", width, height, camera.width, camera.height),
        "the same size");
  }
  camera.width = width;
  camera.height = height;
  sized_ = true;
  return {};
}

Result<void> OniDepthStream::setFieldOfView(OniFields value, std::uint32_t bytes) {
  const double horizontal = value.take<double>().value_or(0.0);
  const double vertical = value.take<double>().value_or(0.0);
  const auto sound = [](double angle) { return angle >= 0.1 && angle <= 3.0; };  // false for NaN
  if (bytes != 16 || !sound(horizontal) || !sound(vertical)) {
    return bad(fmt::format("a field of view of {} x {} rad in {} bytes", horizontal, vertical, bytes),
               "0.1 to 3, in 16 bytes");
  }
  DepthCamera& camera = index_.info.camera;
  if (!index_.frames.empty() && (camera.horizontalFov != horizontal || camera.verticalFov != vertical)) {
    return bad("a different field of view", "the same for all frames");
  }
  camera.horizontalFov = horizontal;
  camera.verticalFov = vertical;
  return {};
}

Result<void> OniDepthStream::setCrop(OniFields value, std::uint32_t bytes) {
  const bool enabled = value.take<std::uint32_t>().value_or(0) != 0;
  OniFrameEntry crop;
  crop.left = value.take<std::uint16_t>().value_or(0);
  crop.top = value.take<std::uint16_t>().value_or(0);
  crop.width = value.take<std::uint16_t>().value_or(0);
  crop.height = value.take<std::uint16_t>().value_or(0);
  if (bytes != 12) return bad(fmt::format("a cropping property of {} bytes", bytes), "12");
  crop_ = enabled ? std::optional(crop) : std::nullopt;
  return {};
}

Result<void> OniDepthStream::addFrame(OniFields fields, OniPayload payload, std::uint64_t latestUs) {
  const std::optional<std::uint64_t> timeUs = fields.take<std::uint64_t>();
  const std::optional<std::uint32_t> number = fields.take<std::uint32_t>();
  if (!timeUs || !number) return bad("a frame with fewer than 12 bytes of fields", "its time and number");
  if (*timeUs > latestUs) return bad(fmt::format("a frame at {} us", *timeUs), fmt::format("at most {}", latestUs));
  if (!index_.frames.empty() && (*timeUs <= index_.frames.back().timeUs || *number <= lastNumber_)) {
    return bad(fmt::format("frame {} at {} us after frame {} at {} us", *number, *timeUs, lastNumber_,
                           index_.frames.back().timeUs),
               "increasing numbers and times");
  }
  lastNumber_ = *number;
  if (!sized_) return bad("a depth frame", "the image size before it");

  const std::uint16_t width = index_.info.camera.width;
  const std::uint16_t height = index_.info.camera.height;
  OniFrameEntry entry = crop_.value_or(OniFrameEntry{.width = width, .height = height});
  if (entry.width == 0 || entry.height == 0 || entry.left + entry.width > width || entry.top + entry.height > height) {
    return bad(fmt::format("an image cropped to {} x {} at {}, {}", entry.width, entry.height, entry.left, entry.top),
               fmt::format("a region within {} x {}", width, height));
  }
  const std::size_t pixels = std::size_t{entry.width} * entry.height;
  const bool fits =
      index_.info.codec == OniCodec::kRaw ? payload.bytes == 2 * pixels : pixels <= kOniPixelsPerByte * payload.bytes;
  constexpr std::size_t kLargestTable = 2 + (1 << 17);
  if (!fits || payload.bytes > 4 * pixels + kLargestTable) {
    return bad(fmt::format("{} bytes of depth", payload.bytes), fmt::format("an image of {} pixels", pixels));
  }
  if (index_.frames.size() >= std::size_t{std::numeric_limits<int>::max()})
    return bad("too many frames", "at most 2^31");
  entry.timeUs = *timeUs;
  entry.payload = payload.at;
  entry.payloadBytes = payload.bytes;
  entry.mirrored = mirrored_;
  index_.info.mirrored = index_.info.mirrored || mirrored_;
  index_.frames.push_back(entry);
  return {};
}

}  // namespace lorica
