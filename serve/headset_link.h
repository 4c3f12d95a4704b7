#pragma once

#include "capture/headset/worn_headset.h"
#include "serve/wish.h"

#include <cstddef>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Finds how the headset of a client lies to the depth camera, while both see its wearer, who may be any of several
/// people: see docs/REGISTRATION.md.
/// What it found is kept for the same camera, and given up when camera or headset were moved. Times are of one
/// monotonic clock.
class HeadsetLink {
 public:
  /// Another run begins.
  /// @param camera  what tells it from others
  /// @param worn    is told all that is known; null = nothing is tracked
  void begin(const std::string& camera, std::shared_ptr<WornHeadset> worn);
  /// A pose of a headset, of one client at a time. @param now  when it came [s]
  void addHeadset(const Wish& wish, double now);
  /// A tracked head joint.
  /// @param place    whose: 0, or that of one of several people  @param head  floor frame [m]
  /// @param arrived  when its image came [s]
  void addTracked(std::size_t place, const Vec3& head, double arrived);
  /// Looks for the registration now and then, in a thread of its own.
  /// @return the message `registration`, when there is another one to be told; else empty
  /// @param origin  of the world in the floor frame [m]
  [[nodiscard]] std::string update(double now, const Vec3& origin = Vec3::Zero());

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
  [[nodiscard]] std::string told(const std::string& advice, const Vec3& origin);

  void know(const std::optional<Registration>& registration);

  std::shared_ptr<WornHeadset> worn_;
  std::filesystem::path file_;             // where it is kept; empty = nowhere
  std::vector<HeadRegistration> samples_;  // for each place
  std::optional<Registration> known_;
  std::optional<std::size_t> place_;
  std::future<Found> solving_;
  int client_ = 0;                // whose headset it is
  double heard_ = -1e9;           // last time [s]
  double clockDifference_ = 0.0;  // of the client's clock to ours, by the quickest message [s]
  double solved_ = -1e9;          // last time [s]
  std::string said_;
};

}  // namespace lorica
