#pragma once

/// Recordings of a camera's own images, which a lens makes a pinhole's. Internal: not installed.

#include "capture/sensor/depth_lens.h"
#include "capture/sensor/depth_recording.h"
#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

class OniBytes;

inline constexpr std::size_t kMaxDepthRecords = 4'000'000;  ///< that a recording's file is cut into

/// What a reader found.
struct RawDepth {
  DepthLens lens;
  std::vector<double> times;  ///< of each frame [s]
  DepthRecordingInfo about;   ///< without frames and duration
  /// Reads a frame. @param raw  of the lens's size
  std::function<Result<void>(int frame, std::span<std::uint16_t> raw)> read;
};

/// Checks times, lens and the unit of the first frame. @param name  of the recording, for messages
[[nodiscard]] Result<std::unique_ptr<DepthRecording>> recordingOf(RawDepth raw, const std::filesystem::path& path);

/// What is known of a recording's camera before its own word: what the user says, and the file beside it.
class GivenLens {
 public:
  /// @param text  see parseDepthLens(); empty = none
  /// @param json  files of which the first one that is there says it
  [[nodiscard]] static Result<GivenLens> find(std::string text, const std::vector<std::filesystem::path>& json);

  /// The camera of images of a size.
  /// @param own   what the recording says itself, and how that is called; none = nothing
  /// @param unit  of its numbers if nobody says another [m]
  /// @param from  gets what it was taken from
  [[nodiscard]] Result<DepthLens> lensOf(int width, int height, const std::optional<DepthLens>& own, double unit,
                                         std::string& from) const;

 private:
  std::string text_;
  std::string file_;     ///< that says it; empty = none
  std::string content_;  ///< of the file
};

/// The four kinds, see isDepthRecording().
[[nodiscard]] Result<RawDepth> readDepthPictures(const std::filesystem::path& folder, const std::string& lens);
[[nodiscard]] Result<RawDepth> readDepthArrays(const std::filesystem::path& file, const std::string& lens);
[[nodiscard]] Result<RawDepth> readDepthMatroska(std::shared_ptr<const OniBytes> bytes, const std::string& name,
                                                 const GivenLens& lens);
[[nodiscard]] Result<RawDepth> readDepthBag(std::shared_ptr<const OniBytes> bytes, const std::string& name,
                                            const GivenLens& lens);

/// Decodes a PNG picture of one channel of 16 bits.
/// @param image  of width x height
[[nodiscard]] Result<void> decodeDepthPng(std::string_view bytes, const std::string& name, int width, int height,
                                          std::span<std::uint16_t> image);
/// The size that a PNG picture claims to have. @return width and height, or that it is none
[[nodiscard]] Result<std::pair<int, int>> depthPngSize(std::string_view bytes, const std::string& name);

}  // namespace lorica
