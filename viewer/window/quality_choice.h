#pragma once

namespace lorica {

/// Chooses the rendering quality from the measured frame times: lower if the animation stutters, higher if there is
/// time to spare, with hysteresis.
///
/// Evaluates one second at a time. If its pictures take longer than allowed, the quality is lowered by one level. If
/// they take less than a quarter of that for three seconds, it is raised by one. A level that was too slow is tried
/// again after 10 s, then after twice that time, and so on.
class QualityChoice {
 public:
  /// @param levels  0 is the lowest; starts at the highest
  explicit QualityChoice(int levels) : highest_(levels - 1), level_(levels - 1) {}

  /// Adds the measurement of one picture.
  /// @param seconds  drawing time, without waiting for the display [s]
  /// @param now      monotonic clock [s]
  /// @return whether the level changed
  bool add(double seconds, double now);
  [[nodiscard]] int level() const { return level_; }
  /// Allows another time for a picture. The default is a window's: 25 pictures per second.
  void setLongest(double seconds) { longest_ = seconds; }
  static constexpr double kLongest = 1.0 / 25.0;  ///< [s]

 private:
  int highest_;
  int level_;
  double longest_ = kLongest;
  double begin_ = -1.0;  // start of the evaluated second [s]; below 0 = none yet
  double sum_ = 0.0;     // drawing time of the pictures in it [s]
  int pictures_ = 0;
  int easySeconds_ = 0;      // in a row
  double raisedAt_ = -1e9;   // [s]
  double notBefore_ = -1e9;  // earliest time to raise the level [s]
  double waitNext_ = 10.0;   // delay after a level was too slow [s]
};

}  // namespace lorica
