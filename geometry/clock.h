#pragma once

#include <chrono>
#include <cmath>
#include <optional>
#include <string>

namespace lorica {

/// Of a monotonic clock [s].
[[nodiscard]] inline double secondsOf(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
[[nodiscard]] inline double now() {
  return secondsOf(std::chrono::steady_clock::now());
}

[[nodiscard]] inline double microsecondsBetween(std::chrono::steady_clock::time_point begin,
                                                std::chrono::steady_clock::time_point end) {
  return std::chrono::duration<double, std::micro>(end - begin).count();
}

/// How long the rest of some work takes if it goes on as it went. So it never comes to nothing before the work has
/// ended, and it rises where the work stands.
/// @param worked   the share that was done
/// @param rest     the share that remains
/// @param seconds  since the work began
/// @return none as long as it cannot be told [s]
[[nodiscard]] inline std::optional<double> timeLeft(double worked, double rest, double seconds) {
  constexpr double kSettled = 2.0, kEnough = 0.03;  // an estimate before says nothing [s], [share]
  if (seconds <= kSettled || worked < kEnough * (worked + rest) || rest <= 0.0) return std::nullopt;
  return seconds * rest / worked;
}

/// "about 3 minutes", no more exact than an estimate is. @param seconds  above 0
[[nodiscard]] inline std::string roughly(double seconds) {
  const auto about = [](double count, const char* unit) {
    return "about " + std::to_string(std::lround(count)) + " " + unit;
  };
  if (seconds < 8.0) return "some seconds";
  if (seconds < 55.0) return about(10.0 * std::round(seconds / 10.0), "seconds");
  if (seconds < 90.0) return "about a minute";
  if (seconds < 55.0 * 60.0) return about(seconds / 60.0, "minutes");
  return seconds < 90.0 * 60.0 ? "about an hour" : about(seconds / 3600.0, "hours");
}

}  // namespace lorica
