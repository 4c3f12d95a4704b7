#pragma once

#include "viewer/pictures/gif_writer.h"
#include "viewer/pictures/video_writer.h"
#include "viewer/renderer/image.h"

#include <filesystem>
#include <optional>
#include <string>

namespace lorica {

/// A video (.mp4) of all frames of a motion, or an animation (.gif) of at most 16 frames per second. The file appears
/// when finish() succeeds.
class Movie {
 public:
  /// Fails early if the file name or the folder is not usable.
  [[nodiscard]] static Result<void> check(const std::string& option, const std::filesystem::path& file);
  /// @param framesPerSecond  of the motion
  static Result<Movie> create(const std::filesystem::path& file, int width, int height, double framesPerSecond);

  /// Whether this frame of the motion is part of the movie.
  [[nodiscard]] bool takes(int frame) const { return frame % every_ == 0; }
  [[nodiscard]] Result<void> add(const Image& image);
  [[nodiscard]] Result<void> finish();
  [[nodiscard]] int frames() const { return frames_; }

 private:
  Movie() = default;
  std::optional<VideoWriter> video_;
  std::optional<GifWriter> gif_;
  int every_ = 1;
  int frames_ = 0;
};

}  // namespace lorica
