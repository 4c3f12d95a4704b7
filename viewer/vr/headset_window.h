#pragma once

#include "viewer/vr/headset.h"
#include "viewer/vr/headset_place.h"
#include "viewer/window/window.h"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace lorica {

/// A window whose scene is seen in a headset as well: beside the avatar or, if WindowChoices say so, through its eyes.
/// Controllers hold props along a ray, or those in reach, as the mouse does in a window; what is let go flies on. The
/// window shows what the left eye sees. When the session in the headset ends, it is a usual window, and says why.
class HeadsetWindow final : public Window {
 public:
  /// @param open  opens the window, once a headset was found
  static Result<std::unique_ptr<HeadsetWindow>> create(const std::function<Result<Window>()>& open);
  ~HeadsetWindow() override;
  HeadsetWindow(HeadsetWindow&&) = delete;
  HeadsetWindow& operator=(HeadsetWindow&&) = delete;

  void show(const Scene& scene, const WindowValues& values) override;
  void rest(double seconds) override;
  [[nodiscard]] WindowRequests takeRequests() override;
  [[nodiscard]] HandAim aim(int hand) const override;
  [[nodiscard]] Camera camera() const override;

  /// Null once it is gone.
  [[nodiscard]] const Headset* headset() const { return headset_ ? &*headset_ : nullptr; }
  [[nodiscard]] const HeadsetPlace& place() const { return place_; }
  /// What was drawn last for an eye, 0 = left.
  [[nodiscard]] const Camera& eye(int index) const { return eyes_[index]; }
  /// Why the session in the headset has ended; empty = it has not.
  [[nodiscard]] const std::string& ended() const { return ended_; }

 private:
  HeadsetWindow(Headset headset, Window window) : Window(std::move(window)), headset_(std::move(headset)) {}
  void lose(const Error& why);
  bool drawEyes(Renderer& renderer, const Scene& scene, const SceneOptions& options);
  void findPlace(const Scene& scene, const WindowValues& values);
  void move(double seconds);
  void holdProps(const Scene& scene, const WindowValues& values);
  void feel(const Scene& scene, const WindowValues& values);
  [[nodiscard]] Ray aimOf(int hand) const;

  /// A hand that holds a prop, or wants to: along a ray that is fixed in its aim or, for a prop in reach, in its grip.
  struct Hold {
    int hand = 0;
    bool reaches = false;
    Vec3 direction = -Vec3::UnitZ();  // in that frame
    bool asked = false;               // the session was
  };

  std::optional<Headset> headset_;
  HeadsetPlace place_;
  std::array<Camera, 2> eyes_;
  std::optional<bool> inside_;  // where the wearer is; none = nowhere yet
  std::optional<Hold> hold_;
  std::optional<int> letGo_;        // what is to be told
  Vec3 throwsWith_ = Vec3::Zero();  // with it
  std::optional<Ray> takes_;        // the same
  std::array<bool, 2> grabbed_{};   // in the last picture
  /// Where the hands were in the last pictures, for their velocity: world [m], when [s].
  struct Was {
    std::array<Vec3, 2> hands{Vec3(Vec3::Zero()), Vec3(Vec3::Zero())};
    double time = 0.0;
  };
  std::array<Was, 5> was_;
  std::size_t next_ = 0;  // of `was_`, the oldest
  double turned_ = 0.0;   // what the stick for turning wanted in the last picture
  double time_ = 0.0;     // of the last picture [s]
  double felt_ = 0.0;     // when a touch was felt last [s]
  std::string ended_;
};

}  // namespace lorica
