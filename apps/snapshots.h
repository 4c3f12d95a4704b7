#pragma once

#include "apps/camera_options.h"
#include "apps/command_line.h"
#include "apps/movie.h"
#include "apps/report.h"
#include "session/session.h"
#include "viewer/image.h"
#include "viewer/renderer.h"
#include "viewer/scene.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// What a picture shows of a session: the skin, coloured by part, and what surrounds it. A body is cut where the parts
/// meet; a surface that is shown instead of the body has whole triangles, each of the part that covers its first
/// corner.
class SessionScene {
 public:
  explicit SessionScene(const Session& session);

  /// Borrows from the session and from this object.
  [[nodiscard]] Scene of(const Session& session) const;

 private:
  std::vector<Triangle> triangles_;  // what is shown, or the surface of all parts, without caps, over their points
  std::vector<PartIndex> partOfTriangle_;
};

/// Draws sessions without a window.
class SnapshotCamera {
 public:
  /// @return the camera, or kNoDisplay with what was tried and which package helps
  static Result<SnapshotCamera> create(int width, int height);

  [[nodiscard]] Image draw(const Scene& scene, const SceneOptions& options, const Camera& camera);
  [[nodiscard]] const std::string& rendererName() const { return rendererName_; }

 private:
  SnapshotCamera(OffscreenContext context, Renderer renderer, int width, int height);
  OffscreenContext context_;  // outlives the renderer, which needs it current
  Renderer renderer_;
  std::string rendererName_;
  int width_;
  int height_;
};

/// --snapshots, --every, --video and the camera.
struct SnapshotOptions {
  std::string folder;  ///< empty = no pictures
  int every = 30;      ///< frames
  std::string video;   ///< file; empty = none
  CameraOptions camera;

  [[nodiscard]] bool any() const { return !folder.empty() || !video.empty(); }
};

/// @param window  --window, which draws by itself
void addSnapshotOptions(CommandLine& app, SnapshotOptions& options, Option* window);

/// Fails early where the folder or the video cannot be, or a camera has nothing to look at.
[[nodiscard]] Result<void> checkSnapshots(const SnapshotOptions& options);

/// What was drawn of a session.
struct DrawnFiles {
  int snapshots = 0;
  int videoFrames = 0;

  void addTo(const SnapshotOptions& options, nlohmann::ordered_json& json) const;
  void addTo(const SnapshotOptions& options, Report& report) const;
};

/// Pictures of a session as it runs, frame_0000.png and so on, and a video of it, from a camera that follows.
class SnapshotSeries {
 public:
  /// @param session  outlives the series
  /// @return nothing where no pictures are wanted; the series; or why there can be none
  static Result<std::optional<SnapshotSeries>> create(const SnapshotOptions& options, const Session& session);

  /// Once a frame; draws those that are due.
  /// @param name   of what plays, for the caption
  /// @param inset  see Scene; null = none
  [[nodiscard]] Result<void> add(const Session& session, const std::string& name, const Image* inset = nullptr);
  /// Whether add() will draw the session's present frame.
  [[nodiscard]] bool due(const Session& session) const { return snapshotDue(session) || filmFrames(session) > 0; }
  /// Ends the video. @return what was drawn
  [[nodiscard]] Result<DrawnFiles> finish();

 private:
  SnapshotSeries(const SnapshotOptions& options, SnapshotCamera pictures, FollowCamera follow, const Session& session);
  [[nodiscard]] bool snapshotDue(const Session& session) const;
  [[nodiscard]] double filmSeconds(const Session& session) const;
  [[nodiscard]] int filmFrames(const Session& session) const;

  SnapshotOptions options_;
  SnapshotCamera pictures_;
  SessionScene scene_;
  FollowCamera follow_;
  std::optional<Movie> movie_;
  double filmSeconds_ = 0.0;  // of the video, up to the frame that was added last [s]
  int filmed_ = 0;            // frames of it
  std::optional<double> firstTime_, previousTime_;
  DrawnFiles drawn_;
};

}  // namespace lorica
