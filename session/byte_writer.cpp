#include "session/byte_writer.h"

#include "geometry/work_budgets.h"

#include <algorithm>
#include <cstdint>

namespace lorica {

void putExpressions(std::span<const NamedWeight> expressions, ByteWriter& bytes) {
  const auto fits = [](const NamedWeight& one) { return one.name.size() <= kMaxExpressionName; };
  const auto fitting = static_cast<std::size_t>(std::count_if(expressions.begin(), expressions.end(), fits));
  std::size_t left = std::min(fitting, kMaxPoseExpressions);
  bytes.put(static_cast<std::uint16_t>(left));
  for (const NamedWeight& one : expressions) {
    if (left == 0) return;
    if (!fits(one)) continue;
    bytes.put(static_cast<std::uint8_t>(one.name.size()));
    bytes.put(std::string_view(one.name));
    bytes.put(one.weight);
    --left;
  }
}

}  // namespace lorica
