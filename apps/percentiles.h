#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lorica {

/// What is told of many measurements.
struct Spread {
  double median = 0.0;
  double p95 = 0.0;
};

/// By nearest rank, so that every figure was measured; zeros of nothing.
[[nodiscard]] inline Spread spreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return {quantile(0.5), quantile(0.95)};
}

}  // namespace lorica
