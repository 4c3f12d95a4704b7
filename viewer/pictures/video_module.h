#pragma once

#include "geometry/result.h"
#include "viewer/renderer/image.h"

#include <filesystem>
#include <memory>

namespace lorica {

/// Encoder that writes a video file.
class VideoEncoder {
 public:
  virtual ~VideoEncoder() = default;
  /// @param image  of the encoder's size
  virtual Result<void> add(const Image& image) = 0;
  /// Closes the file. Write errors are not reported; they can only be detected by reading the file.
  virtual void close() = 0;
};

/// Functions that write MP4 with OpenCV and FFmpeg, which depend on two hundred libraries. They are in a separate
/// module, loaded when the first video is written.
struct VideoModule {
  /// @return null if neither H.264 nor MPEG-4 can be encoded
  std::unique_ptr<VideoEncoder> (*open)(const std::filesystem::path& file, int width, int height,
                                        double framesPerSecond);
  /// Number of frames in a file; 0 if it cannot be opened.
  long long (*frameCount)(const std::filesystem::path& file);
};

/// Name of the module's symbol.
inline constexpr const char* kVideoSymbol = "loricaVideo";

}  // namespace lorica
