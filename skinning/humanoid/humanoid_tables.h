#pragma once

#include "skinning/skeleton.h"

#include <span>
#include <string_view>

namespace lorica {

/// How one convention names a bone: in lower case, joined ("UpLeg" is upleg), without side, prefix or leading zeros;
/// several names are separated by blanks, the best first. A row of a left bone also applies to the right one. The row
/// of kSpine lists all joints of the trunk; their order is given by the skeleton.
struct BoneNames {
  HumanBone bone;
  std::string_view names;
};

struct NamingConvention {
  std::string_view name;
  std::span<const BoneNames> rows;
};

/// All known conventions; the last one mixes all of them.
[[nodiscard]] std::span<const NamingConvention> namingConventions();

}  // namespace lorica
