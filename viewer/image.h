#pragma once

#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// 8-bit sRGB image, row 0 at the top, RGBA interleaved.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

[[nodiscard]] Result<void> writePng(const std::filesystem::path& file, const Image& image);
[[nodiscard]] Result<Image> readPng(const std::filesystem::path& file);

/// Images in rows, each with its label underneath.
[[nodiscard]] Image contactSheet(std::span<const Image> images, std::span<const std::string> labels, int columns);

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
