#include "capture/retarget/retarget.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/random_numbers.h"
#include "skinning/character.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

using test::angleBetween;
using test::degrees;
using test::Figure;
using test::makeFigure;
using test::makeFrame;
using test::PersonPose;
using test::worldOf;
using B = HumanBone;
using J = BodyJoint;

/// How much longer than in the bind pose the visible edges of a character become: what is left behind shows as long
/// edges between it and the rest.
class EdgeStretch {
 public:
  struct Worst {
    double stretch =
        0.0;            ///< growth of an edge, divided by its length; by 8 % of the height if it is shorter than that
    VertexIndex a = 0;  ///< its ends
    VertexIndex b = 0;
  };

  explicit EdgeStretch(const Character& character);

  /// The edge with the largest stretch.
  /// @param posed  vertexCount positions [m]
  [[nodiscard]] Worst in(std::span<const Vec3> posed) const;

 private:
  struct Edge {
    VertexIndex a, b;
    double length;  ///< in the bind pose [m]
  };
  std::vector<Edge> edges_;
  double height_;
};

/// The largest stretch of a character whose joints all follow: shoulders and hips of coarse meshes come near.
inline constexpr double kMaxStretch = 1.0;

EdgeStretch::EdgeStretch(const Character& character) : height_(character.height) {
  std::vector<std::pair<VertexIndex, VertexIndex>> ends;
  for (const Triangle& t : character.shown.empty() ? character.mesh.triangles : character.shown) {
    for (std::size_t k = 0; k < 3; ++k) ends.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const std::vector<Vec3>& bind = character.mesh.vertices;
  for (const auto& [a, b] : ends) edges_.push_back({a, b, (bind[a] - bind[b]).norm()});
}

EdgeStretch::Worst EdgeStretch::in(std::span<const Vec3> posed) const {
  constexpr double kShort = 0.08;  // of the height
  Worst worst;
  for (const Edge& edge : edges_) {
    const double growth = (posed[edge.a] - posed[edge.b]).norm() - edge.length;
    const double stretch = growth / std::max(edge.length, kShort * height_);
    if (stretch > worst.stretch) worst = {stretch, edge.a, edge.b};
  }
  return worst;
}

/// The joint with the largest weight at a vertex.
JointIndex mainJoint(const Character& character, VertexIndex vertex) {
  const auto first = character.influences.begin() + character.influenceBegin[vertex];
  const auto last = character.influences.begin() + character.influenceBegin[vertex + 1];
  return std::max_element(first, last, [](const Influence& a, const Influence& b) { return a.weight < b.weight; })
      ->joint;
}

constexpr double kFrame = 1.0 / 30.0;

/// Both arms bent forward, both knees slightly bent; slowly swaying.
SkeletonFrame swayingFrame(double time, bool withOrientations) {
  PersonPose person;
  person.hips = Quat(Eigen::AngleAxisd(0.2 * std::sin(time), Vec3::UnitY()));
  person.chest = person.neck = person.head = person.hips;
  for (std::size_t i = 0; i < 2; ++i) {
    const double m = i == 0 ? 1.0 : -1.0;
    person.upper[i] = person.chest * Quat(Eigen::AngleAxisd(-m * degrees(40.0), Vec3::UnitZ())) *
                      Quat(Eigen::AngleAxisd(-m * (degrees(30.0) + 0.2 * std::sin(2.0 * time)), Vec3::UnitY()));
    person.lower[i] = person.upper[i] * Quat(Eigen::AngleAxisd(-m * degrees(80.0), Vec3::UnitY()));
    person.end[i] = person.lower[i];
  }
  for (std::size_t i = 2; i < 4; ++i) {
    person.upper[i] = person.hips * Quat(Eigen::AngleAxisd(-degrees(20.0), Vec3::UnitX()));
    person.lower[i] = person.hips * Quat(Eigen::AngleAxisd(degrees(20.0), Vec3::UnitX()));
    person.end[i] = person.hips;
  }
  person.middleHip = Vec3(0.5 + 0.1 * std::sin(time), 0.09 + 0.82 * std::cos(degrees(20.0)), 2.0);
  return makeFrame(person, time, withOrientations);
}

void lose(SkeletonFrame& frame, J joint) {
  frame[joint].position = Vec3::Zero();
  frame[joint].confidence = 0.0;
}

double largestTurn(const Pose& a, const Pose& b) {
  double largest = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    largest = std::max(largest, a[j].rotation.angularDistance(b[j].rotation));
  }
  return largest;
}

/// A figure and what moves it.
struct RetargetLoss : testing::Test {
  const Figure figure = makeFigure({});
  Retargeter retargeter = *Retargeter::create(figure.skeleton);
  Pose pose = Pose(figure.tposeRotation.size());
};

TEST_F(RetargetLoss, ALostJointHoldsEasesAndComesBackWithoutAJump) {
  for (const bool withOrientations : {false, true}) {
    for (int lost = 0; lost < kBodyJointCount; ++lost) {
      SCOPED_TRACE(nameOf(static_cast<J>(lost)));
      retargeter = *Retargeter::create(figure.skeleton);
      pose = Pose(pose.size());
      Retargeter reference = *Retargeter::create(figure.skeleton);
      Pose live(pose.size()), before;
      for (int f = 0; f < 150; ++f) {
        SkeletonFrame frame = swayingFrame(f * kFrame, withOrientations);
        reference.apply(frame, live);
        if (f >= 30 && f < 100) lose(frame, static_cast<J>(lost));
        retargeter.apply(frame, pose);
        if (!before.empty()) {
          // Factor 2: a forearm that already points right compensates for the remaining rotation of its upper arm.
          EXPECT_LE(largestTurn(pose, before), 2.0 * ConfidenceHoldSettings{}.returnTurn * kFrame) << f;
          EXPECT_LT((pose[0].translation - before[0].translation).norm(), 0.05 + 4.0 * kFrame) << f;
        }
        before = pose;
      }
      EXPECT_LT(largestTurn(pose, live), degrees(1.0)) << "the same as without the loss";
    }
  }
}

TEST_F(RetargetLoss, AnUnknownHandKeepsItsForearmThenRests) {
  const auto forearm = static_cast<std::size_t>(figure.skeleton.jointOf(B::kLeftLowerArm));
  Quat last = Quat::Identity();
  for (int f = 0; f < 120; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, false);
    if (f >= 30) lose(frame, J::kLeftHand);
    retargeter.apply(frame, pose);
    if (f < 30) last = pose[forearm].rotation;
    if (f >= 30 && f <= 44) {
      EXPECT_LT(pose[forearm].rotation.angularDistance(last), 1e-7) << f;
    }
  }
  EXPECT_GT(last.angularDistance(Quat::Identity()), degrees(60.0));
  EXPECT_LT(pose[forearm].rotation.angularDistance(Quat::Identity()), 1e-6);
}

TEST_F(RetargetLoss, UnknownJointsAtTheOriginPullNothing) {
  // Whatever position an unknown joint reports, the pose is bit-identical.
  std::mt19937 random(5);
  Retargeter a = *Retargeter::create(figure.skeleton);
  Retargeter b = *Retargeter::create(figure.skeleton);
  Pose poseA(figure.tposeRotation.size()), poseB(figure.tposeRotation.size());
  for (int f = 0; f < 200; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, f % 2 == 0);
    SkeletonFrame other = frame;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      if (random() % 3 != 0) continue;
      frame.joints[j] = {Vec3::Zero(), std::nullopt, 0.0};
      other.joints[j] = {Vec3(7, -8, 9), Quat(0, 1, 0, 0), 0.0};
    }
    a.apply(frame, poseA);
    b.apply(other, poseB);
    for (std::size_t j = 0; j < poseA.size(); ++j) {
      ASSERT_EQ(poseA[j].rotation.coeffs(), poseB[j].rotation.coeffs()) << f;
      ASSERT_EQ(poseA[j].translation, poseB[j].translation) << f;
    }
  }
}

TEST_F(RetargetLoss, NobodySeenShowsTheRestPose) {
  const Pose rest = restPose(figure.skeleton);
  for (int f = 0; f < 60; ++f) {
    SkeletonFrame frame;
    frame.time = f * kFrame;
    retargeter.apply(frame, pose);
    EXPECT_LT(largestTurn(pose, rest), 1e-9);
    EXPECT_LT((pose[0].translation - rest[0].translation).norm(), 1e-9);
  }
}

TEST_F(RetargetLoss, AnUpperBodyAloneMovesItsArms) {
  for (int f = 0; f < 30; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, false);
    for (const J joint : {J::kTorso, J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee, J::kLeftFoot,
                          J::kRightFoot, J::kHead, J::kNeck}) {
      lose(frame, joint);
    }
    retargeter.apply(frame, pose);
    const std::vector<Affine3> world = worldOf(figure.skeleton, pose);
    const auto at = [&](B bone) -> Vec3 { return world[figure.skeleton.jointOf(bone)].translation(); };
    const Vec3 upper = frame[J::kLeftElbow].position - frame[J::kLeftShoulder].position;
    EXPECT_LT(angleBetween(at(B::kLeftLowerArm) - at(B::kLeftUpperArm), upper), degrees(0.1));
    EXPECT_NEAR(at(B::kLeftFoot).y(), 0.08, 1e-6);
  }
}

TEST_F(RetargetLoss, LegsThatEaseToRestStayAboveTheFloor) {
  // A person sits down and the legs are hidden: the character's legs straighten and must raise it.
  for (int f = 0; f < 120; ++f) {
    PersonPose person;
    for (std::size_t i = 2; i < 4; ++i) person.upper[i] = Quat(Eigen::AngleAxisd(-degrees(85.0), Vec3::UnitX()));
    person.middleHip = Vec3(0, 0.53, 2);
    SkeletonFrame frame = makeFrame(person, f * kFrame, false);
    if (f >= 30) {
      for (const J joint : {J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) lose(frame, joint);
    }
    retargeter.apply(frame, pose);
    const std::vector<Affine3> world = worldOf(figure.skeleton, pose);
    const auto foot = static_cast<std::size_t>(figure.skeleton.jointOf(B::kLeftFoot));
    EXPECT_GT(world[foot].translation().y(), 0.08 - 0.011) << f;
  }
}

TEST_F(RetargetLoss, OrientationsThatComeAndGoDoNotJump) {
  Pose before;
  for (int f = 0; f < 200; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, true);
    // The forearms' own orientation is a rotation by 90 degrees; sometimes it is missing.
    for (const J joint : {J::kLeftElbow, J::kLeftHand}) {
      frame[joint].orientation = *frame[joint].orientation * Quat(Eigen::AngleAxisd(degrees(90.0), Vec3::UnitX()));
    }
    if (f / 20 % 2 == 1) {
      for (TrackedJoint& joint : frame.joints) joint.orientation.reset();
    }
    retargeter.apply(frame, pose);
    const auto forearm = static_cast<std::size_t>(figure.skeleton.jointOf(B::kLeftLowerArm));
    if (!before.empty()) {
      EXPECT_LT(pose[forearm].rotation.angularDistance(before[forearm].rotation), degrees(18.0));
    }
    before = pose;
  }
}

TEST_F(RetargetLoss, WildNumbersNeverGiveNan) {
  std::mt19937 random(11);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const std::array<double, 8> wild = {0.0, 1.0, -1.0, nan, inf, -inf, 1e6, 1e-12};
  const auto pick = [&] { return wild[random() % wild.size()]; };
  for (int f = 0; f < 3000; ++f) {
    SkeletonFrame frame = swayingFrame(f * kFrame, true);
    if (random() % 10 == 0) frame.time = pick();
    for (TrackedJoint& joint : frame.joints) {
      if (random() % 4 == 0) joint.position = Vec3(pick(), pick(), pick());
      if (random() % 4 == 0) joint.orientation = Quat(pick(), pick(), pick(), pick());
      if (random() % 4 == 0) joint.confidence = pick();
    }
    // All joints at one position, or along one line.
    if (random() % 7 == 0) {
      for (TrackedJoint& joint : frame.joints) joint.position = Vec3(0, 1, 0);
    }
    if (random() % 7 == 0) {
      for (std::size_t j = 0; j < kBodyJointCount; ++j) frame.joints[j].position = Vec3(0, 0.1 * double(j), 0);
    }
    retargeter.apply(frame, pose);
    for (const JointTransform& t : pose) {
      ASSERT_TRUE(t.rotation.coeffs().allFinite() && t.translation.allFinite()) << f;
      ASSERT_NEAR(t.rotation.norm(), 1.0, 1e-9) << f;
    }
  }
}

/// A motion's poses on a character.
std::vector<Pose> performed(const Character& character, std::span<const SkeletonFrame> frames, std::size_t every) {
  ProxySkeleton proxy = *ProxySkeleton::create(character);
  Retargeter retargeter = *Retargeter::create(proxy.skeleton(), {});
  Pose proxyPose(proxy.skeleton().joints().size());
  std::vector<Pose> poses;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    retargeter.apply(frames[f], proxyPose);
    if (f % every != 0) continue;
    poses.emplace_back(character.skeleton.joints().size());
    proxy.mapBack(proxyPose, poses.back());
  }
  return poses;
}

std::vector<Pose> posesOf(const SkeletalMotion& motion, std::size_t every) {
  const std::size_t joints = motion.skeleton.joints().size();
  std::vector<Pose> poses;
  for (std::size_t f = 0; f < motion.times.size(); f += every) {
    const auto first = motion.poses.begin() + static_cast<std::ptrdiff_t>(f * joints);
    poses.emplace_back(first, first + static_cast<std::ptrdiff_t>(joints));
  }
  return poses;
}

/// No edge becomes longer than the limit allows.
void expectWhole(const Character& character, std::span<const Pose> poses, const std::string& what,
                 double limit = test::kMaxStretch) {
  const test::EdgeStretch edges(character);
  std::vector<Affine3> world(character.skeleton.joints().size());
  std::vector<Vec3> posed(character.mesh.vertices.size());
  test::EdgeStretch::Worst worst;
  for (const Pose& pose : poses) {
    computeWorldFromJoint(character.skeleton, pose, world);
    computeWorldFromModel(character, world, world);
    skinLinearBlend(character, world, posed);
    const test::EdgeStretch::Worst in = edges.in(posed);
    if (in.stretch > worst.stretch) worst = in;
  }
  const auto joint = [&](VertexIndex v) { return character.skeleton.joint(test::mainJoint(character, v)).name; };
  EXPECT_LT(worst.stretch, limit) << what << ": from " << joint(worst.a) << " to " << joint(worst.b);
}

const std::vector<SkeletonFrame>& recording(const std::string& name) {
  static std::map<std::string, std::vector<SkeletonFrame>> read;
  std::vector<SkeletonFrame>& frames = read[name];
  if (frames.empty()) frames = *readJointCsv(test::recordingsFolder() / (name + ".csv"));
  return frames;
}

/// A puppet of 180 vertices, as wide as it is tall; its arms are one joint each, and swing down through its body.
constexpr const char* kPuppet = "greenman/greenman.glb";
constexpr double kMaxStretchOfPuppet = 2.5;

class SharedCharacter : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedCharacter, StaysWholeInEveryMotion) {
  LORICA_REQUIRE_DATASET(file, std::string("characters/") + GetParam());
  const Result<CharacterFile> read = readCharacterFile(file);
  ASSERT_TRUE(read) << read.error().message;
  const Character& character = read->character;
  const double limit = GetParam() == std::string(kPuppet) ? kMaxStretchOfPuppet : test::kMaxStretch;
  for (const char* name : {"walk", "wave", "squat_and_reach", "jumping_jacks", "punch_and_kick", "turn_around",
                           "walk_noisy", "punch_and_kick_noisy"}) {
    expectWhole(character, performed(character, recording(name), 10), name, limit);
  }
  for (const char* name : {"animated_drawings/zombie", "animated_drawings/jumping_jacks", "makehuman/walk1",
                           "makehuman/zombieWalk1", "makehuman/tpose"}) {
    LORICA_REQUIRE_DATASET(bvh, std::string("bvh/") + name + ".bvh");
    const Result<SkeletalMotion> motion = retargetMotion(readBvh(bvh)->motion, character, {});
    ASSERT_TRUE(motion) << motion.error().message;
    expectWhole(character, posesOf(*motion, 10), name, limit);
  }
  for (const char* name : {"m01", "m02", "m04", "m07", "m10"}) {
    LORICA_REQUIRE_DATASET(joints, fmt::format("joints/ui_prmd/{}_s01_e01_positions.txt", name));
    expectWhole(character, performed(character, readJointStream(joints, {})->frames, 10), name, limit);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SharedCharacter,
                         ::testing::Values("cesiumman/CesiumMan.glb", "kaykit/Barbarian.glb", "kaykit/Mage.glb",
                                           "raylib_robot/robot.glb", kPuppet, "arnaud/arnaud.fbx",
                                           "godette/Godette_vrm_v4.vrm"),
                         [](const auto& chosen) {
                           const std::string name = std::filesystem::path(chosen.param).stem().string();
                           return name.substr(0, name.find('_'));
                         });

/// The mannequin with hands, feet and toes that hang at random places, or whose mesh is carried by controls there.
Character rearranged(std::uint64_t seed) {
  Character character = makeMannequin();
  const Skeleton whole = character.skeleton;
  RandomNumbers random(seed);
  std::vector<Affine3> world(whole.joints().size());
  computeWorldFromJoint(whole, restPose(whole), world);
  std::vector<Joint> joints(whole.joints().begin(), whole.joints().end());
  const auto hang = [&](Joint& joint, JointIndex parent, const Affine3& where) {
    const Affine3 local = (parent == kNoJoint ? Affine3(Affine3::Identity()) : world[parent]).inverse() * where;
    joint.parent = parent;
    joint.rest.translation = local.translation();
    joint.rest.rotation = Quat(local.rotation()).normalized();
  };
  std::map<JointIndex, JointIndex> carriedBy;
  for (const B end : {B::kLeftHand, B::kRightHand, B::kLeftFoot, B::kRightFoot}) {
    const JointIndex joint = whole.jointOf(end);
    const std::array<JointIndex, 2> places = {kNoJoint, whole.jointOf(B::kHips)};
    const JointIndex place = places[random.bits() % places.size()];
    switch (random.bits() % 4) {
      case 0:  // stays on its limb
        break;
      case 1:  // hangs elsewhere, and is known
        hang(joints[joint], place, world[joint]);
        break;
      case 2:  // hangs elsewhere, under a name that says what it is
        hang(joints[joint], place, world[joint]);
        for (JointIndex j = 0; j < whole.jointCount(); ++j) {
          JointIndex above = j;
          while (above != kNoJoint && above != joint) above = whole.joint(above).parent;
          if (above == joint) joints[j].bone.reset();
        }
        break;
      case 3: {  // stays, but a control carries its mesh
        Joint control{fmt::format("{}", random.bits() % 1000), kNoJoint, {}, std::nullopt};
        hang(control, place, world[joint]);
        carriedBy[joint] = static_cast<JointIndex>(joints.size());
        joints.push_back(control);
        character.jointFromModel.push_back(character.jointFromModel[joint]);
        break;
      }
    }
  }
  for (Influence& influence : character.influences) {
    if (const auto found = carriedBy.find(influence.joint); found != carriedBy.end()) influence.joint = found->second;
  }
  character.skeleton = *Skeleton::create(std::move(joints));
  return character;
}

TEST(Stretch, RigsWhoseHandsAndFeetHangElsewhereStayWhole) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Character character = rearranged(seed);
    const Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
    ASSERT_TRUE(proxy) << "seed " << seed << ": " << proxy.error().message;
    EXPECT_TRUE(leftBehind(character).empty()) << "seed " << seed;
    for (const char* name : {"walk", "jumping_jacks", "squat_and_reach"}) {
      expectWhole(character, performed(character, recording(name), 10), fmt::format("seed {}, {}", seed, name));
    }
  }
}

// The measure itself: a foot that stays where the walk began.
TEST(Stretch, AFootLeftBehindIsNoticed) {
  const Character character = makeMannequin();
  const test::EdgeStretch edges(character);
  EXPECT_LT(edges.in(character.mesh.vertices).stretch, 1e-12);
  std::vector<Vec3> walked = character.mesh.vertices;
  for (VertexIndex v = 0; v < static_cast<VertexIndex>(walked.size()); ++v) {
    if (test::mainJoint(character, v) != character.skeleton.jointOf(B::kLeftFoot)) walked[v].z() += 0.3;
  }
  EXPECT_GT(edges.in(walked).stretch, test::kMaxStretch);
}

}  // namespace
}  // namespace lorica::test
