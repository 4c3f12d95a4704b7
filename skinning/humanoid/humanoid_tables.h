#pragma once

#include "skinning/skeleton.h"

#include <span>
#include <string_view>

namespace lorica {

/// How one convention names a bone: in lower case, joined ("UpLeg" is upleg), without side, prefix or leading zeros;
/// several names are parted by blanks, the best first. A row of a left bone stands for the right one too. The row of
/// kSpine holds all joints of the trunk: their order is the skeleton's.
struct BoneNames {
  HumanBone bone;
  std::string_view names;
};

struct NamingConvention {
  std::string_view name;
  std::span<const BoneNames> rows;
};

/// Every convention that Lorica knows; the last one is loose and mixes all of them.
[[nodiscard]] std::span<const NamingConvention> namingConventions();

}  // namespace lorica
