#include "skinning/morphs/morphs.h"

#include "geometry/counts.h"
#include "geometry/result.h"
#include "skinning/key_times.h"
#include "skinning/morphs/expressions.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace lorica {

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

namespace {

constexpr std::size_t kAxes = 13;
constexpr double kSamePosition = 1e-6;  // [m]

/// One of each pair of opposite directions through the faces, edges and corners of a cube.
[[nodiscard]] std::array<Vec3, kAxes> cubeAxes() {
  std::array<Vec3, kAxes> axes;
  std::size_t count = 0;
  for (int code = 14; code < 27; ++code) {  // 13 is the centre, smaller codes are opposite to larger ones
    const Eigen::Vector3i steps(code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1);
    axes[count++] = steps.cast<double>().normalized();
  }
  return axes;
}

constexpr std::size_t kMaxSets = 4096;
constexpr std::size_t kMaxTimes = 512;  // of a clip

/// The times at which a clip's weights are at their extremes, at most `limit` of them.
[[nodiscard]] std::vector<double> extremeTimes(std::span<const MorphWeightTrack> tracks, std::size_t limit) {
  std::vector<double> times;
  bool exact = true;
  double first = kInfinity;
  double last = -kInfinity;
  for (const MorphWeightTrack& track : tracks) {
    exact =
        exact && track.interpolation != KeyInterpolation::kCubicSpline && times.size() + track.times.size() <= limit;
    if (exact) times.insert(times.end(), track.times.begin(), track.times.end());
    first = std::min(first, track.times.front());
    last = std::max(last, track.times.back());
  }
  if (!exact) {
    times.clear();
    const double steps = limit - 1;
    for (std::size_t i = 0; i < limit; ++i) times.push_back(first + (last - first) * static_cast<double>(i) / steps);
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// The outermost displacements of one vertex.
struct Extremes {
  std::array<double, 2 * kAxes> reach{};     // along each axis, and against it
  std::array<Vec3, 2 * kAxes> displacement;  // [m]

  Extremes() { displacement.fill(Vec3::Zero()); }
};

}  // namespace

std::vector<float> usedWeightSets(const Morphs& morphs, const Expressions& expressions, std::span<const float> chosen) {
  std::vector<float> effective(chosen.size());
  effectiveWeights(expressions, chosen, effective);
  std::vector<float> sets = expressions.baseWeights;
  addMorphWeights(expressions, effective, sets);

  const auto moves = [](const std::vector<MorphWeightTrack>& tracks) { return !tracks.empty(); };
  const std::size_t moving = std::count_if(morphs.clips.begin(), morphs.clips.end(), moves);
  if (moving == 0) return sets;
  const std::size_t limit = std::clamp<std::size_t>(kMaxSets / moving, 2, kMaxTimes);
  for (const std::vector<MorphWeightTrack>& tracks : morphs.clips) {
    if (!moves(tracks)) continue;
    for (const double time : extremeTimes(tracks, limit)) {
      const std::size_t begin = sets.size();
      if (begin >= kMaxSets * expressions.baseWeights.size()) return sets;
      sets.insert(sets.end(), expressions.baseWeights.begin(), expressions.baseWeights.end());
      const std::span<float> set = std::span(sets).subspan(begin);
      sampleMorphWeights(tracks, time, set);
      addMorphWeights(expressions, effective, set);
    }
  }
  return sets;
}

std::vector<ReachedPosition> reachedPositions(const Morphs& morphs, std::span<const float> weightSets,
                                              std::span<const Vec3> bindPositions, double threshold) {
  const std::size_t targetCount = morphs.targets.size();
  if (targetCount == 0 || weightSets.empty()) return {};
  LORICA_CHECK(weightSets.size() % targetCount == 0, "one weight per target in every set");
  static const std::array<Vec3, kAxes> kCubeAxes = cubeAxes();

  // 1. The vertices that any set moves.
  const std::size_t setCount = weightSets.size() / targetCount;
  std::vector<int> slotOf(bindPositions.size(), -1);
  std::vector<VertexIndex> vertices;
  for (std::size_t t = 0; t < targetCount; ++t) {
    bool used = false;
    for (std::size_t s = 0; s < setCount; ++s) {
      used = used || weightSets[s * targetCount + t] != morphs.targets[t].defaultWeight;
    }
    if (!used) continue;
    for (const MorphOffset& offset : morphs.targets[t].offsets) {
      int& slot = slotOf[offset.vertex];
      if (slot != -1) continue;
      slot = countOf(vertices);
      vertices.push_back(offset.vertex);
    }
  }

  // 2. How far each set moves them.
  std::vector<Extremes> extremes(vertices.size());
  std::vector<Vec3> moved(vertices.size());
  for (std::size_t s = 0; s < setCount; ++s) {
    std::fill(moved.begin(), moved.end(), Vec3::Zero());
    for (std::size_t t = 0; t < targetCount; ++t) {
      const double factor = weightSets[s * targetCount + t] - morphs.targets[t].defaultWeight;
      if (factor == 0.0) continue;
      for (const MorphOffset& offset : morphs.targets[t].offsets) {
        moved[slotOf[offset.vertex]] += factor * offset.position.cast<double>();
      }
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      for (std::size_t a = 0; a < 2 * kAxes; ++a) {
        const double reach = moved[i].dot(kCubeAxes[a / 2]) * (a % 2 == 0 ? 1.0 : -1.0);
        if (reach <= extremes[i].reach[a]) continue;
        extremes[i].reach[a] = reach;
        extremes[i].displacement[a] = moved[i];
      }
    }
  }

  // 3. Each vertex' different positions, in the order of the vertices.
  std::vector<ReachedPosition> reached;
  std::vector<Vec3> kept;
  for (std::size_t v = 0; v < slotOf.size(); ++v) {
    if (slotOf[v] == -1) continue;
    kept.clear();
    double farthest = 0.0;
    for (const Vec3& d : extremes[slotOf[v]].displacement) {
      farthest = std::max(farthest, d.norm());
      const bool known =
          std::any_of(kept.begin(), kept.end(), [&](const Vec3& k) { return (k - d).norm() < kSamePosition; });
      if (!known && d.norm() >= kSamePosition) kept.push_back(d);
    }
    if (farthest < threshold) continue;
    for (const Vec3& d : kept) reached.push_back({static_cast<VertexIndex>(v), bindPositions[v] + d});
  }
  return reached;
}

}  // namespace lorica
