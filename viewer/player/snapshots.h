#pragma once

#include "session/session.h"
#include "viewer/pictures/video_writer.h"
#include "viewer/player/follow_camera.h"
#include "viewer/player/session_face.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/renderer.h"
#include "viewer/renderer/scene.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// How far the avatars of a session are visible. Who comes or leaves while it runs fades within half a second of the
/// session's time, so a session that is run again looks the same.
class AvatarFade {
 public:
  static constexpr double kSeconds = 0.5;

  /// Call after each frame of the session. Does nothing if it was called for that frame. In the first frame after its
  /// creation or after a restart of the session who is there is visible at once.
  void update(const Session& session);
  /// 0 to 1; 1 before the first update if the avatar is there.
  [[nodiscard]] double of(const Session& session, std::size_t avatar) const;

 private:
  int frame_ = 0;      // of the last update
  double time_ = 0.0;  // of the last update [s]
  std::vector<double> visible_;
};

/// The drawable content of a session: the skin of each visible avatar, coloured by part, and the scene. A body is
/// cut at the part boundaries. A surface shown instead of the body keeps whole triangles, each coloured by the part
/// that covers its first vertex.
class SessionScene {
 public:
  explicit SessionScene(const Session& session);

  /// Call after each frame of the session, drawn or not: avatars that come and leave fade.
  void follow(const Session& session) { fade_.update(session); }
  /// Borrows from the session and from this object.
  /// @param show  the mesh is not posed if an avatar is shown instead
  /// @param watcher  [m], where the picture is taken from: an avatar's eyes follow it
  [[nodiscard]] Scene of(const Session& session, const SceneOptions& show, const Vec3& watcher) const;

  /// See SessionFace::choose(); does nothing if the first avatar has no face.
  void chooseExpression(int expression) {
    if (!drawn_.empty() && drawn_.front().face) drawn_.front().face->choose(expression);
  }

 private:
  /// An avatar of the session.
  struct Drawn {
    std::vector<Triangle> triangles;        ///< the shown surface, or that of all parts without caps, over their points
    std::vector<PartIndex> colors;          ///< of the parts, see colorsOfParts()
    std::vector<PartIndex> partOfTriangle;  ///< the colour of its part
    std::vector<Affine3> worldFromModel;    ///< of the joints, of the last scene
    std::optional<SessionFace> face;
  };
  static Drawn drawnOf(const SessionAvatar& avatar);
  static SceneFigure figureOf(Drawn& drawn, const SessionAvatar& avatar, double time, const SceneOptions& show,
                              const Vec3& watcher);

  AvatarFade fade_;
  mutable std::vector<Drawn> drawn_;         // one for each avatar
  mutable std::vector<SceneFigure> others_;  // figures of the last scene but the first
};

/// What is shown of a session unless the user says otherwise: an avatar as its maker drew it; of other characters the
/// parts and their hulls.
[[nodiscard]] SceneOptions usualView(const Character& character);

/// Draws sessions without a window.
class SnapshotCamera {
 public:
  /// @return the camera, or kNoDisplay with what was tried and the missing package
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

/// Of a picture or a window [pixels].
struct CanvasSize {
  int width = 1280, height = 720;

  [[nodiscard]] double aspect() const { return static_cast<double>(width) / height; }
};
inline constexpr int kSmallestSide = 16, kLargestSide = 4096;

/// "640x360", "portrait" (1080x1920) or "square" (1080x1080); none for any other text, or a side that is not possible.
[[nodiscard]] std::optional<CanvasSize> pictureSizeOf(std::string_view text);

/// What is behind the avatars.
struct Background {
  std::optional<Vec3f> color = {};  ///< sRGB, instead of sky and ground
  bool transparent = false;         ///< instead of both, too
  bool dark = false;                ///< sky and ground of a dark room

  /// Whether others will put a picture behind.
  [[nodiscard]] bool isForKeying() const { return color.has_value() || transparent; }
};
/// "light", "dark", "#00ff00", "green" or "transparent"; none for any other text.
[[nodiscard]] std::optional<Background> backgroundNamed(std::string_view text);
/// @param background  none = as it is
void setBackground(const std::optional<Background>& background, SceneOptions& show);

/// --snapshots, --every, --video, --headless, the camera, --size and --background. A window has the last two, too.
struct SnapshotOptions {
  std::string folder;  ///< empty = no pictures
  int every = 30;      ///< frames
  std::string video;   ///< file; empty = none
  CameraOptions camera;
  CanvasSize size;
  std::optional<Background> background;  ///< none = the sky
  bool headless = false;                 ///< no window, even if there is a display

  [[nodiscard]] bool any() const { return !folder.empty() || !video.empty(); }
  [[nodiscard]] bool transparent() const { return background && background->transparent; }
  [[nodiscard]] bool forKeying() const { return background && background->isForKeying(); }
  /// Whether a long enough run draws a picture of this name in the folder.
  [[nodiscard]] bool draws(const std::string& name) const;
};

/// What was drawn, where it was asked for.
struct DrawnFiles {
  std::string folder, video;  ///< of the options; empty = none
  int snapshots = 0, videoFrames = 0;
};

/// Pictures of a running session (frame_0000.png, ...) and a video, by default from a camera that follows the body.
class SnapshotSeries {
 public:
  /// @param session  outlives the series
  /// @return none if no pictures were requested; the series; or an error
  static Result<std::optional<SnapshotSeries>> create(const SnapshotOptions& options, const Session& session);

  /// Call once per frame; draws the pictures that are due.
  /// @param name   of the motion, for the caption
  /// @param inset  see Scene; null = none
  [[nodiscard]] Result<void> add(const Session& session, const std::string& name, const Image* inset = nullptr);
  /// Whether add() will draw the session's current frame.
  [[nodiscard]] bool due(const Session& session) const { return snapshotDue(session) || filmFrames(session) > 0; }
  /// Finishes the video. @return the number of pictures drawn
  [[nodiscard]] Result<DrawnFiles> finish();

 private:
  SnapshotSeries(const SnapshotOptions& options, SnapshotCamera pictures, const Session& session);
  [[nodiscard]] bool snapshotDue(const Session& session) const;
  [[nodiscard]] double filmSeconds(const Session& session) const;
  [[nodiscard]] int filmFrames(const Session& session) const;

  SnapshotOptions options_;
  SnapshotCamera pictures_;
  SessionScene scene_;
  FollowCamera follow_;
  std::optional<VideoWriter> movie_;
  double filmSeconds_ = 0.0;  // duration of the video up to the last added frame [s]
  int filmed_ = 0;            // number of its frames
  std::optional<double> firstTime_, previousTime_;
  DrawnFiles drawn_;
};

}  // namespace lorica
