#include "capture/tracking/fit/limb_search.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr float kWidthSq = 0.08F * 0.08F;  ///< robust width of points [m^2]
constexpr std::size_t kMaxNear = 160;      ///< max points considered
constexpr float kExplained = 0.02F;        ///< a point that is nearer to another capsule than this [m]
constexpr float kLoose = 0.05F;            ///< points this far from the rest of the body suggest a limb [m]
constexpr float kUnlike = 0.12F;           ///< candidates differ by this much at elbow or hand [m]

constexpr float kNoLimit = 1e30F;

/// Directions of the upper limb in its parent's frame, for a left limb; x is outward.
constexpr int kDirections = 22;
std::array<V3, kDirections> makeDirections(bool arm) {
  // Rings about the vertical that the joint allows: height and number of directions.
  std::array<V3, kDirections> directions;
  std::size_t n = 0;
  const auto add = [&](float up, float from, float to, int count) {
    for (int i = 0; i < count && n < kDirections; ++i) {
      const float share = count == 1 ? 0.5F : i / static_cast<float>(count - 1);
      const float a = (from + share * (to - from)) * 0.017453293F;  // 0 outward, 90 forward
      const float across = std::sqrt(1.0F - up * up);
      directions[n++] = {across * std::cos(a), up, across * std::sin(a)};
    }
  };
  if (arm) {
    add(-0.99F, 0, 90, 1);
    add(-0.85F, -60, 130, 5);
    add(-0.45F, -40, 125, 5);
    add(0.0F, -25, 125, 5);
    add(0.5F, -10, 110, 4);
    add(0.9F, 0, 70, 2);
  } else {
    add(-0.995F, 0, 90, 1);
    add(-0.93F, -90, 180, 6);
    add(-0.7F, -30, 120, 5);
    add(-0.3F, 0, 110, 5);
    add(0.1F, 20, 100, 5);
  }
  while (n < kDirections) directions[n++] = -V3::UnitY();
  return directions;
}

/// The terms that a limb's own pose changes.
struct LimbTerms {
  std::vector<int> capsules;
  std::vector<Sample> samples;
  std::vector<CollisionPair> pairs;
};

std::array<LimbTerms, kFitLimbCount> makeTerms() {
  std::array<LimbTerms, kFitLimbCount> terms;
  const auto& capsules = capsuleDefs();
  const auto samples = samplesOfBody();
  for (int i = 0; i < kFitLimbCount; ++i) {
    const auto mine = [&](int capsule) { return isOf(static_cast<Limb>(i), capsules[capsule].node); };
    LimbTerms& limb = terms[i];
    for (int c = 0; c < kCapsuleCount; ++c) {
      if (mine(c)) limb.capsules.push_back(c);
    }
    for (const Sample& sample : samples) {
      if (mine(sample.capsule)) limb.samples.push_back(sample);
    }
    for (const CollisionPair& pair : collisionPairs()) {
      if (mine(samples[pair.sample].capsule)) limb.pairs.push_back(pair);
    }
  }
  return terms;
}

const LimbTerms& termsOf(Limb limb) {
  static const std::array<LimbTerms, kFitLimbCount> terms = makeTerms();
  return terms[limb];
}

}  // namespace

LimbSearch::LimbSearch() {
  termsOf(kLeftArm);  // made now, not in a frame
  near_.reserve(kMaxNear);
  loose_.reserve(kMaxNear);
}

float LimbSearch::costOf(const BodyView& view, const BodyPose& pose, const Proportions& proportions, Limb limb,
                         float limit) {
  float cost = restOf(limb, pose).cost();
  for (const BallLimit& range : ballLimits()) {
    if (range.node != upperNodeOf(limb)) continue;
    cost += excessOf(range, pose.turn[range.node]).squaredNorm() / (kLimitDeviation * kLimitDeviation);
  }
  if (cost >= limit) return cost;
  poseBody(pose, proportions, body_);
  const LimbTerms& mine = termsOf(limb);
  for (const Sample& sample : mine.samples) {
    const SamplePulls pulls = pullsOf(view, body_, sample);
    for (int i = 0; i < pulls.count; ++i) cost += pulls.pull[i].cost;
  }
  if (cost >= limit) return cost;
  for (const CollisionPair& pair : mine.pairs) {
    if (without_ != limb && isOf(without_, body_.capsule[pair.capsule].node)) continue;
    cost += collisionOf(body_, ballOf(body_, samplesOfBody()[pair.sample]), pair.capsule).cost;
  }
  const float each = kPointCount /
                     static_cast<float>(std::max<std::size_t>(1, std::min<std::size_t>(view.points().size(), 600))) /
                     (kPointDeviation * kPointDeviation);
  for (const Near& point : near_) {
    if (cost >= limit) return cost;
    SurfaceMatch m;
    m.costSq = point.otherSq;
    m.bound = point.otherBound;
    for (const int capsule : mine.capsules) matchCapsule(body_, capsule, point.position, point.normal, point.ray, m);
    cost += each * robust(m.costSq, kWidthSq).cost;
  }
  return cost;
}

void LimbSearch::offer(const BodyPose& pose, float cost, Limb limb) {
  if (count_ == kMaxCandidates && cost >= candidates_[count_ - 1].cost) return;
  // Measured by the limb's rotations: about 0.3 m at the end of a one-metre arm.
  const auto unlike = [&](const BodyPose& other) {
    const Node up = upperNodeOf(limb);
    const float turn = pose.turn[up].angularDistance(other.turn[up]);
    const float bend = std::abs(pose.angle[lowerNodeOf(limb)][0] - other.angle[lowerNodeOf(limb)][0]);
    return turn + bend > kUnlike / 0.25F;
  };
  for (std::size_t i = 0; i < count_; ++i) {
    if (unlike(candidates_[i].pose)) continue;
    if (candidates_[i].cost <= cost) return;
    for (std::size_t k = i; k + 1 < count_; ++k) candidates_[k] = candidates_[k + 1];
    --count_;
    break;
  }
  if (count_ < kMaxCandidates) ++count_;
  std::size_t at = count_ - 1;
  while (at > 0 && candidates_[at - 1].cost > cost) {
    candidates_[at] = candidates_[at - 1];
    --at;
  }
  candidates_[at] = {pose, cost};
}

std::span<const LimbSearch::Candidate> LimbSearch::search(const BodyView& view, const Proportions& proportions,
                                                          const BodyPose& pose, Limb limb, Limb without) {
  static const std::array<std::array<V3, kDirections>, 2> directions = {makeDirections(true), makeDirections(false)};
  const bool arm = limb == kLeftArm || limb == kRightArm;
  const float mirror = (limb & 1) == 0 ? 1.0F : -1.0F;
  PosedModel body;
  poseBody(pose, proportions, body);
  const Node up = upperNodeOf(limb), low = lowerNodeOf(limb), end = endNodeOf(limb);
  const V3 origin = body.position[up];
  const float upperLength = (body.position[low] - origin).norm();
  const float lowerLength = (body.position[end] - body.position[low]).norm();
  const float handLength = (arm ? 0.12F : 0.04F) * body.girth[kPelvis];
  const float reach = upperLength + lowerLength + handLength + 0.15F;

  without_ = without;
  near_.clear();
  loose_.clear();
  const auto points = view.points();
  const std::size_t max = std::min<std::size_t>(points.size(), 600);
  for (std::size_t i = 0; i < max && near_.size() < kMaxNear; ++i) {
    const BodyView::Point& point = points[i];
    if ((point.position - origin).squaredNorm() > reach * reach) continue;
    SurfaceMatch m;
    // Points that the rest of the body explains well cannot suggest the limb.
    for (int c = 0; c < kCapsuleCount && m.costSq >= kExplained * kExplained; ++c) {
      const int node = body.capsule[c].node;
      if (!isOf(limb, node) && !isOf(without, node)) {
        matchCapsule(body, c, point.position, point.normal, point.ray, m);
      }
    }
    if (m.costSq < kExplained * kExplained) continue;
    near_.push_back({point.position, point.normal, point.ray, m.costSq, m.bound});
    if (m.costSq > kLoose * kLoose) loose_.push_back(point.position);
  }
  count_ = 0;
  presentCost_ = costOf(view, pose, proportions, limb, kNoLimit);

  BodyPose tried = pose;
  const M3& above = body.rotation[nodeDefs()[up].parent];
  const auto attempt = [&](const V3& upper, const V3& lower) {
    layLimb(limb, body, upper, lower, tried);
    // Worse than all that are kept is worth no more.
    const float limit = count_ == kMaxCandidates ? candidates_[count_ - 1].cost : kNoLimit;
    offer(tried, costOf(view, tried, proportions, limb, limit), limb);
  };
  // Reach for points that nothing else explains: first the farthest, then others distributed over them.
  if (!loose_.empty()) {
    std::size_t furthest = 0;
    for (std::size_t i = 1; i < loose_.size(); ++i) {
      if ((loose_[i] - origin).squaredNorm() > (loose_[furthest] - origin).squaredNorm()) furthest = i;
    }
    std::swap(loose_[0], loose_[furthest]);
    constexpr std::size_t kTargets = 4;
    for (std::size_t k = 0; k < kTargets; ++k) {
      const std::size_t i = k * loose_.size() / kTargets;
      if (k > 0 && i == 0) continue;
      const V3 target = loose_[i] + 0.03F * (loose_[i] - view.cameraPosition()).normalized();
      const V3 line = (target - origin).normalized();
      const V3 wrist = target - handLength * line;
      const V3 side = (std::abs(line.y()) < 0.9F ? V3::UnitY() : V3::UnitZ()).cross(line).normalized();
      const V3 other = line.cross(side);
      for (int swivel = 0; swivel < 6; ++swivel) {
        const float a = swivel * 1.0471976F;
        const LimbLine found =
            reachFor(origin, upperLength, lowerLength, wrist, std::cos(a) * side + std::sin(a) * other);
        attempt(found.upper, found.lower);
      }
    }
  }
  for (const V3& direction : directions[arm ? 0 : 1]) {
    const V3 upper = above * V3(mirror * direction.x(), direction.y(), direction.z());
    attempt(upper, upper);
    const V3 side = (std::abs(upper.y()) < 0.9F ? V3::UnitY() : V3::UnitZ()).cross(upper).normalized();
    const V3 other = upper.cross(side);
    for (int swivel = 0; swivel < 4; ++swivel) {
      const float a = swivel * 1.5707963F + 0.4F;
      const V3 across = std::cos(a) * side + std::sin(a) * other;
      for (const float bend : {0.9F, 1.8F}) attempt(upper, std::cos(bend) * upper + std::sin(bend) * across);
    }
  }
  return {candidates_.data(), count_};
}

}  // namespace lorica::fit
