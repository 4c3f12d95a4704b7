#include "player/movie.h"

#include "geometry/errors.h"
#include "geometry/text.h"

#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kGifRate = 16.0;  // maximum frames per second

}  // namespace

Result<void> Movie::check(const std::string& option, const std::filesystem::path& file) {
  if (file.extension() != ".mp4" && file.extension() != ".gif") {
    return invalidArgument("{} {}: expected a name that ends in .mp4 or .gif", option, file.string());
  }
  return checkOutput(option, file);
}

Result<Movie> Movie::create(const std::filesystem::path& file, int width, int height, double framesPerSecond) {
  Movie movie;
  if (file.extension() == ".gif") {
    movie.every_ = std::ceil(framesPerSecond / kGifRate - 1e-6);
    LORICA_TRY(GifWriter gif, GifWriter::create(file, width, height, framesPerSecond / movie.every_));
    movie.gif_.emplace(std::move(gif));
    return movie;
  }
  LORICA_TRY(VideoWriter video, VideoWriter::create(file, width, height, framesPerSecond));
  movie.video_.emplace(std::move(video));
  return movie;
}

Result<void> Movie::add(const Image& image) {
  ++frames_;
  return gif_ ? gif_->add(image) : video_->add(image);
}

Result<void> Movie::finish() {
  return gif_ ? gif_->finish() : video_->finish();
}

}  // namespace lorica
