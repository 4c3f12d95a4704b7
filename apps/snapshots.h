#pragma once

#include "session/session.h"
#include "viewer/image.h"
#include "viewer/renderer.h"
#include "viewer/scene.h"

#include <string>
#include <vector>

namespace lorica {

/// From the body to the camera: its right side and a little from the front and above, so that a kick shows. Unit.
inline const Vec3 kViewDirection = Vec3(-0.80, 0.17, 0.575).normalized();

/// What a picture shows of a session: the skin, cut where the parts meet and coloured by part, and what surrounds it.
class SessionScene {
 public:
  explicit SessionScene(const Decomposition& decomposition);

  /// Borrows from the session and from this object.
  [[nodiscard]] Scene of(const Session& session) const;

 private:
  std::vector<Triangle> triangles_;  // the surface of all parts, without caps, over their points
  std::vector<PartIndex> partOfTriangle_;
};

/// A camera that keeps a moving body in the picture: it follows the hips, calmly, and stays level.
class FollowCamera {
 public:
  /// @param distance  from the body [m]
  explicit FollowCamera(double distance) : distance_(distance) {}

  /// @param seconds  since the last frame [s]
  void update(const Session& session, double seconds);
  [[nodiscard]] Camera camera() const;

 private:
  double distance_;
  Vec3 target_ = Vec3::Zero();
  bool started_ = false;
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

}  // namespace lorica
