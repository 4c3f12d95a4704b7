#include "capture/tracking/fit/body_fit.h"

#include "capture/skeleton_frame.h"
#include "capture/tracking/fit/body_model.h"
#include "capture/tracking/fit/calm_limbs.h"
#include "capture/tracking/fit/joint_confidence.h"
#include "capture/tracking/fit/limb_pose.h"
#include "capture/tracking/fit/limb_search.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace lorica::fit {
namespace {

/// Position of the hips of people in front of the virtual camera, floor frame [m].
const V3 kPosition(0.0F, 0.915F, -2.7F);

/// The mannequin in a pose in front of the virtual camera, without noise, with the true labels.
class PosedScene {
 public:
  explicit PosedScene(const BodyPose& pose) : view(DepthCamera{}) {
    PosedModel body;
    poseBody(pose, Proportions(), body);
    SkeletonFrame frame;
    readJoints(body, frame);
    for (TrackedJoint& joint : frame.joints) joint.confidence = 1.0;
    std::vector<SkeletonFrame> frames(2, frame);
    frames[1].time = 1.0;
    std::vector<VirtualPerson> people;
    people.push_back({VirtualPerformer::create(makeMannequin(), frames).value()});
    // The floor frame's origin is below the camera.
    people[0].worldFromMotion.translation() = VirtualRoom{}.worldFromCamera.translation();
    people[0].worldFromMotion.translation().y() = 0.0;
    VirtualSensorSettings settings;
    settings.noise = DepthNoiseSettings::clean();
    VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
    sensor.render(0, depth);
    labels.assign(sensor.labels().begin(), sensor.labels().end());
    floorFromCamera = sensor.floorFromCamera();
    view.look(depth.depthMm, labels, 1, floorFromCamera);
    truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
  }

  /// Puts something 1 m before the camera into all rows below the one that sees the person at this height [m].
  void hideBelow(double height) {
    const DepthCamera camera;
    const Vec3 seen = floorFromCamera.inverse() * Vec3(kPosition.x(), height, kPosition.z());
    const double row = 0.5 * camera.height - camera.focalY() * seen.y() / -seen.z();
    const auto first = static_cast<std::ptrdiff_t>(row) * camera.width;
    std::fill(depth.depthMm.begin() + first, depth.depthMm.end(), std::uint16_t{1000});
    std::fill(labels.begin() + first, labels.end(), std::uint8_t{0});
    view.look(depth.depthMm, labels, 1, floorFromCamera);
  }

  /// Puts something this much before the person into all columns to the right of the one that sees this x [m].
  void hideBeside(double x, double before) {
    const DepthCamera camera;
    const Vec3 seen = floorFromCamera.inverse() * Vec3(x, 1.2, kPosition.z());
    const auto first = static_cast<int>(0.5 * camera.width + camera.focalX() * seen.x() / -seen.z());
    const auto nearer = static_cast<std::uint16_t>(1000.0 * (-seen.z() - before));
    for (int row = 0; row < camera.height; ++row) {
      for (int column = first; column < camera.width; ++column) {
        const auto i = static_cast<std::size_t>(row * camera.width + column);
        depth.depthMm[i] = nearer;
        labels[i] = 0;
      }
    }
    view.look(depth.depthMm, labels, 1, floorFromCamera);
  }

  [[nodiscard]] double worst(const BodyPose& pose) const {
    PosedModel body;
    poseBody(pose, Proportions(), body);
    SkeletonFrame frame;
    readJoints(body, frame);
    double max = 0.0;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      max = std::max(max, (frame.joints[j].position - truth.joints[j].position).norm());
    }
    return max;
  }

  DepthFrame depth;
  std::vector<std::uint8_t> labels;
  Isometry3 floorFromCamera;
  BodyView view;
  SkeletonFrame truth;
};

constexpr std::array<FitStage, 3> kStages = {{{0.30F, 150, 6}, {0.10F, 300, 6}, {0.06F, 600, 8}}};

PosePrior weakPrior(const BodyPose& pose) {
  PosePrior prior;
  prior.pose = pose;
  prior.stiffness.setConstant(0.5F);
  return prior;
}

TEST(BodyFit, FindsAPoseFromOneNearIt) {
  const BodyPose pose = standingPose(kPosition, 0.2F, 0.5F, 0.2F, 0.6F);
  const PosedScene scene(pose);
  BodyPose start = standingPose(kPosition + V3(0.08F, -0.015F, -0.1F), 0.0F, 0.3F, 0.1F, 0.3F);
  EXPECT_GT(scene.worst(start), 0.10);
  BodyFitter fitter;
  fitter.fit(scene.view, Proportions(), weakPrior(start), kStages, start);
  EXPECT_LT(scene.worst(start), 0.045);
}

TEST(BodyFit, StepsNeverRaiseTheCost) {
  const PosedScene scene(standingPose(kPosition, 0.0F, 1.2F, 0.0F, 0.2F));
  BodyPose pose = standingPose(kPosition + V3(0.1F, -0.015F, 0.1F), 0.5F, 0.2F, 0.3F, 1.0F);
  BodyFitter fitter;
  const PosePrior prior = weakPrior(pose);
  const FitStage judge = {0.1F, 300, 0};
  const std::array<FitStage, 1> one = {{{0.1F, 300, 1}}};
  float before = fitter.costOf(scene.view, Proportions(), prior, judge, pose).total();
  for (int step = 0; step < 12; ++step) {
    fitter.fit(scene.view, Proportions(), prior, one, pose);
    const float after = fitter.costOf(scene.view, Proportions(), prior, judge, pose).total();
    EXPECT_LE(after, before * 1.0001F);
    before = after;
  }
}

TEST(BodyFit, FreeSpaceKeepsLimbsOutOfTheBackground) {
  const BodyPose pose = standingPose(kPosition, 0.0F, 0.2F, 0.0F, 0.2F);
  const PosedScene scene(pose);
  BodyFitter fitter;
  const FitStage judge = {0.08F, 600, 0};
  const BodyPose raised = standingPose(kPosition, 0.0F, 1.5F, 0.0F, 0.2F);
  const FitCost right = fitter.costOf(scene.view, Proportions(), weakPrior(pose), judge, pose);
  const FitCost wrong = fitter.costOf(scene.view, Proportions(), weakPrior(raised), judge, raised);
  EXPECT_GT(wrong.freeSpace, right.freeSpace + 500.0F);
}

TEST(BodyFit, TheEdgeOfSomethingInFrontIsNotThePersonsOutline) {
  const BodyPose pose = standingPose(kPosition, 0.0F, 0.2F, 0.0F, 0.2F);
  BodyFitter fitter;
  const FitStage judge = {0.08F, 600, 0};
  PosedScene scene(pose);
  const FitCost whole = fitter.costOf(scene.view, Proportions(), weakPrior(pose), judge, pose);
  for (const double x : {0.08, 0.0, -0.05}) {
    scene.hideBeside(x, 0.5);
    const FitCost half = fitter.costOf(scene.view, Proportions(), weakPrior(pose), judge, pose);
    EXPECT_LT(half.freeSpace, whole.freeSpace + 5.0F) << x;
    BodyPose found = pose;
    fitter.fit(scene.view, Proportions(), weakPrior(found), kStages, found);
    EXPECT_LT((found.root - pose.root).norm(), 0.04F) << x;
  }
}

TEST(BodyFit, TheEdgeOfSomethingBehindIsThePersonsOutline) {
  // The same half of a person before something farther: half a body would be missing.
  const BodyPose pose = standingPose(kPosition, 0.0F, 0.2F, 0.0F, 0.2F);
  PosedScene scene(pose);
  scene.hideBeside(0.0, -0.5);
  BodyFitter fitter;
  EXPECT_GT(fitter.costOf(scene.view, Proportions(), weakPrior(pose), {0.08F, 600, 0}, pose).freeSpace, 500.0F);
}

TEST(BodyFit, FacingTheOtherWayCostsMore) {
  const BodyPose pose = standingPose(kPosition, 0.0F, 0.3F, 0.1F, 0.4F);
  const PosedScene scene(pose);
  BodyFitter fitter;
  const FitStage judge = {0.08F, 600, 0};
  BodyPose front = pose;
  BodyPose back = turnedAbout(pose, Proportions());
  fitter.fit(scene.view, Proportions(), weakPrior(front), kStages, front);
  fitter.fit(scene.view, Proportions(), weakPrior(back), kStages, back);
  EXPECT_LT(1.2F * fitter.costOf(scene.view, Proportions(), weakPrior(front), judge, front).plausible(),
            fitter.costOf(scene.view, Proportions(), weakPrior(back), judge, back).plausible());
}

TEST(BodyFit, ASizeThatIsWrongIsRepaired) {
  const PosedScene scene(standingPose(kPosition, 0.0F, 0.5F, 0.0F, 0.3F));
  BodyPose pose = standingPose(kPosition, 0.0F, 0.5F, 0.0F, 0.3F);
  Proportions proportions;
  proportions.factor[kSize] = 1.1F;  // the mannequin itself is 1
  BodyFitter fitter;
  std::array<float, kProportionCount> deviation;
  deviation.fill(0.03F);
  for (int round = 0; round < 12; ++round) {
    fitter.fit(scene.view, proportions, weakPrior(pose), kStages, pose);
    fitter.refineProportions(scene.view, deviation, pose, proportions);
  }
  EXPECT_NEAR(proportions.factor[kSize], 1.0F, 0.04F);
}

TEST(BodyFit, AnArmThatPointsForwardTakesItsShoulderAlong) {
  const BodyPose hanging = standingPose(kPosition, 0.0F, 0.1F, 0.0F, 0.0F);
  const BodyPose forward = standingPose(kPosition, 0.0F, 0.1F, 1.5F, 0.0F);
  for (const Node clavicle : {kLeftClavicle, kRightClavicle}) {
    EXPECT_NEAR(protractionOf(hanging, clavicle), 0.0F, 0.03F);
    EXPECT_NEAR(protractionOf(forward, clavicle), 0.45F, 0.03F);
  }
}

// Real arms are often shorter than the proportions learnt so far. The trunk must not turn away to make room for them.
TEST(BodyFit, ArmsThatAreShorterThanTheBodysDoNotPushTheShouldersBack) {
  const BodyPose pose = standingPose(kPosition, 0.0F, 0.2F, 1.3F, 0.1F);
  const PosedScene scene(pose);
  Proportions longer;
  longer.factor[kUpperArmLength] = longer.factor[kForearmLength] = 1.15F;
  BodyPose fitted = pose;
  BodyFitter fitter;
  fitter.fit(scene.view, longer, weakPrior(fitted), kStages, fitted);
  PosedModel body;
  poseBody(fitted, longer, body);
  for (const auto& [node, joint] :
       {std::pair{kLeftUpperArm, BodyJoint::kLeftShoulder}, std::pair{kRightUpperArm, BodyJoint::kRightShoulder}}) {
    EXPECT_LT((body.position[node].cast<double>() - scene.truth[joint].position).norm(), 0.025) << nameOf(joint);
  }
}

TEST(BodyFit, ALegThatIsNotSeenIsStraight) {
  const BodyPose pose = standingPose(kPosition, 0.0F, 0.3F, 0.0F, 0.2F);
  PosedScene scene(pose);
  scene.hideBelow(0.8);
  BodyPose bent = pose;
  bent.turn[kLeftThigh] = Q(Eigen::AngleAxisf(-0.8F, V3::UnitX()));
  bent.angle[kLeftShin][0] = 1.2F;
  BodyFitter fitter;
  fitter.fit(scene.view, Proportions(), weakPrior(bent), kStages, bent);
  EXPECT_LT(bent.angle[kLeftShin][0], 0.2F);
  EXPECT_LT(vectorOf(bent.turn[kLeftThigh]).norm(), 0.2F);
}

TEST(BodyFit, RestCostsTheSquareOfTheAnglesFromIt) {
  BodyPose pose = restPose();
  for (int limb = 0; limb < kFitLimbCount; ++limb)
    EXPECT_NEAR(restOf(static_cast<Limb>(limb), pose).cost(), 0.0F, 1e-6F);
  pose.angle[kLeftShin][0] += 0.5F;
  pose.turn[kLeftThigh] = Q(Eigen::AngleAxisf(-1.0F, V3::UnitX())) * pose.turn[kLeftThigh];
  const LimbRest rest = restOf(kLeftLeg, pose);
  EXPECT_NEAR(rest.cost(), rest.weight * 1.25F, 1e-3F);
  EXPECT_NEAR(rest.turn.x(), -1.0F, 1e-5F);
}

TEST(SurfaceMatch, SkipsOnlyCapsulesThatCannotBeNearest) {
  PosedModel body;
  poseBody(standingPose(kPosition, 0.7F, 0.9F, 0.6F, 1.1F), Proportions(), body);
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  for (int i = 0; i < 20'000; ++i) {
    V3 direction, normal;
    for (int k = 0; k < 3; ++k) direction[k] = unit(random);
    for (int k = 0; k < 3; ++k) normal[k] = unit(random);
    const V3 position = kPosition + direction;
    const V3 ray = position.normalized();
    normal.normalize();
    SurfaceMatch found, nearest;
    for (int c = 0; c < kCapsuleCount; ++c) {
      matchCapsule(body, c, position, normal, ray, found);
      SurfaceMatch alone;
      matchCapsule(body, c, position, normal, ray, alone);
      if (alone.costSq < nearest.costSq) nearest = alone;
    }
    ASSERT_EQ(found.capsule, nearest.capsule) << i;
    ASSERT_EQ(found.costSq, nearest.costSq) << i;
    ASSERT_GE(found.bound * found.bound, found.costSq) << i;
  }
}

TEST(LimbSearch, FindsAnArmThatIsElsewhere) {
  const BodyPose pose = standingPose(kPosition, 0.0F, 1.6F, 0.0F, 0.1F);
  const PosedScene scene(pose);
  PosedModel body;
  poseBody(pose, Proportions(), body);
  BodyPose lost = pose;
  layLimb(kLeftArm, body, -V3::UnitY(), -V3::UnitY(), lost);
  LimbSearch search;
  const auto found = search.search(scene.view, Proportions(), lost, kLeftArm);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found[0].cost, 0.5F * search.presentCost());
  PosedModel best;
  poseBody(found[0].pose, Proportions(), best);
  EXPECT_LT((best.position[kLeftHand] - body.position[kLeftHand]).norm(), 0.15F);
}

TEST(LimbSearch, LeavesAnArmThatIsRight) {
  const BodyPose pose = standingPose(kPosition, 0.0F, 1.2F, 0.3F, 0.8F);
  const PosedScene scene(pose);
  LimbSearch search;
  for (const Limb limb : {kLeftArm, kRightArm, kLeftLeg, kRightLeg}) {
    const auto found = search.search(scene.view, Proportions(), pose, limb);
    if (found.empty()) continue;
    EXPECT_GT(found[0].cost, search.presentCost() - 30.0F) << int{limb};
  }
}

constexpr float kFrame = 1.0F / 30.0F;  // [s]
constexpr float kPi = 3.14159265F;

JointConfidence confidenceOf(float seen) {
  CapsuleSupport support;
  support.seen.fill(seen);
  JointConfidence confidence;
  confidence.restart();
  for (int view = 0; view < 6; ++view) confidence.update(support, false);
  return confidence;
}

/// Both arms at an angle from hanging, forwards [rad].
BodyPose armsAt(float forward, float heading = 0.0F) {
  return standingPose(V3(0.0F, 0.9F, -2.0F), heading, 0.1F, forward, 0.3F);
}

PosedModel posed(const BodyPose& pose) {
  PosedModel body;
  poseBody(pose, Proportions(), body);
  return body;
}

/// The farthest that an elbow or wrist moves against its shoulder [m].
float moveOfArms(const BodyPose& from, const BodyPose& to) {
  const PosedModel a = posed(from), b = posed(to);
  float farthest = 0.0F;
  for (const auto& [shoulder, elbow, wrist] :
       {std::array{kLeftUpperArm, kLeftForearm, kLeftHand}, std::array{kRightUpperArm, kRightForearm, kRightHand}}) {
    for (const Node node : {elbow, wrist}) {
      const V3 before = a.position[node] - a.position[shoulder], now = b.position[node] - b.position[shoulder];
      farthest = std::max(farthest, (now - before).norm());
    }
  }
  return farthest;
}

TEST(CalmLimbs, WhatIsSeenIsShownWhereItIsHoweverFastItMoves) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  // A punch: from rest to 8 m/s within four frames.
  float angle = 0.0F;
  for (const float step : {0.0F, 0.0F, 0.15F, 0.3F, 0.5F, 0.5F, 0.3F, 0.0F}) {
    angle += step;
    calm.update(armsAt(angle), Proportions(), seen, kFrame);
    EXPECT_LT(moveOfArms(armsAt(angle), calm.pose()), 1e-6F) << angle;
  }
}

TEST(CalmLimbs, AGuessedArmMovesNoFasterThanPeopleMoveTheirs) {
  const JointConfidence guessed = confidenceOf(0.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  for (int frame = 1; frame < 30; ++frame) {
    const BodyPose before = calm.pose();
    // Fitted elsewhere in each view, and the whole body turns about in one of them.
    const BodyPose fitted = armsAt(frame % 2 == 1 ? 2.5F : -0.4F, frame < 15 ? 0.0F : kPi);
    calm.update(fitted, Proportions(), guessed, kFrame);
    EXPECT_LT(moveOfArms(before, calm.pose()), 0.11F) << frame;
    SkeletonFrame shown;
    for (TrackedJoint& joint : shown.joints) joint.confidence = 1.0;
    calm.doubt(shown);
    // Once the trunk has turned, the arm is back where it was in every other view.
    if (frame < 15 || frame % 2 == 1) {
      EXPECT_LT(shown[BodyJoint::kLeftHand].confidence, 0.5) << frame;
    }
    EXPECT_EQ(shown[BodyJoint::kHead].confidence, 1.0) << frame;
  }
}

/// The farthest that head, shoulders and hips move [m].
float moveOfTrunk(const BodyPose& from, const BodyPose& to) {
  const PosedModel a = posed(from), b = posed(to);
  float farthest = (headOf(b) - headOf(a)).norm();
  for (const Node node : {kLeftUpperArm, kRightUpperArm, kLeftThigh, kRightThigh}) {
    farthest = std::max(farthest, (b.position[node] - a.position[node]).norm());
  }
  return farthest;
}

TEST(CalmLimbs, ATrunkThatMovesAsPeopleDoIsShownWhereItIs) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  BodyPose pose = armsAt(0.0F);
  // A jump to the side: from rest to 4.5 m/s within four frames.
  for (const float step : {0.0F, 0.0F, 0.03F, 0.07F, 0.11F, 0.15F, 0.15F, 0.05F}) {
    pose.root.x() += step;
    calm.update(pose, Proportions(), seen, kFrame);
    EXPECT_LT(moveOfTrunk(pose, calm.pose()), 1e-6F) << step;
  }
}

TEST(CalmLimbs, ATrunkThatIsFittedElsewhereIsShownOnTheWayThere) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), seen, kFrame);
  BodyPose leaning = armsAt(0.0F);
  leaning.turn[kPelvis] = leaning.turn[kPelvis] * Q(Eigen::AngleAxisf(0.3F, V3::UnitX()));
  const BodyPose before = calm.pose();
  ASSERT_GT(moveOfTrunk(before, leaning), 0.15F);
  calm.update(leaning, Proportions(), seen, kFrame);
  EXPECT_LT(moveOfTrunk(before, calm.pose()), 0.09F);
  EXPECT_GT(moveOfTrunk(before, calm.pose()), 0.06F);
  calm.update(leaning, Proportions(), seen, kFrame);
  calm.update(leaning, Proportions(), seen, kFrame);
  EXPECT_LT(moveOfTrunk(leaning, calm.pose()), 1e-6F);
}

TEST(CalmLimbs, AFloorThatIsFoundLaterIsNoMovement) {
  const JointConfidence seen = confidenceOf(9.0F);
  CalmLimbs calm;
  BodyPose pose = armsAt(0.0F);
  calm.update(pose, Proportions(), seen, kFrame);
  Eigen::Isometry3f newFromOld(Eigen::AngleAxisf(0.2F, V3::UnitX()));
  newFromOld.translation() = V3(0.0F, 0.5F, 0.1F);
  calm.move(newFromOld);
  pose.root = newFromOld * pose.root;
  pose.turn[kPelvis] = Q(newFromOld.linear()) * pose.turn[kPelvis];
  calm.update(pose, Proportions(), seen, kFrame);
  EXPECT_LT(moveOfTrunk(pose, calm.pose()), 1e-6F);
}

TEST(CalmLimbs, AnArmThatIsSeenAgainArrivesAndIsSureFromThenOn) {
  const JointConfidence guessed = confidenceOf(0.0F), seen = confidenceOf(9.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  const BodyPose up = armsAt(2.5F);
  const auto isSure = [&] {
    SkeletonFrame shown;
    for (TrackedJoint& joint : shown.joints) joint.confidence = 1.0;
    calm.doubt(shown);
    return shown[BodyJoint::kLeftHand].confidence >= 0.5;
  };
  int frames = 0;
  do {
    calm.update(up, Proportions(), seen, kFrame);
    EXPECT_EQ(isSure(), moveOfArms(up, calm.pose()) <= 0.03F);
  } while (!isSure() && ++frames < 30);
  // 0.9 m of chord along an arc of 1.2 m, at 3.5 m/s.
  EXPECT_GE(frames, 6);
  EXPECT_LE(frames, 12);
}

TEST(CalmLimbs, AfterALongPauseThePoseIsShownAsItIs) {
  const JointConfidence guessed = confidenceOf(0.0F);
  CalmLimbs calm;
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  calm.update(armsAt(2.5F), Proportions(), guessed, 0.5F);
  EXPECT_LT(moveOfArms(armsAt(2.5F), calm.pose()), 1e-6F);
  calm.restart();
  calm.update(armsAt(0.0F), Proportions(), guessed, kFrame);
  EXPECT_LT(moveOfArms(armsAt(0.0F), calm.pose()), 1e-6F);
}

}  // namespace
}  // namespace lorica::fit
