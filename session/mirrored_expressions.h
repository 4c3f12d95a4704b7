#pragma once

#include "capture/named_weight.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The expression of the other side: `blinkLeft` is `blinkRight`, `Blink_L` is `Blink_R`, `mouthSmileLeft` is
/// `mouthSmileRight`. Names that end in no side are their own.
[[nodiscard]] std::string mirroredExpression(std::string_view name);

/// A face with left and right swapped. Allocates when names change only.
class MirroredExpressions {
 public:
  /// @return the weights of `sent`, in its order, under the names of the other side. Valid until the next call
  [[nodiscard]] std::span<const NamedWeight> of(std::span<const NamedWeight> sent);

 private:
  std::vector<std::string> names_;  ///< as sent
  std::vector<NamedWeight> mirrored_;
};

}  // namespace lorica
