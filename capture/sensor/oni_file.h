#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/sensor/oni_depth_codec.h"
#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace lorica {

/// What an .oni recording holds.
struct OniInfo {
  std::string version;         ///< of the format: "1.0.1.0"
  std::string device;          ///< as the recorder named it; may be empty
  DepthCamera camera;          ///< of all depth frames
  OniCodec codec{};            ///< of the depth frames
  int frameCount = 0;          ///< depth frames, at least one
  int colorFrameCount = 0;     ///< not read
  int infraredFrameCount = 0;  ///< not read
  double duration = 0.0;       ///< from the first depth frame to the last [s]
  bool mirrored = false;       ///< frames in the file are as in a mirror; those read are not
  bool cutOff = false;         ///< the recorder was stopped hard: the file has no end, its whole frames are there
  std::uint64_t end = 0;       ///< byte behind the last record: what follows is padding
};

/// An .oni recording of OpenNI 1 or 2, opened and checked: every record but the depths themselves, which are checked as
/// they are read. Reading needs no OpenNI2, which crashes on damaged files.
///
/// docs/SENSORS.md describes the format. Of several depth streams the first is read. Nothing is taken from the file's
/// tables of places, so they may be wrong.
class OniFile {
 public:
  /// Reads all record headers: milliseconds for a minute of recording.
  /// @return or a sentence with the file, the byte, what was found and expected
  [[nodiscard]] static Result<OniFile> open(const std::filesystem::path& file);
  /// The same of a file in memory, whose bytes must outlive it. @param name  what the sentences call it
  [[nodiscard]] static Result<OniFile> parse(std::string_view bytes, std::string name);

  OniFile(OniFile&&) noexcept;
  OniFile& operator=(OniFile&&) noexcept;
  ~OniFile();

  [[nodiscard]] const OniInfo& info() const;
  /// Time of a depth frame [s]: by the sensor's clock, rises from frame to frame.
  [[nodiscard]] double timeOf(int frame) const;
  /// Reads one depth frame. Any frame costs the same: each is packed by itself.
  /// @param frame  below info().frameCount; a CHECK
  /// @param out    all of it is written, its storage used again; undefined after an error
  [[nodiscard]] Result<void> read(int frame, DepthFrame& out);

 private:
  struct Contents;
  explicit OniFile(std::unique_ptr<Contents> contents);

  std::unique_ptr<Contents> contents_;
};

}  // namespace lorica
