#pragma once

#include "collision/hulls/host.h"
#include "viewer/pictures/video_writer.h"
#include "viewer/player/follow_camera.h"
#include "viewer/player/snapshots.h"
#include "viewer/renderer/image.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// The files that the demo wrote.
struct DemoFiles {
  std::string renderer;                          ///< "OSMesa 22.3.6"
  std::optional<std::filesystem::path> video;    ///< none if the video module is not installed
  std::vector<std::filesystem::path> snapshots;  ///< the body, then the same moments with only the hulls
  std::filesystem::path contactSheet;
};

/// Whether the demo writes a file of this name.
[[nodiscard]] bool isOfDemo(const std::string& name);

/// Draws the demo to files: a video of all frames, snapshots of the most eventful moments, each with the body and with
/// only the hulls, and a contact sheet of them.
class DemoPictures {
 public:
  /// @return kNoDisplay and the missing package if there is no renderer; kUnwritable for the folder or the video
  static Result<DemoPictures> create(const std::filesystem::path& folder, double framesPerSecond, Host& host);

  /// Draws the session's last frame.
  /// @param seconds        since the start
  /// @param frame, frames  index of the frame, and number of frames
  [[nodiscard]] Result<void> add(const Session& session, const std::string& caption, double seconds, int frame,
                                 int frames);

  /// Completes the video and writes the pictures. No file has its final name before this.
  [[nodiscard]] Result<DemoFiles> finish();

 private:
  struct Moment {
    Image body;
    Image hulls;  // without the skin
    std::string label;
    double events = -1.0;  // score of the moment
  };
  DemoPictures(std::filesystem::path folder, SnapshotCamera camera, std::optional<VideoWriter> video);

  std::filesystem::path folder_;
  SnapshotCamera camera_;
  std::optional<VideoWriter> video_;
  FollowCamera follow_;
  std::unique_ptr<SessionScene> scene_;
  std::vector<Moment> moments_;
  double lastSeconds_ = 0.0;
};

}  // namespace lorica
