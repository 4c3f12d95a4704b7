#include "viewer/pictures/video_writer.h"

#include "geometry/errors.h"
#include "geometry/hard_stop.h"
#include "geometry/module.h"
#include "geometry/new_file.h"
#include "viewer/pictures/video_module.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <optional>
#include <system_error>

namespace lorica {
namespace fs = std::filesystem;

struct VideoWriter::Impl {
  fs::path file;
  fs::path temporary;  ///< next to `file`; ends in ".mp4" because FFmpeg chooses the container by the extension
  int width = 0;
  int height = 0;
  long long frames = 0;
  const VideoModule* module = nullptr;
  std::unique_ptr<VideoEncoder> encoder;  ///< null once finished
  std::optional<AtHardStop> cleaning;

  ~Impl() {
    if (temporary.empty()) return;
    encoder.reset();
    std::error_code ignored;
    fs::remove(temporary, ignored);
  }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

Result<VideoWriter> VideoWriter::create(const fs::path& file, int width, int height, double framesPerSecond) {
  if (file.extension() != ".mp4") {
    return invalidArgument("{}: the name of a video must end in .mp4", file.string());
  }
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0) {
    return invalidArgument("{}: video of {} x {} pixels: both must be even and above 0", file.string(), width, height);
  }
  if (!std::isfinite(framesPerSecond) || framesPerSecond <= 0.0 || framesPerSecond > 1000.0) {
    return invalidArgument("{}: {} frames per second, expected above 0, at most 1000", file.string(), framesPerSecond);
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return unwritable("{}: the folder {} does not exist", file.string(), folder.string());
  }
  if (fs::is_directory(file, error)) {
    return unwritable("{}: is a folder", file.string());
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    return unwritable("{}: no permission to write to {}", file.string(), folder.string());
  }

  LORICA_TRY(const void* module, loadModule("video", kVideoSymbol, fmt::format("{}: writing MP4", file.string())));
  auto impl = std::make_unique<Impl>();
  impl->file = file;
  impl->width = width;
  impl->height = height;
  impl->temporary = folder / fmt::format(".{}.{}.partial.mp4", file.stem().string(), ::getpid());
  impl->cleaning.emplace([temporary = impl->temporary] {
    std::error_code ignored;
    fs::remove(temporary, ignored);
  });
  fs::remove(impl->temporary, error);                            // left behind by a killed program of the same number
  LORICA_TRY(const int created, createPart(impl->temporary));    // FFmpeg would follow a link of that name
  const int problem = ::write(created, "", 1) == 1 ? 0 : errno;  // FFmpeg does not say that a disk is full
  ::close(created);
  if (problem != 0) return unwritable(file, problem);
  impl->module = static_cast<const VideoModule*>(module);
  impl->encoder = impl->module->open(impl->temporary, width, height, framesPerSecond);
  if (impl->encoder == nullptr) {
    return unwritable("{}: OpenCV's FFmpeg encodes neither H.264 nor MPEG-4", file.string());
  }
  return VideoWriter(std::move(impl));
}

Result<void> VideoWriter::add(const Image& image) {
  LORICA_CHECK(impl_ && impl_->encoder, "VideoWriter::add after finish or move");
  if (image.width != impl_->width || image.height != impl_->height || image.rgba.size() != image.byteCount()) {
    return invalidArgument("{}: frame {} is {} x {} pixels, expected {} x {}", impl_->file.string(), impl_->frames,
                           image.width, image.height, impl_->width, impl_->height);
  }
  LORICA_TRY_DO(prefixed(fmt::format("{}: frame {}", impl_->file.string(), impl_->frames), impl_->encoder->add(image)));
  ++impl_->frames;
  return {};
}

Result<void> VideoWriter::finish() {
  LORICA_CHECK(impl_ && impl_->encoder, "VideoWriter::finish after finish or move");
  impl_->encoder->close();
  impl_->encoder.reset();
  const std::string name = impl_->file.string();
  if (impl_->frames == 0) return invalidArgument("{}: the video has no frames", name);
  // OpenCV does not report failed writes (a full disk), so the frames in the file are counted.
  const long long written = impl_->module->frameCount(impl_->temporary);
  if (written != impl_->frames) {
    return unwritable("{}: only {} of {} frames were written: is the disk full?", name, written, impl_->frames);
  }
  std::error_code error;
  fs::rename(impl_->temporary, impl_->file, error);
  if (error) return unwritable("{}: {}", name, error.message());
  impl_->temporary.clear();
  return {};
}

}  // namespace lorica
