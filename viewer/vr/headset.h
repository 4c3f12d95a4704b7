#pragma once

#include "geometry/math.h"
#include "geometry/result.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/renderer.h"

#include <array>
#include <memory>
#include <string>

namespace lorica {

/// From straight ahead to the edges of what an eye sees; to the left and down they are negative as a rule [rad].
struct EyeAngles {
  double left = -0.8, right = 0.8, up = 0.8, down = -0.8;
};

/// What of a headset is seen at the time when a picture is shown. Its *stage* frame has its origin on the floor, Y up,
/// and is the runtime's; heads, eyes and hands look along their -Z, with +X to the right [m].
struct HeadsetEye {
  Isometry3 stageFromEye = Isometry3::Identity();
  EyeAngles angles;
};
struct HeadsetHand {
  bool seen = false;
  bool bare = false;                                ///< it holds no controller: it grabs by a pinch or a fist
  Isometry3 stageFromGrip = Isometry3::Identity();  ///< in the middle of the fist
  Isometry3 stageFromAim = Isometry3::Identity();   ///< along which it points
  bool grabs = false;                               ///< trigger, squeeze, pinch or fist
  Eigen::Vector2d stick = Eigen::Vector2d::Zero();  ///< to the right and ahead, -1 to 1
  bool changes = false, opens = false;              ///< a button was pressed since the last picture
};
struct HeadsetFrame {
  double time = 0.0;     ///< when it is shown, by the runtime's clock [s]
  double period = 0.0;   ///< until the next picture [s]
  double ahead = 0.0;    ///< how far poses are predicted: from when they were asked for until then; 0 = not known [s]
  bool drawn = false;    ///< the runtime wants pictures
  bool located = false;  ///< eyes and head are known
  Isometry3 stageFromHead = Isometry3::Identity();
  std::array<HeadsetEye, 2> eyes;    ///< left, right
  std::array<HeadsetHand, 2> hands;  ///< left, right
};

/// A headset that an OpenXR runtime drives. The loader, libopenxr_loader.so.1, is opened at run time. Used from one
/// thread, that of the OpenGL context. After an error nothing more can be done with it.
class Headset {
 public:
  /// Looks for runtime and headset; needs no display.
  /// @return the headset, or what is missing: kNoDisplay
  static Result<std::unique_ptr<Headset>> find();
  virtual ~Headset() = default;
  Headset(const Headset&) = delete;
  Headset& operator=(const Headset&) = delete;

  /// "Monado, Simulated HMD".
  [[nodiscard]] const std::string& description() const { return description_; }
  /// Begins a session that draws in the current OpenGL context, which is one of GLX or EGL.
  virtual Result<void> start(Renderer::GetProc getProc) = 0;
  /// Hears what the runtime reports.
  /// @return an error if the session is over: kCancelled, the user ended it there; or the runtime or the headset is
  /// gone
  virtual Result<void> poll() = 0;
  /// Whether it takes pictures: then each has a beginFrame() and an endFrame().
  [[nodiscard]] bool running() const { return running_; }
  /// Waits until the next picture should be drawn, and locates everything for the time when it is shown.
  virtual Result<void> beginFrame() = 0;
  [[nodiscard]] const HeadsetFrame& frame() const { return frame_; }
  /// Of the picture of an eye [pixels].
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Takes the renderer's last picture for an eye, 0 = left. Only if the frame is drawn.
  virtual Result<void> take(int eye, Renderer& renderer) = 0;
  /// What was taken last for an eye.
  [[nodiscard]] virtual Image picture(int eye) const = 0;
  /// Gives the panel another picture, of which kPanelWidth x kPanelHeight pixels are shown at most.
  virtual Result<void> drawPanel(const Image& image) = 0;
  static constexpr int kPanelWidth = 1024, kPanelHeight = 512;
  /// Shows what drawPanel() got on a rectangle in the room, over the scene, in this frame.
  /// @param stageFromPanel  its middle  @param width, height  [m]
  virtual void placePanel(const Isometry3& stageFromPanel, double width, double height) = 0;
  /// Shows the pictures that were taken, if there is one for each eye.
  virtual Result<void> endFrame() = 0;
  /// Shakes a controller for a moment. @param strength  0 to 1
  virtual void pulse(int hand, double strength) = 0;

 protected:
  Headset() = default;

  std::string description_;
  bool running_ = false;
  HeadsetFrame frame_;
  int width_ = 0, height_ = 0;
};

}  // namespace lorica
