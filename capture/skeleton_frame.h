#pragma once

#include "geometry/counts.h"
#include "geometry/math.h"
#include "geometry/result.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// The 15 joints of NiTE 2 in its order. Left and right are the person's own.
enum class BodyJoint : std::uint8_t {
  kHead,
  kNeck,
  kLeftShoulder,
  kRightShoulder,
  kLeftElbow,
  kRightElbow,
  kLeftHand,
  kRightHand,
  kTorso,
  kLeftHip,
  kRightHip,
  kLeftKnee,
  kRightKnee,
  kLeftFoot,
  kRightFoot,
};
inline constexpr int kBodyJointCount = 15;  ///< joints that BodyJoint names

/// Joints of the left side, those of the arm first. Their counterparts on the right follow each of them.
inline constexpr std::array<BodyJoint, 6> kLeftJoints = {BodyJoint::kLeftShoulder, BodyJoint::kLeftElbow,
                                                         BodyJoint::kLeftHand,     BodyJoint::kLeftHip,
                                                         BodyJoint::kLeftKnee,     BodyJoint::kLeftFoot};
/// The joint on the right that one on the left has as its partner.
[[nodiscard]] constexpr BodyJoint rightOf(BodyJoint left) {
  return static_cast<BodyJoint>(ordinalOf(left) + 1);
}

/// Lower snake case: "left_shoulder".
[[nodiscard]] std::string_view nameOf(BodyJoint joint);

/// A joint as reported by a tracker.
struct TrackedJoint {
  Vec3 position = Vec3::Zero();  ///< world [m]: Y up, floor at y = 0
  /// worldFromJoint rotation; identity for every joint of a person in T-pose who faces +Z
  std::optional<Quat> orientation;
  double confidence = 0.0;  ///< 0 unknown (position is meaningless), 0.5 inferred, 1 seen
};

/// SkeletonFrame::user of a place that is empty: the avatar of that place is not there.
inline constexpr int kNobody = std::numeric_limits<int>::min();

/// One person at one point in time.
struct SkeletonFrame {
  double time = 0.0;                                 ///< [s], increases from frame to frame
  int user = 1;                                      ///< number of the person, from 0; kNobody while there is none
  std::array<TrackedJoint, kBodyJointCount> joints;  ///< in the order of BodyJoint

  /// A joint by its name.
  [[nodiscard]] TrackedJoint& operator[](BodyJoint j) { return joints[ordinalOf(j)]; }
  /// The same, to read.
  [[nodiscard]] const TrackedJoint& operator[](BodyJoint j) const { return joints[ordinalOf(j)]; }
};

/// Source of skeletons: a recording, a tracker, or a network stream.
class SkeletonSource {
 public:
  virtual ~SkeletonSource() = default;
  /// Returns the next frame; nullopt at the end of the stream; an error if the data is bad.
  [[nodiscard]] virtual Result<std::optional<SkeletonFrame>> next() = 0;
};

/// An expression that a source of motion shows, by the source's own name: "Joy", "happy".
struct NamedWeight {
  std::string name;     ///< of the expression
  float weight = 0.0f;  ///< 0 to 1

  [[nodiscard]] bool operator==(const NamedWeight&) const = default;
};

}  // namespace lorica
