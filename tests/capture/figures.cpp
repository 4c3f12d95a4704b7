#include "tests/capture/figures.h"

#include <cmath>
#include <random>
#include <string>

namespace lorica::test {
namespace {

/// The same on every standard library, unlike std::uniform_real_distribution.
double uniform(std::mt19937& random, double from, double to) {
  return from + (to - from) * (static_cast<double>(random()) / 4294967296.0);
}

Quat randomRotation(std::mt19937& random) {
  Quat q;
  do {
    for (int i = 0; i < 4; ++i) q.coeffs()[i] = uniform(random, -1.0, 1.0);
  } while (q.norm() > 1.0 || q.norm() < 0.1);
  return q.normalized();
}

Quat about(const Vec3& axis, double angle) {
  return Quat(Eigen::AngleAxisd(angle, axis));
}

/// Joints of a figure in T-pose, in world positions, before their axes are chosen.
struct Draft {
  struct Entry {
    HumanBone bone;
    int parent;
    Vec3 position;
    Quat turn;  ///< from T-pose to rest pose, world
  };
  std::vector<Entry> entries;

  int add(HumanBone bone, int parent, const Vec3& position, const Quat& turn) {
    entries.push_back({bone, parent, position, turn});
    return static_cast<int>(entries.size()) - 1;
  }
};

Draft draftFigure(const FigureSettings& s) {
  using B = HumanBone;
  Draft draft;
  const Quat none = Quat::Identity();
  const double hipHeight = 0.08 + s.thigh + s.shin;
  const int hips = draft.add(B::kHips, -1, {0, hipHeight + 0.04, 0}, none);
  int chest = draft.add(B::kSpine, hips, {0, hipHeight + 0.12, 0}, none);
  if (s.fullSpine) {
    chest = draft.add(B::kChest, chest, {0, hipHeight + 0.25, 0}, none);
    chest = draft.add(B::kUpperChest, chest, {0, hipHeight + 0.37, 0}, none);
  }
  const double neckHeight = hipHeight + 0.53;
  const int neck = draft.add(B::kNeck, chest, {0, neckHeight, 0}, none);
  draft.add(B::kHead, neck, {0, neckHeight + 0.11, 0}, none);
  for (const bool left : {true, false}) {
    const double m = left ? 1.0 : -1.0;
    const double y = neckHeight - 0.05;
    const Quat down = about(Vec3::UnitZ(), -m * s.armsDown);
    const Quat bent = down * about(Vec3::UnitY(), -m * s.elbowsBent);
    int parent = chest;
    if (s.fullSpine) parent = draft.add(left ? B::kLeftShoulder : B::kRightShoulder, chest, {m * 0.04, y, 0}, none);
    double x = 0.18;
    parent = draft.add(left ? B::kLeftUpperArm : B::kRightUpperArm, parent, {m * x, y, 0}, down);
    x += s.upperArm;
    parent = draft.add(left ? B::kLeftLowerArm : B::kRightLowerArm, parent, {m * x, y, 0}, bent);
    x += s.forearm;
    parent = draft.add(left ? B::kLeftHand : B::kRightHand, parent, {m * x, y, 0}, bent);
    draft.add(left ? B::kLeftMiddleProximal : B::kRightMiddleProximal, parent, {m * (x + 0.08), y, 0}, bent);
  }
  for (const bool left : {true, false}) {
    const double m = left ? 1.0 : -1.0;
    const Quat apart = about(Vec3::UnitZ(), m * s.legsApart);
    int parent = draft.add(left ? B::kLeftUpperLeg : B::kRightUpperLeg, hips, {m * 0.09, hipHeight, 0}, apart);
    parent = draft.add(left ? B::kLeftLowerLeg : B::kRightLowerLeg, parent, {m * 0.09, 0.08 + s.shin, 0}, apart);
    parent = draft.add(left ? B::kLeftFoot : B::kRightFoot, parent, {m * 0.09, 0.08, 0}, none);
    if (s.fullSpine) draft.add(left ? B::kLeftToes : B::kRightToes, parent, {m * 0.09, 0.02, s.toesAhead}, none);
  }
  return draft;
}

}  // namespace

Figure makeFigure(const FigureSettings& settings) {
  std::mt19937 random(settings.seed);
  const Draft draft = draftFigure(settings);
  Figure figure;
  std::vector<Joint> joints;
  std::vector<Affine3> worldFromJoint;
  if (settings.armature) {
    Joint root;
    root.name = "Armature";
    root.rest.rotation = about(Vec3::UnitX(), -degrees(90.0));
    root.rest.scale = Vec3::Constant(0.01);
    worldFromJoint.push_back(root.rest.matrix());
    joints.push_back(root);
    figure.tposeRotation.push_back(root.rest.rotation);
  }
  const std::size_t offset = joints.size();
  const Quat yaw = about(Vec3::UnitY(), settings.yaw);
  double lowest = 0.0;
  std::vector<Vec3> restPosition;
  for (const Draft::Entry& e : draft.entries) {
    if (e.parent < 0) {
      restPosition.push_back(e.position);
    } else {
      const Draft::Entry& p = draft.entries[e.parent];
      restPosition.push_back(restPosition[e.parent] + p.turn * (e.position - p.position));
    }
    if (e.bone == HumanBone::kLeftFoot) lowest = restPosition.back().y() - e.position.y();
  }
  for (std::size_t i = 0; i < draft.entries.size(); ++i) {
    const Draft::Entry& e = draft.entries[i];
    Joint joint;
    joint.name = std::string(nameOf(e.bone));
    joint.bone = e.bone;
    const Quat axes = settings.crookedAxes ? randomRotation(random) : Quat::Identity();
    figure.tposeRotation.push_back(axes);
    joint.parent = e.parent < 0 ? (settings.armature ? 0 : kNoJoint) : e.parent + static_cast<JointIndex>(offset);
    const Affine3 parent = joint.parent == kNoJoint ? Affine3::Identity() : worldFromJoint[joint.parent];
    const Vec3 position = yaw * Vec3(settings.scale * (restPosition[i] - Vec3(0, lowest, 0)));
    const Quat rotation = yaw * e.turn * axes;
    joint.rest.translation = parent.inverse() * position;
    const Quat parentRotation = Quat(Mat3(parent.linear() / std::cbrt(parent.linear().determinant())));
    joint.rest.rotation = (parentRotation.conjugate() * rotation).normalized();
    joints.push_back(joint);
    worldFromJoint.push_back(parent * joint.rest.matrix());
  }
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  LORICA_CHECK(skeleton.ok(), "tests/capture/figures.cpp creates an invalid skeleton");
  figure.skeleton = std::move(*skeleton);
  return figure;
}

SkeletonFrame makeFrame(const PersonPose& pose, double time, bool withOrientations) {
  using J = BodyJoint;
  SkeletonFrame frame;
  frame.time = time;
  const auto put = [&](J joint, const Vec3& position, const Quat& orientation) {
    frame[joint].position = position;
    if (withOrientations) frame[joint].orientation = orientation;
    frame[joint].confidence = 1.0;
  };
  const Vec3 torso = pose.middleHip + pose.hips * Vec3(0, 0.25, 0);
  const Vec3 neck = torso + pose.chest * Vec3(0, 0.28, 0);
  put(J::kTorso, torso, pose.chest);
  put(J::kNeck, neck, pose.neck);
  put(J::kHead, neck + pose.neck * Vec3(0, 0.16, 0), pose.head);
  const auto limb = [&](std::size_t i, J upper, J lower, J end, const Vec3& start, const Vec3& first,
                        const Vec3& second) {
    const Vec3 middle = start + pose.upper[i] * first;
    put(upper, start, pose.upper[i]);
    put(lower, middle, pose.lower[i]);
    put(end, middle + pose.lower[i] * second, pose.end[i]);
  };
  limb(0, J::kLeftShoulder, J::kLeftElbow, J::kLeftHand, neck + pose.chest * Vec3(0.19, -0.04, 0), {0.30, 0, 0},
       {0.25, 0, 0});
  limb(1, J::kRightShoulder, J::kRightElbow, J::kRightHand, neck + pose.chest * Vec3(-0.19, -0.04, 0), {-0.30, 0, 0},
       {-0.25, 0, 0});
  limb(2, J::kLeftHip, J::kLeftKnee, J::kLeftFoot, pose.middleHip + pose.hips * Vec3(0.1, 0, 0), {0, -0.42, 0},
       {0, -0.40, 0});
  limb(3, J::kRightHip, J::kRightKnee, J::kRightFoot, pose.middleHip + pose.hips * Vec3(-0.1, 0, 0), {0, -0.42, 0},
       {0, -0.40, 0});
  return frame;
}

PersonPose randomPose(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto pick = [&](double from, double to) { return degrees(uniform(random, from, to)); };
  const auto turn = [&](double yaw, double pitch, double roll) {
    return about(Vec3::UnitY(), yaw) * about(Vec3::UnitX(), pitch) * about(Vec3::UnitZ(), roll);
  };
  PersonPose p;
  p.hips = turn(pick(-180, 180), pick(-20, 40), pick(-15, 15));
  p.chest = p.hips * turn(pick(-30, 30), pick(-15, 40), pick(-20, 20));
  p.neck = p.chest * turn(pick(-20, 20), pick(-20, 20), pick(-15, 15));
  p.head = p.neck * turn(pick(-30, 30), pick(-20, 20), pick(-10, 10));
  for (std::size_t i = 0; i < 2; ++i) {
    const double m = i == 0 ? 1.0 : -1.0;
    p.upper[i] = p.chest * about(Vec3::UnitZ(), m * pick(-85, 70)) * about(Vec3::UnitY(), -m * pick(-20, 80)) *
                 about(Vec3::UnitX(), pick(-60, 60));
    p.lower[i] = p.upper[i] * about(Vec3::UnitY(), -m * pick(2, 130)) * about(Vec3::UnitX(), m * pick(-40, 40));
    p.end[i] = p.lower[i] * about(Vec3::UnitX(), m * pick(-40, 40)) * about(Vec3::UnitZ(), pick(-30, 30));
  }
  for (std::size_t i = 2; i < 4; ++i) {
    const double m = i == 2 ? 1.0 : -1.0;
    p.upper[i] = p.hips * about(Vec3::UnitX(), -pick(-20, 90)) * about(Vec3::UnitZ(), m * pick(-5, 40)) *
                 about(Vec3::UnitY(), m * pick(-10, 30));
    p.lower[i] = p.upper[i] * about(Vec3::UnitX(), pick(2, 110));
    p.end[i] = p.lower[i] * about(Vec3::UnitX(), pick(-20, 20));
  }
  return p;
}

SkeletonFrame frameOfRestPose(const Skeleton& skeleton) {
  using B = HumanBone;
  using J = BodyJoint;
  const std::vector<Affine3> world = worldOf(skeleton, restPose(skeleton));
  SkeletonFrame frame;
  const auto at = [&](B bone) { return Vec3(world[skeleton.jointOf(bone)].translation()); };
  const auto put = [&](J joint, const Vec3& position) { frame[joint] = {position, std::nullopt, 1.0}; };
  put(J::kHead, at(B::kHead));
  put(J::kNeck, at(B::kNeck));
  put(J::kLeftShoulder, at(B::kLeftUpperArm));
  put(J::kRightShoulder, at(B::kRightUpperArm));
  put(J::kLeftElbow, at(B::kLeftLowerArm));
  put(J::kRightElbow, at(B::kRightLowerArm));
  put(J::kLeftHand, at(B::kLeftHand));
  put(J::kRightHand, at(B::kRightHand));
  put(J::kLeftHip, at(B::kLeftUpperLeg));
  put(J::kRightHip, at(B::kRightUpperLeg));
  put(J::kLeftKnee, at(B::kLeftLowerLeg));
  put(J::kRightKnee, at(B::kRightLowerLeg));
  put(J::kLeftFoot, at(B::kLeftFoot));
  put(J::kRightFoot, at(B::kRightFoot));
  put(J::kTorso, 0.5 * (0.5 * (at(B::kLeftUpperLeg) + at(B::kRightUpperLeg)) + at(B::kNeck)));
  return frame;
}

std::vector<Affine3> worldOf(const Skeleton& skeleton, const Pose& pose) {
  std::vector<Affine3> world(pose.size());
  computeWorldFromJoint(skeleton, pose, world);
  return world;
}

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace lorica::test
