#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/files.h"
#include "geometry/random_numbers.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/skinning/humanoid/humanoid_samples.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using test::contradictions;
using test::differences;
using test::namesOf;
using test::RigNames;
using test::rigOf;
using enum HumanBone;

// Files whose zero pose is no pose of a body: bones along the axes of their joints, as LaFAN1, Unreal and many rigs
// store them.

using enum HumanBone;
/// Gives a joint's new axes by the way to its first child, in a T-pose that faces +Z; zero for joints that end.
using Convention = std::function<Quat(const Joint& joint, const Vec3& bone)>;

Quat basis(const Vec3& x, const Vec3& y) {
  Mat3 axes;
  axes.col(0) = x.normalized();
  axes.col(2) = x.cross(y).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Quat(axes);
}

/// A direction that is not along a bone and lies in the plane in which a limb bends.
Vec3 bending(const Vec3& bone) {
  return std::abs(bone.normalized().z()) > 0.7 ? Vec3::UnitY() : Vec3::UnitZ();
}

Quat alongX(const Joint&, const Vec3& bone) {
  return bone.norm() > 0.0 ? basis(bone, bending(bone)) : Quat::Identity();
}
Quat alongY(const Joint&, const Vec3& bone) {
  return bone.norm() > 0.0 ? basis(bending(bone), bone) * Quat(basis(Vec3::UnitY(), Vec3::UnitX())).conjugate()
                           : Quat::Identity();
}
/// Left limbs along X, right limbs and nothing else along -X.
Quat mirroredAlongX(const Joint& joint, const Vec3& bone) {
  return alongX(joint, joint.name.find("ight") == std::string::npos ? bone : Vec3(-bone));
}
Quat crooked(const Joint& joint, const Vec3&) {
  RandomNumbers random(std::accumulate(joint.name.begin(), joint.name.end(), 1000u));
  return Quat(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0),
              random.between(-1.0, 1.0))
      .normalized();
}

/// The same motion, frame for frame, of joints with other axes; their rotations are zero where the axes are those of
/// the world.
SkeletalMotion inConvention(const SkeletalMotion& motion, const Convention& convention) {
  const std::span<const Joint> joints = motion.skeleton.joints();
  const std::vector<Affine3> rest = test::worldOf(motion.skeleton, restPose(motion.skeleton));
  std::vector<Quat> axes;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto child = std::find_if(joints.begin(), joints.end(), [&](const Joint& c) { return c.parent == int(j); });
    const Vec3 bone = child == joints.end() ? Vec3(Vec3::Zero())
                                            : Vec3(rest[child - joints.begin()].translation() - rest[j].translation());
    axes.push_back(Quat(rest[j].linear()).conjugate() * convention(joints[j], bone));
  }
  const auto changed = [&](std::size_t j, JointTransform t) {
    const int parent = joints[j].parent;
    const Quat above = parent == kNoJoint ? Quat::Identity() : axes[parent].conjugate();
    t.translation = above * t.translation;
    t.rotation = above * t.rotation * axes[j];
    return t;
  };
  SkeletalMotion out{motion.name, {}, motion.times, motion.poses};
  std::vector<Joint> renamed(joints.begin(), joints.end());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    renamed[j].rest = changed(j, joints[j].rest);
    renamed[j].rest.rotation = Quat::Identity();
  }
  out.skeleton = Skeleton::create(std::move(renamed)).value();
  for (std::size_t i = 0; i < out.poses.size(); ++i) out.poses[i] = changed(i % joints.size(), out.poses[i]);
  return out;
}

const Skeleton& mannequin() {
  static const Skeleton skeleton = makeMannequin().skeleton;
  return skeleton;
}

/// What the mannequin does, with the names of its joints.
SkeletalMotion performed(std::string_view motion) {
  return retargetMotion(skeletalMotionOf(shippedFrames(motion)).value(), mannequin()).value();
}

BvhFile throughFile(const SkeletalMotion& motion) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(writeBvh(folder.path() / "motion.bvh", motion));
  Result<BvhFile> file = readBvh(folder.path() / "motion.bvh");
  EXPECT_TRUE(file) << file.error().message;
  return std::move(*file);
}

struct Differences {
  double position = 0.0;  ///< [m]
  double turn = 0.0;      ///< [degrees]
};

/// The largest differences of the mannequin's bones between two motions that it performs.
Differences difference(const SkeletalMotion& a, const SkeletalMotion& b) {
  const SkeletalMotion one = retargetMotion(a, mannequin()).value();
  const SkeletalMotion other = retargetMotion(b, mannequin()).value();
  Differences largest;
  for (int f = 0; f < one.frameCount(); f += 5) {
    const std::vector<Affine3> x = test::worldOf(mannequin(), Pose(one.pose(f).begin(), one.pose(f).end()));
    const std::vector<Affine3> y = test::worldOf(mannequin(), Pose(other.pose(f).begin(), other.pose(f).end()));
    for (std::size_t j = 0; j < x.size(); ++j) {
      if (!mannequin().joint(JointIndex(j)).bone) continue;
      if (*mannequin().joint(JointIndex(j)).bone > kRightHand) continue;  // fingers turn with the hand
      const double turn = Quat(x[j].linear()).angularDistance(Quat(y[j].linear())) * 180.0 / std::numbers::pi;
      largest.position = std::max(largest.position, (x[j].translation() - y[j].translation()).norm());
      largest.turn = std::max(largest.turn, turn);
    }
  }
  return largest;
}

/// Nobody stands and no arm hangs in any frame: people who sit at a table.
SkeletalMotion seated(SkeletalMotion motion) {
  const auto turn = [&](HumanBone bone, double degrees, const Vec3& axis) {
    const std::size_t count = motion.skeleton.jointCount();
    for (std::size_t i = motion.skeleton.jointOf(bone); i < motion.poses.size(); i += count) {
      motion.poses[i].rotation = Quat(Eigen::AngleAxisd(test::degrees(degrees), axis)) * motion.poses[i].rotation;
    }
  };
  for (const bool left : {true, false}) {
    turn(left ? kLeftUpperLeg : kRightUpperLeg, -80.0, Vec3::UnitX());
    turn(left ? kLeftLowerLeg : kRightLowerLeg, 80.0, Vec3::UnitX());
    turn(left ? kLeftUpperArm : kRightUpperArm, -60.0, Vec3::UnitX());
    turn(left ? kLeftLowerArm : kRightLowerArm, left ? -60.0 : 60.0, Vec3::UnitY());
  }
  return motion;
}

TEST(BvhRest, PeopleWhoNeverStand) {
  const SkeletalMotion motion = seated(performed("walk"));
  const BvhFile usual = throughFile(motion);
  for (const Convention& convention : {Convention(alongX), Convention(crooked)}) {
    const BvhFile unusual = throughFile(inConvention(motion, convention));
    EXPECT_EQ(unusual.unit, usual.unit);
    EXPECT_EQ(unusual.firstGuess.at(0), "rest pose: each limb from the frame in which it is straightest");
    const Differences off = difference(usual.motion, unusual.motion);
    EXPECT_LT(off.position, 0.06) << unusual.firstGuess.at(0);
    EXPECT_LT(off.turn, 35.0) << unusual.firstGuess.at(0);
  }
}

/// People who walk all the time, and whose swinging foot, or hand, points down: it is no frame's rest.
SkeletalMotion pointing(SkeletalMotion motion, HumanBone left, HumanBone right) {
  const std::size_t count = motion.skeleton.jointCount();
  for (std::size_t f = 0; f < motion.poses.size() / count; ++f) {
    const Pose pose(motion.pose(int(f)).begin(), motion.pose(int(f)).end());
    const std::vector<Affine3> world = test::worldOf(motion.skeleton, pose);
    const auto height = [&](HumanBone bone) { return world[motion.skeleton.jointOf(bone)].translation().y(); };
    const HumanBone bone = height(kLeftFoot) > height(kRightFoot) ? left : right;
    Quat& turned = motion.poses[f * count + motion.skeleton.jointOf(bone)].rotation;
    turned = turned * Quat(Eigen::AngleAxisd(test::degrees(70.0), Vec3::UnitX()));
  }
  return motion;
}

TEST(BvhRest, AFootThatSwingsIsNotLevel) {
  SkeletalMotion walking = performed("walk");
  const std::size_t count = walking.skeleton.jointCount();
  constexpr std::size_t kStanding = 25;  // frames before the first step
  ASSERT_GT(walking.times.size(), 3 * kStanding);
  walking.poses.erase(walking.poses.begin(), walking.poses.begin() + kStanding * count);
  walking.times.resize(walking.times.size() - kStanding);
  const SkeletalMotion motion = pointing(walking, kLeftFoot, kRightFoot);
  const BvhFile usual = throughFile(motion);
  for (const Convention& convention : {Convention(alongX), Convention(mirroredAlongX), Convention(crooked)}) {
    const BvhFile unusual = throughFile(inConvention(motion, convention));
    EXPECT_NE(unusual.firstGuess.at(0).find(" foot from frame "), std::string::npos) << unusual.firstGuess.at(0);
    const Differences off = difference(usual.motion, unusual.motion);
    EXPECT_LT(off.position, 0.06) << unusual.firstGuess.at(0);
    EXPECT_LT(off.turn, 35.0) << unusual.firstGuess.at(0);
  }
}

/// A T-pose has other hands than the I-pose in which these motions begin: they twist by as much as the limits allow.
TEST(BvhRest, AxesOfJointsDoNotMatter) {
  for (const std::string_view shipped : kShippedMotions) {
    const SkeletalMotion motion = performed(shipped);
    const BvhFile usual = throughFile(motion);
    EXPECT_EQ(usual.firstGuess.at(0), "rest pose: the zero pose, a T-pose");
    for (const Convention& convention :
         {Convention(alongX), Convention(alongY), Convention(mirroredAlongX), Convention(crooked)}) {
      const BvhFile unusual = throughFile(inConvention(motion, convention));
      EXPECT_EQ(unusual.firstGuess.at(0), "rest pose: frame 0, an I-pose");
      EXPECT_EQ(unusual.unit, usual.unit);
      const Differences off = difference(usual.motion, unusual.motion);
      EXPECT_LT(off.position, 0.05) << motion.name;
      EXPECT_LT(off.turn, 30.0) << motion.name;
    }
  }
}

TEST(BvhRest, ThePoseMayBeAskedFor) {
  const SkeletalMotion motion = inConvention(performed("wave"), alongX);
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "wave.bvh";
  const std::filesystem::path other = folder.path() / "rest.bvh";
  ASSERT_TRUE(writeBvh(file, motion));
  SkeletalMotion first{"rest", motion.skeleton, {0.0}, {motion.pose(7).begin(), motion.pose(7).end()}};
  ASSERT_TRUE(writeBvh(other, first));
  const auto guessOf = [&](const std::string& asked) {
    const Result<BvhFile> read = readBvh(file, parseBvhRest(asked).value());
    return read ? read->firstGuess.at(0) : read.error().message;
  };
  EXPECT_EQ(guessOf("zero"), "rest pose: the zero pose as asked for, no usual pose");
  EXPECT_EQ(guessOf("frame:7"), "rest pose: frame 7 as asked for, an I-pose");
  EXPECT_EQ(guessOf(other.string()), "rest pose: the first frame of rest.bvh as asked for, an I-pose");
  EXPECT_NE(guessOf("frame:99999").find("frames, expected frame 99999"), std::string::npos);
  const SkeletalMotion byFrame = readBvh(file, parseBvhRest("frame:7").value())->motion;
  const SkeletalMotion byFile = readBvh(file, parseBvhRest(other.string()).value())->motion;
  EXPECT_LT(difference(byFrame, byFile).turn, 0.01);
  for (const char* wrong : {"frame:", "frame:-1", "frame:x", "tpose", "rest.glb"})
    EXPECT_FALSE(parseBvhRest(wrong)) << wrong;
}

TEST(BvhRest, AnotherSkeletonsFileIsRefused) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeBvh(folder.path() / "a.bvh", performed("wave")));
  ASSERT_TRUE(writeBvh(folder.path() / "b.bvh", skeletalMotionOf(shippedFrames("wave")).value()));
  const Result<BvhFile> read =
      readBvh(folder.path() / "a.bvh", parseBvhRest((folder.path() / "b.bvh").string()).value());
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("has no joint"), std::string::npos) << read.error().message;
}

TEST(BvhRest, SharedFilesOfThreeConventionsMoveAlike) {
  LORICA_REQUIRE_DATASET(reference, "strangers/xsens_reference.bvh");
  const BvhFile usual = readBvh(reference).value();
  EXPECT_EQ(usual.firstGuess.at(0), "rest pose: the zero pose, a T-pose");
  for (const char* name : {"bones_along_x.bvh", "bones_along_y.bvh"}) {
    const BvhFile unusual = readBvh(reference.parent_path() / name).value();
    EXPECT_EQ(unusual.unit, "centimetres");
    const SkeletalMotion walk = retargetMotion(unusual.motion, mannequin()).value();
    const std::vector<Affine3> world = test::worldOf(mannequin(), Pose(walk.pose(30).begin(), walk.pose(30).end()));
    const Vec3 shoulder = world[mannequin().jointOf(kLeftUpperArm)].translation();
    EXPECT_LT((shoulder - Vec3(0.172, 1.45, shoulder.z())).norm(), 0.02) << name << ": " << shoulder.transpose();
    EXPECT_LT(difference(usual.motion, unusual.motion).position, 0.06) << name;
  }
}

// What other programs need of a BVH file that Lorica wrote: names that are words and differ, and numbers.

/// A chain of joints, 0.5 m each, at rest.
SkeletalMotion chainOf(const std::vector<std::string>& names) {
  std::vector<Joint> joints;
  for (const std::string& name : names) {
    JointTransform rest;
    rest.translation = Vec3(0.0, 0.5, 0.0);
    joints.push_back({name, static_cast<JointIndex>(joints.size()) - 1, rest, std::nullopt});
  }
  SkeletalMotion motion;
  motion.skeleton = Skeleton::create(std::move(joints)).value();
  motion.times = {0.0};
  motion.poses = restPose(motion.skeleton);
  return motion;
}

TEST(BvhWriter, NamesAreWordsThatDiffer) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> names = {"Hand", "Hand", "Hand_2", "left arm", "left{arm", "", "", "Hand"};
  ASSERT_TRUE(writeBvh(folder.path() / "out.bvh", chainOf(names)));
  const Result<BvhFile> read = readBvh(folder.path() / "out.bvh");
  ASSERT_TRUE(read) << read.error().message;
  std::vector<std::string> found;
  for (const Joint& joint : read->motion.skeleton.joints()) found.push_back(joint.name);
  EXPECT_EQ(found, (std::vector<std::string>{"Hand", "Hand_3", "Hand_2", "left_arm", "left_arm_2", "joint", "joint_2",
                                             "Hand_4"}));
}

TEST(BvhWriter, PosesThatAreNotFiniteAreRefusedWithFrameAndJoint) {
  const test::TemporaryFolder folder;
  SkeletalMotion motion = chainOf({"hips", "spine"});
  motion.times.push_back(0.1);
  const Pose rest = motion.poses;
  motion.poses.insert(motion.poses.end(), rest.begin(), rest.end());
  motion.poses[3].rotation.x() = std::numeric_limits<double>::infinity();
  const Result<void> written = writeBvh(folder.path() / "out.bvh", motion);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("frame 2: the pose of joint 'spine' is not finite"), std::string::npos)
      << written.error().message;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.bvh"));
}

void expectBones(const std::filesystem::path& file, const std::map<HumanBone, std::string>& truth,
                 std::string_view by) {
  const Result<BvhFile> read = readBvh(file);
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Skeleton& skeleton = read->motion.skeleton;
  HumanoidGuess none;
  none.jointOf.fill(kNoJoint);
  const HumanoidGuess guess = guessHumanoid(withBones(skeleton, none));
  EXPECT_EQ(differences(truth, namesOf(skeleton, guess)), "") << file;
  EXPECT_EQ(contradictions(skeleton, guess), "") << file;
  EXPECT_EQ(guess.by, by) << file;
  for (const auto& [bone, name] : truth) {
    ASSERT_NE(skeleton.jointOf(bone), kNoJoint) << file << " " << nameOf(bone);
    EXPECT_EQ(skeleton.joint(skeleton.jointOf(bone)).name, name) << file << ": reading finds them, too";
  }
}

TEST(BvhBones, JumpingJacks) {
  LORICA_REQUIRE_DATASET(file, "bvh/animated_drawings/jumping_jacks.bvh");
  std::map<HumanBone, std::string> truth = namesOf(rigOf("", "", "Left,Right", "Hips,lowerback,Chest,Chest2,Neck,Head",
                                                         "%Hip,%Knee,%Ankle,%Toe", "%Collar,%Shoulder,%Elbow,%Wrist"));
  truth[kLeftThumbMetacarpal] = "LThumb";
  truth[kRightThumbMetacarpal] = "RThumb";
  truth[kLeftMiddleProximal] = "LFingers";
  truth[kRightMiddleProximal] = "RFingers";
  expectBones(file, truth, "names (Biovision)");
}

TEST(BvhBones, Zombie) {
  LORICA_REQUIRE_DATASET(file, "bvh/animated_drawings/zombie.bvh");
  // Of four bones of the spine the third is the middle.
  std::map<HumanBone, std::string> truth =
      namesOf(rigOf("", "", "Left,Right", "Hips,Spine,Spine2,Spine3,Neck,Head", "%UpLeg,%Leg,%Foot,%ToeBase",
                    "%Shoulder,%Arm,%ForeArm,%Hand"));
  truth[kLeftThumbMetacarpal] = "LeftHandThumb1";
  truth[kRightThumbMetacarpal] = "RightHandThumb1";
  expectBones(file, truth, "names (Mixamo)");
}

TEST(BvhBones, MakeHumanTodayAndBefore) {
  const RigNames today =
      rigOf("", "", "L,R", "root,spine05,spine03,spine01,neck01,head", "upperleg01.%,lowerleg01.%,foot.%,toe2-1.%",
            "clavicle.%,upperarm01.%,lowerarm01.%,wrist.%", "finger@-#.%", "1,2,3,4,5");
  // Its Hips joint carries only the legs.
  const RigNames before = rigOf("", "", "L,R", "Root,Spine1,Spine2,Spine3,Neck,Head", "UpLeg_%,LoLeg_%,Foot_%,Toe_%",
                                "Clavicle_%,UpArm_%,LoArm_%,Hand_%", "@#_%", "Thumb,Index,Middle,Ring,Pinky");
  for (const auto& [name, rig] : {std::pair("tpose", today), {"walk1", before}, {"zombieWalk1", before}}) {
    LORICA_REQUIRE_DATASET(file, std::string("bvh/makehuman/") + name + ".bvh");
    expectBones(file, namesOf(rig), "names (MakeHuman)");
  }
}

}  // namespace
}  // namespace lorica
