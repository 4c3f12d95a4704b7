#include "capture/tracking/fit/body_model.h"

#include "skinning/mannequin/mannequin_skeleton.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr float kDegree = 0.017453293F;

V3 bonePosition(HumanBone bone) {
  return mannequinJoint(bone).cast<float>();
}

V3 mirroredX(const V3& v) {
  return {-v.x(), v.y(), v.z()};
}
/// Rotation axes mirror as pseudovectors.
V3 mirroredAxis(const V3& v) {
  return {v.x(), -v.y(), -v.z()};
}

std::array<NodeDef, kNodeCount> makeNodes() {
  using B = HumanBone;
  std::array<NodeDef, kNodeCount> nodes;
  int dof = 0;
  const auto set = [&](Node node, int parent, const V3& position, int dofs, std::array<std::int8_t, 3> lengths,
                       std::int8_t girth) -> NodeDef& {
    NodeDef& def = nodes[node];
    def = {parent, position, dof, dofs, {V3::UnitX(), V3::UnitX()}, {0.0F, 0.0F}, {0.0F, 0.0F}, lengths, girth};
    dof += dofs;
    return def;
  };
  const std::int8_t no = kNoProportion;
  const V3 leftHip = bonePosition(B::kLeftUpperLeg);
  set(kPelvis, -1, {0.0F, leftHip.y(), leftHip.z()}, 6, {kHipBreadth, kTrunkLength, no}, kTrunkGirth);
  set(kSpine, kPelvis, {0.0F, 1.07F, -0.017F}, 3, {no, kTrunkLength, no}, kTrunkGirth);
  set(kChest, kSpine, {0.0F, 1.21F, -0.022F}, 3, {no, kTrunkLength, no}, kTrunkGirth);
  set(kNeck, kChest, bonePosition(B::kNeck), 3, {kHeadSize, kHeadSize, kHeadSize}, kHeadSize);
  int side = 0;
  const auto at = [&](B bone) { return side == 0 ? bonePosition(bone) : mirroredX(bonePosition(bone)); };
  const auto axis = [&](const V3& v) { return side == 0 ? v : mirroredAxis(v); };
  const auto node = [&](Node left) { return static_cast<Node>(left + side); };
  for (side = 0; side < 2; ++side) {
    NodeDef& clavicle =
        set(node(kLeftClavicle), kChest, at(B::kLeftShoulder), 2, {kShoulderBreadth, no, no}, kTrunkGirth);
    clavicle.axis = {axis(V3::UnitZ()), axis(-V3::UnitY())};
    clavicle.min = {-12 * kDegree, -18 * kDegree};
    clavicle.max = {35 * kDegree, 28 * kDegree};
    set(node(kLeftUpperArm), node(kLeftClavicle), at(B::kLeftUpperArm), 3, {kUpperArmLength, no, no}, kLimbGirth);
    NodeDef& forearm =
        set(node(kLeftForearm), node(kLeftUpperArm), at(B::kLeftLowerArm), 1, {kForearmLength, no, no}, kLimbGirth);
    forearm.axis[0] = axis(-V3::UnitY());
    forearm.max[0] = 150 * kDegree;
    forearm.min[0] = -3 * kDegree;
    NodeDef& hand = set(node(kLeftHand), node(kLeftForearm), at(B::kLeftHand), 2, {kForearmLength, no, no}, kLimbGirth);
    hand.axis = {axis(V3::UnitZ()), axis(-V3::UnitY())};
    hand.min = {-70 * kDegree, -70 * kDegree};
    hand.max = {70 * kDegree, 70 * kDegree};
  }
  for (side = 0; side < 2; ++side) {
    set(node(kLeftThigh), kPelvis, at(B::kLeftUpperLeg), 3, {no, kThighLength, no}, kLimbGirth);
    NodeDef& shin = set(node(kLeftShin), node(kLeftThigh), at(B::kLeftLowerLeg), 1, {no, kShinLength, no}, kLimbGirth);
    shin.axis[0] = V3::UnitX();
    shin.max[0] = 140 * kDegree;
    shin.min[0] = -3 * kDegree;
    NodeDef& foot = set(node(kLeftFoot), node(kLeftShin), at(B::kLeftFoot), 2, {no, no, no}, no);
    foot.axis = {V3::UnitX(), axis(V3::UnitY())};
    foot.min = {-30 * kDegree, -25 * kDegree};
    foot.max = {50 * kDegree, 30 * kDegree};
  }
  return nodes;
}

std::array<Capsule, kCapsuleCount> makeCapsules() {
  // Of the left side and the middle, in model space. Fitted to the mannequin's skin by bench programs; see
  // docs/TRACKING.md.
  const std::array<Capsule, 13> rows = {{
      {kPelvis, {0.0F, 0.905F, -0.010F}, {0.0F, 1.020F, -0.001F}, 0.105F, 0.102F, 0.64F},
      {kSpine, {0.0F, 1.030F, 0.003F}, {0.0F, 1.190F, 0.001F}, 0.094F, 0.098F, 0.72F},
      {kChest, {0.0F, 1.220F, -0.001F}, {0.0F, 1.345F, -0.008F}, 0.110F, 0.121F, 0.71F},
      {kNeck, {0.0F, 1.470F, -0.026F}, {0.0F, 1.560F, -0.012F}, 0.060F, 0.058F, 1.0F},
      {kNeck, {0.0F, 1.612F, 0.003F}, {0.0F, 1.654F, 0.000F}, 0.099F, 0.103F, 1.34F},
      {kLeftClavicle, {0.060F, 1.422F, -0.023F}, {0.165F, 1.403F, -0.020F}, 0.064F, 0.062F, 1.0F},
      {kLeftUpperArm, {0.200F, 1.409F, -0.019F}, {0.455F, 1.409F, -0.022F}, 0.052F, 0.036F, 1.0F},
      {kLeftForearm, {0.475F, 1.409F, -0.020F}, {0.690F, 1.408F, -0.014F}, 0.040F, 0.026F, 1.0F},
      {kLeftHand, {0.715F, 1.405F, -0.008F}, {0.848F, 1.403F, -0.012F}, 0.033F, 0.023F, 1.0F},
      {kLeftThigh, {0.094F, 0.820F, -0.012F}, {0.097F, 0.500F, 0.002F}, 0.089F, 0.058F, 1.0F},
      {kLeftShin, {0.097F, 0.450F, -0.006F}, {0.098F, 0.335F, -0.023F}, 0.053F, 0.056F, 1.0F},
      {kLeftShin, {0.098F, 0.335F, -0.023F}, {0.099F, 0.100F, -0.035F}, 0.053F, 0.033F, 1.0F},
      {kLeftFoot, {0.099F, 0.047F, -0.045F}, {0.106F, 0.030F, 0.125F}, 0.044F, 0.036F, 1.0F},
  }};
  const auto& nodes = nodeDefs();
  std::array<Capsule, kCapsuleCount> capsules;
  std::size_t n = 0;
  for (const Capsule& row : rows) {
    const V3 origin = nodes[row.node].position;
    capsules[n++] = {row.node, row.a - origin, row.b - origin, row.radiusA, row.radiusB, row.flat};
    if (row.node < kLeftClavicle) continue;
    const V3 right = mirroredX(origin);
    capsules[n++] = {static_cast<Node>(row.node + 1),
                     mirroredX(row.a) - right,
                     mirroredX(row.b) - right,
                     row.radiusA,
                     row.radiusB,
                     row.flat};
  }
  // Hands are not flattened: their capsules have the width of a fist.
  return capsules;
}

Q turnBy(const V3& vector) {
  const float angle = vector.norm();
  if (angle < 1e-9F) return Q::Identity();
  return Q(Eigen::AngleAxisf(angle, vector / angle));
}

}  // namespace

const std::array<NodeDef, kNodeCount>& nodeDefs() {
  static const std::array<NodeDef, kNodeCount> nodes = makeNodes();
  return nodes;
}

const std::array<Capsule, kCapsuleCount>& capsuleDefs() {
  static const std::array<Capsule, kCapsuleCount> capsules = makeCapsules();
  return capsules;
}

V3 vectorOf(const Q& turn) {
  const Q q = turn.w() < 0.0F ? Q(-turn.w(), -turn.x(), -turn.y(), -turn.z()) : turn;
  const float s = q.vec().norm();
  if (s < 1e-7F) return 2.0F * q.vec();
  return (2.0F * std::atan2(s, q.w()) / s) * q.vec();
}

BodyPose stepped(const BodyPose& pose, const Step& step) {
  BodyPose out = pose;
  const auto& nodes = nodeDefs();
  for (std::size_t n = 0; n < kNodeCount; ++n) {
    const NodeDef& def = nodes[n];
    if (n == kPelvis) out.root += step.segment<3>(0);
    const int first = n == kPelvis ? 3 : def.firstDof;
    if (def.dofCount >= 3) {
      out.turn[n] = (turnBy(step.segment<3>(first)) * out.turn[n]).normalized();
      continue;
    }
    for (int i = 0; i < def.dofCount; ++i) {
      const std::size_t k = i;
      out.angle[n][k] = std::clamp(out.angle[n][k] + step[first + i], def.min[k], def.max[k]);
    }
  }
  return out;
}

Step stepBetween(const BodyPose& from, const BodyPose& to) {
  Step step;
  const auto& nodes = nodeDefs();
  for (std::size_t n = 0; n < kNodeCount; ++n) {
    const NodeDef& def = nodes[n];
    if (n == kPelvis) step.segment<3>(0) = to.root - from.root;
    const int first = n == kPelvis ? 3 : def.firstDof;
    if (def.dofCount >= 3) {
      step.segment<3>(first) = vectorOf(to.turn[n] * from.turn[n].conjugate());
      continue;
    }
    for (int i = 0; i < def.dofCount; ++i) {
      const std::size_t k = i;
      step[first + i] = to.angle[n][k] - from.angle[n][k];
    }
  }
  return step;
}

void poseBody(const BodyPose& pose, const Proportions& proportions, PosedModel& body) {
  const auto& nodes = nodeDefs();
  const auto factor = [&](int p) { return p < 0 ? 1.0F : proportions.factor[p]; };
  const float size = proportions.factor[kSize];
  for (std::size_t n = 0; n < kNodeCount; ++n) {
    const NodeDef& def = nodes[n];
    const float girth = factor(def.girth);
    for (int i = 0; i < 3; ++i) {
      const std::int8_t along = def.lengthsAlong[i];
      body.scale[n][i] = size * (along >= 0 ? factor(along) : (i == 2 ? girth : 1.0F));
    }
    body.girth[n] = size * girth;
    const bool isRoot = def.parent < 0;
    const M3 above = isRoot ? M3::Identity() : body.rotation[def.parent];
    if (isRoot) {
      body.position[n] = pose.root;
    } else {
      const std::size_t parent = def.parent;
      body.position[n] =
          body.position[parent] + above * body.scale[parent].cwiseProduct(def.position - nodes[parent].position);
    }
    int dof = def.firstDof;
    if (isRoot) {
      for (int i = 0; i < 3; ++i) body.twist[dof++] = {V3::Zero(), V3::Unit(i)};
    }
    const auto turnAbout = [&](const V3& axis) {
      body.twist[dof++] = {axis, V3(body.position[n] - pose.root).cross(axis)};
    };
    if (def.dofCount >= 3) {
      for (int i = 0; i < 3; ++i) turnAbout(above.col(i));
      body.rotation[n] = above * pose.turn[n].toRotationMatrix();
      continue;
    }
    M3 rotation = above;
    for (int i = 0; i < def.dofCount; ++i) {
      const std::size_t k = i;
      turnAbout(rotation * def.axis[k]);
      rotation = rotation * Eigen::AngleAxisf(pose.angle[n][k], def.axis[k]).toRotationMatrix();
    }
    body.rotation[n] = rotation;
  }
  const auto& capsules = capsuleDefs();
  for (std::size_t i = 0; i < kCapsuleCount; ++i) {
    const Capsule& def = capsules[i];
    ShapedCapsule& out = body.capsule[i];
    const std::size_t n = def.node;
    V3 a = def.a.cwiseProduct(body.scale[n]);
    V3 b = def.b.cwiseProduct(body.scale[n]);
    out.node = def.node;
    out.radiusA = def.radiusA * body.girth[n];
    out.radiusAb = def.radiusB * body.girth[n] - out.radiusA;
    out.flat = def.flat;
    out.middle = body.position[n] + body.rotation[n] * (0.5F * (a + b));
    out.reach = 0.5F * (b - a).norm() + std::max(def.radiusA, def.radiusB) * body.girth[n] / std::min(def.flat, 1.0F);
    out.start = body.position[n] + body.rotation[n] * a;
    out.axis = body.rotation[n] * (b - a);
    std::tie(body.balls.x[i], body.balls.y[i], body.balls.z[i]) =
        std::tie(out.middle.x(), out.middle.y(), out.middle.z());
    body.balls.radius[i] = out.reach;
    out.widest = std::max(def.radiusA, def.radiusB) * body.girth[n];
    a.x() *= def.flat;
    b.x() *= def.flat;
    out.a = a;
    out.ab = b - a;
    out.inverseAbSq = 1.0F / out.ab.squaredNorm();
  }
}

V3 positionIn(const PosedModel& body, Node node, const V3& modelPosition) {
  return body.position[node] +
         body.rotation[node] * body.scale[node].cwiseProduct(modelPosition - nodeDefs()[node].position);
}

V3 headOf(const PosedModel& body) {
  static const V3 head = bonePosition(HumanBone::kHead);
  return positionIn(body, kNeck, head);
}

void readJoints(const PosedModel& body, SkeletonFrame& frame) {
  using J = BodyJoint;
  const auto put = [&](J joint, const V3& position, const M3& rotation) {
    TrackedJoint& out = frame[joint];
    out.position = position.cast<double>();
    out.orientation = Quat(rotation.cast<double>()).normalized();
    out.confidence = 0.0;
  };
  put(J::kNeck, body.position[kNeck], body.rotation[kNeck]);
  put(J::kHead, headOf(body), body.rotation[kNeck]);
  int node = kLeftUpperArm;  // the limbs' nodes are in the order of their joints
  for (const J left : kLeftJoints) {
    for (const J joint : {left, rightOf(left)}) {
      put(joint, body.position[node], body.rotation[node]);
      ++node;
    }
  }
  put(J::kTorso, 0.25F * (body.position[kLeftThigh] + body.position[kRightThigh]) + 0.5F * body.position[kNeck],
      body.rotation[kChest]);
}

}  // namespace lorica::fit
