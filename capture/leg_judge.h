#pragma once

#include "capture/skeleton_frame.h"

#include <array>

namespace lorica {

/// Finds legs that cannot be, although a sensor marks them as seen: ankles above knees above hips on an upright trunk,
/// thighs and shins that change their length or do not fit the trunk. Sensors report such legs for people who sit, who
/// stand behind furniture, or of whom they see only a part.
///
/// Judges the last second or so, not single frames, so that kicks and jumps pass. A joint that the sensor only inferred
/// (confidence up to 0.5) is judged more strictly. Use one instance per person. Allocates nothing.
class LegJudge {
 public:
  /// Sets the confidence of knee and foot of implausible legs to 0.
  void apply(SkeletonFrame& frame);

  /// @param side  0 left, 1 right
  [[nodiscard]] bool plausible(std::size_t side) const { return !legs_[side].implausible; }
  /// Whether a leg was implausible in any frame so far.
  [[nodiscard]] bool everImplausible() const { return ever_; }

 private:
  struct Leg {
    double bad = 0.0;    ///< share of the last time in which the leg could not be
    double thigh = 0.0;  ///< usual lengths [m]; 0 = not seen yet
    double shin = 0.0;
    bool implausible = false;
  };
  struct Look;

  std::array<Leg, 2> legs_;
  double trunk_ = 0.0;   ///< usual length from the hips to the neck [m]; 0 = not seen yet
  double judged_ = 0.0;  ///< time judged so far [s]
  double time_ = 0.0;    ///< of the previous frame [s]
  bool any_ = false;
  bool ever_ = false;
};

}  // namespace lorica
