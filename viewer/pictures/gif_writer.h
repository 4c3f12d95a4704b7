#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct GifFileType;

namespace lorica {

/// Writes an animated GIF that repeats forever, frame by frame; the file appears when finish() succeeds. For short,
/// small animations on web pages. Each frame stores the pixels that changed since the previous one, in its own palette
/// of at most 255 colours, chosen by repeatedly splitting the box of its colours (after P. Heckbert, "Color image
/// quantization for frame buffer display", 1982). Colours are accurate to 2 % if 255 are sufficient.
class GifWriter {
 public:
  /// @param framesPerSecond  up to 50; times are stored in hundredths of a second, rounded without accumulating errors
  /// @return the writer, or why it cannot be created
  static Result<GifWriter> create(const std::filesystem::path& file, int width, int height, double framesPerSecond);

  [[nodiscard]] Result<void> add(const Image& image);
  [[nodiscard]] Result<void> finish();

 private:
  GifWriter(std::filesystem::path file, int width, int height, double framesPerSecond);
  void put(int status) const;

  std::filesystem::path file_;
  int width_, height_;
  double framesPerSecond_;
  int frames_ = 0;
  std::vector<std::uint8_t> shown_;                     // RGB of the last frame, as a reader shows it
  std::vector<std::uint8_t> indices_;                   // of the frame, scratch
  std::vector<std::uint32_t> weightOfBin_;              // scratch
  std::vector<std::array<std::uint32_t, 3>> sumOfBin_;  // scratch
  std::vector<std::uint8_t> colorOfBin_;                // scratch
  std::vector<std::array<std::uint8_t, 3>> palette_;
  std::unique_ptr<std::string> bytes_;  // written by giflib, which keeps its address
  struct Close {
    void operator()(GifFileType* gif) const;
  };
  std::unique_ptr<GifFileType, Close> gif_;
};

}  // namespace lorica
