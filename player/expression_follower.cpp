#include "player/expression_follower.h"

#include <algorithm>

namespace lorica {

void ExpressionFollower::apply(std::span<const NamedWeight> sent, const Expressions& expressions,
                               std::span<const float> given, Face& face) {
  const bool same = std::equal(sent.begin(), sent.end(), known_.begin(), known_.end(),
                               [](const NamedWeight& a, const Known& b) { return a.name == b.name; });
  if (!same) learn(sent, expressions, given, face);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (known_[i].expression) face.set(*known_[i].expression, sent[i].weight);
  }
}

void ExpressionFollower::learn(std::span<const NamedWeight> sent, const Expressions& expressions,
                               std::span<const float> given, Face& face) {
  for (const Known& known : known_) {
    if (!known.expression) continue;
    face.set(*known.expression, *known.expression < given.size() ? given[*known.expression] : 0.0f);
  }
  known_.clear();
  bool blinks = false;
  for (const NamedWeight& one : sent) {
    known_.push_back({one.name, findExpression(expressions, one.name)});
    const std::optional<std::size_t> expression = known_.back().expression;
    blinks = blinks || (expression && expressions.list[*expression].kind == ProceduralKind::kBlink);
  }
  face.setBlinking(!blinks);
}

}  // namespace lorica
