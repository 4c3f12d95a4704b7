#include "capture/files/bvh_file.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/files.h"
#include "geometry/result.h"
#include "skinning/mannequin/mannequin.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// Any bytes as a BVH file. What is accepted must be sound and fit the bytes that it came from; and one in 256, as
/// its bytes have it, must be fit to be carried over to another skeleton, which takes far longer than reading it.
namespace {

using namespace lorica;

bool isFinite(const JointTransform& t) {
  return t.translation.allFinite() && t.rotation.coeffs().allFinite() && t.scale.allFinite();
}

void expectSound(const SkeletalMotion& motion, std::size_t frames, std::size_t joints) {
  LORICA_CHECK(motion.times.size() == frames && motion.poses.size() == frames * joints, "frames got lost");
  for (std::size_t f = 1; f < frames; ++f) LORICA_CHECK(motion.times[f] > motion.times[f - 1], "times do not rise");
  for (const JointTransform& t : motion.poses) {
    LORICA_CHECK(isFinite(t) && std::abs(t.rotation.norm() - 1.0) < 1e-6, "a joint without place or turn");
  }
}

void retarget(const SkeletalMotion& motion) {
  static const Skeleton mannequin = makeMannequin().skeleton;
  const Result<SkeletalMotion> out = retargetMotion(motion, mannequin);
  if (!out) return;
  expectSound(*out, motion.times.size(), static_cast<std::size_t>(mannequin.jointCount()));
  const Result<std::vector<SkeletonFrame>> frames = bodyJointsOf(motion);
  LORICA_CHECK(frames.ok(), "retargeted, but no body");
  for (const SkeletonFrame& frame : *frames) {
    for (const TrackedJoint& joint : frame.joints) LORICA_CHECK(joint.position.allFinite(), "a joint nowhere");
  }
  LORICA_CHECK(skeletalMotionOf(*frames).ok(), "joints that make no skeleton");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Result<BvhFile> file = parseBvh(text, "fuzz");
  if (!file) {
    const std::string& message = file.error().message;
    LORICA_CHECK(message.rfind("fuzz, line ", 0) == 0, "an error that does not say where");
    LORICA_CHECK(message.find("found") != std::string::npos || message.find("ends here") != std::string::npos,
                 "an error that does not say what was found");
    LORICA_CHECK(message.find("expected") != std::string::npos, "an error that does not say what was expected");
    return 0;
  }
  const SkeletalMotion& motion = file->motion;
  LORICA_CHECK(motion.frameCount() > 0 && motion.poses.size() <= 2 * size, "more joints and frames than bytes");
  LORICA_CHECK(!file->unit.empty() && file->metresPerUnit > 0.0, "no unit");
  expectSound(motion, motion.times.size(), static_cast<std::size_t>(motion.skeleton.jointCount()));
  if (motion.frameCount() <= 20 && contentHash(text) % 256 == 0) retarget(motion);
  return 0;
}
