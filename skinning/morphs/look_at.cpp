#include "skinning/morphs/look_at.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {

double LookAtRange::operator()(double angle) const {
  return std::min(std::abs(angle), inputMax) / inputMax * output;
}

Gaze gazeTowards(const LookAt& lookAt, const Affine3& worldFromHead, const Vec3& target) {
  if (lookAt.head == kNoJoint) return {};
  const Vec3 p = lookAt.modelFromHead * (worldFromHead.inverse() * target - lookAt.offsetFromHead);
  if (!p.allFinite() || p.squaredNorm() == 0.0) return {};
  return {std::atan2(p.x(), p.z()), std::atan2(-p.y(), std::hypot(p.x(), p.z()))};
}

Gaze followed(const Gaze& gaze) {
  constexpr double kWhole = std::numbers::pi / 3.0;
  constexpr double kNone = std::numbers::pi / 2.0;
  const double share = std::clamp((kNone - std::abs(gaze.yaw)) / (kNone - kWhole), 0.0, 1.0);
  return {share * gaze.yaw, share * gaze.pitch};
}

GazeWeights gazeWeights(const LookAt& lookAt, const Gaze& gaze) {
  GazeWeights weights;
  if (lookAt.kind != LookAtKind::kExpression) return weights;
  (gaze.yaw > 0.0 ? weights.left : weights.right) = lookAt.outer(gaze.yaw);
  if (gaze.pitch > 0.0) {
    weights.down = lookAt.down(gaze.pitch);
  } else {
    weights.up = lookAt.up(gaze.pitch);
  }
  return weights;
}

std::array<Quat, 2> eyeRotations(const LookAt& lookAt, const Gaze& gaze) {
  std::array<Quat, 2> rotations = {Quat::Identity(), Quat::Identity()};
  if (lookAt.kind != LookAtKind::kBone) return rotations;
  const bool toLeft = gaze.yaw > 0.0;
  const double pitch = gaze.pitch > 0.0 ? lookAt.down(gaze.pitch) : -lookAt.up(gaze.pitch);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const LookAtRange& range = toLeft == (eye == 0) ? lookAt.outer : lookAt.inner;
    const double yaw = (toLeft ? 1.0 : -1.0) * range(gaze.yaw);
    rotations[eye] = Eigen::AngleAxisd(yaw, Vec3::UnitY()) * Eigen::AngleAxisd(pitch, Vec3::UnitX());
  }
  return rotations;
}

void turnEyes(const Character& character, const LookAt& lookAt, const Gaze& gaze, std::span<Affine3> worldFromModel) {
  if (lookAt.kind != LookAtKind::kBone) return;
  const Skeleton& skeleton = character.skeleton;
  LORICA_CHECK(worldFromModel.size() == character.jointFromModel.size(), "one transform per joint");
  const std::array<Quat, 2> turns = eyeRotations(lookAt, gaze);
  const std::array<JointIndex, 2> eyes = {lookAt.leftEye, lookAt.rightEye};
  const std::array<Quat, 2> rests = {lookAt.modelFromLeftEye, lookAt.modelFromRightEye};
  for (std::size_t e = 0; e < 2; ++e) {
    const JointIndex eye = eyes[e];
    if (eye == kNoJoint || turns[e].vec().isZero()) continue;
    // The rotation is about the model's axes at rest, so in the eye's own frame it is conjugated by its rest rotation.
    const Quat turn = rests[e].conjugate() * turns[e] * rests[e];
    const Affine3 worldFromEye = worldFromModel[eye] * character.jointFromModel[eye].inverse();
    const Affine3 moved = worldFromEye * turn * worldFromEye.inverse();
    for (JointIndex j = eye; j < skeleton.jointCount(); ++j) {
      JointIndex ancestor = j;
      while (ancestor > eye) ancestor = skeleton.joint(ancestor).parent;  // parents precede children
      if (ancestor == eye) worldFromModel[j] = moved * worldFromModel[j];
    }
  }
}

}  // namespace lorica
