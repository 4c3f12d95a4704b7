#include "geometry/similar_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMaxCompared = 2000;

[[nodiscard]] std::size_t editDistance(std::string_view a, std::string_view b) {
  const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  std::vector<std::size_t> row(b.size() + 1);
  std::vector<std::size_t> above(row.size()), twoAbove(row.size());
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  const auto same = [&](std::size_t i, std::size_t j) { return small(a[i - 1]) == small(b[j - 1]); };
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(twoAbove, above);
    std::swap(above, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j - 1] + (same(i, j) ? 0 : 1), above[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && same(i, j - 1) && same(i - 1, j);
      if (swapped) row[j] = std::min(row[j], twoAbove[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string didYouMean(std::string_view name, std::span<const std::string> known) {
  if (name.size() > kLongestName) return "";
  const std::string* nearest = nullptr;
  std::size_t min = std::max<std::size_t>(name.size() / 2, 2) + 1;
  for (const std::string& candidate : known.first(std::min(known.size(), kMaxCompared))) {
    if (candidate.size() > kLongestName) continue;
    const std::size_t distance = editDistance(name, candidate);
    if (distance >= min) continue;
    min = distance;
    nearest = &candidate;
  }
  return nearest == nullptr ? "" : fmt::format("; did you mean \"{}\"?", *nearest);
}

}  // namespace lorica
