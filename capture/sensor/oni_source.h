#pragma once

#include "capture/sensor/depth_source.h"
#include "capture/sensor/oni_file.h"

#include <filesystem>
#include <memory>

namespace lorica {

/// The depth frames of an .oni recording, each once, in order, as fast as they are requested.
class OniSource : public DepthSource {
 public:
  /// @param name  for messages.
  explicit OniSource(OniFile file, std::string name) : file_(std::move(file)), name_(std::move(name)) {}

  [[nodiscard]] const DepthCamera& camera() const override { return file_.info().camera; }
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override;

  [[nodiscard]] const OniInfo& info() const { return file_.info(); }  ///< of the file
  /// Index of the frame that next() returns now; info().frameCount at the end.
  [[nodiscard]] int position() const { return position_; }
  /// Moves to a frame; costs nothing. @param frame  clamped to 0 .. info().frameCount
  void seek(int frame);
  /// Moves to the first frame at or after a time, counted from the first frame [s].
  void seekTime(double seconds);

 private:
  OniFile file_;
  std::string name_;
  int position_ = 0;
  DepthFrame scratch_;
};

/// Opens an .oni recording. @return the source, or an error with file, byte, found and expected
[[nodiscard]] Result<std::unique_ptr<OniSource>> openOni(const std::filesystem::path& file);

/// As openOni(), but returns the general source type.
[[nodiscard]] Result<std::unique_ptr<DepthSource>> makeOniSource(const std::filesystem::path& file);

}  // namespace lorica
