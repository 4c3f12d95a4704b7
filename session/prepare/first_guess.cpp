#include "session/prepare/first_guess.h"

#include "capture/retarget/mirrored_axes.h"
#include "capture/retarget/skeletal_retarget.h"
#include "session/prepare/subject.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

/// Along the floor, from the ankles to the middle of the feet: their toes, or else the surface that they move. Zero if
/// the feet are unknown [m].
Vec3 wayOfFeet(const Character& character) {
  const Skeleton& skeleton = character.skeleton;
  const auto bindOf = [&](JointIndex joint) -> Vec3 { return character.jointFromModel[joint].inverse().translation(); };
  Vec3 sum = Vec3::Zero();
  for (const auto& [footBone, toesBone] :
       {std::pair(HumanBone::kLeftFoot, HumanBone::kLeftToes), {HumanBone::kRightFoot, HumanBone::kRightToes}}) {
    const JointIndex foot = skeleton.jointOf(footBone), toes = skeleton.jointOf(toesBone);
    if (foot == kNoJoint) continue;
    Vec3 way = toes == kNoJoint ? Vec3(Vec3::Zero()) : Vec3(bindOf(toes) - bindOf(foot));
    if (way.isZero(0.0)) {
      double weight = 0.0;
      for (std::size_t v = 0; v + 1 < character.influenceBegin.size(); ++v) {
        for (std::size_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
          const Influence& influence = character.influences[i];
          if (influence.joint != foot) continue;
          way += influence.weight * (character.mesh.vertices[v] - bindOf(foot));
          weight += influence.weight;
        }
      }
      if (weight > 0.0) way /= weight;
    }
    sum += Vec3(way.x(), 0.0, way.z());
  }
  return sum;
}

/// Along the floor, where a character looks in its bind pose: to the front of left and right, or where its feet point
/// if that is the other way, as in bodies that were mirrored after their joints had been named. Zero if it has no legs.
Vec3 aheadOf(const Character& character) {
  constexpr double kClear = 0.02;  // [m]
  const Skeleton& skeleton = character.skeleton;
  const JointIndex left = skeleton.jointOf(HumanBone::kLeftUpperLeg);
  const JointIndex right = skeleton.jointOf(HumanBone::kRightUpperLeg);
  if (left == kNoJoint || right == kNoJoint) return Vec3::Zero();
  std::vector<Affine3> world(skeleton.jointCount());
  computeWorldFromJoint(skeleton, restPose(skeleton), world);
  const Vec3 across = world[left].translation() - world[right].translation();
  const Vec3 ahead = across.cross(Vec3::UnitY());
  if (!MirroredAxes(skeleton).any()) return ahead;
  const Vec3 feet = wayOfFeet(character);
  return feet.norm() > kClear && feet.dot(ahead) < 0.0 ? Vec3(-ahead) : ahead;
}

/// From the hips to the head in the bind pose; zero if it lacks one of them.
Vec3 uprightOf(const Character& character) {
  const Skeleton& skeleton = character.skeleton;
  const JointIndex hips = skeleton.jointOf(HumanBone::kHips), head = skeleton.jointOf(HumanBone::kHead);
  if (hips == kNoJoint || head == kNoJoint) return Vec3::Zero();
  std::vector<Affine3> world(skeleton.jointCount());
  computeWorldFromJoint(skeleton, restPose(skeleton), world);
  return world[head].translation() - world[hips].translation();
}

}  // namespace

std::string firstGuessOf(std::vector<std::string> guess, const Motion& motion) {
  constexpr int kSamples = 256;
  std::vector<SkeletonFrame> ofBones;
  if (motion.bones) {
    const SkeletalMotion& bones = *motion.bones;
    SkeletalMotion sampled{bones.name, bones.skeleton, {}, {}};
    const int stride = std::max(1, bones.frameCount() / kSamples);
    for (int f = 0; f < bones.frameCount(); f += stride) {
      sampled.times.push_back(bones.times[f]);
      sampled.poses.insert(sampled.poses.end(), bones.pose(f).begin(), bones.pose(f).end());
    }
    if (Result<std::vector<SkeletonFrame>> joints = bodyJointsOf(sampled)) ofBones = std::move(*joints);
    const JointIndex foot = bones.skeleton.jointOf(HumanBone::kLeftFoot);
    if (foot != kNoJoint && !ofBones.empty() && ofBones.front()[BodyJoint::kLeftFoot].confidence == 1.0) {
      std::vector<Affine3> world(bones.skeleton.jointCount());
      computeWorldFromJoint(bones.skeleton, bones.pose(0), world);
      const double floor = world[foot].translation().y() - ofBones.front()[BodyJoint::kLeftFoot].position.y();
      guess.push_back(std::abs(floor) < 0.005
                          ? "the floor is y = 0, since soles come down to it"
                          : fmt::format("the floor is y = {:.2f} m, where soles come down to", floor));
    }
  }
  const std::vector<SkeletonFrame>& frames = motion.bones ? ofBones : motion.joints;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const auto across = [&](BodyJoint left, BodyJoint right) {
      const bool seen = frames[f][left].confidence > 0.0 && frames[f][right].confidence > 0.0;
      return seen ? Vec3(frames[f][left].position - frames[f][right].position) : Vec3(Vec3::Zero());
    };
    Vec3 left = across(BodyJoint::kLeftHip, BodyJoint::kRightHip);
    if (left.isZero(0.0)) left = across(BodyJoint::kLeftShoulder, BodyJoint::kRightShoulder);
    const Vec3 ahead = left.cross(Vec3::UnitY());
    if (ahead.isZero(1e-6)) continue;
    guess.push_back(fmt::format("the body faces {} at first", wayInWords(ahead)));
    break;
  }
  return fmt::format("{}", fmt::join(guess, "; "));
}

std::string firstGuessOf(const CharacterFile& file) {
  constexpr double kLies = 0.5;  // cosine between the body's up and the world's
  std::string guess = file.format == kSequence
                          ? "rest pose: the first frame; a unit is a metre; Y is up"
                          : fmt::format("rest pose: the bind pose; {:g} m per unit; Y is up", file.metresPerUnit);
  const Vec3 up = uprightOf(file.character), ahead = aheadOf(file.character);
  if (!up.isZero(0.0) && up.y() < kLies * up.norm()) {
    guess += fmt::format("; it lies, its head towards {}", wayInWords(up));
  } else if (!ahead.isZero(0.0)) {
    guess += fmt::format("; by its legs it faces {}", wayInWords(ahead));
  }
  const std::vector<Vec3>& vertices = file.character.mesh.vertices;
  if (!vertices.empty()) guess += fmt::format("; its lowest point is at y = {:.2f} m", boundsOf(vertices).min.y());
  return guess;
}

std::string wayInWords(const Vec3& ahead) {
  constexpr double kNear = 15.0;
  const double angle = std::atan2(ahead.x(), ahead.z()) * 180.0 / std::numbers::pi;
  const int quarter = static_cast<int>(std::lround(angle / 90.0));
  constexpr std::array<std::string_view, 5> kAxes = {"-Z", "-X", "+Z", "+X", "-Z"};
  if (std::abs(angle - 90.0 * quarter) <= kNear) return std::string(kAxes[quarter + 2]);
  return fmt::format("{:.0f} degrees from +Z towards {}", std::abs(angle), angle > 0.0 ? "+X" : "-X");
}

}  // namespace lorica
