#include "capture/synthetic/synthetic_motion.h"

#include "capture/synthetic/motion_clips.h"

#include <cmath>

namespace lorica {

std::string_view nameOf(SyntheticMotion motion) {
  switch (motion) {
    case SyntheticMotion::kWalk:
      return "walk";
    case SyntheticMotion::kWave:
      return "wave";
    case SyntheticMotion::kJumpingJacks:
      return "jumping_jacks";
    case SyntheticMotion::kSquatAndReach:
      return "squat_and_reach";
    case SyntheticMotion::kPunchAndKick:
      return "punch_and_kick";
    case SyntheticMotion::kTurnAround:
      return "turn_around";
  }
  return {};
}

void roundForFile(std::vector<SkeletonFrame>& frames) {
  // Adding zero turns -0 into 0.
  const auto rounded = [](double value, double perUnit) { return std::round(value * perUnit) / perUnit + 0.0; };
  for (SkeletonFrame& frame : frames) {
    frame.time = rounded(frame.time, 1e6);
    for (TrackedJoint& joint : frame.joints) {
      for (double& p : joint.position) p = rounded(p, 1e5);
      if (!joint.orientation) continue;
      for (double& q : joint.orientation->coeffs()) q = rounded(q, 1e5);
    }
  }
}

std::vector<SkeletonFrame> synthesizeMotion(SyntheticMotion motion) {
  switch (motion) {
    case SyntheticMotion::kWalk:
      return motion::perform(motion::walk());
    case SyntheticMotion::kWave:
      return motion::perform(motion::wave());
    case SyntheticMotion::kJumpingJacks:
      return motion::perform(motion::jumpingJacks());
    case SyntheticMotion::kSquatAndReach:
      return motion::perform(motion::squatAndReach());
    case SyntheticMotion::kPunchAndKick:
      return motion::perform(motion::punchAndKick());
    case SyntheticMotion::kTurnAround:
      return motion::perform(motion::turnAround());
  }
  return {};
}

}  // namespace lorica
