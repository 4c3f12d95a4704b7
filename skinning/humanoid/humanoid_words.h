#pragma once

#include "skinning/skeleton.h"

#include <string>
#include <vector>

namespace lorica {

enum class Side : std::uint8_t { kMiddle, kLeft, kRight };

/// The parsed name of a joint: "mixamorig:LeftHandThumb1" is (hand, thumb1), left.
struct JointName {
  std::vector<std::string> words;  ///< lower case; without side, namespace and words that most joints share
  Side side = Side::kMiddle;
  /// Of several joints with one name the lowest is used: 0 deforms, 1 is ordinary, 2 drives another, 3 only offsets
  /// one.
  int preference = 1;

  [[nodiscard]] std::string key() const;  ///< the words joined
};

/// Parses the names of all joints of a skeleton, in order. Parts that most of them share (a namespace, "Bip01",
/// "_Armature", a running number at the end) are removed, so the names cannot be parsed one by one.
[[nodiscard]] std::vector<JointName> readJointNames(const Skeleton& skeleton);

/// Removes leading zeros of the number at the end: "spine01" becomes "spine1".
[[nodiscard]] std::string withoutLeadingZeros(const std::string& key);

/// Whether a joint's name marks it as a helper, not a bone: twist, end, target, pole and others.
[[nodiscard]] bool isHelper(const JointName& name);

}  // namespace lorica
