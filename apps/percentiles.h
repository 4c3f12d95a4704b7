#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lorica {

/// Percentiles of a series of measurements.
struct Percentiles {
  double median = 0.0;
  double p95 = 0.0;
};

/// By the nearest-rank method, so that each figure is a measured value. Zeros if there are no values.
[[nodiscard]] inline Percentiles percentilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    const std::size_t rank = std::ceil(share * values.size());
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return {quantile(0.5), quantile(0.95)};
}

}  // namespace lorica
