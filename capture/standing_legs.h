#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <cstdint>

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

/// Gives a person whose legs are not known legs to stand on: for people who sit, webcams, and legs that LegJudge
/// refused.
///
/// The feet stand below the hips and stay in place until the hips have moved or turned away; then one foot after the
/// other steps. The body is raised or lowered so that the hips are at standing height; quick movements of the hips,
/// such as a bow or a small squat, bend the knees. Lengths of the legs come from the length of the trunk (adults'
/// proportions, R. Drillis and R. Contini, "Body Segment Parameters", 1966). Appears and goes within half a second. Use
/// one instance per person. Allocates nothing.
class StandingLegs {
 public:
  /// When these legs are used instead of the person's own.
  enum class Use : std::uint8_t {
    kIfUnknown,  ///< while neither leg is known
    kAlways,
    kOnKnownFloor,  ///< always, and heights are right: the body is not moved
  };
  /// One for each person.
  explicit StandingLegs(Use use) : use_(use) {}

  /// Of the hips above the floor, of somebody who stands [lengths of the trunk].
  static const double kHipHeight;
  /// From the middle of the hips to one of them [lengths of the trunk].
  static constexpr double kHipHalf = 0.18;

  /// Sets hips, knees and feet, and moves all joints vertically, if these legs are used; else only while returning to
  /// the person's own legs. A frame without neck is not changed.
  void apply(SkeletonFrame& frame);

 private:
  struct Foot {
    Vec3 from{0, 0, 0}, to{0, 0, 0};  ///< of the current or last step [m]
    double stepped = 1.0;             ///< share of it that is done
    double yaw = 0.0;                 ///< heading in which it was placed [rad]
    [[nodiscard]] Vec3 position() const;
  };

  void stand(SkeletonFrame& frame, double step);

  Use use_;
  std::array<Foot, 2> feet_;
  double share_ = 0.0;      ///< of these legs in what is shown
  double unknown_ = 0.0;    ///< how long neither leg was known [s]
  double trunk_ = 0.0;      ///< usual length from the hips to the neck [m]; 0 = not seen yet
  double usualHips_ = 0.0;  ///< usual height of the hips [m]
  double time_ = 0.0;       ///< of the previous frame [s]
  bool any_ = false;
  bool placed_ = false;  ///< the feet have positions
};

}  // namespace lorica
