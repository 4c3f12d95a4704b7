#pragma once

#include "capture/skeleton_frame.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lorica::bench {

/// The row of the table that a motion belongs to.
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
  kFar,  ///< beyond the range of such a camera
};

/// A motion in front of the virtual sensor, independent of the body.
struct TrackedMotion {
  std::string name;
  MotionKind kind = MotionKind::kOrdinary;
  std::vector<SkeletonFrame> joints;       ///< motion given by joints, or
  std::optional<SkeletalMotion> skeletal;  ///< by a skeleton
  double seconds = 8.0;                    ///< duration that is used
  double turn = 0.0;                       ///< rotation of the person about the vertical axis [rad]
  std::vector<TimeSpan> absent;            ///< when the person is away, leaving at 1.5 m/s
  std::vector<VirtualScreen> screens;      ///< screens that hide the person
  std::vector<Aabb> furniture;             ///< furniture that is always present
  std::vector<SkeletonFrame> companion;    ///< a second person's joints, performed by the mannequin
};

/// Procedural motions, including the shipped recordings. The path of the walk is shortened so that the person stays
/// between 2.3 and 4.5 m from the camera; `walk_far` has the full path, 2.4 to 6.2 m.
[[nodiscard]] std::vector<TrackedMotion> formulaMotions();

/// Motions of third-party data: BVH files and a clip of crossed arms.
/// @param folder  of the data; missing files are skipped
/// @return the motions, or an error with the file that could not be read
[[nodiscard]] Result<std::vector<TrackedMotion>> dataMotions(const std::filesystem::path& folder);

/// A person to be tracked.
struct TestPerson {
  std::string name;
  Character character;
  bool own = false;  ///< the mannequin, from which the tracker's body is made
  bool odd = false;  ///< has non-human proportions
};

/// The mannequin, bodies derived from it, and the available bodies of third-party data.
/// @return the bodies, or an error with the file that could not be read
[[nodiscard]] Result<std::vector<TestPerson>> trackedBodies(const std::filesystem::path& folder);

/// Places the person at the origin in front of a camera at a height of 1.1 m and a distance of 2.7 m. If the motion
/// covers a long path, the camera is farther away and the centre of the path is at the origin.
/// @return the sensor, or why the body cannot perform the motion
[[nodiscard]] Result<VirtualSensor> sensorBefore(const TestPerson& body, const TrackedMotion& motion,
                                                 const DepthCamera& camera, const DepthNoiseSettings& noise);

}  // namespace lorica::bench
