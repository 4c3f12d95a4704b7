#include "skinning/morphs/face.h"

#include "geometry/result.h"

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

constexpr double kSlotSeconds = 4.0;

/// SplitMix64 (https://prng.di.unimi.it/splitmix64.c): spreads neighbouring numbers over all 64 bits.
[[nodiscard]] std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

/// 0 <= number < 1.
[[nodiscard]] double fraction(std::uint64_t bits) {
  return (bits >> 11) * 0x1p-53;
}

}  // namespace

float blinkWeight(double time, std::uint64_t seed) {
  if (!(std::abs(time) < 1e9)) return 0.0F;
  // A blink that begins at the end of a slot ends in the next one.
  const std::int64_t slot = std::floor(time / kSlotSeconds);
  for (const std::int64_t s : {slot, slot - 1}) {
    const std::uint64_t bits = mixed(s ^ mixed(seed));
    const double begin = kSlotSeconds * s + 2.0 + 2.0 * fraction(bits);
    const double seconds = 0.1 + 0.1 * fraction(mixed(bits));
    const double share = (time - begin) / seconds;
    if (!(share > 0.0 && share < 1.0)) continue;
    // Eyes close faster than they open: closed at two fifths of the time.
    const double closed = share < 0.4 ? share / 0.4 : (1.0 - share) / 0.6;
    return closed * closed * (3.0 - 2.0 * closed);
  }
  return 0.0F;
}

Face::Face(const Morphs& morphs, const Expressions& expressions, const LookAt& lookAt)
    : morphs_(&morphs),
      expressions_(&expressions),
      lookAt_(&lookAt),
      blink_(indexOf("blink")),
      blinkLeft_(indexOf("blinkLeft")),
      blinkRight_(indexOf("blinkRight")),
      lookUp_(indexOf("lookUp")),
      lookDown_(indexOf("lookDown")),
      lookLeft_(indexOf("lookLeft")),
      lookRight_(indexOf("lookRight")),
      chosen_(expressions.list.size(), 0.0F),
      wanted_(chosen_),
      effective_(chosen_),
      targets_(expressions.baseWeights) {
  LORICA_CHECK(targets_.size() == morphs_->targets.size(), "the expressions belong to another character");
}

int Face::indexOf(const char* preset) const {
  const std::optional<std::size_t> index = findExpression(*expressions_, preset);
  return index ? static_cast<int>(*index) : -1;
}

void Face::set(std::size_t expression, float weight) {
  LORICA_CHECK(expression < chosen_.size(), "no such expression");
  chosen_[expression] = weight;
}

void Face::drive(int expression, float weight) {
  if (expression != -1) wanted_[expression] = weight;
}

void Face::update(const FaceInput& input) {
  std::copy(chosen_.begin(), chosen_.end(), wanted_.begin());
  const auto chosen = [&](int expression) { return expression != -1 && chosen_[expression] != 0.0F; };

  // 1. What a face does by itself.
  if (blinks_ && input.clip.empty() && !chosen(blink_) && !chosen(blinkLeft_) && !chosen(blinkRight_)) {
    const float closed = blinkWeight(input.time);
    if (blink_ != -1) {
      drive(blink_, closed);
    } else {
      drive(blinkLeft_, closed);
      drive(blinkRight_, closed);
    }
  }
  if (lookAt_->kind == LookAtKind::kExpression && !chosen(lookUp_) && !chosen(lookDown_) && !chosen(lookLeft_) &&
      !chosen(lookRight_)) {
    const GazeWeights gaze = gazeWeights(*lookAt_, input.gaze);
    drive(lookUp_, gaze.up);
    drive(lookDown_, gaze.down);
    drive(lookLeft_, gaze.left);
    drive(lookRight_, gaze.right);
  }

  // 2. Targets: those of the clip, and what the expressions add.
  effectiveWeights(*expressions_, wanted_, effective_);
  std::copy(expressions_->baseWeights.begin(), expressions_->baseWeights.end(), targets_.begin());
  sampleMorphWeights(input.clip, input.clipTime, targets_);
  addMorphWeights(*expressions_, effective_, targets_);
}

}  // namespace lorica
