#pragma once

#include "bindings/live_character.h"
#include "collision/world/self_contact.h"
#include "collision/world/shape_contact.h"

#include <cstdint>
#include <optional>
#include <span>

namespace lorica {

/// Asks what a live body touches in its present pose.
class LiveContacts {
 public:
  /// See SelfContactQuery. The first call prepares the query.
  [[nodiscard]] std::span<const SelfContact> ofItself(const LiveCharacter& live);
  /// See ShapeContactQuery. The first call prepares the query. @param shape  that checkShape() accepts
  [[nodiscard]] std::span<const ShapeContact> withShape(const LiveCharacter& live, const RoundedShape& shape);

 private:
  std::optional<SelfContactQuery> self_;
  std::optional<ShapeContactQuery> shape_;
};

/// An error if a shape has no points, or a number that is not finite, below 0, or beyond 1,000 km.
[[nodiscard]] Result<void> checkShape(const RoundedShape& shape);

}  // namespace lorica
