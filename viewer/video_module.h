#pragma once

#include "geometry/result.h"
#include "viewer/image.h"

#include <filesystem>
#include <memory>

namespace lorica {

/// A video file that is being written.
class VideoEncoder {
 public:
  virtual ~VideoEncoder() = default;
  /// @param image  of the size that the encoder was made for
  virtual Result<void> add(const Image& image) = 0;
  /// Ends the file. A failed write shows only in what a reader finds in it.
  virtual void close() = 0;
};

/// What writes MP4: OpenCV and FFmpeg, which bring two hundred libraries. They are in a module of its own, loaded when
/// a video is first written.
struct VideoModule {
  /// @return null where neither H.264 nor MPEG-4 can be encoded
  std::unique_ptr<VideoEncoder> (*open)(const std::filesystem::path& file, int width, int height,
                                        double framesPerSecond);
  /// Frames that a reader finds in a file; 0 when it cannot be opened.
  long long (*frameCount)(const std::filesystem::path& file);
};

/// What the module's constant is called.
inline constexpr const char* kVideoSymbol = "loricaVideo";

}  // namespace lorica
