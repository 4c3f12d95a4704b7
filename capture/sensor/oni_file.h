#pragma once

#include "capture/sensor/depth_recording.h"
#include "capture/sensor/oni_depth_codec.h"
#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace lorica {

class OniBytes;

/// Properties of an .oni recording.
struct OniInfo {
  std::string version;         ///< format version: "1.0.1.0"
  std::string device;          ///< as named by the recorder; may be empty
  DepthCamera camera;          ///< of all depth frames
  OniCodec codec{};            ///< of the depth frames
  int frameCount = 0;          ///< depth frames, at least one
  int colorFrameCount = 0;     ///< not read
  int infraredFrameCount = 0;  ///< not read
  double duration = 0.0;       ///< from the first depth frame to the last [s]
  bool mirrored = false;       ///< frames are mirrored in the file; read() returns them unmirrored
  bool cutOff = false;         ///< the file has no end record, since its recorder was killed or it was truncated, but
                               ///< its complete frames are there
  std::uint64_t end = 0;       ///< byte after the last record: the rest is padding
};

/// An opened and checked .oni recording of OpenNI 1 or 2. All records are checked on opening except the depths
/// themselves, which are checked when they are read. Does not need OpenNI2, which crashes on damaged files.
///
/// docs/SENSORS.md describes the format. If there are several depth streams, the first is read. The file's seek tables
/// are not used, so they may be wrong.
class OniFile final : public DepthRecording {
 public:
  /// Reads all record headers: takes milliseconds for a minute of recording.
  /// @return the file, or an error with file, byte, found and expected
  [[nodiscard]] static Result<OniFile> open(const std::filesystem::path& file);
  /// Opens a file in memory, whose bytes must outlive the result. @param name  name of the file in error messages
  [[nodiscard]] static Result<OniFile> parse(std::string_view bytes, std::string name);

  OniFile(OniFile&&) noexcept;
  OniFile& operator=(OniFile&&) noexcept;
  ~OniFile() override;

  [[nodiscard]] const OniInfo& info() const;  ///< read when it was opened
  [[nodiscard]] const DepthCamera& camera() const override { return info().camera; }
  /// Time of a depth frame [s]: in the sensor's clock, increases from frame to frame.
  [[nodiscard]] double timeOf(int frame) const;
  /// Reads one depth frame. All frames cost the same: each is packed independently.
  /// @param frame  below info().frameCount; checked by LORICA_CHECK
  /// @param out    overwritten completely, reusing its storage; undefined after an error
  [[nodiscard]] Result<void> read(int frame, DepthFrame& out) override;

 private:
  struct Contents;
  OniFile(std::unique_ptr<Contents> contents, std::string name);
  static Result<OniFile> indexed(std::unique_ptr<OniBytes> bytes, const std::filesystem::path& file);

  std::unique_ptr<Contents> contents_;
};

/// Opens an .oni recording. @return the source, or an error with file, byte, found and expected
[[nodiscard]] Result<std::unique_ptr<OniFile>> openOni(const std::filesystem::path& file);

}  // namespace lorica
