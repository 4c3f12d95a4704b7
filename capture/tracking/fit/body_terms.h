#pragma once

#include "capture/tracking/fit/body_model.h"
#include "capture/tracking/fit/body_view.h"
#include "capture/tracking/fit/limb_pose.h"

#include <array>
#include <span>

/// The terms of a fit's cost, one point, ball or joint at a time. BodyFitter and LimbSearch sum them.
namespace lorica::fit {

inline constexpr float kPointDeviation = 0.02F;  ///< [m]
inline constexpr float kPointCount = 600.0F;     ///< points are weighted as if there were this many
inline constexpr float kFrontSlack = 0.03F;      ///< how far the body may lie in front of the seen surface [m]
inline constexpr float kLimitDeviation = 0.08F;  ///< [rad]

/// Geman and McClure's robust square, 0 to width^2, and its weight.
struct Robust {
  float cost, weight;
};
[[nodiscard]] inline Robust robust(float square, float widthSq) {
  const float k = 1.0F / (1.0F + square / widthSq);
  return {square * k, k * k};
}

/// A seen point matched to the body.
struct SurfaceMatch {
  int capsule = 0;
  float residual = 0.0F;  ///< [m]
  float costSq = 1e9F;    ///< squared residual, plus the difference of the normals [m^2]
  float bound = 4e4F;     ///< at least the root of costSq [m]
  V3 at = V3::Zero();     ///< on the surface
  V3 pull = V3::Zero();   ///< derivative of the residual with respect to the motion of `at`
};
/// Replaces the best match so far if the capsule is a better one.
void matchCapsule(const PosedModel& body, int capsule, const V3& position, const V3& normal, const V3& ray,
                  SurfaceMatch& best);

/// A ball of a capsule, tested against the image.
struct Sample {
  int capsule;
  float along;  ///< 0 at a, 1 at b
  float aside;  ///< -1, 0, 1: for a flat capsule, the ball at that end of its width
};
[[nodiscard]] std::span<const Sample> samplesOfBody();

struct Ball {
  V3 centre;
  float radius;
};
[[nodiscard]] Ball ballOf(const PosedModel& body, const Sample& sample);

/// One squared residual and its derivative.
struct Pull {
  V3 derivative = V3::Zero();
  float residual = 0.0F;
  float weight = 0.0F;
  float cost = 0.0F;
};
struct SamplePulls {
  V3 at;
  std::array<Pull, 3> pull;
  int count = 0;
};
/// Penalties for lying below the floor, outside the outline, or in front of the seen surface.
[[nodiscard]] SamplePulls pullsOf(const BodyView& view, const PosedModel& body, const Sample& sample);

/// Which samples must not be inside which capsules; sorted by sample.
struct CollisionPair {
  int sample;
  int capsule;
};
[[nodiscard]] std::span<const CollisionPair> collisionPairs();
[[nodiscard]] Pull collisionOf(const PosedModel& body, const Ball& ball, int capsule);

/// Limits of a free node, following JointRange, and its usual deviation from rest.
struct BallLimit {
  int node;
  V3 twistAxis, firstAxis, secondAxis;
  std::array<float, 2> twist, first, second;
  float usual;  ///< deviation from rest [rad]; 0 = no preference
};
[[nodiscard]] std::span<const BallLimit> ballLimits();
/// How far a limb is from restPose(). Next to what the image shows this is little; it decides about limbs that are not
/// seen.
struct LimbRest {
  V3 turn;       ///< of the upper limb [rad]
  float bend;    ///< of elbow or knee [rad]
  float weight;  ///< 1 / deviation^2
  [[nodiscard]] float cost() const { return weight * (turn.squaredNorm() + bend * bend); }
};
[[nodiscard]] LimbRest restOf(Limb limb, const BodyPose& pose);
/// Usual forward angle of a collarbone [rad]: an arm that points forward takes its shoulder along.
[[nodiscard]] float protractionOf(const BodyPose& pose, std::size_t clavicle);
/// How far a rotation exceeds its range: three residuals [rad].
[[nodiscard]] V3 excessOf(const BallLimit& limit, const Q& turn);

}  // namespace lorica::fit
