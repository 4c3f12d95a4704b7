#pragma once

#include "apps/camera_options.h"
#include "session/session.h"
#include "viewer/image.h"
#include "viewer/renderer.h"
#include "viewer/scene.h"

#include <CLI/CLI.hpp>

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

/// --snapshots, --every and the camera.
struct SnapshotOptions {
  std::string folder;  ///< empty = no pictures
  int every = 30;      ///< frames
  CameraOptions camera;
};

/// @return --snapshots, for others to exclude
CLI::Option* addSnapshotOptions(CLI::App& app, SnapshotOptions& options);

/// Fails early where the folder cannot be.
[[nodiscard]] Result<void> checkSnapshots(const SnapshotOptions& options);

/// Pictures of a session as it runs, frame_0000.png and so on, from a camera that follows.
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
  [[nodiscard]] bool due(const Session& session) const { return (session.frameCount() - 1) % options_.every == 0; }
  [[nodiscard]] int written() const { return written_; }

 private:
  SnapshotSeries(const SnapshotOptions& options, SnapshotCamera pictures, FollowCamera follow, const Session& session);
  SnapshotOptions options_;
  SnapshotCamera pictures_;
  SessionScene scene_;
  FollowCamera follow_;
  std::optional<double> firstTime_;
  double previousTime_ = 0.0;
  int written_ = 0;
};

}  // namespace lorica
