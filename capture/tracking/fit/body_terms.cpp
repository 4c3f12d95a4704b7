#include "capture/tracking/fit/body_terms.h"

#include "geometry/counts.h"
#include "skinning/humanoid/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lorica::fit {
namespace {

constexpr float kNormalWeight = 0.06F;   ///< weight of opposite normals, as a distance / sqrt(2) [m]
constexpr float kFreeDeviation = 0.02F;  ///< [m]
constexpr float kFreeWidth = 0.30F;      ///< robust width of samples outside the outline [m]
constexpr float kFrontWidth = 0.12F;     ///< ... in front of the seen surface [m]
constexpr float kOccluderGap = 0.15F;    ///< something nearer by this much hides a sample [m]
constexpr float kCollisionDeviation = 0.03F;
constexpr float kFloorDeviation = 0.02F;
constexpr float kProtraction = 0.45F;  ///< angle of a collarbone whose arm points straight forward [rad]
constexpr float kUsualSpine = 0.10F;   ///< deviation of either spine joint from straight [rad]
constexpr float kUsualArm = 1.0F;      ///< deviation of an arm from hanging, at shoulder and elbow [rad]
constexpr float kUsualLeg = 0.25F;     ///< deviation of a leg from straight, at hip and knee [rad]
constexpr float kRootSlack = 1.0001F;  ///< against rounding, where a distance is bounded before it is known

std::vector<Sample> makeSamples() {
  std::vector<Sample> samples;
  const auto& capsules = capsuleDefs();
  for (int i = 0; i < kCapsuleCount; ++i) {
    const Capsule& capsule = capsules[i];
    const bool wide = capsule.flat < 1.0F;
    const int count = wide ? 3 : (capsule.node == kLeftClavicle || capsule.node == kRightClavicle) ? 2 : 4;
    for (int k = 0; k < count; ++k) {
      const float along = (static_cast<float>(k) + 0.0F) / static_cast<float>(count - 1);
      if (wide) {
        for (const float aside : {-1.0F, 0.0F, 1.0F}) samples.push_back({i, along, aside});
      } else {
        samples.push_back({i, along, 0.0F});
      }
    }
  }
  return samples;
}

std::vector<CollisionPair> makePairs() {
  std::vector<CollisionPair> pairs;
  const auto& samples = samplesOfBody();
  const auto& capsules = capsuleDefs();
  const auto isOf = [](Node node, std::initializer_list<Node> left) {
    return std::any_of(left.begin(), left.end(), [&](Node n) { return node == n || node == n + 1; });
  };
  for (int s = 0; s < countOf(samples); ++s) {
    const Sample& sample = samples[s];
    const Node mine = capsules[sample.capsule].node;
    for (int c = 0; c < kCapsuleCount; ++c) {
      const Node other = capsules[c].node;
      const bool otherSide = mine >= kLeftClavicle && other >= kLeftClavicle && ((mine ^ other) & 1) != 0;
      const bool arm = isOf(mine, {kLeftForearm, kLeftHand}) || (isOf(mine, {kLeftUpperArm}) && sample.along > 0.9F);
      const bool trunk = other <= kNeck;
      const bool meets =
          (arm && trunk) || (arm && otherSide && isOf(other, {kLeftUpperArm, kLeftForearm, kLeftHand})) ||
          (arm && isOf(other, {kLeftThigh})) ||
          (isOf(mine, {kLeftShin, kLeftFoot}) && otherSide && isOf(other, {kLeftThigh, kLeftShin, kLeftFoot})) ||
          (isOf(mine, {kLeftThigh}) && sample.along > 0.5F && otherSide && isOf(other, {kLeftThigh}));
      if (meets) pairs.push_back({s, c});
    }
  }
  return pairs;
}
std::vector<BallLimit> makeLimits() {
  std::vector<BallLimit> limits;
  const auto add = [&](Node node, HumanBone bone, double times, float usual) {
    const JointRange& r = jointRange(bone);
    BallLimit l{};
    l.node = node;
    l.twistAxis = r.twistAxis.cast<float>();
    l.firstAxis = r.firstAxis.cast<float>();
    l.secondAxis = r.secondAxis.cast<float>();
    const auto range = [&](std::array<float, 2>& to, const AngleRange& from) {
      to[0] = from.min * times;
      to[1] = from.max * times;
    };
    range(l.twist, r.twist);
    range(l.first, r.first);
    range(l.second, r.second);
    l.usual = usual;
    limits.push_back(l);
  };
  add(kSpine, HumanBone::kChest, 1.5, kUsualSpine);
  add(kChest, HumanBone::kChest, 1.5, kUsualSpine);
  add(kNeck, HumanBone::kNeck, 2.0, 0.30F);
  add(kLeftUpperArm, HumanBone::kLeftUpperArm, 1.0, 0.0F);
  add(kRightUpperArm, HumanBone::kRightUpperArm, 1.0, 0.0F);
  add(kLeftThigh, HumanBone::kLeftUpperLeg, 1.0, 0.0F);
  add(kRightThigh, HumanBone::kRightUpperLeg, 1.0, 0.0F);
  return limits;
}

/// Whether a point is certainly farther than this from a capsule.
bool isFarther(const ShapedCapsule& c, const V3& position, float than) {
  const float ball = c.reach + than;
  if ((position - c.middle).squaredNorm() > ball * ball) return true;
  if (c.flat != 1.0F) return false;
  const V3 off = position - c.start;
  const float along = std::clamp(off.dot(c.axis) * c.inverseAbSq, 0.0F, 1.0F);
  const float tube = c.widest + than;
  return (off - along * c.axis).squaredNorm() > tube * tube;
}
}  // namespace

std::span<const Sample> samplesOfBody() {
  static const std::vector<Sample> samples = makeSamples();
  return samples;
}
std::span<const CollisionPair> collisionPairs() {
  static const std::vector<CollisionPair> pairs = makePairs();
  return pairs;
}
std::span<const BallLimit> ballLimits() {
  static const std::vector<BallLimit> limits = makeLimits();
  return limits;
}

void matchCapsule(const PosedModel& body, int capsule, const V3& position, const V3& normal, const V3& ray,
                  SurfaceMatch& best) {
  const ShapedCapsule& c = body.capsule[capsule];
  if (isFarther(c, position, best.bound)) return;
  const AxisHit axis = axisHit(body, c, position);
  const float least = (axis.length - axis.radius) / std::max(1.0F, c.flat);
  if (least > 0.0F && least * least > best.costSq) return;
  SurfaceHit hit = surfaceHit(body, c, axis);
  SurfaceMatch m;
  m.capsule = capsule;
  m.residual = hit.distance;
  m.at = position - hit.distance * hit.normal;
  m.pull = -hit.normal;
  const float facing = hit.normal.dot(ray);
  if (facing > 0.0F) {
    // The camera sees no back faces: a point behind the middle belongs to the capsule's outline at most.
    V3 rim = hit.normal - facing * ray;
    const float length = rim.norm();
    if (length > 1e-3F) {
      rim /= length;
      const float r = c.radiusA + hit.along * c.radiusAb;
      const V3 centre = position - (hit.distance + r) * hit.normal;
      m.at = centre + r * rim;
      const V3 gap = position - m.at;
      m.residual = gap.norm();
      if (m.residual > 1e-5F) m.pull = -gap / m.residual;
      hit.normal = rim;
    }
  }
  m.costSq = m.residual * m.residual;
  if (normal.squaredNorm() > 0.5F) m.costSq += kNormalWeight * kNormalWeight * (1.0F - hit.normal.dot(normal));
  if (m.costSq >= best.costSq) return;
  m.bound = kRootSlack * std::sqrt(m.costSq);
  best = m;
}

Ball ballOf(const PosedModel& body, const Sample& sample) {
  const ShapedCapsule& c = body.capsule[sample.capsule];
  const std::size_t node = c.node;
  V3 q = c.a + sample.along * c.ab;
  const float r = c.radiusA + sample.along * c.radiusAb;
  q.x() = q.x() / c.flat + sample.aside * (r / c.flat - r);
  return {body.position[node] + body.rotation[node] * q, std::min(r, r / c.flat)};
}

SamplePulls pullsOf(const BodyView& view, const PosedModel& body, const Sample& sample) {
  const Ball ball = ballOf(body, sample);
  SamplePulls out;
  out.at = ball.centre;
  const auto add = [&](const V3& derivative, float residual, float deviation, float width) {
    const Robust r = robust(residual * residual, width * width);
    const float each = 1.0F / (deviation * deviation);
    out.pull[out.count++] = {derivative, residual, each * r.weight, each * r.cost};
  };
  const float under = ball.radius - (ball.centre.y() - view.ground().value_or(-1e3F)) - 0.01F;
  if (under > 0.0F) add(-V3::UnitY(), under, kFloorDeviation, 0.2F);
  const BodyView::Sight sight = view.sightOf(ball.centre);
  if (!sight.inside) return out;
  if (!sight.person && sight.seen > 0.0F && sight.seen < sight.depth - kOccluderGap) return out;
  const float beside = sight.outside * sight.metresPerBlock + 0.75F * ball.radius;
  if (beside > 0.0F) add(sight.gradient, beside, kFreeDeviation, kFreeWidth);
  if (sight.person) {
    const float before = sight.seen - (sight.depth - ball.radius) - kFrontSlack;
    if (before > 0.0F) add(-sight.axis, before, kFreeDeviation, kFrontWidth);
  }
  return out;
}

Pull collisionOf(const PosedModel& body, const Ball& ball, int capsule) {
  const ShapedCapsule& other = body.capsule[capsule];
  const float reach = other.reach + ball.radius;
  if ((ball.centre - other.middle).squaredNorm() > reach * reach) return {};
  const SurfaceHit hit = distanceTo(body, other, ball.centre);
  const float deep = 0.8F * ball.radius - hit.distance;
  if (deep <= 0.0F) return {};
  constexpr float kEach = 1.0F / (kCollisionDeviation * kCollisionDeviation);
  return {-hit.normal, deep, kEach, kEach * deep * deep};
}

LimbRest restOf(Limb limb, const BodyPose& pose) {
  const BodyPose& rest = restPose();
  const Node up = upperNodeOf(limb), low = lowerNodeOf(limb);
  const float usual = limb == kLeftArm || limb == kRightArm ? kUsualArm : kUsualLeg;
  return {vectorOf(pose.turn[up] * rest.turn[up].conjugate()), pose.angle[low][0] - rest.angle[low][0],
          1.0F / (usual * usual)};
}

float protractionOf(const BodyPose& pose, std::size_t clavicle) {
  const bool left = clavicle == kLeftClavicle;
  const V3 arm = pose.turn[left ? kLeftUpperArm : kRightUpperArm] * V3(left ? 1.0F : -1.0F, 0.0F, 0.0F);
  return kProtraction * std::max(0.0F, arm.z());
}

V3 excessOf(const BallLimit& limit, const Q& turn) {
  const float along = turn.vec().dot(limit.twistAxis);
  float twist = 2.0F * std::atan2(along, turn.w());
  if (twist > 3.14159265F) twist -= 6.2831853F;
  if (twist < -3.14159265F) twist += 6.2831853F;
  const Q untwist(Eigen::AngleAxisf(-twist, limit.twistAxis));
  const Eigen::AngleAxisf swing(turn * untwist);
  float angle = swing.angle();
  if (angle > 3.14159265F) angle -= 6.2831853F;
  const float first = angle * swing.axis().dot(limit.firstAxis);
  const float second = angle * swing.axis().dot(limit.secondAxis);
  const auto beyond = [](float x, const std::array<float, 2>& range) {
    return std::max(0.0F, x - range[1]) + std::min(0.0F, x - range[0]);
  };
  const auto half = [](float x, const std::array<float, 2>& range) {
    return std::max(0.05F, x > 0.0F ? range[1] : -range[0]);
  };
  const float hf = half(first, limit.first);
  const float hs = half(second, limit.second);
  const float f = first / hf;
  const float s = second / hs;
  const float out = std::sqrt(f * f + s * s);
  const float over = out > 1.0F ? 1.0F - 1.0F / out : 0.0F;
  return {beyond(twist, limit.twist), over * first, over * second};
}

}  // namespace lorica::fit
