#include "skinning/morphs/morphs.h"

#include "geometry/result.h"
#include "skinning/key_times.h"

#include <algorithm>

namespace lorica {

void defaultWeights(const Morphs& morphs, std::span<float> targetWeights) {
  LORICA_CHECK(targetWeights.size() == morphs.targets.size(), "one weight per target");
  for (std::size_t t = 0; t < targetWeights.size(); ++t) targetWeights[t] = morphs.targets[t].defaultWeight;
}

void sampleMorphWeights(std::span<const MorphWeightTrack> tracks, double time, std::span<float> targetWeights) {
  for (const MorphWeightTrack& track : tracks) {
    const std::size_t first = track.firstTarget;
    const std::size_t count = track.targetCount;
    LORICA_CHECK(first + count <= targetWeights.size(), "the clip belongs to another character");
    const std::span<float> out = targetWeights.subspan(first, count);
    const BetweenKeys at = locateKeys(track.times, time);
    const bool cubic = track.interpolation == KeyInterpolation::kCubicSpline;
    const std::size_t stride = cubic ? 3 * count : count;
    const float* here = track.values.data() + at.first * stride + (cubic ? count : 0);
    if (at.seconds == 0.0 || track.interpolation == KeyInterpolation::kStep) {
      std::copy_n(here, count, out.begin());
      continue;
    }
    const double t = at.fraction;
    const double t2 = t * t;
    const double t3 = t2 * t;
    for (std::size_t i = 0; i < count; ++i) {
      const double value = here[i];
      const double next = here[i + stride];
      if (!cubic) {
        out[i] = value + t * (next - value);
        continue;
      }
      const double leaving = at.seconds * here[i + count];
      const double arriving = at.seconds * here[i + stride - count];
      out[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * value + (t3 - 2.0 * t2 + t) * leaving + (3.0 * t2 - 2.0 * t3) * next +
               (t3 - t2) * arriving;
    }
  }
}

void applyMorphs(const Morphs& morphs, std::span<const float> targetWeights, std::span<const Vec3> bindPositions,
                 std::span<const Vec3f> bindNormals, std::span<Vec3> positions, std::span<Vec3f> normals) {
  LORICA_CHECK(targetWeights.size() == morphs.targets.size(), "one weight per target");
  LORICA_CHECK(positions.size() == bindPositions.size(), "as many positions out as in");
  LORICA_CHECK(normals.size() == bindNormals.size(), "as many normals out as in");
  std::copy(bindPositions.begin(), bindPositions.end(), positions.begin());
  std::copy(bindNormals.begin(), bindNormals.end(), normals.begin());

  const auto factorOf = [&](std::size_t t) { return targetWeights[t] - morphs.targets[t].defaultWeight; };
  for (std::size_t t = 0; t < targetWeights.size(); ++t) {
    const float factor = factorOf(t);
    if (factor == 0.0F) continue;
    for (const MorphOffset& offset : morphs.targets[t].offsets) {
      positions[offset.vertex] += static_cast<double>(factor) * offset.position.cast<double>();
    }
    if (normals.empty()) continue;
    for (const MorphOffset& offset : morphs.targets[t].offsets) normals[offset.vertex] += factor * offset.normal;
  }
  if (normals.empty()) return;
  for (std::size_t t = 0; t < targetWeights.size(); ++t) {
    if (factorOf(t) == 0.0F) continue;
    for (const MorphOffset& offset : morphs.targets[t].offsets) {
      Vec3f& normal = normals[offset.vertex];
      const float length = normal.norm();
      if (length > 1e-12F) normal /= length;
    }
  }
}

}  // namespace lorica
