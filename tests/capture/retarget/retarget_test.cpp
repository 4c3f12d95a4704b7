#include "capture/retarget/retarget.h"

#include "capture/files/joint_csv.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

namespace lorica {
namespace {

using test::angleBetween;
using test::degrees;
using test::Figure;
using test::FigureSettings;
using test::makeFigure;
using test::makeFrame;
using test::PersonPose;
using test::randomPose;
using test::worldOf;
using B = HumanBone;

/// All kinds of characters: rest poses, arbitrary joint axes, proportions, size, extra root joints.
std::vector<FigureSettings> manyFigures() {
  std::vector<FigureSettings> all(7);
  all[1].armsDown = degrees(45.0);
  all[1].legsApart = degrees(8.0);
  all[2].crookedAxes = true;
  all[3].crookedAxes = true;
  all[3].armsDown = degrees(35.0);
  all[3].elbowsBent = degrees(12.0);
  all[3].seed = 7;
  all[4].thigh = 0.30;
  all[4].shin = 0.45;
  all[4].upperArm = 0.2;
  all[4].forearm = 0.4;
  all[4].fullSpine = false;
  all[5].scale = 0.3;
  all[5].crookedAxes = true;
  all[5].armature = true;
  all[5].yaw = degrees(90.0);
  all[6].armature = true;
  all[6].armsDown = degrees(80.0);
  all[6].scale = 1.4;
  return all;
}

Retargeter makeRetargeter(const Figure& figure) {
  Result<Retargeter> made = Retargeter::create(figure.skeleton);
  EXPECT_TRUE(made) << made.error().message;
  return std::move(*made);
}

std::vector<Affine3> retargetOnce(const Figure& figure, const SkeletonFrame& frame) {
  Retargeter retargeter = makeRetargeter(figure);
  Pose pose(figure.tposeRotation.size());
  retargeter.apply(frame, pose);
  return worldOf(figure.skeleton, pose);
}

Vec3 positionOf(const Figure& figure, const std::vector<Affine3>& world, B bone) {
  return world[figure.skeleton.jointOf(bone)].translation();
}

Quat rotationOf(const Figure& figure, const std::vector<Affine3>& world, B bone) {
  const Mat3 linear = world[figure.skeleton.jointOf(bone)].linear();
  return Quat(Mat3(linear / std::cbrt(linear.determinant())));
}

/// worldFromLimb as defined for TrackedJoint, from the figure's known axes.
Quat orientationOf(const Figure& figure, const std::vector<Affine3>& world, B bone) {
  const auto joint = static_cast<std::size_t>(figure.skeleton.jointOf(bone));
  return rotationOf(figure, world, bone) * figure.tposeRotation[joint].conjugate();
}

void expectLimbDirections(const Figure& figure, const std::vector<Affine3>& world, const PersonPose& person,
                          double tolerance) {
  for (std::size_t i = 0; i < kLimbCount; ++i) {
    const LimbBones& limb = limbs()[i];
    const Vec3 axis = i == 0 ? Vec3::UnitX() : i == 1 ? Vec3(-Vec3::UnitX()) : Vec3(-Vec3::UnitY());
    const Vec3 upper = positionOf(figure, world, limb.lower) - positionOf(figure, world, limb.upper);
    const Vec3 lower = positionOf(figure, world, limb.end) - positionOf(figure, world, limb.lower);
    EXPECT_LT(angleBetween(upper, person.upper[i] * axis), tolerance) << nameOf(limb.upper);
    EXPECT_LT(angleBetween(lower, person.lower[i] * axis), tolerance) << nameOf(limb.lower);
  }
  const Vec3 neck = positionOf(figure, world, B::kHead) - positionOf(figure, world, B::kNeck);
  EXPECT_LT(angleBetween(neck, person.neck * Vec3::UnitY()), tolerance);
}

TEST(Retarget, MissingBonesAreNamed) {
  Joint only;
  only.name = "Root";
  only.bone = B::kHips;
  const Result<Retargeter> none = Retargeter::create(*Skeleton::create({only}));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message,
            "the skeleton lacks humanoid bones that retargeting needs: leftUpperArm, leftLowerArm, leftHand, "
            "rightUpperArm, rightLowerArm, rightHand, leftUpperLeg, leftLowerLeg, leftFoot, rightUpperLeg, "
            "rightLowerLeg, rightFoot, spine (or chest)");

  const Figure figure = makeFigure({});
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  joints[figure.skeleton.jointOf(B::kRightHand)].bone.reset();
  const Result<Retargeter> oneHand = Retargeter::create(*Skeleton::create(joints));
  ASSERT_FALSE(oneHand);
  EXPECT_EQ(oneHand.error().message, "the skeleton lacks humanoid bones that retargeting needs: rightHand");
}

TEST(Retarget, BonesOutOfOrderOrOfNoLengthAreRefused) {
  const Figure figure = makeFigure({});
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  const auto at = [&](B bone) -> Joint& { return joints[figure.skeleton.jointOf(bone)]; };
  std::swap(at(B::kLeftLowerArm).bone, at(B::kLeftHand).bone);
  const Result<Retargeter> swapped = Retargeter::create(*Skeleton::create(joints));
  ASSERT_FALSE(swapped);
  EXPECT_EQ(swapped.error().message, "the bone leftHand does not descend from leftLowerArm");
  joints.assign(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  at(B::kRightFoot).rest.translation.setZero();
  const Result<Retargeter> flat = Retargeter::create(*Skeleton::create(joints));
  ASSERT_FALSE(flat);
  EXPECT_EQ(flat.error().message, "the bone rightLowerLeg is 0 m long in the rest pose, expected at least 0.001 m");
}

TEST(Retarget, NeckHeadAndClaviclesMayBeMissing) {
  const Figure figure = makeFigure({});
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  for (const B bone : {B::kNeck, B::kHead, B::kLeftShoulder, B::kRightShoulder, B::kSpine, B::kUpperChest}) {
    joints[figure.skeleton.jointOf(bone)].bone.reset();
  }
  const Skeleton skeleton = *Skeleton::create(joints);
  Result<Retargeter> retargeter = Retargeter::create(skeleton);
  ASSERT_TRUE(retargeter) << retargeter.error().message;
  Pose pose(joints.size());
  retargeter->apply(makeFrame(randomPose(3), 0.0, true), pose);
  for (const Affine3& m : worldOf(skeleton, pose)) EXPECT_TRUE(m.matrix().allFinite());
}

TEST(Retarget, LimbsTakeTheDirectionsOfThePersons) {
  for (const FigureSettings& settings : manyFigures()) {
    const Figure figure = makeFigure(settings);
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
      for (const bool withOrientations : {false, true}) {
        SCOPED_TRACE("figure seed " + std::to_string(settings.seed) + " arms down " +
                     std::to_string(settings.armsDown) + " pose seed " + std::to_string(seed) +
                     (withOrientations ? " with" : " without"));
        const PersonPose person = randomPose(seed);
        const std::vector<Affine3> world = retargetOnce(figure, makeFrame(person, 0.0, withOrientations));
        expectLimbDirections(figure, world, person, degrees(0.01));
      }
    }
  }
}

TEST(Retarget, RestPoseInGivesRestPoseOut) {
  for (FigureSettings settings : manyFigures()) {
    settings.elbowsBent = std::min(settings.elbowsBent, degrees(12.0));
    const Figure figure = makeFigure(settings);
    const Pose rest = restPose(figure.skeleton);
    Retargeter retargeter = makeRetargeter(figure);
    Pose pose(rest.size());
    retargeter.apply(test::frameOfRestPose(figure.skeleton), pose);
    for (std::size_t j = 0; j < rest.size(); ++j) {
      SCOPED_TRACE(figure.skeleton.joint(static_cast<JointIndex>(j)).name);
      EXPECT_LT(pose[j].rotation.angularDistance(rest[j].rotation), degrees(0.1));
      EXPECT_LT((pose[j].translation - rest[j].translation).norm(), 1e-6 / (settings.armature ? 0.01 : 1.0));
      EXPECT_EQ(pose[j].scale, rest[j].scale);
    }
    EXPECT_NEAR(retargeter.legRatio(), 1.0, 1e-9);
  }
}

TEST(Retarget, OrientationsSetTheTwist) {
  for (const FigureSettings& settings : manyFigures()) {
    const Figure figure = makeFigure(settings);
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
      SCOPED_TRACE(seed);
      const PersonPose person = randomPose(seed);
      const std::vector<Affine3> world = retargetOnce(figure, makeFrame(person, 0.0, true));
      for (std::size_t i = 0; i < kLimbCount; ++i) {
        const LimbBones& limb = limbs()[i];
        EXPECT_LT(orientationOf(figure, world, limb.upper).angularDistance(person.upper[i]), degrees(0.1))
            << nameOf(limb.upper);
        EXPECT_LT(orientationOf(figure, world, limb.lower).angularDistance(person.lower[i]), degrees(0.1))
            << nameOf(limb.lower);
        EXPECT_LT(orientationOf(figure, world, limb.end).angularDistance(person.end[i]), degrees(0.1))
            << nameOf(limb.end);
      }
      EXPECT_LT(orientationOf(figure, world, B::kHead).angularDistance(person.head), degrees(0.1));
      EXPECT_LT(orientationOf(figure, world, B::kHips).angularDistance(person.hips), degrees(0.1));
      EXPECT_LT(
          orientationOf(figure, world, settings.fullSpine ? B::kUpperChest : B::kSpine).angularDistance(person.chest),
          degrees(0.1));
    }
  }
}

TEST(Retarget, BentElbowsAndKneesSetTheTwistWithoutOrientations) {
  for (const FigureSettings& settings : manyFigures()) {
    const Figure figure = makeFigure(settings);
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
      SCOPED_TRACE(seed);
      PersonPose person = randomPose(seed);
      // Pure hinges, folded far enough to be detected.
      for (std::size_t i = 0; i < kLimbCount; ++i) {
        const Vec3 axis = i == 0 ? Vec3(-Vec3::UnitY()) : i == 1 ? Vec3::UnitY() : Vec3::UnitX();
        person.lower[i] = person.upper[i] * Quat(Eigen::AngleAxisd(degrees(62.0 + seed % 50), axis));
      }
      const std::vector<Affine3> world = retargetOnce(figure, makeFrame(person, 0.0, false));
      for (std::size_t i = 0; i < kLimbCount; ++i) {
        EXPECT_LT(orientationOf(figure, world, limbs()[i].upper).angularDistance(person.upper[i]), degrees(0.1));
        EXPECT_LT(orientationOf(figure, world, limbs()[i].lower).angularDistance(person.lower[i]), degrees(0.1));
      }
    }
  }
}

TEST(Retarget, AHandsTurnIsSharedWithTheForearm) {
  const Figure figure = makeFigure({});
  PersonPose person;
  SkeletonFrame frame = makeFrame(person, 0.0, false);
  frame[BodyJoint::kLeftHand].orientation = Quat(Eigen::AngleAxisd(degrees(80.0), Vec3::UnitX()));
  const std::vector<Affine3> world = retargetOnce(figure, frame);
  const Quat forearm = orientationOf(figure, world, B::kLeftLowerArm);
  EXPECT_LT(forearm.angularDistance(Quat(Eigen::AngleAxisd(degrees(40.0), Vec3::UnitX()))), degrees(0.1));
  EXPECT_LT(orientationOf(figure, world, B::kLeftHand).angularDistance(*frame[BodyJoint::kLeftHand].orientation),
            degrees(0.1));
}

TEST(Retarget, KneesNeverBendBackwards) {
  const Figure figure = makeFigure({});
  for (int tilt = 1; tilt <= 25; ++tilt) {
    PersonPose person;
    for (std::size_t i = 2; i < 4; ++i) {
      person.lower[i] = Quat(Eigen::AngleAxisd(degrees(-tilt), Vec3::UnitX()));  // the ankle in front of the knee
    }
    const std::vector<Affine3> world = retargetOnce(figure, makeFrame(person, 0.0, false));
    const Vec3 thigh = positionOf(figure, world, B::kLeftLowerLeg) - positionOf(figure, world, B::kLeftUpperLeg);
    const Vec3 shin = positionOf(figure, world, B::kLeftFoot) - positionOf(figure, world, B::kLeftLowerLeg);
    EXPECT_LT(angleBetween(thigh, shin), 1e-6) << tilt;
  }
}

/// The person walks in place and squats; the standing foot never moves.
SkeletonFrame steppingFrame(int frame) {
  const double t = frame / 30.0;
  PersonPose person;
  person.hips = Quat(Eigen::AngleAxisd(0.3 * std::sin(t), Vec3::UnitY()));
  person.chest = person.hips;
  person.neck = person.head = person.chest;
  const double squat = degrees(50.0) * (0.5 - 0.5 * std::cos(2.0 * t));
  const double lift = degrees(45.0) * std::max(0.0, std::sin(3.0 * t));
  for (std::size_t i = 2; i < 4; ++i) {
    const double raised = i == 3 ? lift : 0.0;
    person.upper[i] = person.hips * Quat(Eigen::AngleAxisd(-(squat + raised), Vec3::UnitX()));
    person.lower[i] = person.hips * Quat(Eigen::AngleAxisd(0.9 * squat + raised, Vec3::UnitX()));
    person.end[i] = person.hips;
  }
  person.middleHip = Vec3::Zero();
  const double leftFoot = makeFrame(person, t, false)[BodyJoint::kLeftFoot].position.y();
  person.middleHip = Vec3(1.5, 0.09 - leftFoot, 2.5 + 0.1 * t);
  return makeFrame(person, t, false);
}

TEST(Retarget, FeetStayOnTheFloor) {
  for (const FigureSettings& settings : manyFigures()) {
    const Figure figure = makeFigure(settings);
    const std::vector<Affine3> rest = worldOf(figure.skeleton, restPose(figure.skeleton));
    const double restAnkle = positionOf(figure, rest, B::kLeftFoot).y();
    Retargeter retargeter = makeRetargeter(figure);
    Pose pose(figure.tposeRotation.size());
    for (int f = 0; f < 300; ++f) {
      SCOPED_TRACE(f);
      retargeter.apply(steppingFrame(f), pose);
      const std::vector<Affine3> world = worldOf(figure.skeleton, pose);
      const double left = positionOf(figure, world, B::kLeftFoot).y();
      const double right = positionOf(figure, world, B::kRightFoot).y();
      EXPECT_NEAR(std::min(left, right), restAnkle, 0.01 * settings.scale);
      if (settings.fullSpine) {
        EXPECT_GT(positionOf(figure, world, B::kLeftToes).y(), 0.0);
        const Quat foot = orientationOf(figure, world, B::kLeftFoot);
        EXPECT_LT(angleBetween(foot * Vec3::UnitY(), Vec3::UnitY()), degrees(1.0)) << "a standing foot is flat";
      }
    }
  }
}

TEST(Retarget, TheRootMovesByTheRatioOfLegLengths) {
  FigureSettings settings;
  settings.scale = 0.5;
  const Figure figure = makeFigure(settings);
  Retargeter retargeter = makeRetargeter(figure);
  Pose pose(figure.tposeRotation.size());
  PersonPose person;
  const double ratio = 0.5;  // thigh and shin are 0.42 + 0.40 on both sides, then scaled
  Vec3 start;
  for (int f = 0; f <= 60; ++f) {
    person.middleHip = Vec3(0.02 * f, 0.9, 2.0 - 0.01 * f);
    retargeter.apply(makeFrame(person, f / 30.0, false), pose);
    const std::vector<Affine3> world = worldOf(figure.skeleton, pose);
    const Vec3 hips =
        0.5 * (positionOf(figure, world, B::kLeftUpperLeg) + positionOf(figure, world, B::kRightUpperLeg));
    if (f == 0) start = hips;
    EXPECT_NEAR(hips.x() - start.x(), ratio * 0.02 * f, 1e-9);
    EXPECT_NEAR(hips.z() - start.z(), -ratio * 0.01 * f, 1e-9);
    EXPECT_NEAR(hips.y(), 0.5 * (0.08 + 0.82), 1e-9);
  }
  EXPECT_NEAR(start.x(), 0.0, 1e-9);
  EXPECT_NEAR(start.z(), 2.0, 1e-9);
}

TEST(Retarget, AJumpLeavesTheFloor) {
  const Figure figure = makeFigure({});
  Retargeter retargeter = makeRetargeter(figure);
  Pose pose(figure.tposeRotation.size());
  for (int f = 0; f < 60; ++f) {
    PersonPose person;
    const double height = f < 30 ? 0.0 : std::max(0.0, 0.3 * std::sin((f - 30) * degrees(12.0)));
    person.middleHip = Vec3(0, 0.82 + 0.09 + height, 0);
    retargeter.apply(makeFrame(person, f / 30.0, true), pose);
    const std::vector<Affine3> world = worldOf(figure.skeleton, pose);
    EXPECT_NEAR(positionOf(figure, world, B::kLeftFoot).y(), 0.08 + height, 0.01) << f;
  }
}

TEST(Retarget, RaisedArmsLiftTheCollarBones) {
  const Figure figure = makeFigure({});
  PersonPose person;
  const double level = positionOf(figure, retargetOnce(figure, makeFrame(person, 0, false)), B::kLeftUpperArm).y();
  person.upper[0] = person.lower[0] = Quat(Eigen::AngleAxisd(degrees(80.0), Vec3::UnitZ()));
  person.upper[1] = person.lower[1] = Quat(Eigen::AngleAxisd(degrees(70.0), Vec3::UnitZ()));  // lowered
  const std::vector<Affine3> world = retargetOnce(figure, makeFrame(person, 0, false));
  EXPECT_GT(positionOf(figure, world, B::kLeftUpperArm).y(), level + 0.02);
  EXPECT_NEAR(positionOf(figure, world, B::kRightUpperArm).y(), level, 1e-6);
}

TEST(Retarget, ASmallMotionIsASmallMotion) {
  // Straight and bent arms over the whole hemisphere in front: no flips of twist between neighbouring frames.
  const Figure figure = makeFigure({});
  Retargeter retargeter = makeRetargeter(figure);
  Pose pose(figure.tposeRotation.size());
  Pose before;
  for (int f = 0; f < 1200; ++f) {
    const double t = f / 30.0;
    PersonPose person;
    for (std::size_t i = 0; i < 2; ++i) {
      const double m = i == 0 ? 1.0 : -1.0;
      person.upper[i] = Quat(Eigen::AngleAxisd(m * degrees(80.0) * std::sin(0.7 * t), Vec3::UnitZ())) *
                        Quat(Eigen::AngleAxisd(-m * degrees(45.0 + 45.0 * std::sin(0.43 * t)), Vec3::UnitY()));
      person.lower[i] =
          person.upper[i] * Quat(Eigen::AngleAxisd(-m * degrees(60.0 + 60.0 * std::sin(1.1 * t)), Vec3::UnitY()));
    }
    retargeter.apply(makeFrame(person, t, false), pose);
    for (std::size_t j = 0; j < before.size(); ++j) {
      EXPECT_LT(pose[j].rotation.angularDistance(before[j].rotation), degrees(22.0))
          << f << " " << figure.skeleton.joint(static_cast<JointIndex>(j)).name;
    }
    before = pose;
  }
}

TEST(Retarget, SameFramesGiveTheSameBits) {
  const Figure figure = makeFigure({});
  Retargeter a = makeRetargeter(figure);
  Retargeter b = makeRetargeter(figure);
  Pose poseA(figure.tposeRotation.size());
  Pose poseB(figure.tposeRotation.size());
  for (std::uint32_t f = 0; f < 50; ++f) {
    SkeletonFrame frame = makeFrame(randomPose(f), f / 30.0, f % 3 == 0);
    frame.joints[f % kBodyJointCount].confidence = 0.0;
    a.apply(frame, poseA);
    b.apply(frame, poseB);
    for (std::size_t j = 0; j < poseA.size(); ++j) {
      EXPECT_EQ(poseA[j].rotation.coeffs(), poseB[j].rotation.coeffs());
      EXPECT_EQ(poseA[j].translation, poseB[j].translation);
    }
  }
}

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

/// Worst values for one recording on the mannequin.
struct Measures {
  double limbAngle = 0.0;      ///< between a limb of the character and the person's [rad]
  double kneeBackwards = 0.0;  ///< sine of the largest bend of a knee the wrong way
  double lowestPoint = 0.0;    ///< of the skin [m]
  double plantedFoot = 0.0;    ///< a standing ankle's distance from its rest height [m]
  double wristTwist = 0.0;     ///< of the hand relative to the forearm, about the forearm [rad]
  double elbowTwist = 0.0;     ///< of the forearm relative to the upper arm, about the forearm [rad]
  double turn = 0.0;           ///< of a joint from one frame to the next [rad]
  double rootStep = 0.0;       ///< [m]
};

void measure(const std::string& file, Measures& worst) {
  const auto frames = readJointCsv(test::recordingsFolder() / file);
  ASSERT_TRUE(frames) << frames.error().message;
  const Skeleton& skeleton = mannequin().skeleton;
  Result<Retargeter> retargeter = Retargeter::create(skeleton);
  ASSERT_TRUE(retargeter) << retargeter.error().message;

  Pose pose(skeleton.joints().size());
  Pose before;
  const std::vector<Affine3> rest = test::worldOf(skeleton, restPose(skeleton));
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> posed(mannequin().mesh.vertices.size());
  double standing = 1.0;
  for (const SkeletonFrame& frame : *frames) {
    for (const BodyJoint foot : {BodyJoint::kLeftFoot, BodyJoint::kRightFoot}) {
      if (frame[foot].confidence == 1.0) standing = std::min(standing, frame[foot].position.y());
    }
  }

  for (const SkeletonFrame& frame : *frames) {
    retargeter->apply(frame, pose);
    const std::vector<Affine3> world = test::worldOf(skeleton, pose);
    const auto index = [&](B bone) { return static_cast<std::size_t>(skeleton.jointOf(bone)); };
    const auto at = [&](B bone) -> Vec3 { return world[index(bone)].translation(); };
    const auto turnFromRest = [&](B bone) {
      return Quat(Mat3(world[index(bone)].linear() * rest[index(bone)].linear().transpose()));
    };
    for (const Affine3& m : world) ASSERT_TRUE(m.matrix().allFinite()) << frame.time;

    for (std::size_t i = 0; i < kLimbCount; ++i) {
      const LimbBones& limb = limbs()[i];
      const TrackedJoint& a = frame[limb.upperJoint];
      const TrackedJoint& b = frame[limb.lowerJoint];
      const TrackedJoint& c = frame[limb.endJoint];
      const Vec3 upper = at(limb.lower) - at(limb.upper);
      const Vec3 lower = at(limb.end) - at(limb.lower);
      if (a.confidence > 0.0 && b.confidence > 0.0 && c.confidence > 0.0) {
        worst.limbAngle = std::max(worst.limbAngle, angleBetween(upper, b.position - a.position));
        worst.limbAngle = std::max(worst.limbAngle, angleBetween(lower, c.position - b.position));
      }
      const auto twist = [&](B outer, B inner) {
        const Quat q = turnFromRest(outer) * turnFromRest(inner).conjugate();
        return std::abs(
            std::remainder(2.0 * std::atan2(q.vec().dot(lower.normalized()), q.w()), 2.0 * std::numbers::pi));
      };
      if (i >= kFirstLeg) {
        const Vec3 forward = turnFromRest(limb.upper) * Vec3::UnitZ();
        worst.kneeBackwards = std::max(worst.kneeBackwards, lower.normalized().dot(forward));
        const double above = c.position.y() - standing;
        if (c.confidence == 1.0 && above < 0.005) {
          worst.plantedFoot =
              std::max(worst.plantedFoot, std::abs(at(limb.end).y() - rest[index(limb.end)].translation().y()));
        }
      } else {
        worst.wristTwist = std::max(worst.wristTwist, twist(limb.end, limb.lower));
        worst.elbowTwist = std::max(worst.elbowTwist, twist(limb.lower, limb.upper));
      }
    }
    computeWorldFromModel(mannequin(), world, skin);
    skinLinearBlend(mannequin(), skin, posed);
    for (const Vec3& p : posed) worst.lowestPoint = std::min(worst.lowestPoint, p.y());
    if (!before.empty()) {
      for (std::size_t j = 0; j < pose.size(); ++j) {
        worst.turn = std::max(worst.turn, pose[j].rotation.angularDistance(before[j].rotation));
      }
      const std::size_t hips = index(B::kHips);
      worst.rootStep = std::max(worst.rootStep, (pose[hips].translation - before[hips].translation).norm());
    }
    before = pose;
  }
  const auto record = [&](const char* name, double value) {
    ::testing::Test::RecordProperty(name, std::to_string(value));
  };
  record("limb_angle_deg", worst.limbAngle / degrees(1.0));
  record("lowest_point_m", worst.lowestPoint);
  if (std::getenv("LORICA_PRINT_MEASURES") != nullptr) {
    std::printf("%-26s limb %.2f knee %.3f low %.4f planted %.4f wrist %.0f elbow %.0f turn %.0f root %.3f\n",
                file.c_str(), worst.limbAngle / degrees(1.0), worst.kneeBackwards, worst.lowestPoint, worst.plantedFoot,
                worst.wristTwist / degrees(1.0), worst.elbowTwist / degrees(1.0), worst.turn / degrees(1.0),
                worst.rootStep);
  }
}

class CleanRecording : public ::testing::TestWithParam<const char*> {};

TEST_P(CleanRecording, PlaysOnTheMannequin) {
  Measures worst;
  measure(GetParam(), worst);
  EXPECT_LT(worst.limbAngle, degrees(1.0));
  EXPECT_LT(worst.kneeBackwards, 0.02);
  EXPECT_GT(worst.lowestPoint, -0.02);
  EXPECT_LT(worst.plantedFoot, 0.01);
  EXPECT_LT(worst.wristTwist, degrees(95.0));
  EXPECT_LT(worst.elbowTwist, degrees(95.0));
}

INSTANTIATE_TEST_SUITE_P(All, CleanRecording,
                         ::testing::Values("walk.csv", "wave.csv", "jumping_jacks.csv", "squat_and_reach.csv",
                                           "punch_and_kick.csv", "turn_around.csv"),
                         [](const auto& chosen) {
                           const std::string name = chosen.param;
                           return name.substr(0, name.find('.'));
                         });

class NoisyRecording : public ::testing::TestWithParam<const char*> {};

TEST_P(NoisyRecording, PlaysOnTheMannequin) {
  Measures worst;
  measure(GetParam(), worst);
  EXPECT_LT(worst.kneeBackwards, 0.02);
  EXPECT_GT(worst.lowestPoint, -0.02);
}

INSTANTIATE_TEST_SUITE_P(All, NoisyRecording, ::testing::Values("walk_noisy.csv", "punch_and_kick_noisy.csv"),
                         [](const auto& chosen) {
                           const std::string name = chosen.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace lorica
