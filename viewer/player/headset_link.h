#pragma once

#include "capture/headset/worn_headset.h"
#include "viewer/renderer/screen.h"

#include <cstddef>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Hands the poses of a headset to whatever follows its wearer. With a depth camera it finds how the headset lies to
/// it, while both see the wearer, who may be any of several people: see docs/REGISTRATION.md. What it found is kept for
/// the same camera, and given up when camera or headset were moved. Times are of one monotonic clock.
class HeadsetLink {
 public:
  /// Another run begins.
  /// @param camera  what tells it from others; empty = an avatar follows head and hands, without a camera
  /// @param worn    is told all that is known; null = nobody is followed
  void begin(const std::string& camera, std::shared_ptr<WornHeadset> worn);
  /// Gives up what is known: it is found again, from what comes from now on.
  void forget();
  /// A pose of a headset, of one wearer at a time. @param now  when it came [s]
  void addHeadset(const HeadsetPose& headset, double now);
  /// A tracked head joint.
  /// @param place    whose: 0, or that of one of several people  @param head  floor frame [m]
  /// @param arrived  when its image came [s]
  void addTracked(std::size_t place, const Vec3& head, double arrived);
  /// Looks for the registration now and then, in a thread of its own.
  /// @param origin  of the world in the floor frame [m]
  /// @return what is known of the wearer, when it is something else
  [[nodiscard]] std::optional<WearerState> update(double now, const Vec3& origin = Vec3::Zero());

  /// Whether an answer is on its way.
  [[nodiscard]] bool solving() const { return solving_.valid(); }
  [[nodiscard]] const std::optional<Registration>& known() const { return known_; }
  /// The place of the wearer, once known.
  [[nodiscard]] const std::optional<std::size_t>& place() const { return place_; }

 private:
  struct Found {
    std::optional<Registration> registration;
    std::optional<std::size_t> place;
    bool moved = false;
    std::string advice;
  };
  [[nodiscard]] static Found solve(const std::vector<HeadRegistration>& samples,
                                   const std::optional<Registration>& known, std::optional<std::size_t> place);
  [[nodiscard]] std::optional<WearerState> ifChanged(WearerState state);
  void know(const std::optional<Registration>& registration);

  std::shared_ptr<WornHeadset> worn_;
  bool alone_ = false;                     // without a camera
  std::filesystem::path file_;             // where it is kept; empty = nowhere
  std::vector<HeadRegistration> samples_;  // for each place
  std::optional<Registration> known_;
  std::optional<std::size_t> place_;
  std::future<Found> solving_;
  int wearer_ = 0;                    // whose headset it is
  double lastPose_ = -1e9;            // when it came [s]
  double clockDifference_ = 0.0;      // of the headset's clock to ours, by the quickest message [s]
  double solved_ = -1e9;              // last time [s]
  std::optional<WearerState> state_;  // as update() gave it last
};

}  // namespace lorica
