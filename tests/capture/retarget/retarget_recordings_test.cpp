#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
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
using B = HumanBone;

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
