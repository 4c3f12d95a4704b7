#pragma once

/// The records of an .oni recording, and access to the bytes of any. Internal: not installed.

#include "capture/sensor/oni_file.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Random access to the bytes of a file.
class OniBytes {
 public:
  virtual ~OniBytes() = default;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// @return whether all of `out` was filled
  [[nodiscard]] virtual bool read(std::uint64_t at, std::span<std::uint8_t> out) const = 0;
};

/// A regular file, opened without waiting.
[[nodiscard]] Result<std::unique_ptr<OniBytes>> openBytes(const std::filesystem::path& file);
/// Bytes in memory, which outlive the result.
[[nodiscard]] std::unique_ptr<OniBytes> bytesInMemory(std::string_view bytes);

/// Index entry of a depth frame in the file.
struct OniFrameEntry {
  std::uint64_t timeUs = 0;
  std::uint64_t payload = 0;  ///< byte in the file
  std::uint32_t payloadBytes = 0;
  std::uint16_t left = 0;  ///< left edge of the recorded image region
  std::uint16_t top = 0;
  std::uint16_t width = 0;
  std::uint16_t height = 0;
  bool mirrored = false;
};

struct OniIndex {
  OniInfo info;
  bool tenths = false;  ///< depths are in tenths of a millimetre
  std::vector<OniFrameEntry> frames;
};

/// Reads and checks all records.
[[nodiscard]] Result<OniIndex> indexOni(const OniBytes& bytes, const std::string& name);

}  // namespace lorica
