#include "tests/bench/generators/synthetic_motion.h"

#include "capture/files/joint_csv.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace lorica {
namespace {

using enum BodyJoint;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

constexpr double kFrameRate = 30.0;
constexpr std::array kFeet{kLeftFoot, kRightFoot};

// Measures of a recorded person, taken from positions and orientations alone.

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Distance between two segments [m].
double segmentDistance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  // Distance to a segment is convex along the other, so a ternary search finds the minimum.
  const auto toB = [&](const Vec3& p) {
    const Vec3 d = b1 - b0;
    const double t = d.squaredNorm() > 0.0 ? std::clamp((p - b0).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    return (p - b0 - t * d).norm();
  };
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double l = low + (high - low) / 3.0;
    const double h = high - (high - low) / 3.0;
    if (toB(a0 + l * (a1 - a0)) < toB(a0 + h * (a1 - a0))) {
      high = h;
    } else {
      low = l;
    }
  }
  return toB(a0 + low * (a1 - a0));
}

/// Heel, ball and toe tip on the sole of a bare foot whose ankle is 0.085 m high.
std::array<Vec3, 3> soleOf(const SkeletonFrame& frame, BodyJoint foot) {
  const TrackedJoint& joint = frame[foot];
  const auto at = [&](double ahead) -> Vec3 { return joint.position + *joint.orientation * Vec3(0.0, -0.085, ahead); };
  return {at(-0.05), at(0.145), at(0.185)};
}

/// A thick limb: approximate volume of a body part.
struct Capsule {
  std::string name;
  Vec3 from, to;
  double radius;
};

/// Trunk, head, arms, legs and feet.
std::vector<Capsule> bodyOf(const SkeletonFrame& f) {
  const auto at = [&](BodyJoint j) { return f[j].position; };
  const Vec3 hips = 0.5 * (at(kLeftHip) + at(kRightHip));
  // The trunk ends below the shoulders; the head is a ball.
  const Vec3 chest = at(kTorso) + 0.65 * (at(kNeck) - at(kTorso));
  std::vector<Capsule> body{{"trunk", hips, chest, 0.12}, {"head", at(kHead), at(kHead), 0.10}};
  const auto side = [&](const std::string& name, BodyJoint shoulder, BodyJoint elbow, BodyJoint hand, BodyJoint hip,
                        BodyJoint knee, BodyJoint foot) {
    body.push_back({name + " upper arm", at(shoulder), at(elbow), 0.045});
    body.push_back({name + " forearm", at(elbow), at(hand), 0.04});
    body.push_back({name + " thigh", at(hip), at(knee), 0.07});
    body.push_back({name + " shin", at(knee), at(foot), 0.05});
    const auto sole = soleOf(f, foot);
    const Vec3 up = *f[foot].orientation * Vec3(0.0, 0.03, 0.0);
    body.push_back({name + " foot", sole[0] + up, sole[1] + up, 0.03});
  };
  side("left", kLeftShoulder, kLeftElbow, kLeftHand, kLeftHip, kLeftKnee, kLeftFoot);
  side("right", kRightShoulder, kRightElbow, kRightHand, kRightHip, kRightKnee, kRightFoot);
  return body;
}

/// Whether two capsules of bodyOf are neighbours that touch at a joint.
bool adjacent(const std::string& a, const std::string& b) {
  const auto is = [&](const std::string& x, const std::string& y) { return (a == x && b == y) || (a == y && b == x); };
  if (is("trunk", "head")) return true;
  for (const std::string side : {"left ", "right "}) {
    if (is("trunk", side + "upper arm") || is("trunk", side + "thigh") || is(side + "upper arm", side + "forearm") ||
        is(side + "thigh", side + "shin") || is(side + "shin", side + "foot")) {
      return true;
    }
  }
  return false;
}

/// Centre of mass: Winter's segment masses, centres along the segments.
Vec3 massCentre(const SkeletonFrame& f) {
  const auto along = [&](BodyJoint a, BodyJoint b, double share) -> Vec3 {
    return f[a].position + share * (f[b].position - f[a].position);
  };
  const Vec3 hips = along(kLeftHip, kRightHip, 0.5);
  const Vec3 trunk = 0.284 * along(kTorso, kNeck, 0.5) + 0.213 * 0.5 * (hips + f[kTorso].position);
  const Vec3 arms = 0.028 * (along(kLeftShoulder, kLeftElbow, 0.44) + along(kRightShoulder, kRightElbow, 0.44)) +
                    0.022 * (along(kLeftElbow, kLeftHand, 0.68) + along(kRightElbow, kRightHand, 0.68));
  const Vec3 legs = 0.100 * (along(kLeftHip, kLeftKnee, 0.43) + along(kRightHip, kRightKnee, 0.43)) +
                    0.0465 * (along(kLeftKnee, kLeftFoot, 0.43) + along(kRightKnee, kRightFoot, 0.43)) +
                    0.0145 * (f[kLeftFoot].position + f[kRightFoot].position);
  return 0.081 * f[kHead].position + trunk + arms + legs;
}

/// The pelvis frame from hips and torso: X to the left hip, Y up the trunk.
Mat3 pelvisAxes(const SkeletonFrame& f) {
  const Vec3 hips = 0.5 * (f[kLeftHip].position + f[kRightHip].position);
  Mat3 axes;
  axes.col(1) = (f[kTorso].position - hips).normalized();
  axes.col(0) = f[kLeftHip].position - f[kRightHip].position;
  axes.col(0) = (axes.col(0) - axes.col(0).dot(axes.col(1)) * axes.col(1)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

const std::vector<SkeletonFrame>& framesOf(std::string_view motion) {
  static std::map<std::string_view, std::vector<SkeletonFrame>> made;
  auto [at, isNew] = made.try_emplace(motion);
  if (isNew) at->second = synthesizeMotion(motion);
  return at->second;
}

class SyntheticMotions : public testing::TestWithParam<std::string_view> {
 protected:
  const std::vector<SkeletonFrame>& frames = framesOf(GetParam());

  Vec3 at(std::size_t frame, BodyJoint joint) const { return frames[frame][joint].position; }
};

INSTANTIATE_TEST_SUITE_P(Motions, SyntheticMotions, testing::ValuesIn(kShippedMotions),
                         [](const auto& param) { return std::string(param.param); });

TEST_P(SyntheticMotions, LastFiveToTwentySecondsAtThirtyHertz) {
  ASSERT_GE(frames.size(), 2u);
  EXPECT_GE(frames.back().time, 5.0);
  EXPECT_LE(frames.back().time, 20.0);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_NEAR(frames[i].time, static_cast<double>(i) / kFrameRate, 1e-9);
    ASSERT_EQ(frames[i].user, 1);
    for (const TrackedJoint& joint : frames[i].joints) {
      ASSERT_EQ(joint.confidence, 1.0);
      ASSERT_TRUE(joint.orientation.has_value());
      ASSERT_NEAR(joint.orientation->norm(), 1.0, 1e-12);
      ASSERT_TRUE(joint.position.allFinite());
    }
  }
}

TEST_P(SyntheticMotions, BonesKeepTheirLength) {
  constexpr std::pair<BodyJoint, BodyJoint> kBones[] = {
      {kNeck, kHead},
      {kTorso, kNeck},
      {kNeck, kLeftShoulder},
      {kNeck, kRightShoulder},
      {kTorso, kLeftHip},
      {kTorso, kRightHip},
      {kLeftHip, kRightHip},
      {kLeftShoulder, kLeftElbow},
      {kLeftElbow, kLeftHand},
      {kLeftHip, kLeftKnee},
      {kLeftKnee, kLeftFoot},
      {kRightShoulder, kRightElbow},
      {kRightElbow, kRightHand},
      {kRightHip, kRightKnee},
      {kRightKnee, kRightFoot},
  };
  for (const auto& [a, b] : kBones) {
    const double length = (at(0, a) - at(0, b)).norm();
    for (std::size_t i = 1; i < frames.size(); ++i) {
      ASSERT_NEAR((at(i, a) - at(i, b)).norm(), length, 1e-3) << nameOf(a) << " to " << nameOf(b) << ", frame " << i;
    }
  }
  // An adult of about 1.75 m: the crown is 0.12 m above the middle of the head.
  const double floor = std::min(at(0, kLeftFoot).y(), at(0, kRightFoot).y()) - 0.085;
  EXPECT_NEAR(floor, 0.0, 1e-6);
  EXPECT_NEAR(at(0, kHead).y() + 0.12, 1.74, 0.03);
}

TEST_P(SyntheticMotions, JointsBendNoFartherThanAPersons) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const SkeletonFrame& f = frames[i];
    const Mat3 pelvis = pelvisAxes(f);
    const Quat chest = *f[kTorso].orientation;
    SCOPED_TRACE("frame " + std::to_string(i));

    const double neck = chest.angularDistance(*f[kHead].orientation);
    ASSERT_LT(neck, 75.0 * kDegree);
    const Vec3 spine = pelvis.transpose() * (chest * Vec3::UnitY());
    ASSERT_LT(angleBetween(spine, Vec3::UnitY()), 50.0 * kDegree);
    ASSERT_LT(angleBetween(pelvis.col(0), chest * Vec3::UnitX()), 50.0 * kDegree);

    for (const bool left : {true, false}) {
      const double mirror = left ? 1.0 : -1.0;
      const Vec3 upperArm = at(i, left ? kLeftElbow : kRightElbow) - at(i, left ? kLeftShoulder : kRightShoulder);
      const Vec3 forearm = at(i, left ? kLeftHand : kRightHand) - at(i, left ? kLeftElbow : kRightElbow);
      ASSERT_LT(angleBetween(upperArm, forearm), 150.0 * kDegree);
      // The elbow is a hinge and folds to one side only.
      const Quat worldFromUpper = *f[left ? kLeftShoulder : kRightShoulder].orientation;
      const Vec3 fold = worldFromUpper.conjugate() * forearm.normalized();
      ASSERT_NEAR(fold.y(), 0.0, 1e-6);
      ASSERT_GT(fold.z(), 0.0);
      const Vec3 inChest = chest.conjugate() * upperArm.normalized();
      ASSERT_GT(mirror * inChest.x(), -0.5) << "the upper arm crosses the chest";
      ASSERT_GT(inChest.z(), -0.6) << "the upper arm is too far behind";

      const Vec3 thigh = at(i, left ? kLeftKnee : kRightKnee) - at(i, left ? kLeftHip : kRightHip);
      const Vec3 shin = at(i, left ? kLeftFoot : kRightFoot) - at(i, left ? kLeftKnee : kRightKnee);
      const double knee = angleBetween(thigh, shin);
      ASSERT_LT(knee, 150.0 * kDegree);
      const Quat foot = *f[left ? kLeftFoot : kRightFoot].orientation;
      const Vec3 toes = foot * Vec3::UnitZ();
      if (knee > 5.0 * kDegree) {
        // It folds backward about the axis through the foot that points to the left.
        const Vec3 hinge = thigh.cross(shin).normalized();
        ASSERT_LT(angleBetween(hinge, foot * Vec3::UnitX()), 45.0 * kDegree) << "the knee bends backward or is twisted";
      }
      const Vec3 inPelvis = pelvis.transpose() * thigh.normalized();
      const double flexion = std::atan2(inPelvis.z(), -inPelvis.y());
      ASSERT_GT(flexion, -30.0 * kDegree);
      ASSERT_LT(flexion, 130.0 * kDegree);
      ASSERT_GT(mirror * inPelvis.x(), -0.35) << "the thighs cross";
      ASSERT_LT(mirror * inPelvis.x(), std::sin(65.0 * kDegree));
      // Between foot and shin: 90 degrees when standing.
      const double ankle = angleBetween(-shin, toes) - 90.0 * kDegree;
      ASSERT_GT(ankle, -45.0 * kDegree) << "toes too far up";
      ASSERT_LT(ankle, 65.0 * kDegree) << "toes too far down";
    }
  }
}

TEST_P(SyntheticMotions, OrientationsFollowTheBones) {
  struct Bone {
    BodyJoint from, to;
    Vec3 inTPose;
  };
  const Bone bones[] = {
      {kLeftShoulder, kLeftElbow, Vec3::UnitX()},
      {kLeftElbow, kLeftHand, Vec3::UnitX()},
      {kRightShoulder, kRightElbow, -Vec3::UnitX()},
      {kRightElbow, kRightHand, -Vec3::UnitX()},
      {kLeftHip, kLeftKnee, -Vec3::UnitY()},
      {kLeftKnee, kLeftFoot, -Vec3::UnitY()},
      {kRightHip, kRightKnee, -Vec3::UnitY()},
      {kRightKnee, kRightFoot, -Vec3::UnitY()},
      {kTorso, kNeck, Vec3::UnitY()},
      {kNeck, kHead, Vec3::UnitY()},
  };
  for (const Bone& bone : bones) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Vec3 turned = *frames[i][bone.from].orientation * bone.inTPose;
      ASSERT_LT(angleBetween(turned, at(i, bone.to) - at(i, bone.from)), 1.0 * kDegree)
          << nameOf(bone.from) << ", frame " << i;
    }
  }
}

TEST_P(SyntheticMotions, FeetDoNotSkateOrSink) {
  constexpr double kTouching = 0.004;
  for (const BodyJoint foot : kFeet) {
    for (const std::size_t point : {0u, 1u}) {  // heel and ball: each stays where it touches
      double slid = 0.0;
      for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
        const Vec3 now = soleOf(frames[i], foot)[point];
        const Vec3 next = soleOf(frames[i + 1], foot)[point];
        if (now.y() > kTouching || next.y() > kTouching) {
          slid = 0.0;
          continue;
        }
        slid += (next - now).cwiseProduct(Vec3(1.0, 0.0, 1.0)).norm();
        ASSERT_LT(slid, 0.005) << nameOf(foot) << " point " << point << " slides, frame " << i;
      }
    }
    for (std::size_t i = 0; i < frames.size(); ++i) {
      for (const Vec3& p : soleOf(frames[i], foot)) {
        // Toe tips may penetrate the floor by the amount that real toes would bend.
        const bool toes = (p - soleOf(frames[i], foot)[2]).norm() < 1e-9;
        ASSERT_GT(p.y(), toes ? -0.03 : -0.002) << nameOf(foot) << ", frame " << i;
      }
    }
  }
}

TEST_P(SyntheticMotions, StandsUnlessItJumps) {
  if (GetParam() == "jumping_jacks") return;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    double lowest = 1.0;
    for (const BodyJoint foot : kFeet) {
      for (const Vec3& p : soleOf(frames[i], foot)) lowest = std::min(lowest, p.y());
    }
    ASSERT_LT(lowest, 0.003) << "both feet are in the air, frame " << i;
  }
}

TEST_P(SyntheticMotions, MovesLikeMatterNotLikeATeleport) {
  for (int j = 0; j < kBodyJointCount; ++j) {
    const auto joint = static_cast<BodyJoint>(j);
    const bool limb = joint != kTorso && joint != kNeck && joint != kHead && joint != kLeftHip && joint != kRightHip;
    for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
      const Vec3 rate = (at(i + 1, joint) - at(i, joint)) * kFrameRate;
      const Vec3 change = (at(i + 1, joint) - 2.0 * at(i, joint) + at(i - 1, joint)) * kFrameRate * kFrameRate;
      ASSERT_LT(rate.norm(), limb ? 12.0 : 3.5) << nameOf(joint) << ", frame " << i;
      ASSERT_LT(change.norm(), limb ? 160.0 : 45.0) << nameOf(joint) << ", frame " << i;
      const double turn = frames[i][joint].orientation->angularDistance(*frames[i + 1][joint].orientation);
      ASSERT_LT(turn, 45.0 * kDegree) << nameOf(joint) << " turns too fast, frame " << i;
    }
  }
}

TEST_P(SyntheticMotions, NothingPassesThroughItself) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::vector<Capsule> body = bodyOf(frames[i]);
    for (std::size_t a = 0; a < body.size(); ++a) {
      for (std::size_t b = a + 1; b < body.size(); ++b) {
        if (adjacent(body[a].name, body[b].name)) continue;
        const double gap =
            segmentDistance(body[a].from, body[a].to, body[b].from, body[b].to) - body[a].radius - body[b].radius;
        ASSERT_GT(gap, -0.005) << body[a].name << " and " << body[b].name << ", frame " << i;
      }
    }
  }
}

TEST_P(SyntheticMotions, StaysBeforeTheCamera) {
  for (const std::size_t i : {std::size_t{0}, frames.size() - 1}) {
    EXPECT_LT(at(i, kTorso).cwiseProduct(Vec3(1.0, 0.0, 1.0)).norm(), 1.0);
    EXPECT_LT(angleBetween(pelvisAxes(frames[i]).col(2), Vec3::UnitZ()), 15.0 * kDegree);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_LT(at(i, kTorso).cwiseProduct(Vec3(1.0, 0.0, 1.0)).norm(), 2.5) << "frame " << i;
  }
}

TEST_P(SyntheticMotions, TheShippedFileHoldsThisMotion) {
  const auto file = test::recordingsFolder() / (std::string(GetParam()) + ".csv");
  const auto shipped = readJointCsv(file);
  ASSERT_TRUE(shipped.ok()) << shipped.error().message;
  ASSERT_EQ(shipped->size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_NEAR((*shipped)[i].time, frames[i].time, 1e-6);
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& inFile = (*shipped)[i].joints[j];
      const TrackedJoint& made = frames[i].joints[j];
      ASSERT_LT((inFile.position - made.position).cwiseAbs().maxCoeff(), 0.6e-5) << "frame " << i << ", joint " << j;
      ASSERT_TRUE(inFile.orientation.has_value());
      ASSERT_LT(inFile.orientation->angularDistance(*made.orientation), 5e-5) << "frame " << i << ", joint " << j;
      ASSERT_EQ(inFile.confidence, 1.0);
    }
  }
}

TEST_P(SyntheticMotions, RoundedTheyAreTheShippedFileBitForBit) {
  const std::vector<SkeletonFrame> shipped = shippedFrames(GetParam());
  std::vector<SkeletonFrame> rounded = frames;
  roundForFile(rounded);
  std::string text = jointCsvHeader();
  for (const SkeletonFrame& frame : rounded) text += jointCsvRow(frame);
  const std::vector<SkeletonFrame> made = parseJointCsv(text, "made").value();
  ASSERT_EQ(shipped.size(), made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    ASSERT_EQ(shipped[i].time, made[i].time);
    ASSERT_EQ(shipped[i].user, made[i].user);
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      ASSERT_EQ(shipped[i].joints[j].position, made[i].joints[j].position) << "frame " << i << ", joint " << j;
      ASSERT_EQ(shipped[i].joints[j].orientation->coeffs(), made[i].joints[j].orientation->coeffs());
      ASSERT_EQ(shipped[i].joints[j].confidence, made[i].joints[j].confidence);
    }
  }
}

TEST_P(SyntheticMotions, TwiceGivesTheSame) {
  const std::vector<SkeletonFrame> again = synthesizeMotion(GetParam());
  ASSERT_EQ(again.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      ASSERT_EQ(again[i].joints[j].position, frames[i].joints[j].position);
      ASSERT_EQ(again[i].joints[j].orientation->coeffs(), frames[i].joints[j].orientation->coeffs());
    }
  }
}

// --- Checks specific to each motion. ---

double highest(std::string_view motion, BodyJoint joint) {
  double top = 0.0;
  for (const SkeletonFrame& f : framesOf(motion)) top = std::max(top, f[joint].position.y());
  return top;
}

TEST(SyntheticMotion, WalkIsAGaitWithSwingingArms) {
  const auto& frames = framesOf("walk");
  double travelled = 0.0;
  double fastest = 0.0;
  double together = 0.0;
  for (std::size_t i = 10; i + 10 < frames.size(); ++i) {
    const Vec3 flat(1.0, 0.0, 1.0);
    travelled += (frames[i + 1][kTorso].position - frames[i][kTorso].position).cwiseProduct(flat).norm();
    const Vec3 rate = (frames[i + 10][kTorso].position - frames[i - 10][kTorso].position) * kFrameRate / 20.0;
    fastest = std::max(fastest, rate.norm());
    // If left hand and left foot were ahead of the body at the same time, it would be an amble.
    const Mat3 pelvis = pelvisAxes(frames[i]);
    const double hand = (frames[i][kLeftHand].position - frames[i][kTorso].position).dot(pelvis.col(2));
    const double foot = (frames[i][kLeftFoot].position - frames[i][kRightFoot].position).dot(pelvis.col(2));
    together += (hand - 0.06) * foot;
  }
  EXPECT_GT(travelled, 8.0);
  EXPECT_NEAR(fastest, 1.2, 0.12);
  EXPECT_LT(together, -0.5);
}

TEST(SyntheticMotion, WaveLiftsOneHandThenBoth) {
  int right = 0;
  int both = 0;
  int turns = 0;
  double lastRate = 0.0;
  const auto& frames = framesOf("wave");
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const double head = frames[i][kHead].position.y() - 0.1;
    const bool rightUp = frames[i][kRightHand].position.y() > head;
    const bool leftUp = frames[i][kLeftHand].position.y() > head;
    EXPECT_TRUE(rightUp || !leftUp || i > 150);
    right += rightUp && !leftUp ? 1 : 0;
    both += rightUp && leftUp ? 1 : 0;
    const double rate = frames[i][kRightHand].position.x() - frames[i - 1][kRightHand].position.x();
    if (rightUp && rate * lastRate < 0.0) ++turns;
    lastRate = rate;
  }
  EXPECT_GT(right, 60);
  EXPECT_GT(both, 50);
  EXPECT_GE(turns, 8);
}

TEST(SyntheticMotion, JumpingJacksFlyInParabolas) {
  const auto& frames = framesOf("jumping_jacks");
  std::vector<bool> flies;
  for (const SkeletonFrame& f : frames) {
    double lowest = 1.0;
    for (const BodyJoint foot : kFeet) {
      for (const Vec3& p : soleOf(f, foot)) lowest = std::min(lowest, p.y());
    }
    flies.push_back(lowest > 0.002);
  }
  int flights = 0;
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
    if (flies[i] && !flies[i - 1]) ++flights;
    if (!flies[i - 1] || !flies[i] || !flies[i + 1]) continue;
    const double fall = (massCentre(frames[i + 1]) - 2.0 * massCentre(frames[i]) + massCentre(frames[i - 1])).y() *
                        kFrameRate * kFrameRate;
    EXPECT_NEAR(fall, -9.81, 0.02) << "frame " << i;
  }
  EXPECT_EQ(flights, 14);
  EXPECT_GT(highest("jumping_jacks", kLeftHand), 1.95);
}

TEST(SyntheticMotion, SquatKeepsBalance) {
  double lowestHip = 1.0;
  for (const SkeletonFrame& f : framesOf("squat_and_reach")) {
    lowestHip = std::min(lowestHip, f[kLeftHip].position.y());
    const Vec3 mass = massCentre(f);
    const auto left = soleOf(f, kLeftFoot);
    const auto right = soleOf(f, kRightFoot);
    ASSERT_LT(mass.x(), left[0].x()) << "time " << f.time;
    ASSERT_GT(mass.x(), right[0].x()) << "time " << f.time;
    ASSERT_LT(mass.z(), left[2].z() - 0.01) << "time " << f.time;
    // On tiptoe the heels carry no weight.
    ASSERT_GT(mass.z(), left[0].y() > 0.02 ? left[1].z() - 0.06 : left[0].z() + 0.01) << "time " << f.time;
  }
  EXPECT_LT(lowestHip, 0.58);
  EXPECT_GT(highest("squat_and_reach", kLeftHand), 2.0);
}

TEST(SyntheticMotion, PunchesReachOutAndKicksGoHigh) {
  const auto& frames = framesOf("punch_and_kick");
  const auto strikes = [&](auto&& measure, double threshold) {
    int count = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) {
      if (measure(frames[i]) > threshold && measure(frames[i - 1]) <= threshold) ++count;
    }
    return count;
  };
  const auto leftFist = [](const SkeletonFrame& f) { return f[kLeftHand].position.z() - f[kTorso].position.z(); };
  const auto rightFist = [](const SkeletonFrame& f) { return f[kRightHand].position.z() - f[kTorso].position.z(); };
  EXPECT_EQ(strikes(leftFist, 0.55), 3) << "two jabs and one more; the hook stays short";
  EXPECT_EQ(strikes(rightFist, 0.55), 3) << "three crosses";
  EXPECT_EQ(strikes([](const SkeletonFrame& f) { return f[kRightFoot].position.y(); }, 0.8), 2) << "two kicks";
  // While kicking, the person stands over the left foot.
  for (const SkeletonFrame& f : frames) {
    if (f[kRightFoot].position.y() < 0.4) continue;
    const Vec3 off = (massCentre(f) - f[kLeftFoot].position).cwiseProduct(Vec3(1.0, 0.0, 1.0));
    ASSERT_LT(off.norm(), 0.14) << "time " << f.time;
  }
}

TEST(SyntheticMotion, TurnAroundGoesAllTheWay) {
  const auto& frames = framesOf("turn_around");
  double turned = 0.0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Vec3 before = pelvisAxes(frames[i - 1]).col(2);
    const Vec3 after = pelvisAxes(frames[i]).col(2);
    turned += std::atan2(before.cross(after).y(), before.dot(after));
  }
  EXPECT_NEAR(turned / kDegree, 360.0, 8.0);
}

}  // namespace
}  // namespace lorica
