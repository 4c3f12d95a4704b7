#pragma once

#include "geometry/result.h"
#include "viewer/image.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// Writes an animated GIF, which repeats for ever, frame by frame; the file appears when finish() succeeds. For short,
/// small pictures on web pages: a frame stores what has changed since the one before it, in at most 255 colours of its
/// own, chosen by cutting the box of its colours (after P. Heckbert, "Color image quantization for frame buffer
/// display", 1982). Colours come within 2 % of those given where 255 are enough. The format: CompuServe, "Graphics
/// Interchange Format 89a".
class GifWriter {
 public:
  /// @param framesPerSecond  up to 50; time is kept in hundredths of a second, rounded so that errors do not add up
  /// @return the writer, or why there can be none
  static Result<GifWriter> create(const std::filesystem::path& file, int width, int height, double framesPerSecond);

  [[nodiscard]] Result<void> add(const Image& image);
  [[nodiscard]] Result<void> finish();

 private:
  GifWriter(std::filesystem::path file, int width, int height, double framesPerSecond);

  std::filesystem::path file_;
  int width_, height_;
  double framesPerSecond_;
  int frames_ = 0;
  std::string bytes_;
  std::vector<std::uint8_t> shown_;                     // RGB, as a reader shows it so far
  std::vector<std::uint8_t> indices_;                   // of the frame, scratch
  std::vector<std::uint32_t> weightOfBin_;              // scratch
  std::vector<std::array<std::uint32_t, 3>> sumOfBin_;  // scratch
  std::vector<std::uint8_t> colorOfBin_;                // scratch
  std::vector<std::array<std::uint8_t, 3>> palette_;
};

}  // namespace lorica
