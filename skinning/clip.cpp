#include "skinning/clip.h"

#include "skinning/key_times.h"

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

using Vec4 = Eigen::Vector4d;

[[nodiscard]] const Vec3& numbers(const Vec3& v) {
  return v;
}
[[nodiscard]] const Vec4& numbers(const Quat& q) {
  return q.coeffs();
}

[[nodiscard]] Vec3 blended(const Vec3& a, const Vec3& b, double fraction) {
  return a + fraction * (b - a);
}
[[nodiscard]] Vec4 blended(const Quat& a, const Quat& b, double fraction) {
  return a.normalized().slerp(fraction, b.normalized()).coeffs();
}

/// Coefficients of a track's value at a time; for rotations x, y, z, w, not yet normalised.
template <typename Value>
[[nodiscard]] auto sampled(const KeyTrack<Value>& track, double time) {
  using Numbers = std::decay_t<decltype(numbers(std::declval<const Value&>()))>;
  const BetweenKeys at = locateKeys(track.times, time);
  if (track.interpolation == KeyInterpolation::kCubicSpline) {
    const Numbers value = numbers(track.values[3 * at.first + 1]);
    if (at.seconds == 0.0) return value;
    const Numbers leaving = numbers(track.values[3 * at.first + 2]);
    const Numbers arriving = numbers(track.values[3 * at.first + 3]);
    const Numbers next = numbers(track.values[3 * at.first + 4]);
    const double t = at.fraction;
    const double t2 = t * t;
    const double t3 = t2 * t;
    return Numbers((2.0 * t3 - 3.0 * t2 + 1.0) * value + at.seconds * (t3 - 2.0 * t2 + t) * leaving +
                   (3.0 * t2 - 2.0 * t3) * next + at.seconds * (t3 - t2) * arriving);
  }
  if (track.interpolation == KeyInterpolation::kStep || at.seconds == 0.0) {
    return Numbers(numbers(track.values[at.first]));
  }
  return Numbers(blended(track.values[at.first], track.values[at.first + 1], at.fraction));
}

}  // namespace

void sampleClip(const Clip& clip, double time, std::span<JointTransform> pose) {
  for (const JointTrack& track : clip.tracks) {
    LORICA_CHECK(track.joint >= 0 && track.joint < countOf(pose), "the clip belongs to another skeleton");
    JointTransform& joint = pose[track.joint];
    if (track.translation) joint.translation = sampled(*track.translation, time);
    if (track.scale) joint.scale = sampled(*track.scale, time);
    if (track.rotation) {
      const Vec4 q = sampled(*track.rotation, time);
      // A spline may pass through zero, where the rotation is undefined.
      const double norm = q.norm();
      joint.rotation = norm > 1e-12 ? Quat(Vec4(q / norm)) : Quat::Identity();
    }
  }
}

SkeletalMotion sampleWhole(const Skeleton& skeleton, const Clip& clip, double framesPerSecond) {
  LORICA_CHECK(framesPerSecond > 0.0, "framesPerSecond must be positive");
  const double steps = std::max(0.0, std::round(clip.seconds * framesPerSecond));
  const auto frameCount = std::size_t{1} + static_cast<std::size_t>(clip.seconds > 0.0 ? std::max(1.0, steps) : 0.0);
  SkeletalMotion motion{clip.name, skeleton, {}, {}};
  const std::size_t jointCount = skeleton.jointCount();
  motion.times.reserve(frameCount);
  motion.poses.reserve(frameCount * jointCount);
  Pose pose = restPose(skeleton);
  for (std::size_t frame = 0; frame < frameCount; ++frame) {
    const double time = frameCount == 1 ? 0.0 : clip.seconds * frame / static_cast<double>(frameCount - 1);
    sampleClip(clip, time, pose);
    motion.times.push_back(time);
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  return motion;
}

void poseAt(const SkeletalMotion& motion, double time, std::span<JointTransform> pose) {
  const auto after = std::upper_bound(motion.times.begin(), motion.times.end(), time);
  const int next = after - motion.times.begin();
  const std::span<const JointTransform> from = motion.pose(std::max(next - 1, 0));
  const std::span<const JointTransform> to = motion.pose(std::min(next, motion.frameCount() - 1));
  const double begin = next > 0 ? motion.times[next - 1] : 0.0;
  const bool between = next > 0 && next < motion.frameCount();
  const double share = between ? (time - begin) / (*after - begin) : 0.0;
  for (std::size_t j = 0; j < pose.size(); ++j) {
    pose[j].translation = from[j].translation + share * (to[j].translation - from[j].translation);
    pose[j].rotation = from[j].rotation.slerp(share, to[j].rotation);
    pose[j].scale = from[j].scale + share * (to[j].scale - from[j].scale);
  }
}

}  // namespace lorica
