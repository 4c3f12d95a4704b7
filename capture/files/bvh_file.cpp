#include "capture/files/bvh_file.h"

#include "capture/files/bvh_text.h"
#include "geometry/files.h"
#include "skinning/humanoid/humanoid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace lorica {
namespace {

constexpr double kUsualHeight = 1.7;
constexpr double kMinHeight = 0.5;
constexpr double kMaxHeight = 2.5;

struct Unit {
  std::string_view name;
  double metres;
};
/// The last unit is left over from the conversion of the CMU database: inches over 0.45.
constexpr std::array<Unit, 6> kUnits = {{{"centimetres", 0.01},
                                         {"metres", 1.0},
                                         {"millimetres", 0.001},
                                         {"inches", 0.0254},
                                         {"decimetres", 0.1},
                                         {"units of the CMU database (5.644 cm)", 0.0254 / 0.45}}};

/// Longest side of the bounding box of the rest pose, in the file's unit.
double sizeOf(const BvhText& text) {
  std::vector<Vec3> positions;
  positions.reserve(text.joints.size() + text.endSites.size());
  const auto under = [&](int parent, const Vec3& offset) {
    positions.push_back(parent < 0 ? offset : Vec3(positions[parent] + offset));
  };
  for (const BvhJoint& joint : text.joints) under(joint.parent, joint.offset);
  for (const auto& [parent, offset] : text.endSites) under(parent, offset);
  const Aabb box = boundsOf(positions);
  return (box.max - box.min).maxCoeff();
}

void guessUnit(const BvhText& text, BvhFile& out) {
  const double size = sizeOf(text);
  if (!(size > 0.0)) {
    out.unit = "metres";
    out.notes.emplace_back("the skeleton has no extent: metres assumed");
    return;
  }
  const auto offBy = [&](const Unit& unit) { return std::abs(std::log(unit.metres * size / kUsualHeight)); };
  const Unit& unit = *std::min_element(kUnits.begin(), kUnits.end(),
                                       [&](const Unit& a, const Unit& b) { return offBy(a) < offBy(b); });
  out.unit = unit.name;
  out.metresPerUnit = unit.metres;
  const double height = unit.metres * size;
  const bool odd = height < kMinHeight || height > kMaxHeight;
  out.notes.push_back(fmt::format("the rest pose measures {:.4g} units: {} assumed, {:.3g} m{}", size, unit.name,
                                  height, odd ? "; no unit gives 0.5 to 2.5 m" : ""));
}

bool isPosition(BvhChannel channel) {
  return channel <= BvhChannel::kZPosition;
}

/// Which joints' position channels are added to their offsets.
std::vector<bool> positionsThatAdd(const BvhText& text, BvhFile& out) {
  constexpr std::size_t kSamples = 32;
  const std::size_t stride = std::max<std::size_t>(1, text.frameCount / kSamples);
  double fromOffsets = 0.0;
  double fromZero = 0.0;
  std::vector<bool> adds(text.joints.size(), false);
  bool zeroRoot = false;
  for (std::size_t j = 0; j < text.joints.size(); ++j) {
    const BvhJoint& joint = text.joints[j];
    bool allZero = true;
    bool any = false;
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      if (!isPosition(joint.channels[c])) continue;
      any = true;
      const double offset = joint.offset[static_cast<int>(joint.channels[c])];
      const double* value = text.values.data() + joint.firstChannel + c;
      if (joint.parent < 0) {
        for (std::size_t f = 0; f < text.frameCount && allZero; ++f) {
          allZero = std::abs(value[f * text.channelCount]) < 1e-5;  // what six decimals leave
        }
        continue;
      }
      for (std::size_t f = 0; f < text.frameCount; f += stride) {
        fromOffsets += std::abs(value[f * text.channelCount] - offset);
        fromZero += std::abs(value[f * text.channelCount]);
      }
    }
    if (joint.parent < 0 && any && allZero && joint.offset.norm() > 0.0) {
      adds[j] = true;
      zeroRoot = true;
    }
  }
  if (zeroRoot) out.notes.emplace_back("the root's positions are all zero: its offset is used");
  if (fromOffsets > fromZero) {
    for (std::size_t j = 0; j < adds.size(); ++j) adds[j] = adds[j] || text.joints[j].parent >= 0;
    out.notes.emplace_back("positions of joints below the root are relative to their offsets, not to their parents");
  }
  return adds;
}

/// The frames, in metres and in the file's axes.
std::vector<JointTransform> posesOf(const BvhText& text, double metresPerUnit, const std::vector<bool>& adds) {
  constexpr double kHalfDegree = 0.5 * std::numbers::pi / 180.0;
  const std::size_t jointCount = text.joints.size();
  std::vector<JointTransform> poses;
  poses.reserve(text.frameCount * jointCount);
  for (std::size_t f = 0; f < text.frameCount; ++f) {
    const double* row = text.values.data() + f * text.channelCount;
    for (std::size_t j = 0; j < jointCount; ++j) {
      const BvhJoint& joint = text.joints[j];
      JointTransform& pose = poses.emplace_back();
      Vec3 position = joint.offset;
      double w = 1.0;
      double x = 0.0;
      double y = 0.0;
      double z = 0.0;
      for (std::size_t c = 0; c < joint.channels.size(); ++c) {
        const double value = row[joint.firstChannel + c];
        const BvhChannel channel = joint.channels[c];
        if (isPosition(channel)) {
          const auto axis = static_cast<int>(channel);
          position[axis] = adds[j] ? joint.offset[axis] + value : value;
          continue;
        }
        if (value == 0.0) continue;
        // Product with a rotation about one axis, written out: this loop takes most of the reader's time.
        const double half = kHalfDegree * value;
        const double cosine = std::cos(half);
        const double sine = std::sin(half);
        const double w0 = w;
        const double x0 = x;
        const double y0 = y;
        const double z0 = z;
        w *= cosine;
        x *= cosine;
        y *= cosine;
        z *= cosine;
        if (channel == BvhChannel::kXRotation) {
          w -= x0 * sine;
          x += w0 * sine;
          y += z0 * sine;
          z -= y0 * sine;
        } else if (channel == BvhChannel::kYRotation) {
          w -= y0 * sine;
          x -= z0 * sine;
          y += w0 * sine;
          z += x0 * sine;
        } else {
          w -= z0 * sine;
          x += y0 * sine;
          y -= x0 * sine;
          z += w0 * sine;
        }
      }
      pose.translation = metresPerUnit * position;
      pose.rotation = Quat(w, x, y, z);
    }
  }
  return poses;
}

/// Unit vector from the middle of the feet to the head; nullopt if the skeleton lacks them.
std::optional<Vec3> uprightOf(const Skeleton& skeleton, std::span<const JointTransform> pose) {
  const auto firstOf = [&](std::initializer_list<HumanBone> bones) {
    for (const HumanBone bone : bones) {
      if (skeleton.jointOf(bone) != kNoJoint) return skeleton.jointOf(bone);
    }
    return kNoJoint;
  };
  const JointIndex head = firstOf({HumanBone::kHead, HumanBone::kNeck});
  const JointIndex left = firstOf({HumanBone::kLeftFoot, HumanBone::kLeftLowerLeg});
  const JointIndex right = firstOf({HumanBone::kRightFoot, HumanBone::kRightLowerLeg});
  if (head == kNoJoint || left == kNoJoint || right == kNoJoint) return std::nullopt;
  std::vector<Affine3> world(skeleton.jointCount());
  computeWorldFromJoint(skeleton, pose, world);
  const auto at = [&](JointIndex joint) -> Vec3 { return world[joint].translation(); };
  const Vec3 up = at(head) - 0.5 * (at(left) + at(right));
  const double length = up.norm();
  if (!(length > 0.0)) return std::nullopt;
  return Vec3(up / length);
}

/// The rotation that maps the file's up axis to +Y.
Quat turnToYUp(const SkeletalMotion& motion, BvhFile& out) {
  constexpr int kSamples = 64;
  constexpr double kClear = 0.8;
  const std::optional<Vec3> rest = uprightOf(motion.skeleton, restPose(motion.skeleton));
  if (!rest) return Quat::Identity();
  Vec3 sum = Vec3::Zero();
  int count = 0;
  const int stride = std::max(1, motion.frameCount() / kSamples);
  for (int f = 0; f < motion.frameCount(); f += stride) {
    sum += uprightOf(motion.skeleton, motion.pose(f)).value_or(Vec3::Zero());
    ++count;
  }
  const Vec3 mean = sum / count;
  int axis = 0;
  Vec3 up = mean;
  if (mean.cwiseAbs().maxCoeff(&axis) < kClear) {
    rest->cwiseAbs().maxCoeff(&axis);
    up = *rest;
  } else if (std::abs((*rest)[axis]) > kClear) {
    up = *rest;  // a person walking on their hands
  }
  const bool down = up[axis] < 0.0;
  if (axis == 1 && !down) return Quat::Identity();
  const Vec3 from = (down ? -1.0 : 1.0) * Vec3::Unit(axis);
  out.notes.push_back(fmt::format("{}{} is up in the file: rotated so that Y is up", down ? "-" : "", "XYZ"[axis]));
  return axis == 1 ? Quat(0.0, 1.0, 0.0, 0.0) : rotationBetween(from, Vec3::UnitY());
}

/// Adds a joint to a forearm or shin that ends in an end site instead of a hand or foot. Otherwise its direction would
/// be undefined.
Result<void> addLimbEnds(const BvhText& text, double metresPerUnit, SkeletalMotion& motion) {
  std::vector<Joint> joints(motion.skeleton.joints().begin(), motion.skeleton.joints().end());
  const std::size_t before = joints.size();
  constexpr std::array<std::pair<HumanBone, HumanBone>, 4> kLowerAndEnd = {
      {{HumanBone::kLeftLowerArm, HumanBone::kLeftHand},
       {HumanBone::kRightLowerArm, HumanBone::kRightHand},
       {HumanBone::kLeftLowerLeg, HumanBone::kLeftFoot},
       {HumanBone::kRightLowerLeg, HumanBone::kRightFoot}}};
  for (const auto& [lowerBone, endBone] : kLowerAndEnd) {
    const JointIndex lower = motion.skeleton.jointOf(lowerBone);
    if (lower == kNoJoint || motion.skeleton.jointOf(endBone) != kNoJoint) continue;
    const auto site = std::find_if(text.endSites.begin(), text.endSites.end(),
                                   [&](const auto& s) { return s.first == lower && s.second.norm() > 0.0; });
    if (site == text.endSites.end()) continue;
    Joint joint;
    joint.name = joints[lower].name + " (end site)";
    joint.parent = lower;
    joint.rest.translation = metresPerUnit * site->second;
    joints.push_back(std::move(joint));
  }
  if (joints.size() == before) return {};
  std::vector<JointTransform> poses;
  poses.reserve(motion.times.size() * joints.size());
  for (int f = 0; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    poses.insert(poses.end(), pose.begin(), pose.end());
    for (std::size_t j = before; j < joints.size(); ++j) poses.push_back(joints[j].rest);
  }
  LORICA_TRY(motion.skeleton, Skeleton::create(std::move(joints)));
  motion.poses = std::move(poses);
  return {};
}

Result<Skeleton> skeletonOf(const BvhText& text, double metresPerUnit) {
  std::vector<Joint> joints;
  joints.reserve(text.joints.size());
  for (const BvhJoint& from : text.joints) {
    Joint joint;
    joint.name = from.name;
    joint.parent = from.parent < 0 ? kNoJoint : from.parent;
    joint.rest.translation = metresPerUnit * from.offset;
    joints.push_back(std::move(joint));
  }
  return Skeleton::create(std::move(joints));
}

/// Rotates the roots of the rest pose and of all frames.
Result<void> turnMotion(const Quat& turn, SkeletalMotion& motion) {
  std::vector<Joint> joints(motion.skeleton.joints().begin(), motion.skeleton.joints().end());
  const std::size_t count = joints.size();
  const auto turned = [&](JointTransform& t) {
    t.translation = turn * t.translation;
    t.rotation = turn * t.rotation;
  };
  for (std::size_t j = 0; j < count; ++j) {
    if (joints[j].parent != kNoJoint) continue;
    turned(joints[j].rest);
    for (std::size_t f = 0; f < motion.times.size(); ++f) turned(motion.poses[f * count + j]);
  }
  LORICA_TRY(motion.skeleton, Skeleton::create(std::move(joints)));
  return {};
}

}  // namespace

Result<BvhFile> parseBvh(std::string_view text, std::string_view name) {
  LORICA_TRY(BvhText parsed, parseBvhText(text, name));
  BvhFile out;
  out.notes = std::move(parsed.notes);
  guessUnit(parsed, out);
  const std::vector<bool> adds = positionsThatAdd(parsed, out);

  SkeletalMotion& motion = out.motion;
  motion.name = std::string(name);
  LORICA_TRY(motion.skeleton, skeletonOf(parsed, out.metresPerUnit));
  motion.poses = posesOf(parsed, out.metresPerUnit, adds);
  motion.times.reserve(parsed.frameCount);
  for (std::size_t f = 0; f < parsed.frameCount; ++f) {
    motion.times.push_back(static_cast<double>(f) * parsed.frameSeconds);
  }

  // Names identify head and feet in any axes. Shape works only once Y is up, so it is evaluated again then.
  const auto findBones = [&] { motion.skeleton = withBones(motion.skeleton, guessHumanoid(motion.skeleton)); };
  findBones();
  if (const Quat turn = turnToYUp(motion, out); turn.w() < 1.0) {
    LORICA_TRY_DO(turnMotion(turn, motion));
    findBones();
  }
  LORICA_TRY_DO(addLimbEnds(parsed, out.metresPerUnit, motion));
  return out;
}

Result<BvhFile> readBvh(const std::filesystem::path& file) {
  LORICA_TRY(const std::string text, readFile(file));
  LORICA_TRY(BvhFile out, parseBvh(text, file.string()));
  out.motion.name = file.stem().string();
  return out;
}

}  // namespace lorica
