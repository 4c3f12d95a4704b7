#include "apps/movie.h"

#include "apps/report.h"
#include "geometry/errors.h"

namespace lorica {

Result<void> Movie::check(const std::string& option, const std::filesystem::path& file) {
  if (file.extension() != ".mp4") {
    return invalidArgument("{} {}: films are MP4 files, expected a name that ends in .mp4", option, file.string());
  }
  return checkOutput(option, file);
}

Result<Movie> Movie::create(const std::filesystem::path& file, int width, int height, double framesPerSecond) {
  LORICA_TRY(VideoWriter video, VideoWriter::create(file, width, height, framesPerSecond));
  return Movie(std::move(video));
}

}  // namespace lorica
