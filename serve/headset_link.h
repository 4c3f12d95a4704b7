#pragma once

#include "capture/registration/head_registration.h"
#include "serve/wish.h"

#include <filesystem>
#include <future>
#include <optional>
#include <string>

namespace lorica {

/// Finds how the headset of a client lies to the depth camera, while both see its wearer: see docs/REGISTRATION.md.
/// What it found is kept for the same camera, and given up when camera or headset were moved. Times are of one
/// monotonic clock.
class HeadsetLink {
 public:
  /// Another run begins. @param camera  what tells it from others; empty = nothing is tracked
  void begin(const std::string& camera);
  /// A pose of a headset, of one client at a time. @param now  when it came [s]
  void addHeadset(const Wish& wish, double now);
  /// The tracked head joint. @param now  when it was tracked [s]
  void addTracked(const Vec3& head, double now);
  /// Looks for the registration now and then, in a thread of its own.
  /// @return the message `registration`, when there is another one to be told; else empty
  [[nodiscard]] std::string update(double now);

  /// Whether an answer is on its way.
  [[nodiscard]] bool solving() const { return solving_.valid(); }
  [[nodiscard]] const std::optional<Registration>& known() const { return known_; }

 private:
  struct Found {
    std::optional<Registration> registration;
    bool moved = false;
    std::string advice;
  };
  [[nodiscard]] std::string told(const std::string& advice);

  std::string camera_;
  std::filesystem::path file_;  // where it is kept; empty = nowhere
  HeadRegistration samples_;
  std::optional<Registration> known_;
  std::future<Found> solving_;
  int client_ = 0;                // whose headset it is
  double heard_ = -1e9;           // last time [s]
  double clockDifference_ = 0.0;  // of the client's clock to ours, by the quickest message [s]
  double solved_ = -1e9;          // last time [s]
  std::string said_;
};

}  // namespace lorica
