#pragma once

namespace lorica {

/// Which quality of pictures a machine is fast enough for, from how long they take: lower where people see them jerk,
/// higher where there is time to spare, and calm in between.
///
/// Judges a second at a time. Below 25 pictures a second it goes down one level. Where a picture takes less than 10 ms
/// for three seconds, it goes up one. A level that was too much is tried again after 10 s, then after twice as long.
class QualityChoice {
 public:
  /// @param levels  0 is the lowest; starts at the highest
  explicit QualityChoice(int levels) : highest_(levels - 1), level_(levels - 1) {}

  /// Takes a picture into account.
  /// @param seconds  that drawing it took, without waiting for the display [s]
  /// @param now      a clock that never goes back [s]
  /// @return whether the level changed
  bool add(double seconds, double now);
  [[nodiscard]] int level() const { return level_; }

 private:
  int highest_;
  int level_;
  double begin_ = -1.0;  // of the second that is judged [s]; below 0 = none yet
  double sum_ = 0.0;     // of the pictures in it [s]
  int pictures_ = 0;
  int easySeconds_ = 0;      // in a row
  double raisedAt_ = -1e9;   // [s]
  double notBefore_ = -1e9;  // a level up [s]
  double waitNext_ = 10.0;   // after a level was too much [s]
};

}  // namespace lorica
