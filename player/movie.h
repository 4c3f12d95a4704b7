#pragma once

#include "viewer/pictures/video_writer.h"

#include <filesystem>
#include <utility>

namespace lorica {

/// A video (.mp4) of a motion. The file appears when finish() succeeds.
class Movie {
 public:
  static Result<Movie> create(const std::filesystem::path& file, int width, int height, double framesPerSecond) {
    LORICA_TRY(VideoWriter video, VideoWriter::create(file, width, height, framesPerSecond));
    return Movie(std::move(video));
  }

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
