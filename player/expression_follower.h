#pragma once

#include "capture/named_weight.h"
#include "skinning/morphs/face.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Lets a face show the expressions of a source of motion. Names of VRM 0.x and 1.0 are the same: "Joy" is "happy".
/// While the source sends a blink of its own, the face does not blink by itself.
class ExpressionFollower {
 public:
  /// Allocates nothing while the names stay the same.
  /// @param sent         those that the character lacks are left out
  /// @param expressions  of the face
  /// @param given        their weights while the source does not name them; missing ones are 0
  void apply(std::span<const NamedWeight> sent, const Expressions& expressions, std::span<const float> given,
             Face& face);

 private:
  struct Known {
    std::string name;
    std::optional<std::size_t> expression;
  };
  void learn(std::span<const NamedWeight> sent, const Expressions& expressions, std::span<const float> given,
             Face& face);

  std::vector<Known> known_;
};

}  // namespace lorica
