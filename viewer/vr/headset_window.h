#pragma once

#include "viewer/vr/headset.h"
#include "viewer/vr/headset_panel.h"
#include "viewer/vr/headset_place.h"
#include "viewer/window/window.h"

#include <array>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// A window whose scene is seen in a headset as well: beside the avatar or, if Choices say so, through its eyes.
/// If the avatar follows the headset, by itself or before a registered camera, its head is where the wearer's is.
/// Controllers hold props along a ray, or those in reach, as the mouse does in a window; what is let go flies on. The
/// window shows what the left eye sees. When the session in the headset ends, it is a usual window, and says why; a
/// headset that was lost is taken again when it comes back.
class HeadsetWindow final : public Window {
 public:
  /// Without a display nothing is mirrored, and it is over when the user ends the session in the headset.
  /// @param open  opens the window, once a headset was found, where there is a display
  /// @param say   gets the messages where there is none
  static Result<std::unique_ptr<HeadsetWindow>> create(const std::function<Result<Window>()>& open,
                                                       std::function<void(const std::string&)> say);
  ~HeadsetWindow() override;
  HeadsetWindow(HeadsetWindow&&) = delete;
  HeadsetWindow& operator=(HeadsetWindow&&) = delete;

  [[nodiscard]] bool open() const override;
  void show(const Scene& scene, const WindowValues& values) override;
  void rest(double seconds) override;
  [[nodiscard]] std::vector<Change> takeChanges() override;
  [[nodiscard]] HandAim aim(int hand) const override;
  [[nodiscard]] Camera camera() const override;
  [[nodiscard]] std::span<const HeadsetPose> headsets() override;
  void setWearer(const WearerState& state) override;

  /// Of the last picture: waiting for the runtime, from then on until the eyes are drawn, handing over.
  [[nodiscard]] const std::array<TimedStage, 3>& times() const { return times_; }
  [[nodiscard]] const HeadsetPanel& panel() const { return panel_; }
  /// Null once it is gone.
  [[nodiscard]] const Headset* headset() const { return headset_.get(); }
  [[nodiscard]] const HeadsetPlace& place() const { return place_; }
  /// Why there is no session in the headset; empty = there is one.
  [[nodiscard]] const std::string& ended() const { return ended_; }

 private:
  HeadsetWindow(std::unique_ptr<Headset> headset, Window window)
      : Window(std::move(window)), headset_(std::move(headset)) {}
  void lose(const Error& why);
  void seek();
  bool drawEyes(Renderer& renderer, const Scene& scene, const SceneOptions& options);
  void findPlace(const Scene& scene, const WindowValues& values);
  void move(double seconds);
  void notePose();
  [[nodiscard]] Isometry3 followedFromStage() const;
  void usePanel(const WindowValues& values);
  void holdProps(const Scene& scene, const WindowValues& values);
  void feel(const Scene& scene, const WindowValues& values);
  [[nodiscard]] Ray aimOf(int hand) const;

  /// What a hand holds: along a ray that is fixed in its aim or, for a prop in reach, in its grip.
  struct Hold {
    enum class State : std::uint8_t {
      kFree,
      kPresses,   // the run is to be asked for the prop that `ray` meets
      kAsked,     // it was: the prop is held, or there was none
      kReleases,  // the run is to be told that it is let go, with `velocity`
    };
    State state = State::kFree;
    bool reaches = false;             // the prop was in reach, else along the aim
    Vec3 direction = -Vec3::UnitZ();  // in that frame
    bool grabbed = false;             // the hand was closed in the last picture
    Ray ray = {};
    Vec3 velocity = Vec3::Zero();

    [[nodiscard]] bool holds() const { return state == State::kPresses || state == State::kAsked; }
  };

  std::unique_ptr<Headset> headset_;  // null = it is gone
  HeadsetPlace place_;
  WearerState wearer_;
  HeadsetPlace floor_;   // of what follows the wearer: its floor frame from the stage
  bool stands_ = false;  // the wearer has a place on it
  std::array<HeadsetPose, 1> poses_{{{.wearer = -1, .pose = {}}}};  // the last one; no client of a page
  bool poseIsNew_ = false;                                          // headsets() has not given it yet
  HeadsetPanel panel_;
  bool panelAtHand_ = false;      // it is shown while a bare left palm is looked at
  std::array<bool, 2> points_{};  // hands, at the panel
  std::array<Camera, 2> eyes_;
  std::array<TimedStage, 3> times_{{{"wait"}, {"eyes"}, {"hand over"}}};
  std::optional<bool> inside_;  // where the wearer is; none = nowhere yet
  std::array<Hold, 2> holds_;   // of the left and the right hand
  /// Where the hands were in the last pictures, for their velocity: world [m], when [s].
  struct Was {
    std::array<Vec3, 2> hands{Vec3(Vec3::Zero()), Vec3(Vec3::Zero())};
    double time = 0.0;
  };
  std::array<Was, 5> was_;
  std::size_t next_ = 0;  // of `was_`, the oldest
  double turned_ = 0.0;   // what the stick for turning wanted in the last picture
  double time_ = 0.0;     // of the last picture [s]
  double touched_ = 0.0;  // when a touch was felt last [s]
  std::string ended_;
  bool mayReturn_ = false;  // a headset that was lost
  double lookedAt_ = 0.0;   // when it was looked for last [s]
  std::future<Result<std::unique_ptr<Headset>>> finding_;
};

}  // namespace lorica
