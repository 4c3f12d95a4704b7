#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lorica::bench {

using Joints = std::array<Vec3, kBodyJointCount>;

[[nodiscard]] inline Joints positionsOf(const SkeletonFrame& frame) {
  Joints joints;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) joints[j] = frame.joints[j].position;
  return joints;
}

/// A joint that somebody marked on the depth image.
struct MarkedJoint {
  BodyJoint joint{};
  Eigen::Vector2d fromMiddle;  ///< of the image [px]
  double depth = 0.0;          ///< measured there [m]; 0 = not
};

/// A depth recording of real people and what is true in it.
struct RealRecording {
  std::string name, kind;
  std::filesystem::path file;
  int firstFrame = 0;  ///< with a person
  int peopleVisible = 1;
  double frameSeconds = 1.0 / 30.0;
  Isometry3 floorFromCamera = Isometry3::Identity();
  std::vector<std::map<int, Joints>> people;  ///< by frame, camera frame
  /// Of some frames, those of each person who is marked.
  std::map<int, std::vector<std::vector<MarkedJoint>>> marks;
};

/// Reads what belongs to NAME.oni in a folder, but not its frames: NAME.json, NAME.joints.csv, NAME.joints2.csv,
/// and its rows of marks.csv.
/// @param names  only recordings whose name starts with one of these; empty = all
/// @return in the order of their names, at least one, or an error with the file that could not be read
[[nodiscard]] Result<std::vector<RealRecording>> readRealRecordings(const std::filesystem::path& folder,
                                                                    const std::vector<std::string>& names);

/// How the tracker's joints differ from the recorded ones by definition, floor frame.
[[nodiscard]] Result<Joints> readOffsets(const std::filesystem::path& file);

}  // namespace lorica::bench
