#pragma once

#include "capture/sensor/oni_depth_codec.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace lorica::test {

struct OniCrop {
  std::uint16_t left, top, width, height;
};

struct OniWriterSettings {
  int width = 8;
  int height = 6;
  OniCodec codec = OniCodec::kTable;
  bool mirrored = false;
  bool tenths = false;
  bool oldVersion = false;  ///< 1.0.0.6: record headers of 24 bytes
  std::optional<OniCrop> crop;
  double horizontalFov = 1.0;
  double verticalFov = 0.8;
};

/// Writes .oni recordings like OpenNI2's recorder, with a colour stream beside the depth.
class OniWriter {
 public:
  explicit OniWriter(const OniWriterSettings& settings);
  void addFrame(std::uint64_t timeUs, std::span<const std::uint16_t> depths);
  /// The file left by a recorder that is killed now.
  [[nodiscard]] const std::string& unfinished() const { return bytes_; }
  /// With counts, tables and the end record.
  [[nodiscard]] std::string finished() const;

 private:
  void record(std::uint32_t type, std::uint32_t node, const std::string& fields, const std::string& payload = {});
  void addNode(std::uint32_t type, std::uint32_t node, std::uint32_t codec, const std::string& name);
  void property(std::uint32_t type, std::uint32_t node, const std::string& name, const std::string& value);
  void number(std::uint32_t node, const std::string& name, std::uint64_t value);

  OniWriterSettings settings_;
  std::string bytes_;
  std::uint32_t frames_ = 0;
  std::uint64_t lastUs_ = 0;
  std::size_t depthCountAt_ = 0;
  std::size_t colorCountAt_ = 0;
};

}  // namespace lorica::test
