#pragma once

#include "viewer/pictures/video_writer.h"

#include <filesystem>
#include <string>
#include <utility>

namespace lorica {

/// A video (.mp4) of a motion. The file appears when finish() succeeds.
class Movie {
 public:
  /// Fails early if the file name or the folder is not usable.
  [[nodiscard]] static Result<void> check(const std::string& option, const std::filesystem::path& file);
  static Result<Movie> create(const std::filesystem::path& file, int width, int height, double framesPerSecond);

  [[nodiscard]] Result<void> add(const Image& image) {
    ++frames_;
    return video_.add(image);
  }
  [[nodiscard]] Result<void> finish() { return video_.finish(); }
  [[nodiscard]] int frames() const { return frames_; }

 private:
  explicit Movie(VideoWriter video) : video_(std::move(video)) {}
  VideoWriter video_;
  int frames_ = 0;
};

}  // namespace lorica
