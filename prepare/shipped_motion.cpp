#include "prepare/shipped_motion.h"

#include "capture/files/joint_csv.h"

#include <vector>

namespace lorica {

Motion shippedMotion(SyntheticMotion which) {
  Motion motion;
  motion.name = nameOf(which);
  std::vector<SkeletonFrame> frames = synthesizeMotion(which);
  roundForFile(frames);
  // Through the text of the file: reading it normalises rotations.
  std::string text = jointCsvHeader();
  for (const SkeletonFrame& frame : frames) text += jointCsvRow(frame);
  motion.joints = parseJointCsv(text, motion.name).value();
  motion.format = "joints (lorica)";
  return motion;
}

std::optional<Motion> shippedMotion(const std::string& name) {
  for (int m = 0; m < kSyntheticMotionCount; ++m) {
    const auto which = static_cast<SyntheticMotion>(m);
    if (nameOf(which) == name) return shippedMotion(which);
  }
  return std::nullopt;
}

}  // namespace lorica
