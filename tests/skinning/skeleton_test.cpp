#include "skinning/skeleton.h"

#include "skinning/character.h"
#include "skinning/clip.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/random_pose.h"
#include "tests/support/allocations.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

namespace lorica::test {
namespace {

Joint jointNamed(std::string name, JointIndex parent) {
  Joint joint;
  joint.name = std::move(name);
  joint.parent = parent;
  return joint;
}

/// A tree of random shape, sometimes with several roots.
Skeleton randomSkeleton(std::mt19937& random, int jointCount) {
  std::vector<Joint> joints;
  for (int i = 0; i < jointCount; ++i) {
    const auto parent = static_cast<JointIndex>(random() % static_cast<unsigned>(i + 1)) - 1;
    Joint joint = jointNamed(std::to_string(i), parent);
    joint.rest.translation = randomVector(random, 0.5);
    joint.rest.rotation = randomRotation(random);
    joints.push_back(joint);
  }
  return valueOf(Skeleton::create(std::move(joints)));
}

TEST(HumanBone, NamesRoundTripAndDiffer) {
  std::set<std::string_view> names;
  for (int b = 0; b < kHumanBoneCount; ++b) {
    const auto bone = static_cast<HumanBone>(b);
    names.insert(nameOf(bone));
    EXPECT_EQ(humanBoneNamed(nameOf(bone)), bone) << nameOf(bone);
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kHumanBoneCount));
}

TEST(HumanBone, NamesAreThoseOfVrm) {
  EXPECT_EQ(nameOf(HumanBone::kHips), "hips");
  EXPECT_EQ(nameOf(HumanBone::kUpperChest), "upperChest");
  EXPECT_EQ(nameOf(HumanBone::kLeftUpperArm), "leftUpperArm");
  EXPECT_EQ(nameOf(HumanBone::kRightToes), "rightToes");
  EXPECT_EQ(nameOf(HumanBone::kLeftThumbMetacarpal), "leftThumbMetacarpal");
  EXPECT_EQ(nameOf(HumanBone::kRightLittleDistal), "rightLittleDistal");
}

TEST(HumanBone, UnknownNamesAreNothing) {
  for (const char* name : {"", "Hips", "hips ", "leftEye", "jaw", "left"}) EXPECT_FALSE(humanBoneNamed(name)) << name;
}

TEST(Skeleton, WithoutJointsIsRefused) {
  EXPECT_EQ(errorOf(Skeleton::create({})).code, ErrorCode::kInvalidArgument);
}

TEST(Skeleton, ParentThatDoesNotPrecedeIsRefusedByName) {
  for (const JointIndex parent : {1, 2, 7, -2}) {
    const Result<Skeleton> skeleton =
        Skeleton::create({jointNamed("root", kNoJoint), jointNamed("elbow", parent), jointNamed("hand", 0)});
    ASSERT_FALSE(skeleton.ok()) << parent;
    expectAll(skeleton.error().message, {"elbow", std::to_string(parent)});
  }
}

TEST(Skeleton, RestThatIsNotARigidNumberIsRefused) {
  std::vector<Joint> joints = {jointNamed("root", kNoJoint), jointNamed("tail", 0)};
  joints[1].rest.translation.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Skeleton::create(joints).ok());
  joints[1].rest.translation.y() = 0.0;
  joints[1].rest.rotation.coeffs().setZero();
  EXPECT_FALSE(Skeleton::create(joints).ok());
  joints[1].rest.rotation.setIdentity();
  EXPECT_TRUE(Skeleton::create(joints).ok());
}

TEST(Skeleton, BoneOfTwoJointsIsRefused) {
  std::vector<Joint> joints = {jointNamed("a", kNoJoint), jointNamed("b", 0)};
  joints[0].bone = HumanBone::kHead;
  joints[1].bone = HumanBone::kHead;
  EXPECT_TRUE(has(errorOf(Skeleton::create(joints)).message, "head"));
}

TEST(Skeleton, FindsJointsByBone) {
  std::vector<Joint> joints = {jointNamed("pelvis", kNoJoint), jointNamed("skull", 0)};
  joints[1].bone = HumanBone::kHead;
  const Skeleton skeleton = valueOf(Skeleton::create(joints));
  EXPECT_EQ(skeleton.jointOf(HumanBone::kHead), 1);
  EXPECT_EQ(skeleton.jointOf(HumanBone::kHips), kNoJoint);
}

TEST(ForwardKinematics, EqualsProductsFromEachJointUpToItsRoot) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const Skeleton skeleton = randomSkeleton(random, 1 + static_cast<int>(seed) * 3);
    const Pose pose = randomPose(skeleton, random, true);
    std::vector<Affine3> world(pose.size());
    computeWorldFromJoint(skeleton, pose, world);
    for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
      const Mat4 expected = worldFromJointByHand(skeleton, pose, j);
      const double error = (world[j].matrix() - expected).cwiseAbs().maxCoeff();
      EXPECT_LT(error, 1e-11 * (1.0 + expected.cwiseAbs().maxCoeff())) << "seed " << seed << ", joint " << j;
    }
  }
}

TEST(ForwardKinematics, QuarterTurnOfTheElbowMovesTheHandAsDrawn) {
  //  shoulder -- 1 m along x --> elbow -- 1 m along x --> hand; the elbow turns by 90 degrees about z
  std::vector<Joint> joints = {jointNamed("shoulder", kNoJoint), jointNamed("elbow", 0), jointNamed("hand", 1)};
  joints[1].rest.translation = Vec3::UnitX();
  joints[2].rest.translation = Vec3::UnitX();
  const Skeleton skeleton = valueOf(Skeleton::create(joints));
  Pose pose = restPose(skeleton);
  pose[1].rotation = Quat(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  std::vector<Affine3> world(3);
  computeWorldFromJoint(skeleton, pose, world);
  EXPECT_LT((world[2].translation() - Vec3(1, 1, 0)).norm(), 1e-15);
}

/// A tetrahedron with two joints; vertex 0 follows both.
Character smallCharacter() {
  Character character;
  character.mesh = makeTetrahedron();
  Joint root;
  root.name = "root";
  Joint tail;
  tail.name = "tail";
  tail.parent = 0;
  character.skeleton = *Skeleton::create({root, tail});
  character.jointFromModel.assign(2, Affine3::Identity());
  character.influences = {{0, 0.25}, {1, 0.75}, {0, 1.0}, {1, 1.0}, {1, 1.0}};
  character.influenceBegin = {0, 2, 3, 4, 5};
  return character;
}

TEST(CheckCharacter, SoundOnePasses) {
  const Result<void> checked = checkCharacter(smallCharacter());
  EXPECT_TRUE(checked.ok()) << checked.error().message;
}

TEST(CheckCharacter, EveryFlawIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const char* named;
    std::function<void(Character&)> spoil;
  } flaws[] = {
      {"no joints", [](Character& c) { c.skeleton = Skeleton(); }},
      {"no vertices", [](Character& c) { c.mesh.vertices.clear(); }},
      {"inverse bind", [](Character& c) { c.jointFromModel.pop_back(); }},
      {"influenceBegin", [](Character& c) { c.influenceBegin.pop_back(); }},
      {"influenceBegin", [](Character& c) { c.influenceBegin.back() = 4; }},
      {"influenceBegin", [](Character& c) { c.influenceBegin.front() = 1; }},
      {"vertex 1", [](Character& c) { c.influenceBegin[2] = 1; }},
      {"vertex 0", [](Character& c) { c.influenceBegin[1] = 4000000000u; }},
      {"joint 1", [=](Character& c) { c.jointFromModel[1](0, 3) = nan; }},
      {"triangle 2", [](Character& c) { c.mesh.triangles[2][1] = 4; }},
      {"triangle 0", [](Character& c) { c.mesh.triangles[0][0] = -1; }},
      {"vertex 3", [=](Character& c) { c.mesh.vertices[3].z() = nan; }},
      {"joint 2", [](Character& c) { c.influences[1].joint = 2; }},
      {"joint -1", [](Character& c) { c.influences[1].joint = -1; }},
      {"vertex 1", [=](Character& c) { c.influences[2].weight = nan; }},
      {"vertex 0",
       [](Character& c) {
         c.influences = {{0, -0.25}, {1, 1.25}, {0, 1}, {1, 1}, {1, 1}};
       }},
      {"0.9", [](Character& c) { c.influences[1].weight = 0.65; }},
      {"sum to 0",
       [](Character& c) {
         c.influenceBegin = {0, 0, 2, 3, 5};
       }},
  };
  for (const auto& flaw : flaws) {
    Character character = smallCharacter();
    flaw.spoil(character);
    const Result<void> checked = checkCharacter(character);
    ASSERT_FALSE(checked.ok()) << flaw.named;
    EXPECT_EQ(checked.error().code, ErrorCode::kBadMesh);
    EXPECT_TRUE(has(checked.error().message, flaw.named));
  }
}

TEST(CheckCharacter, WeightsMayMissOneByAThousandth) {
  Character character = smallCharacter();
  character.influences[1].weight = 0.7509;
  EXPECT_TRUE(checkCharacter(character).ok());
  character.influences[1].weight = 0.7511;
  EXPECT_FALSE(checkCharacter(character).ok());
}

std::vector<Vec3> posed(const Character& character, const Pose& pose) {
  std::vector<Affine3> world(pose.size());
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> vertices(character.mesh.vertices.size());
  computeWorldFromJoint(character.skeleton, pose, world);
  computeWorldFromModel(character, world, skin);
  skinLinearBlend(character, skin, vertices);
  return vertices;
}

TEST(LinearBlend, EqualsBlendedMatricesMadeByHand) {
  const Character character = makeMannequin();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    const Pose pose = randomPose(character.skeleton, random, true);
    const std::vector<Vec3> actual = posed(character, pose);

    // The other order: all matrices computed from scratch, blended first, then applied once.
    std::vector<Mat4> worldFromModel;
    for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
      worldFromModel.push_back(worldFromJointByHand(character.skeleton, pose, j) *
                               character.jointFromModel[j].matrix());
    }
    double worst = 0.0;
    for (std::size_t v = 0; v < actual.size(); ++v) {
      Mat4 blended = Mat4::Zero();
      for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
        const Influence& influence = character.influences[i];
        blended += influence.weight * worldFromModel[influence.joint];
      }
      const Eigen::Vector4d expected = blended * character.mesh.vertices[v].homogeneous();
      worst = std::max(worst, (actual[v] - expected.head<3>()).norm());
    }
    EXPECT_LT(worst, 1e-11) << "seed " << seed;
  }
}

TEST(LinearBlend, RestPoseGivesTheBindMesh) {
  const Character character = makeMannequin();
  const std::vector<Vec3> vertices = posed(character, restPose(character.skeleton));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    ASSERT_LT((vertices[v] - character.mesh.vertices[v]).norm(), 1e-14) << "vertex " << v;
  }
}

TEST(LinearBlend, RigidMotionOfTheWorldMovesEveryVertexRigidly) {
  const Character character = makeMannequin();
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::mt19937 random(seed);
    Pose pose = randomPose(character.skeleton, random, false);
    const std::vector<Vec3> before = posed(character, pose);
    const Isometry3 motion = Eigen::Translation3d(randomVector(random, 3.0)) * randomRotation(random);
    pose[0].translation = motion * pose[0].translation;
    pose[0].rotation = Quat(motion.rotation()) * pose[0].rotation;
    const std::vector<Vec3> after = posed(character, pose);
    for (std::size_t v = 0; v < before.size(); ++v) {
      ASSERT_LT((after[v] - motion * before[v]).norm(), 1e-12) << "seed " << seed << ", vertex " << v;
    }
  }
}

TEST(LinearBlend, VertexOfOneJointIsMovedByItsMatrixAlone) {
  Character character;
  character.mesh.vertices = {{1.0, 2.0, 3.0}};
  character.skeleton = *Skeleton::create({Joint{}});
  character.jointFromModel = {Affine3(Eigen::Translation3d(-1.0, -2.0, -2.0))};
  character.influences = {{0, 1.0}};
  character.influenceBegin = {0, 1};
  const std::vector<Affine3> world = {Affine3(Eigen::Translation3d(5.0, 0.0, 0.0) * Eigen::Scaling(2.0))};
  std::vector<Affine3> skin(1);
  std::vector<Vec3> vertices(1);
  computeWorldFromModel(character, world, skin);
  skinLinearBlend(character, skin, vertices);
  EXPECT_EQ(vertices[0], Vec3(5.0, 0.0, 2.0));
  EXPECT_EQ(skin[0] * Vec3(1.0, 2.0, 2.0), Vec3(5.0, 0.0, 0.0));
}

TEST(PerFrame, KinematicsAndSkinningAllocateNothing) {
  const Character character = makeMannequin();
  const Pose pose = restPose(character.skeleton);
  std::vector<Affine3> world(pose.size());
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> vertices(character.mesh.vertices.size());

  const long before = allocationCount();
  ASSERT_GT(before, 0);  // the counter works: the setup above allocated memory
  computeWorldFromJoint(character.skeleton, pose, world);
  computeWorldFromModel(character, world, skin);
  skinLinearBlend(character, skin, vertices);
  EXPECT_EQ(allocationCount() - before, 0);
}

constexpr double kPi = std::numbers::pi;

[[nodiscard]] Quat aboutY(double angle) {
  return Quat(Eigen::AngleAxisd(angle, Vec3::UnitY()));
}

[[nodiscard]] Quat negated(const Quat& q) {
  return Quat(Eigen::Vector4d(-q.coeffs()));
}

[[nodiscard]] Clip rotationClip(KeyTrack<Quat> track) {
  Clip clip;
  clip.seconds = track.times.back();
  clip.tracks.push_back({1, std::nullopt, std::move(track), std::nullopt});
  return clip;
}

[[nodiscard]] Clip translationClip(KeyTrack<Vec3> track) {
  Clip clip;
  clip.seconds = track.times.back();
  clip.tracks.push_back({1, std::move(track), std::nullopt, std::nullopt});
  return clip;
}

[[nodiscard]] JointTransform at(const Clip& clip, double time) {
  Pose pose(2);
  sampleClip(clip, time, pose);
  return pose[1];
}

TEST(Clip, WhatHasNoTrackIsLeftAlone) {
  Pose pose(3);
  pose[1].scale = Vec3(3.0, 4.0, 5.0);
  pose[1].rotation = aboutY(0.3);
  pose[2].translation = Vec3(7.0, 8.0, 9.0);
  sampleClip(translationClip({KeyInterpolation::kLinear, {0.0}, {Vec3(1.0, 2.0, 3.0)}}), 0.5, pose);
  EXPECT_EQ(pose[1].translation, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(pose[1].scale, Vec3(3.0, 4.0, 5.0));
  EXPECT_EQ(pose[1].rotation.coeffs(), aboutY(0.3).coeffs());
  EXPECT_EQ(pose[2].translation, Vec3(7.0, 8.0, 9.0));
  EXPECT_EQ(pose[0].translation, Vec3::Zero());
}

TEST(Clip, BeforeTheFirstKeyAndAfterTheLastTheEndsHold) {
  for (const KeyInterpolation kind : {KeyInterpolation::kStep, KeyInterpolation::kLinear}) {
    const Clip clip = translationClip({kind, {1.0, 2.0}, {Vec3::UnitX(), Vec3::UnitY()}});
    EXPECT_EQ(at(clip, -5.0).translation, Vec3::UnitX());
    EXPECT_EQ(at(clip, 1.0).translation, Vec3::UnitX());
    EXPECT_EQ(at(clip, 2.0).translation, Vec3::UnitY());
    EXPECT_EQ(at(clip, 9.0).translation, Vec3::UnitY());
    EXPECT_EQ(at(clip, std::nan("")).translation, Vec3::UnitX());
  }
}

TEST(Clip, StepsHoldUntilTheNextKey) {
  const Clip clip = translationClip({KeyInterpolation::kStep, {0.0, 1.0, 3.0}, {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}}});
  EXPECT_EQ(at(clip, 0.999).translation.x(), 1.0);
  EXPECT_EQ(at(clip, 1.0).translation.x(), 2.0);
  EXPECT_EQ(at(clip, 2.999).translation.x(), 2.0);
  EXPECT_EQ(at(clip, 3.0).translation.x(), 3.0);
}

TEST(Clip, LinearTranslationsAndScalesGoStraight) {
  Clip clip = translationClip({KeyInterpolation::kLinear, {0.0, 1.0, 3.0}, {{1, 0, 0}, {2, 0, 8}, {4, 0, 0}}});
  clip.tracks[0].scale = KeyTrack<Vec3>{KeyInterpolation::kLinear, {0.0, 4.0}, {{1, 1, 1}, {3, 1, 5}}};
  EXPECT_TRUE(at(clip, 0.25).translation.isApprox(Vec3(1.25, 0.0, 2.0)));
  EXPECT_TRUE(at(clip, 2.5).translation.isApprox(Vec3(3.5, 0.0, 2.0)));
  EXPECT_TRUE(at(clip, 1.0).scale.isApprox(Vec3(1.5, 1.0, 2.0)));
}

TEST(Clip, LinearRotationsTurnEvenlyTheShortWay) {
  // From 0 to 120 degrees; the second key is the antipodal quaternion of the same rotation, and not of unit length.
  Quat far = negated(aboutY(2.0 * kPi / 3.0));
  far.coeffs() *= 2.5;
  const Clip clip = rotationClip({KeyInterpolation::kLinear, {0.0, 2.0}, {Quat::Identity(), far}});
  for (int i = 0; i <= 20; ++i) {
    const double time = 0.1 * i;
    const Quat q = at(clip, time).rotation;
    EXPECT_NEAR(q.norm(), 1.0, 1e-12);
    EXPECT_NEAR(q.angularDistance(aboutY(kPi / 3.0 * time)), 0.0, 1e-7) << time;
  }
}

TEST(Clip, NearlyEqualRotationsStayOfUnitLength) {
  const Clip clip = rotationClip({KeyInterpolation::kLinear, {0.0, 1.0}, {aboutY(0.5), aboutY(0.5 + 1e-9)}});
  EXPECT_NEAR(at(clip, 0.4).rotation.norm(), 1.0, 1e-12);
  EXPECT_NEAR(at(clip, 0.4).rotation.angularDistance(aboutY(0.5)), 0.0, 1e-7);
}

TEST(Clip, CubicSplinesRunThroughACubic) {
  // A Hermite spline reproduces any cubic from its values and slopes at the keys.
  const auto p = [](double t) { return Vec3(t * t * t - 2.0 * t, 3.0 * t * t + 1.0, 5.0 - t); };
  const auto slope = [](double t) { return Vec3(3.0 * t * t - 2.0, 6.0 * t, -1.0); };
  KeyTrack<Vec3> track{KeyInterpolation::kCubicSpline, {0.5, 1.0, 3.0}, {}};
  for (const double t : track.times) track.values.insert(track.values.end(), {slope(t), p(t), slope(t)});
  const Clip clip = translationClip(track);
  for (int i = 0; i <= 50; ++i) {
    const double t = 0.5 + 0.05 * i;
    EXPECT_NEAR((at(clip, t).translation - p(t)).norm(), 0.0, 1e-12) << t;
  }
  EXPECT_EQ(at(clip, 0.0).translation, p(0.5));
  EXPECT_EQ(at(clip, 4.0).translation, p(3.0));
}

TEST(Clip, CubicTangentsOfAKeyDifferOnItsTwoSides) {
  const Vec3 zero = Vec3::Zero();
  const Vec3 up = Vec3::UnitY();
  const Clip clip =
      translationClip({KeyInterpolation::kCubicSpline, {0.0, 2.0}, {{9, 9, 9}, zero, up, zero, zero, {9, 9, 9}}});
  // t^3 - 2 t^2 + t = 1/8 at the middle, times two seconds.
  EXPECT_NEAR((at(clip, 1.0).translation - 0.25 * up).norm(), 0.0, 1e-12);
}

TEST(Clip, CubicRotationsAreNormalisedAfterwards) {
  const Quat none(0.0, 0.0, 0.0, 0.0);
  const Clip clip =
      rotationClip({KeyInterpolation::kCubicSpline, {0.0, 1.0}, {none, aboutY(0.0), none, none, aboutY(1.0), none}});
  const double t = 0.3;
  const double b = 3.0 * t * t - 2.0 * t * t * t;
  const Eigen::Vector4d expected = ((1.0 - b) * aboutY(0.0).coeffs() + b * aboutY(1.0).coeffs()).normalized();
  EXPECT_NEAR((at(clip, t).rotation.coeffs() - expected).norm(), 0.0, 1e-12);
}

TEST(Clip, ASplineThroughZeroGivesSomeRotation) {
  const Quat none(0.0, 0.0, 0.0, 0.0);
  const Clip clip = rotationClip(
      {KeyInterpolation::kCubicSpline, {0.0, 1.0}, {none, aboutY(1.0), none, none, negated(aboutY(1.0)), none}});
  EXPECT_NEAR(at(clip, 0.5).rotation.norm(), 1.0, 1e-12);
}

TEST(Clip, SamplingTheWholeKeepsBothEndsAndEqualSteps) {
  std::vector<Joint> joints(2);
  joints[1].parent = 0;
  joints[1].rest.scale = Vec3(1.0, 2.0, 1.0);
  const Skeleton skeleton = *Skeleton::create(joints);
  Clip clip = translationClip({KeyInterpolation::kLinear, {0.0, 1.03}, {Vec3::Zero(), {1.03, 0, 0}}});
  clip.name = "slide";
  const SkeletalMotion motion = sampleWhole(skeleton, clip, 10.0);
  ASSERT_EQ(motion.frameCount(), 11);
  ASSERT_EQ(motion.poses.size(), 22u);
  EXPECT_EQ(motion.name, "slide");
  EXPECT_EQ(motion.times.front(), 0.0);
  EXPECT_EQ(motion.times.back(), 1.03);
  for (int f = 0; f < 11; ++f) {
    EXPECT_NEAR(motion.times[f], 0.103 * f, 1e-12);
    EXPECT_NEAR(motion.pose(f)[1].translation.x(), 0.103 * f, 1e-12);
    EXPECT_EQ(motion.pose(f)[1].scale, Vec3(1.0, 2.0, 1.0));
  }
}

TEST(Clip, AClipOfNoLengthIsOneFrameAndAShortOneTwo) {
  const Skeleton skeleton = *Skeleton::create(std::vector<Joint>(2, Joint{}));
  EXPECT_EQ(sampleWhole(skeleton, Clip{}, 30.0).frameCount(), 1);
  const Clip brief = translationClip({KeyInterpolation::kLinear, {0.0, 0.001}, {Vec3::Zero(), Vec3::UnitX()}});
  EXPECT_EQ(sampleWhole(skeleton, brief, 30.0).frameCount(), 2);
}

TEST(PoseAt, IsExactAtFramesAndInterpolatesBetween) {
  Joint root;
  root.name = "root";
  SkeletalMotion motion;
  motion.skeleton = Skeleton::create({root}).value();
  motion.times = {1.0, 3.0};
  motion.poses.resize(2);
  motion.poses[1].translation = Vec3(4.0, 0.0, -2.0);
  motion.poses[1].rotation = Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()));
  motion.poses[1].scale = Vec3::Constant(3.0);
  Pose pose(1);
  for (const auto& [time, share] :
       {std::pair(-5.0, 0.0), {1.0, 0.0}, {1.5, 0.25}, {2.0, 0.5}, {3.0, 1.0}, {9.0, 1.0}}) {
    poseAt(motion, time, pose);
    EXPECT_LT((pose[0].translation - share * Vec3(4.0, 0.0, -2.0)).norm(), 1e-15) << time;
    EXPECT_LT(pose[0].rotation.angularDistance(Quat(Eigen::AngleAxisd(share, Vec3::UnitY()))), 1e-7) << time;
    EXPECT_LT((pose[0].scale - Vec3::Constant(1.0 + 2.0 * share)).norm(), 1e-15) << time;
  }
}

}  // namespace
}  // namespace lorica::test
