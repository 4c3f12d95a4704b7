#include "tests/bench/generators/synthetic_motion.h"

#include "capture/files/joint_csv.h"
#include "geometry/result.h"
#include "tests/bench/generators/motion_clips.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {

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

std::vector<SkeletonFrame> synthesizeMotion(std::string_view name) {
  constexpr std::array kMakers = {motion::walk,          motion::wave,         motion::jumpingJacks,
                                  motion::squatAndReach, motion::punchAndKick, motion::turnAround};
  const auto found = std::ranges::find(kShippedMotions, name);
  LORICA_CHECK(found != kShippedMotions.end(), "only shipped motions are made");
  return motion::perform(kMakers[found - kShippedMotions.begin()]());
}

}  // namespace lorica
