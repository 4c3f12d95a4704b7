#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"

#include <filesystem>
#include <memory>

namespace lorica {

/// Writes an MP4 frame by frame; the file gets its name only when finish() succeeds.
class VideoWriter {
 public:
  static Result<VideoWriter> create(const std::filesystem::path& file, int width, int height, double framesPerSecond);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  [[nodiscard]] Result<void> add(const Image& image);
  [[nodiscard]] Result<void> finish();

 private:
  struct Impl;
  explicit VideoWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica
