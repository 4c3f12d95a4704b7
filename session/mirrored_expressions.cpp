#include "session/mirrored_expressions.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lorica {

std::string mirroredExpression(std::string_view name) {
  using Sides = std::pair<std::string_view, std::string_view>;
  constexpr std::array<Sides, 5> kSides = {
      {{"Left", "Right"}, {"left", "right"}, {"LEFT", "RIGHT"}, {"_L", "_R"}, {"_l", "_r"}}};
  const auto swapped = [&](std::string_view side, std::string_view other) {
    return std::string(name.substr(0, name.size() - side.size())).append(other);
  };
  for (const auto& [left, right] : kSides) {
    if (name.ends_with(left)) return swapped(left, right);
    if (name.ends_with(right)) return swapped(right, left);
  }
  return std::string(name);
}

std::span<const NamedWeight> MirroredExpressions::of(std::span<const NamedWeight> sent) {
  const bool same = std::equal(sent.begin(), sent.end(), names_.begin(), names_.end(),
                               [](const NamedWeight& one, const std::string& name) { return one.name == name; });
  if (!same) {
    names_.clear();
    mirrored_.clear();
    for (const NamedWeight& one : sent) {
      names_.push_back(one.name);
      mirrored_.push_back({mirroredExpression(one.name), 0.0f});
    }
  }
  for (std::size_t i = 0; i < sent.size(); ++i) mirrored_[i].weight = sent[i].weight;
  return mirrored_;
}

}  // namespace lorica
