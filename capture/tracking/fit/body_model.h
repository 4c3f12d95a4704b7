#pragma once

#include "capture/skeleton_frame.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>

/// The body that is fitted to depth: a tree of 18 nodes with 43 degrees of freedom, covered by tapered capsules. Its
/// dimensions are those of the built-in mannequin, so its joints are those of the humanoid bones. Single precision is
/// enough: the accuracy needed is a millimetre in five metres.
namespace lorica::fit {

using V3 = Eigen::Vector3f;
using M3 = Eigen::Matrix3f;
using Q = Eigen::Quaternionf;

enum Node : std::uint8_t {
  kPelvis,
  kSpine,
  kChest,
  kNeck,
  kLeftClavicle,
  kRightClavicle,
  kLeftUpperArm,
  kRightUpperArm,
  kLeftForearm,
  kRightForearm,
  kLeftHand,
  kRightHand,
  kLeftThigh,
  kRightThigh,
  kLeftShin,
  kRightShin,
  kLeftFoot,
  kRightFoot,
};
inline constexpr int kNodeCount = 18;
inline constexpr int kDofCount = 43;

/// Thighs, shins and feet: the last nodes, capsules and degrees of freedom of the body.
[[nodiscard]] constexpr bool isOfLeg(int node) {
  return node >= kLeftThigh;
}

/// How a body differs from the mannequin, as factors; symmetric left and right.
enum Proportion : std::uint8_t {
  kSize,  ///< of the whole body
  kTrunkLength,
  kShoulderBreadth,
  kHipBreadth,
  kUpperArmLength,
  kForearmLength,
  kThighLength,
  kShinLength,
  kTrunkGirth,
  kLimbGirth,
  kHeadSize,
};
inline constexpr float kMannequinHeight = 1.752F;  ///< whose proportions are 1 [m]
inline constexpr int kProportionCount = 11;
inline constexpr std::int8_t kNoProportion = -1;

struct Proportions {
  std::array<float, kProportionCount> factor;
  Proportions() { factor.fill(1.0F); }
};

/// How a node rotates in its parent: freely, or about one or two axes in sequence (rotation = about first * about
/// second).
struct NodeDef {
  int parent;
  V3 position;  ///< in the mannequin's T-pose, model space [m]
  int firstDof;
  int dofCount;  ///< 3: free (the pelvis has 6, position first); 2 and 1: axes
  std::array<V3, 2> axis;
  std::array<float, 2> min, max;            ///< of the angles [rad]
  std::array<std::int8_t, 3> lengthsAlong;  ///< Proportion that scales x, y, z in this node, or kNoProportion
  std::int8_t girth;
};
[[nodiscard]] const std::array<NodeDef, kNodeCount>& nodeDefs();

/// A tapered capsule, flattened or widened along its node's x axis: a ball of radius r reaches r / flat along x.
struct Capsule {
  Node node;
  V3 a, b;  ///< in the node, of the mannequin [m]
  float radiusA, radiusB;
  float flat;
};
inline constexpr int kCapsuleCount = 21;
[[nodiscard]] const std::array<Capsule, kCapsuleCount>& capsuleDefs();

/// Free nodes store a rotation, the others their angles.
struct BodyPose {
  V3 root = V3::Zero();                                  ///< midpoint between the hips, floor frame [m]
  std::array<Q, kNodeCount> turn;                        ///< parentFromNode; for the pelvis floorFromNode
  std::array<std::array<float, 2>, kNodeCount> angle{};  ///< [rad]
  BodyPose() { turn.fill(Q::Identity()); }
};

using Step = Eigen::Matrix<float, kDofCount, 1>;
/// Applies a step: free nodes rotate by a rotation vector in their parent's frame; angles are added and clamped to
/// their limits.
[[nodiscard]] BodyPose stepped(const BodyPose& pose, const Step& step);
/// The rotation vector of a turn, at most half a revolution [rad].
[[nodiscard]] V3 vectorOf(const Q& turn);
/// The step that leads from one pose to another.
[[nodiscard]] Step stepBetween(const BodyPose& from, const BodyPose& to);

/// A capsule prepared for distance queries: everything in floor frame units.
struct ShapedCapsule {
  int node;
  V3 a, ab;  ///< in the node; x already flattened
  float inverseAbSq;
  float radiusA, radiusAb;
  float flat;
  V3 middle;       ///< of its bounding ball, floor frame
  float reach;     ///< radius of its bounding ball
  V3 start, axis;  ///< a, and from a to b, floor frame
  float widest;    ///< the larger radius
};

/// The bounding balls of all capsules side by side, to compare a point with all at once.
struct CapsuleBalls {
  static constexpr int kRows = (kCapsuleCount + 7) / 8 * 8;  ///< whole vectors; those after the last ball hold nothing
  using Column = Eigen::Array<float, kRows, 1>;
  Column x = Column::Zero(), y = Column::Zero(), z = Column::Zero();  ///< floor frame
  Column radius = Column::Constant(-1e9F);

  /// For each ball, a number that is positive if no point of it is this near.
  [[nodiscard]] Column beyond(const V3& p, float than) const {
    const Column reach = (radius + than).max(0.0F);
    return (x - p.x()).square() + (y - p.y()).square() + (z - p.z()).square() - reach.square();
  }
};

/// A degree of freedom as a twist: per unit, a point s of its subtree moves by turn x (s - root) + move, where root is
/// the position of the pelvis. An origin close to the body keeps single precision accurate.
struct Twist {
  V3 turn, move;
};

/// A pose with all derived quantities.
struct PosedModel {
  std::array<M3, kNodeCount> rotation;  ///< floorFromNode
  std::array<V3, kNodeCount> position;
  std::array<V3, kNodeCount> scale;  ///< of coordinates in the node
  std::array<float, kNodeCount> girth;
  std::array<ShapedCapsule, kCapsuleCount> capsule;
  CapsuleBalls balls;
  std::array<Twist, kDofCount> twist;
};
void poseBody(const BodyPose& pose, const Proportions& proportions, PosedModel& body);

/// Position of a point in a node, given in the mannequin's T-pose in model space.
[[nodiscard]] V3 positionIn(const PosedModel& body, Node node, const V3& modelPosition);

/// The head joint.
[[nodiscard]] V3 headOf(const PosedModel& body);

/// The 15 joints, with orientations as in TrackedJoint; confidences are 0.
void readJoints(const PosedModel& body, SkeletonFrame& frame);

/// A point relative to the nearest point of a capsule's axis, in the capsule's node with x flattened.
struct AxisHit {
  V3 offset;
  float length;  ///< of the offset
  float radius;  ///< of the capsule there
  float along;   ///< 0 at a, 1 at b
};
[[nodiscard]] inline AxisHit axisHit(const PosedModel& body, const ShapedCapsule& c, const V3& p) {
  const std::size_t node = c.node;
  V3 q = body.rotation[node].transpose() * (p - body.position[node]);
  q.x() *= c.flat;
  q -= c.a;
  float t = q.dot(c.ab) * c.inverseAbSq;
  t = t < 0.0F ? 0.0F : (t > 1.0F ? 1.0F : t);
  q -= t * c.ab;
  return {q, q.norm(), c.radiusA + t * c.radiusAb, t};
}

/// Signed distance of a point from a capsule's surface.
struct SurfaceHit {
  float distance;  ///< [m], negative inside
  V3 normal;       ///< outward, floor frame
  float along;     ///< 0 at a, 1 at b
};
[[nodiscard]] inline SurfaceHit surfaceHit(const PosedModel& body, const ShapedCapsule& c, const AxisHit& axis) {
  V3 gradient = axis.length > 1e-6F ? V3(axis.offset / axis.length) : V3::UnitZ();
  gradient.x() *= c.flat;
  const float slope = gradient.norm();
  return {(axis.length - axis.radius) / slope, body.rotation[c.node] * (gradient / slope), axis.along};
}
[[nodiscard]] inline SurfaceHit distanceTo(const PosedModel& body, const ShapedCapsule& c, const V3& p) {
  return surfaceHit(body, c, axisHit(body, c, p));
}

}  // namespace lorica::fit
