#include "capture/retarget/sender_rest.h"

#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

/// What a program sends that sends its bones' own transforms.
BonePose rawPose(const Skeleton& skeleton, std::span<const JointTransform> pose) {
  BonePose raw;
  for (std::size_t b = 0; b < raw.rotation.size(); ++b) {
    const JointIndex joint = skeleton.jointOf(static_cast<HumanBone>(b));
    if (joint == kNoJoint) continue;
    raw.rotation[b] = pose[static_cast<std::size_t>(joint)].rotation;
    raw.offset[b] = pose[static_cast<std::size_t>(joint)].translation;
  }
  return raw;
}

/// Worst difference of rotations [rad] and positions [m] of all bones.
double difference(const Skeleton& skeleton, const BonePose& a, const BonePose& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.rotation.size(); ++i) {
    if (skeleton.jointOf(static_cast<HumanBone>(i)) == kNoJoint) continue;
    worst = std::max(worst, a.rotation[i]->angularDistance(*b.rotation[i]));
    worst = std::max(worst, (a.offset[i] - b.offset[i]).norm());
  }
  return worst;
}

TEST(SenderRest, RawTransformsOfCrookedBonesBecomeThoseFromTheTpose) {
  RandomNumbers random(11);
  test::FigureSettings crooked;
  crooked.crookedAxes = true;
  crooked.armsDown = test::degrees(50.0);
  for (const Skeleton& skeleton : {test::makeFigure(crooked).skeleton, makeMannequin().skeleton}) {
    const Result<SenderRest> rest = SenderRest::create(skeleton);
    Result<BonePoseReader> reader = BonePoseReader::create(skeleton);
    ASSERT_TRUE(rest && reader);
    for (int i = 0; i < 20; ++i) {
      Pose pose = restPose(skeleton);
      for (std::size_t j = 0; j < pose.size(); ++j) {
        if (!skeleton.joint(static_cast<JointIndex>(j)).bone || i == 0) continue;
        Vec3 axis;
        for (double& value : axis) value = random.between(-1.0, 1.0);
        const double angle = random.between(-2.0, 2.0);
        pose[j].rotation = pose[j].rotation * Quat(Eigen::AngleAxisd(angle, axis.normalized()));
      }
      BonePose sent = rawPose(skeleton, pose);
      rest->apply(sent);
      EXPECT_LT(difference(skeleton, sent, reader->read(pose)), 1e-6) << i;
    }
  }
}

TEST(SenderRest, ProportionsThatAreNotSentAreTheModels) {
  const Skeleton skeleton = makeMannequin().skeleton;
  const Result<SenderRest> rest = SenderRest::create(skeleton);
  Result<BonePoseReader> reader = BonePoseReader::create(skeleton);
  ASSERT_TRUE(rest && reader);
  BonePose sent = rawPose(skeleton, restPose(skeleton));
  sent.offset.fill(Vec3::Zero());
  rest->apply(sent);
  EXPECT_LT(difference(skeleton, sent, reader->read(restPose(skeleton))), 1e-6);
}

}  // namespace
}  // namespace lorica
