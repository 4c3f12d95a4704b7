#pragma once

#include "geometry/result.h"
#include "tests/bench/real_variant.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica::bench {

/// Elbows, hands, knees and feet.
inline constexpr std::array kLimbJoints = {BodyJoint::kLeftElbow, BodyJoint::kRightElbow, BodyJoint::kLeftHand,
                                           BodyJoint::kRightHand, BodyJoint::kLeftKnee,   BodyJoint::kRightKnee,
                                           BodyJoint::kLeftFoot,  BodyJoint::kRightFoot};

struct RealOptions {
  std::vector<std::string> names;  ///< only recordings whose name starts with one of these; empty = all
  std::filesystem::path results;   ///< folder for the joints and labels of each recording; empty = none
  std::filesystem::path pictures;  ///< folder for a sheet of each recording: joints over depth; empty = none
  int pictureStep = 10;            ///< every which frame is drawn
  RealVariant variant;             ///< which run of each recording
  int composed = 0;                ///< so many composed rooms instead, see composeRoom()
};

/// Tracks the depth recordings of real people in a folder (NAME.oni, NAME.json, NAME.joints.csv, NAME.joints2.csv,
/// masks/NAME_NNNN.png) and prints how far the joints are from the recorded ones: a row for each recording and each
/// kind. The measures are those of the judge that comes with the data.
/// @return an error with the file that could not be read
[[nodiscard]] Result<void> measureRealPeople(const std::filesystem::path& folder, const RealOptions& options);

}  // namespace lorica::bench
