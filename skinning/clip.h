#pragma once

#include "geometry/counts.h"
#include "skinning/skeleton.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Interpolation between keys, as defined by glTF 2.0
/// (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, appendix C).
enum class KeyInterpolation : std::uint8_t { kStep, kLinear, kCubicSpline };

/// Keys of one property of one joint. Rotations are stored as in the file; sampling normalises them.
template <typename Value>
struct KeyTrack {
  KeyInterpolation interpolation = KeyInterpolation::kLinear;  ///< between two keys
  std::vector<double> times;                                   ///< [s], strictly increasing, at least one
  std::vector<Value> values;  ///< one per key; three for cubic splines: in-tangent, value, out-tangent
};

/// The tracks of one joint. Properties without a track stay at rest.
struct JointTrack {
  JointIndex joint = 0;                       ///< that moves
  std::optional<KeyTrack<Vec3>> translation;  ///< [m], in the parent's frame; none = the rest pose's
  std::optional<KeyTrack<Quat>> rotation;     ///< unit quaternions, in the parent's frame; none = the rest pose's
  std::optional<KeyTrack<Vec3>> scale;        ///< factors; none = the rest pose's
};

/// An animation of a skeleton.
struct Clip {
  std::string name;                ///< in the file; may be empty
  double seconds = 0.0;            ///< time of the last key
  std::vector<JointTrack> tracks;  ///< one for each joint that moves
  double framesPerSecond = 0.0;    ///< of its keys, if each frame has one; else 0
};

/// Samples the clip at a time. Before its first key a track has the first value, after its last key the last value.
/// @param time  [s]
/// @param pose  jointCount local transforms; joints and properties without a track are not changed
void sampleClip(const Clip& clip, double time, std::span<JointTransform> pose);

/// A motion of a skeleton as frames: a sampled clip, a BVH file, or a motion retargeted from another skeleton.
struct SkeletalMotion {
  std::string name;                   ///< of the clip or file
  Skeleton skeleton;                  ///< that moves
  std::vector<double> times;          ///< [s], increasing, at least one
  std::vector<JointTransform> poses;  ///< frameCount x jointCount, frame-major

  [[nodiscard]] int frameCount() const { return countOf(times); }  ///< at least one
  /// The local transforms of all joints in a frame.
  [[nodiscard]] std::span<const JointTransform> pose(int frame) const {
    const std::size_t joints = skeleton.jointCount();
    return std::span(poses).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
};

/// Samples a clip at equal time steps, including its first and last instant.
/// @param framesPerSecond  greater than 0
[[nodiscard]] SkeletalMotion sampleWhole(const Skeleton& skeleton, const Clip& clip, double framesPerSecond);

/// The pose at any time, interpolated between the two nearest frames: translations and scales linearly, rotations by
/// the shorter arc. Before the first frame it is the first one, after the last the last. Does not allocate memory.
/// @param time  [s], as in motion.times
/// @param pose  jointCount local transforms, written
void poseAt(const SkeletalMotion& motion, double time, std::span<JointTransform> pose);

}  // namespace lorica
