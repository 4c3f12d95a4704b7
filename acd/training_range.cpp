#include "acd/training_range.h"

#include "acd/transfer.h"
#include "geometry/result.h"
#include "geometry/rigid_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

constexpr std::size_t kProbesOfAPart = 4;
constexpr std::size_t kMinProbes = 32;
constexpr double kKnownShare = 0.3;

/// Moves points so that their centroid is the origin.
void center(std::span<Vec3> points) {
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : points) centroid += p;
  centroid /= points.size();
  for (Vec3& p : points) p -= centroid;
}

/// Farthest-point sampling of one part (Gonzalez 1985); in a tie the first point wins.
class FarthestFirst {
 public:
  FarthestFirst(const Part& part, std::span<const Vec3> positions)
      : points_(part.points), positions_(positions), distanceSq_(part.points.size()) {
    Aabb box;
    for (const PointIndex p : points_) box.extend(at(p));
    for (std::size_t i = 0; i < points_.size(); ++i) distanceSq_[i] = (at(points_[i]) - box.center()).squaredNorm();
  }

  /// @param taken  for each point of the decomposition, whether it is already a probe, of any part
  /// @return the next point, or -1 after the last
  PointIndex next(std::span<const char> taken) {
    std::size_t farthest = points_.size();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (taken[points_[i]] != 0) continue;
      if (farthest == points_.size() || distanceSq_[i] > distanceSq_[farthest]) farthest = i;
    }
    if (farthest == points_.size()) return -1;
    const Vec3& chosen = at(points_[farthest]);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double distanceSq = (at(points_[i]) - chosen).squaredNorm();
      // The first point is the farthest from the box centre; after it, only distances to chosen points count.
      distanceSq_[i] = started_ ? std::min(distanceSq_[i], distanceSq) : distanceSq;
    }
    started_ = true;
    return points_[farthest];
  }

 private:
  [[nodiscard]] const Vec3& at(PointIndex p) const { return positions_[p]; }

  std::span<const PointIndex> points_;
  std::span<const Vec3> positions_;
  std::vector<double> distanceSq_;
  bool started_ = false;
};

std::vector<PointIndex> chooseProbes(const Decomposition& decomposition, std::span<const Vec3> positions) {
  std::vector<FarthestFirst> spreads;
  spreads.reserve(decomposition.parts.size());
  for (const Part& part : decomposition.parts) spreads.emplace_back(part, positions);

  // In rounds over all parts, so that an incomplete last round favours the first, coarsest parts.
  const std::size_t wanted = std::clamp(kProbesOfAPart * decomposition.parts.size(), kMinProbes, kMaxProbes);
  std::vector<char> taken(positions.size(), 0);
  std::vector<PointIndex> probes;
  probes.reserve(wanted);
  std::size_t before = 0;
  do {
    before = probes.size();
    for (std::size_t i = 0; i < spreads.size() && probes.size() < wanted; ++i) {
      const PointIndex probe = spreads[i].next(taken);
      if (probe < 0) continue;
      taken[probe] = 1;
      probes.push_back(probe);
    }
  } while (probes.size() < wanted && probes.size() > before);
  return probes;
}

}  // namespace

TrainingRange trainingRange(const Decomposition& decomposition, PoseView keyframes) {
  LORICA_CHECK(keyframes.keyframeCount() > 0, "trainingRange() needs at least one keyframe");
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, keyframes.keyframe(0), points);

  TrainingRange range;
  range.probes = chooseProbes(decomposition, points);
  LORICA_CHECK(!range.probes.empty(), "trainingRange() needs a part with points");
  range.keyframeCount = keyframes.keyframeCount();
  range.positions.resize(range.keyframeCount * range.probes.size());
  for (int k = 0; k < range.keyframeCount; ++k) {
    transfer(decomposition, keyframes.keyframe(k), points);
    const std::span<Vec3> kept = std::span(range.positions).subspan(k * range.probes.size(), range.probes.size());
    gatherProbes(range, points, kept);
    center(kept);
  }

  double sumSq = 0.0;
  for (const Vec3& p : range.positions) sumSq += p.squaredNorm();
  range.knownDistance = kKnownShare * std::sqrt(sumSq / range.positions.size());
  return range;
}

double trainingDistance(const TrainingRange& range, std::span<const Vec3> probePositions) {
  LORICA_CHECK(probePositions.size() == range.probes.size() && range.probes.size() <= kMaxProbes,
               "trainingDistance() needs one position for each probe");
  std::array<Vec3, kMaxProbes> memory;
  const std::span<Vec3> pose = std::span(memory).first(probePositions.size());
  std::copy(probePositions.begin(), probePositions.end(), pose.begin());
  center(pose);
  double nearest = std::numeric_limits<double>::infinity();
  double size = 0.0;
  for (const Vec3& p : pose) size += p.squaredNorm();
  if (!std::isfinite(size)) return nearest;
  for (int k = 0; k < range.keyframeCount; ++k) nearest = std::min(nearest, rigidDistance(range.keyframe(k), pose));
  return nearest;
}

void gatherProbes(const TrainingRange& range, std::span<const Vec3> points, std::span<Vec3> probePositions) {
  for (std::size_t i = 0; i < range.probes.size(); ++i) {
    probePositions[i] = points[range.probes[i]];
  }
}

double farthestFrame(const TrainingRange& range, const Decomposition& decomposition, PoseView frames) {
  std::vector<Vec3> points(decomposition.pointCount());
  std::vector<Vec3> probePositions(range.probes.size());
  double farthest = 0.0;
  for (int f = 0; f < frames.keyframeCount(); ++f) {
    transfer(decomposition, frames.keyframe(f), points);
    gatherProbes(range, points, probePositions);
    farthest = std::max(farthest, trainingDistance(range, probePositions));
  }
  return farthest;
}

}  // namespace lorica
