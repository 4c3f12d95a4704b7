#include "skinning/morphs/expressions.h"

#include "geometry/result.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lorica {

namespace {

using Override = ExpressionOverride;

struct Preset {
  std::string_view name;
  std::string_view nameIn0;
  ProceduralKind kind;
};

/// 1.0's presets and their names in 0.x. `surprised` is new in 1.0.
constexpr std::array<Preset, 18> kPresets = {{{"neutral", "Neutral", ProceduralKind::kNone},
                                              {"happy", "Joy", ProceduralKind::kNone},
                                              {"angry", "Angry", ProceduralKind::kNone},
                                              {"sad", "Sorrow", ProceduralKind::kNone},
                                              {"relaxed", "Fun", ProceduralKind::kNone},
                                              {"surprised", "surprised", ProceduralKind::kNone},
                                              {"aa", "A", ProceduralKind::kMouth},
                                              {"ih", "I", ProceduralKind::kMouth},
                                              {"ou", "U", ProceduralKind::kMouth},
                                              {"ee", "E", ProceduralKind::kMouth},
                                              {"oh", "O", ProceduralKind::kMouth},
                                              {"blink", "Blink", ProceduralKind::kBlink},
                                              {"blinkLeft", "Blink_L", ProceduralKind::kBlink},
                                              {"blinkRight", "Blink_R", ProceduralKind::kBlink},
                                              {"lookUp", "LookUp", ProceduralKind::kLookAt},
                                              {"lookDown", "LookDown", ProceduralKind::kLookAt},
                                              {"lookLeft", "LookLeft", ProceduralKind::kLookAt},
                                              {"lookRight", "LookRight", ProceduralKind::kLookAt}}};

/// Equal but for the case of ASCII letters.
[[nodiscard]] bool sameName(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

[[nodiscard]] const Preset* presetOf(std::string_view name) {
  const auto found = std::find_if(kPresets.begin(), kPresets.end(),
                                  [&](const Preset& p) { return sameName(p.name, name) || sameName(p.nameIn0, name); });
  return found == kPresets.end() ? nullptr : &*found;
}

[[nodiscard]] std::optional<std::size_t> indexOf(const Expressions& expressions, std::string_view name) {
  const auto found = std::find_if(expressions.list.begin(), expressions.list.end(),
                                  [&](const Expression& e) { return sameName(e.name, name); });
  if (found == expressions.list.end()) return std::nullopt;
  return static_cast<std::size_t>(found - expressions.list.begin());
}

/// The weight before overrides.
[[nodiscard]] float ownWeight(const Expression& expression, float weight) {
  const float clamped = weight > 0.0F ? std::min(weight, 1.0F) : 0.0F;  // NaN is 0
  if (!expression.binary) return clamped;
  return clamped > 0.5F ? 1.0F : 0.0F;
}

[[nodiscard]] float overrideBy(Override how, float weight) {
  if (how == Override::kNone || !(weight > 0.0F)) return 0.0F;
  return how == Override::kBlock ? 1.0F : weight;
}

}  // namespace

std::string presetName(std::string_view name) {
  const Preset* preset = presetOf(name);
  return std::string(preset != nullptr ? preset->name : name);
}

std::string nameInVrm0(std::string_view name) {
  const auto* const found = std::ranges::find(kPresets, name, &Preset::name);
  return std::string(found == kPresets.end() ? name : found->nameIn0);
}

std::optional<std::size_t> findExpression(const Expressions& expressions, std::string_view name) {
  if (const std::optional<std::size_t> index = indexOf(expressions, name)) return index;
  const Preset* preset = presetOf(name);
  return preset != nullptr ? indexOf(expressions, preset->name) : std::nullopt;
}

bool addExpression(Expressions& expressions, Expression expression) {
  if (indexOf(expressions, expression.name)) return false;
  const auto preset =
      std::find_if(kPresets.begin(), kPresets.end(), [&](const Preset& p) { return p.name == expression.name; });
  expression.kind = preset == kPresets.end() ? ProceduralKind::kNone : preset->kind;
  expressions.list.push_back(std::move(expression));
  return true;
}

std::string namesOf(const Expressions& expressions, std::size_t max) {
  std::string names;
  const std::size_t shown = std::min(expressions.list.size(), max);
  for (std::size_t e = 0; e < shown; ++e) {
    if (e > 0) names += ", ";
    names += expressions.list[e].name;
  }
  const std::size_t more = expressions.list.size() - shown;
  return more == 0 ? names : names + " and " + std::to_string(more) + " more";
}

void effectiveWeights(const Expressions& expressions, std::span<const float> weights, std::span<float> effective) {
  const std::size_t count = expressions.list.size();
  LORICA_CHECK(weights.size() == count && effective.size() == count, "one weight per expression");

  // 1. How much each kind is overridden.
  float blink = 0.0F;
  float lookAt = 0.0F;
  float mouth = 0.0F;
  for (std::size_t e = 0; e < count; ++e) {
    const Expression& expression = expressions.list[e];
    effective[e] = ownWeight(expression, weights[e]);
    if (expression.kind != ProceduralKind::kBlink) blink += overrideBy(expression.overrideBlink, effective[e]);
    if (expression.kind != ProceduralKind::kLookAt) lookAt += overrideBy(expression.overrideLookAt, effective[e]);
    if (expression.kind != ProceduralKind::kMouth) mouth += overrideBy(expression.overrideMouth, effective[e]);
  }

  // 2. What remains.
  for (std::size_t e = 0; e < count; ++e) {
    const Expression& expression = expressions.list[e];
    if (expression.kind == ProceduralKind::kNone) continue;
    const float by = expression.kind == ProceduralKind::kBlink    ? blink
                     : expression.kind == ProceduralKind::kLookAt ? lookAt
                                                                  : mouth;
    if (by > 0.0F) effective[e] *= expression.binary ? 0.0F : 1.0F - std::min(by, 1.0F);
  }
}

void addMorphWeights(const Expressions& expressions, std::span<const float> effective, std::span<float> targetWeights) {
  LORICA_CHECK(effective.size() == expressions.list.size(), "one weight per expression");
  LORICA_CHECK(targetWeights.size() == expressions.baseWeights.size(), "one weight per target");
  for (std::size_t e = 0; e < effective.size(); ++e) {
    if (effective[e] == 0.0F) continue;
    for (const MorphBind& bind : expressions.list[e].morphs) targetWeights[bind.target] += effective[e] * bind.weight;
  }
}

}  // namespace lorica
