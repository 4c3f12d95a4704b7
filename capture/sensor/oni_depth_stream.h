#pragma once

/// The depth node of an .oni recording, built from its records. Internal: not installed.

#include "capture/sensor/oni_records.h"
#include "geometry/little_endian.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace lorica {

/// Reads little-endian numbers from a record, never beyond its end.
class OniFields {
 public:
  explicit OniFields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename T>
  std::optional<T> take() {
    if (bytes_.size() < sizeof(T)) return std::nullopt;
    const T value = loadLittleEndian<T>(reinterpret_cast<const char*>(bytes_.data()));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }
  /// @return the bytes up to the first 0
  std::optional<std::string_view> text(std::size_t bytes) {
    if (bytes_.size() < bytes) return std::nullopt;
    const std::string_view whole(reinterpret_cast<const char*>(bytes_.data()), bytes);
    bytes_ = bytes_.subspan(bytes);
    return whole.substr(0, whole.find('\0'));
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

/// Location of a frame's payload in the file.
struct OniPayload {
  std::uint64_t at = 0;
  std::uint32_t bytes = 0;
};

/// Collects properties and frames of the depth node in an index. Errors are of the form "found ..., expected ..."; the
/// caller adds the location in the file.
class OniDepthStream {
 public:
  /// @param index  is extended; must outlive this
  explicit OniDepthStream(OniIndex& index) : index_(index) {}

  [[nodiscard]] Result<void> setCodec(std::uint32_t codec);
  [[nodiscard]] Result<void> setNumber(std::string_view name, std::uint64_t value);
  /// @param bytes  size of the value according to the record
  [[nodiscard]] Result<void> setGeneral(std::string_view name, OniFields value, std::uint32_t bytes);
  /// @param fields    time and number
  /// @param latestUs  max time of a frame
  [[nodiscard]] Result<void> addFrame(OniFields fields, OniPayload payload, std::uint64_t latestUs);

 private:
  Result<void> setPixelFormat(std::uint64_t format);
  Result<void> setSize(OniFields value, std::uint32_t bytes);
  Result<void> setFieldOfView(OniFields value, std::uint32_t bytes);
  Result<void> setCrop(OniFields value, std::uint32_t bytes);

  OniIndex& index_;
  bool sized_ = false;
  bool mirrored_ = false;
  std::uint32_t lastNumber_ = 0;
  std::optional<OniFrameEntry> crop_;
};

}  // namespace lorica
