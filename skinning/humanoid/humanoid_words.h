#pragma once

#include "skinning/skeleton.h"

#include <string>
#include <vector>

namespace lorica {

enum class Side : std::uint8_t { kMiddle, kLeft, kRight };

/// The name of a joint, taken apart: "mixamorig:LeftHandThumb1" is (hand, thumb1) of the left.
struct JointName {
  std::vector<std::string> words;  ///< lower case; no side, no namespace, nothing that most joints share
  Side side = Side::kMiddle;
  /// Of several joints of one name the lowest is taken: 0 deforms, 1 is plain, 2 drives another, 3 only offsets one.
  int preference = 1;

  [[nodiscard]] std::string key() const;  ///< the words as one
};

/// The names of all joints of a skeleton, in order. What they share (a namespace, "Bip01", "_Armature", a running
/// number at the end) is left out, so it takes all of them to read one.
[[nodiscard]] std::vector<JointName> readJointNames(const Skeleton& skeleton);

/// "spine01" as "spine1": numbers at the end without leading zeros.
[[nodiscard]] std::string withoutLeadingZeros(const std::string& key);

/// Whether a joint is a helper by its name: twist, end, target, pole and such. Not a bone.
[[nodiscard]] bool isHelper(const JointName& name);

}  // namespace lorica
