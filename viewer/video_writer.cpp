#include "viewer/image.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace lorica {
namespace fs = std::filesystem;

struct VideoWriter::Impl {
  fs::path file;
  fs::path temporary;  ///< beside `file`; FFmpeg picks the container by its ending, so it keeps ".mp4"
  int width = 0;
  int height = 0;
  long long frames = 0;
  cv::VideoWriter writer;
  cv::Mat bgr;

  ~Impl() {
    if (temporary.empty()) return;
    release();
    std::error_code ignored;
    fs::remove(temporary, ignored);
  }

  void release() {
    try {
      writer.release();
    } catch (const std::exception&) {  // what is missing then shows when the file is checked
    }
  }

  bool open(const char (&fourcc)[5], double framesPerSecond) {
    try {
      return writer.open(temporary.string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc(fourcc[0], fourcc[1], fourcc[2], fourcc[3]), framesPerSecond,
                         cv::Size(width, height), true);
    } catch (const std::exception&) {
      return false;
    }
  }

  /// Frames that a reader finds in the temporary file; 0 when it cannot be opened.
  long long framesOnDisk() const {
    try {
      cv::VideoCapture reader(temporary.string(), cv::CAP_FFMPEG);
      return reader.isOpened() ? std::llround(reader.get(cv::CAP_PROP_FRAME_COUNT)) : 0;
    } catch (const std::exception&) {
      return 0;
    }
  }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

Result<VideoWriter> VideoWriter::create(const fs::path& file, int width, int height, double framesPerSecond) {
  if (file.extension() != ".mp4") {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: a video's name must end in .mp4", file.string())};
  }
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: video of {} x {} pixels: both must be even and above 0",
                                                          file.string(), width, height)};
  }
  if (!std::isfinite(framesPerSecond) || framesPerSecond <= 0.0 || framesPerSecond > 1000.0) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: {} frames per second, expected above 0, at most 1000",
                                                          file.string(), framesPerSecond)};
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return Error{ErrorCode::kUnwritable, fmt::format("{}: the folder {} is not there", file.string(), folder.string())};
  }
  if (fs::is_directory(file, error)) {
    return Error{ErrorCode::kUnwritable, fmt::format("{}: is a folder", file.string())};
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    return Error{ErrorCode::kUnwritable, fmt::format("{}: may not write into {}", file.string(), folder.string())};
  }

  // FFmpeg writes errors to the console by itself; -8 is its AV_LOG_QUIET. A user's own wish is kept.
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  auto impl = std::make_unique<Impl>();
  impl->file = file;
  impl->width = width;
  impl->height = height;
  impl->temporary = folder / fmt::format(".{}.{}.partial.mp4", file.stem().string(), ::getpid());
  if (!impl->open("avc1", framesPerSecond) && !impl->open("mp4v", framesPerSecond)) {
    return Error{ErrorCode::kUnwritable,
                 fmt::format("{}: OpenCV's FFmpeg encodes neither H.264 nor MPEG-4", file.string())};
  }
  return VideoWriter(std::move(impl));
}

Result<void> VideoWriter::add(const Image& image) {
  CHECK(impl_ && impl_->writer.isOpened(), "VideoWriter::add after finish or move");
  if (image.width != impl_->width || image.height != impl_->height ||
      image.rgba.size() != static_cast<std::size_t>(image.width) * image.height * 4) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: frame {} is {} x {} pixels, expected {} x {}", impl_->file.string(), impl_->frames,
                             image.width, image.height, impl_->width, impl_->height)};
  }
  try {
    const cv::Mat rgba(image.height, image.width, CV_8UC4, const_cast<std::uint8_t*>(image.rgba.data()));
    cv::cvtColor(rgba, impl_->bgr, cv::COLOR_RGBA2BGR);
    impl_->writer.write(impl_->bgr);
  } catch (const std::exception& e) {
    return Error{ErrorCode::kUnwritable,
                 fmt::format("{}: frame {}: {}", impl_->file.string(), impl_->frames, e.what())};
  }
  ++impl_->frames;
  return {};
}

Result<void> VideoWriter::finish() {
  CHECK(impl_ && impl_->writer.isOpened(), "VideoWriter::finish after finish or move");
  impl_->release();
  const std::string name = impl_->file.string();
  if (impl_->frames == 0) return Error{ErrorCode::kInvalidArgument, fmt::format("{}: a video of no frames", name)};
  // OpenCV reports no failed write (a full disk), so the file is asked what it holds.
  const long long written = impl_->framesOnDisk();
  if (written != impl_->frames) {
    return Error{ErrorCode::kUnwritable,
                 fmt::format("{}: {} of {} frames reached the disk: is it full?", name, written, impl_->frames)};
  }
  std::error_code error;
  fs::rename(impl_->temporary, impl_->file, error);
  if (error) return Error{ErrorCode::kUnwritable, fmt::format("{}: {}", name, error.message())};
  impl_->temporary.clear();
  return {};
}

}  // namespace lorica
