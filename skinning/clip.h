#pragma once

#include "skinning/skeleton.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// How a value goes from one key to the next, as glTF 2.0 defines it
/// (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, appendix C).
enum class KeyInterpolation : std::uint8_t { kStep, kLinear, kCubicSpline };

/// Keys of one property of one joint. Rotations are kept as files have them; sampling normalises.
template <typename Value>
struct KeyTrack {
  KeyInterpolation interpolation = KeyInterpolation::kLinear;
  std::vector<double> times;  ///< [s], strictly rising, at least one
  std::vector<Value> values;  ///< one a key; of cubic splines three: in-tangent, value, out-tangent
};

/// What a clip moves of one joint. What has no track stays as it is at rest.
struct JointTrack {
  JointIndex joint = 0;
  std::optional<KeyTrack<Vec3>> translation;
  std::optional<KeyTrack<Quat>> rotation;
  std::optional<KeyTrack<Vec3>> scale;
};

/// An animation of a skeleton.
struct Clip {
  std::string name;
  double seconds = 0.0;  ///< time of the last key
  std::vector<JointTrack> tracks;
};

/// Writes what the clip moves at a time; before its first key a track has the first value, after the last the last.
/// @param time  [s]
/// @param pose  jointCount local transforms; joints and properties without a track are left alone
void sampleClip(const Clip& clip, double time, std::span<JointTransform> pose);

/// A motion of a skeleton in frames: a clip sampled, a BVH file, or a motion carried over from another skeleton.
struct SkeletalMotion {
  std::string name;
  Skeleton skeleton;
  std::vector<double> times;          ///< [s], rising, at least one
  std::vector<JointTransform> poses;  ///< frameCount x jointCount, frame-major

  [[nodiscard]] int frameCount() const { return static_cast<int>(times.size()); }
  [[nodiscard]] std::span<const JointTransform> pose(int frame) const {
    const auto joints = static_cast<std::size_t>(skeleton.jointCount());
    return std::span(poses).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
};

/// A clip in frames of equal length, its first and last moment included.
/// @param framesPerSecond  above 0
[[nodiscard]] SkeletalMotion sampleWhole(const Skeleton& skeleton, const Clip& clip, double framesPerSecond);

}  // namespace lorica
