#include "capture/virtual_sensor/virtual_body.h"

#include <algorithm>
#include <array>
#include <vector>

namespace lorica {
namespace {

using B = HumanBone;

/// A stretched bone, and the bone at its end.
struct Stretch {
  B bone, end;
  double BodyProportions::*along;
};
constexpr std::array kStretches = {Stretch{B::kLeftUpperArm, B::kLeftLowerArm, &BodyProportions::arms},
                                   Stretch{B::kRightUpperArm, B::kRightLowerArm, &BodyProportions::arms},
                                   Stretch{B::kLeftLowerArm, B::kLeftHand, &BodyProportions::arms},
                                   Stretch{B::kRightLowerArm, B::kRightHand, &BodyProportions::arms},
                                   Stretch{B::kLeftUpperLeg, B::kLeftLowerLeg, &BodyProportions::legs},
                                   Stretch{B::kRightUpperLeg, B::kRightLowerLeg, &BodyProportions::legs},
                                   Stretch{B::kLeftLowerLeg, B::kLeftFoot, &BodyProportions::legs},
                                   Stretch{B::kRightLowerLeg, B::kRightFoot, &BodyProportions::legs}};
/// From the hips up; each ends at the next existing one.
constexpr std::array kTrunk = {B::kHips, B::kSpine, B::kChest, B::kUpperChest, B::kNeck};

/// Change of one joint's part of the mesh: `whole` is applied around the joint. Child joints move by `lengths` only.
struct Change {
  Mat3 lengths = Mat3::Identity();      ///< model axes
  Mat3 whole = Mat3::Identity();        ///< model axes
  Mat3 restLengths = Mat3::Identity();  ///< the joint's own axes
};

Mat3 along(const Vec3& axis, double lengthwise, double across) {
  return across * Mat3::Identity() + (lengthwise - across) * axis * axis.transpose();
}

/// Position of a descendant joint relative to a joint at rest.
Vec3 restPosition(const Skeleton& skeleton, JointIndex joint, JointIndex below) {
  Vec3 position = Vec3::Zero();
  for (JointIndex j = below; j != joint && j != kNoJoint; j = skeleton.joint(j).parent) {
    position = skeleton.joint(j).rest.matrix() * position;
  }
  return position;
}

double lowestOf(const TriMesh& mesh) {
  double lowest = mesh.vertices.empty() ? 0.0 : mesh.vertices.front().y();
  for (const Vec3& v : mesh.vertices) lowest = std::min(lowest, v.y());
  return lowest;
}

}  // namespace

Character withProportions(const Character& character, const BodyProportions& proportions) {
  const Skeleton& skeleton = character.skeleton;
  const std::size_t jointCount = skeleton.jointCount();
  std::vector<Affine3> modelFromJoint(jointCount);
  for (std::size_t j = 0; j < jointCount; ++j) modelFromJoint[j] = character.jointFromModel[j].inverse();

  std::vector<Change> changes(jointCount);
  const auto change = [&](B bone, B end, double lengthwise) {
    const JointIndex joint = skeleton.jointOf(bone);
    const JointIndex tip = skeleton.jointOf(end);
    if (joint == kNoJoint || tip == kNoJoint) return;
    const Vec3 axis = modelFromJoint[tip].translation() - modelFromJoint[joint].translation();
    const Vec3 restAxis = restPosition(skeleton, joint, tip);
    if (axis.norm() < 1e-6 || restAxis.norm() < 1e-9) return;
    Change& made = changes[joint];
    made.lengths = along(axis.normalized(), lengthwise, 1.0);
    made.whole = along(axis.normalized(), lengthwise, proportions.girth);
    made.restLengths = along(restAxis.normalized(), lengthwise, 1.0);
  };
  for (const Stretch& stretch : kStretches) change(stretch.bone, stretch.end, proportions.*stretch.along);
  for (std::size_t from = 0; from + 1 < kTrunk.size(); ++from) {
    std::size_t to = from + 1;
    while (to + 1 < kTrunk.size() && skeleton.jointOf(kTrunk[to]) == kNoJoint) ++to;
    change(kTrunk[from], kTrunk[to], proportions.trunk);
  }

  // Parents precede children: each joint moves with its parent's change. If the bind pose is a pose of the skeleton,
  // the changed bind pose is a pose of the changed skeleton.
  std::vector<Vec3> position(jointCount);
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (std::size_t j = 0; j < jointCount; ++j) {
    const JointIndex parent = joints[j].parent;
    position[j] = modelFromJoint[j].translation();
    if (parent == kNoJoint) continue;
    const std::size_t p = parent;
    position[j] = position[p] + changes[p].lengths * (position[j] - modelFromJoint[p].translation());
    joints[j].rest.translation = changes[p].restLengths * joints[j].rest.translation;
  }

  Character changed = character;
  for (std::size_t v = 0; v < changed.mesh.vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      const std::size_t j = character.influences[i].joint;
      const Vec3 from = character.mesh.vertices[v] - modelFromJoint[j].translation();
      sum += character.influences[i].weight * (position[j] + changes[j].whole * from);
    }
    changed.mesh.vertices[v] = sum;
  }

  const Vec3 lift(0.0, lowestOf(character.mesh) - lowestOf(changed.mesh), 0.0);
  for (Vec3& v : changed.mesh.vertices) v = proportions.height * (v + lift);
  for (std::size_t j = 0; j < jointCount; ++j) {
    modelFromJoint[j].translation() = proportions.height * (position[j] + lift);
    changed.jointFromModel[j] = modelFromJoint[j].inverse();
    if (joints[j].parent == kNoJoint) joints[j].rest.translation += lift;
    joints[j].rest.translation *= proportions.height;
  }
  Result<Skeleton> made = Skeleton::create(std::move(joints));
  LORICA_CHECK(made.ok(), "the joint order must match the character's");
  changed.skeleton = std::move(*made);
  const Aabb bounds = boundsOf(changed.mesh.vertices);
  changed.height = bounds.empty() ? 0.0 : bounds.max.y() - bounds.min.y();
  return changed;
}

}  // namespace lorica
