#include "viewer/pictures/video_module.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace lorica {
namespace {

class OpenCvEncoder : public VideoEncoder {
 public:
  ~OpenCvEncoder() override { close(); }

  bool open(const std::filesystem::path& file, const char (&code)[5], int width, int height, double framesPerSecond) {
    try {
      return writer_.open(file.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc(code[0], code[1], code[2], code[3]),
                          framesPerSecond, cv::Size(width, height), true);
    } catch (const std::exception&) {
      return false;
    }
  }

  Result<void> add(const Image& image) override {
    try {
      const cv::Mat rgba(image.height, image.width, CV_8UC4, const_cast<std::uint8_t*>(image.rgba.data()));
      cv::cvtColor(rgba, bgr_, cv::COLOR_RGBA2BGR);
      writer_.write(bgr_);
    } catch (const std::exception& e) {
      return Error{ErrorCode::kUnwritable, e.what()};
    }
    return {};
  }

  void close() override {
    try {
      writer_.release();
    } catch (const std::exception&) {  // missing frames are detected when the file is read
    }
  }

 private:
  cv::VideoWriter writer_;
  cv::Mat bgr_;
};

std::unique_ptr<VideoEncoder> openEncoder(const std::filesystem::path& file, int width, int height,
                                          double framesPerSecond) {
  // FFmpeg prints errors to the console; -8 is AV_LOG_QUIET. A value set by the user is kept.
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  auto encoder = std::make_unique<OpenCvEncoder>();
  if (!encoder->open(file, "avc1", width, height, framesPerSecond) &&
      !encoder->open(file, "mp4v", width, height, framesPerSecond)) {
    return nullptr;
  }
  return encoder;
}

long long countFrames(const std::filesystem::path& file) {
  try {
    cv::VideoCapture reader(file.string(), cv::CAP_FFMPEG);
    return reader.isOpened() ? std::llround(reader.get(cv::CAP_PROP_FRAME_COUNT)) : 0;
  } catch (const std::exception&) {
    return 0;
  }
}

}  // namespace
}  // namespace lorica

extern "C" __attribute__((visibility("default")))
const lorica::VideoModule loricaVideo = {lorica::openEncoder, lorica::countFrames};
