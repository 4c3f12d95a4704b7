#include "capture/synthetic/synthetic_motion.h"

#include "capture/synthetic/motion_clips.h"

#include <array>
#include <cmath>

namespace lorica {
namespace {

struct Shipped {
  std::string_view name;
  motion::Performance (*make)();
};
/// In the order of SyntheticMotion.
constexpr std::array<Shipped, kSyntheticMotionCount> kShipped = {{{"walk", motion::walk},
                                                                  {"wave", motion::wave},
                                                                  {"jumping_jacks", motion::jumpingJacks},
                                                                  {"squat_and_reach", motion::squatAndReach},
                                                                  {"punch_and_kick", motion::punchAndKick},
                                                                  {"turn_around", motion::turnAround}}};

}  // namespace

std::string_view nameOf(SyntheticMotion motion) {
  return kShipped[static_cast<std::size_t>(motion)].name;
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
  return motion::perform(kShipped[static_cast<std::size_t>(motion)].make());
}

}  // namespace lorica
