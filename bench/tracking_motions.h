#pragma once

#include "capture/skeleton_frame.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lorica::bench {

/// Which row of the table a motion counts for.
enum class MotionKind {
  kOrdinary,
  kBoxing,
  kCrossedArms,
  kTurn,
  kBackTurned,
  kSitting,
  kOcclusion,
  kEntering,
  kTwo,
  kFar,  ///< beyond what such a camera is made for
};

/// Someone's motion before the virtual sensor, whoever performs it.
struct TrackedMotion {
  std::string name;
  MotionKind kind = MotionKind::kOrdinary;
  std::vector<SkeletonFrame> joints;       ///< by joints; or
  std::optional<SkeletalMotion> skeletal;  ///< by a skeleton
  double seconds = 8.0;                    ///< of it that is shown
  double turn = 0.0;                       ///< of the person about the vertical [rad]
  std::vector<TimeSpan> absent;            ///< when the person is away, leaving at 1.5 m/s
  std::vector<VirtualScreen> screens;      ///< that hide the person
  std::vector<Aabb> furniture;             ///< that stands there always
  std::vector<SkeletonFrame> companion;    ///< a second person's joints, performed by the mannequin
};

/// Those made by formula; the shipped recordings among them. The walk's way is shortened so that the person stays
/// between 2.3 and 4.5 m from the camera; `walk_far` has all of it, 2.4 to 6.2 m.
[[nodiscard]] std::vector<TrackedMotion> formulaMotions();

/// Those of third-party data: BVH files and a clip of crossed arms.
/// @param folder  of the data; what is absent there is left out
/// @return the motions, or which file could not be read
[[nodiscard]] Result<std::vector<TrackedMotion>> dataMotions(const std::filesystem::path& folder);

/// Someone to be tracked.
struct TrackedBody {
  std::string name;
  Character character;
  bool own = false;  ///< the one that the tracker's body is made from
  bool odd = false;  ///< of proportions that no human has
};

/// The mannequin and the bodies made of it, and those of third-party data that are there.
/// @return the bodies, or which file could not be read
[[nodiscard]] Result<std::vector<TrackedBody>> trackedBodies(const std::filesystem::path& folder);

/// Puts the person at the origin before a camera 1.1 m up and 2.7 m away; further away where the motion goes far, the
/// middle of its way then at the origin.
/// @return the sensor, or why the body cannot perform the motion
[[nodiscard]] Result<VirtualSensor> sensorBefore(const TrackedBody& body, const TrackedMotion& motion,
                                                 const DepthNoiseSettings& noise);

}  // namespace lorica::bench
