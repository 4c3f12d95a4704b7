#pragma once

#include "apps/snapshots.h"
#include "viewer/image.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Where the demo's pictures are.
struct DemoFiles {
  std::string renderer;                          ///< "OSMesa 22.3.6"
  std::optional<std::filesystem::path> video;    ///< nothing where what writes videos is not installed
  std::vector<std::filesystem::path> snapshots;  ///< the body, then as many of the same moments with hulls only
  std::filesystem::path contactSheet;
};

/// The demo drawn to files: a video of every frame, the most eventful moments as snapshots, each also with the hulls
/// alone, and a sheet of them.
class DemoPictures {
 public:
  /// @return kNoDisplay with the package that helps where nothing can draw; kUnwritable for the folder or the video
  static Result<DemoPictures> create(const std::filesystem::path& folder);

  /// Draws the session's last frame.
  /// @param seconds        since the start
  /// @param frame, frames  which of how many
  [[nodiscard]] Result<void> add(const Session& session, const std::string& caption, double seconds, int frame,
                                 int frames);

  /// Completes the video and writes the pictures; before, nothing has appeared under its name.
  [[nodiscard]] Result<DemoFiles> finish();

 private:
  struct Moment {
    Image body;
    Image hulls;  // the same without the skin: what physics touches
    std::string label;
    double events = -1.0;  // how much goes on in it
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
