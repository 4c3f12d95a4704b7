#include "capture/files/bvh_file.h"

#include "capture/files/bvh_text.h"
#include "capture/files/rest_search.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/line_scanner.h"
#include "geometry/text.h"
#include "skinning/humanoid/humanoid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

namespace lorica {
namespace {

constexpr double kUsualHeight = 1.7;
constexpr double kMinHeight = 0.5;
constexpr double kMaxHeight = 2.5;
/// By the rarer units only bodies of the usual sizes are measured.
constexpr double kMinRareHeight = 1.3;
constexpr double kMaxRareHeight = 2.2;
constexpr std::string_view kOwnUnit = "a unit of its own";

struct Unit {
  std::string_view name;
  double metres;
};
/// From the fourth on they are rare. The last is left over from the conversion of the CMU database: inches over 0.45.
constexpr int kFirstRareUnit = 3;
constexpr std::array<Unit, 6> kUnits = {{{"centimetres", 0.01},
                                         {"metres", 1.0},
                                         {"millimetres", 0.001},
                                         {"inches", 0.0254},
                                         {"decimetres", 0.1},
                                         {"units of the CMU database (5.644 cm)", 0.0254 / 0.45}}};

/// Longest side of the bounding box of a pose, end sites included.
double sizeOf(const BvhText& text, const Skeleton& skeleton, std::span<const JointTransform> pose,
              double metresPerUnit) {
  std::vector<Affine3> world(skeleton.jointCount());
  computeWorldFromJoint(skeleton, pose, world);
  std::vector<Vec3> positions;
  positions.reserve(world.size() + text.endSites.size());
  for (const Affine3& joint : world) positions.emplace_back(joint.translation());
  for (const auto& [parent, offset] : text.endSites) positions.emplace_back(world[parent] * (metresPerUnit * offset));
  const Aabb box = boundsOf(positions);
  return (box.max - box.min).maxCoeff();
}

/// Finds the unit in which a size is nearest to a person's height. A body that no unit explains has one of its own.
void setUnit(double size, BvhFile& out) {
  const auto offBy = [&](const Unit& unit) { return std::abs(std::log(unit.metres * size / kUsualHeight)); };
  const auto best =
      std::min_element(kUnits.begin(), kUnits.end(), [&](const Unit& a, const Unit& b) { return offBy(a) < offBy(b); });
  const double height = best->metres * size;
  const bool rare = best - kUnits.begin() >= kFirstRareUnit;
  out.unit = best->name;
  out.metresPerUnit = best->metres;
  if (!rare || height < kMinHeight || height > kMaxHeight) return;
  if (height >= kMinRareHeight && height <= kMaxRareHeight) return;
  out.metresPerUnit = kUsualHeight / size;
  out.unit = fmt::format("{} ({:.4g} cm)", kOwnUnit, 100.0 * out.metresPerUnit);
}

/// Applies a function to the transforms of the rest pose and of all frames, with their joints.
template <typename Change>
Result<void> changeMotion(SkeletalMotion& motion, const Change& change) {
  std::vector<Joint> joints(motion.skeleton.joints().begin(), motion.skeleton.joints().end());
  for (std::size_t i = 0; i < motion.poses.size(); ++i) change(joints[i % joints.size()], motion.poses[i]);
  for (Joint& joint : joints) change(joint, joint.rest);
  LORICA_TRY(motion.skeleton, Skeleton::create(std::move(joints)));
  return {};
}

/// Converts the motion to metres by the size of its rest pose.
Result<void> guessUnit(const BvhText& text, BvhFile& out) {
  const double before = out.metresPerUnit;
  const double size = sizeOf(text, out.motion.skeleton, restPose(out.motion.skeleton), before) / before;
  out.unit = "metres";
  out.metresPerUnit = 1.0;
  if (size > 0.0) setUnit(size, out);
  const double by = out.metresPerUnit / before;
  return changeMotion(out.motion, [&](const Joint&, JointTransform& t) { t.translation *= by; });
}

void sayUnit(const BvhText& text, BvhFile& out) {
  const double size = sizeOf(text, out.motion.skeleton, restPose(out.motion.skeleton), out.metresPerUnit);
  if (!(size > 0.0)) {
    out.firstGuess.emplace_back("metres, since the skeleton has no extent");
    return;
  }
  const bool own = out.unit.starts_with(kOwnUnit);
  out.firstGuess.push_back(fmt::format("{}, since the rest pose measures {:.4g} units ({:.3g} m{})", out.unit,
                                       size / out.metresPerUnit, size,
                                       own ? ", as no usual unit makes a body of that" : ""));
  if (size >= kMinHeight && size <= kMaxHeight) return;
  out.notes.push_back(fmt::format("the rest pose measures {:.3g} m: no unit gives 0.5 to 2.5 m", size));
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

/// The frames, in the file's unit and axes.
std::vector<JointTransform> posesOf(const BvhText& text, const std::vector<bool>& adds) {
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
      pose.translation = position;
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
/// @param zeroRest  the rest pose is not one of the frames, and so tells more than they do
Quat turnToYUp(const SkeletalMotion& motion, bool zeroRest, BvhFile& out) {
  constexpr int kSamples = 64;
  constexpr double kClear = 0.8;
  const std::optional<Vec3> rest = uprightOf(motion.skeleton, restPose(motion.skeleton));
  if (!rest) {
    out.firstGuess.emplace_back("Y is up, since head or feet are unknown");
    return Quat::Identity();
  }
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
  } else if (zeroRest && std::abs((*rest)[axis]) > kClear) {
    up = *rest;  // a person walking on their hands
  }
  const bool down = up[axis] < 0.0;
  const bool asIs = axis == 1 && !down;
  out.firstGuess.push_back(
      fmt::format("{}{} is up{}", down ? "-" : "", "XYZ"[axis], asIs ? "" : ", rotated so that Y is up"));
  if (asIs) return Quat::Identity();
  const Vec3 from = (down ? -1.0 : 1.0) * Vec3::Unit(axis);
  return axis == 1 ? Quat(0.0, 1.0, 0.0, 0.0) : rotationBetween(from, Vec3::UnitY());
}

/// Adds a joint to a forearm or shin that ends in an end site instead of a hand or foot. Otherwise its direction would
/// be undefined. A head gets its end too, if the rest pose is a frame in which it may be bowed.
Result<void> addLimbEnds(const BvhText& text, double metresPerUnit, bool zeroRest, SkeletalMotion& motion) {
  std::vector<Joint> joints(motion.skeleton.joints().begin(), motion.skeleton.joints().end());
  const std::size_t before = joints.size();
  constexpr std::array<std::pair<HumanBone, HumanBone>, 5> kLowerAndEnd = {
      {{HumanBone::kHead, HumanBone::kHead},
       {HumanBone::kLeftLowerArm, HumanBone::kLeftHand},
       {HumanBone::kRightLowerArm, HumanBone::kRightHand},
       {HumanBone::kLeftLowerLeg, HumanBone::kLeftFoot},
       {HumanBone::kRightLowerLeg, HumanBone::kRightFoot}}};
  for (const auto& [lowerBone, endBone] : kLowerAndEnd) {
    const JointIndex lower = motion.skeleton.jointOf(lowerBone);
    const bool isHead = lowerBone == endBone;
    if (lower == kNoJoint || (isHead ? zeroRest : motion.skeleton.jointOf(endBone) != kNoJoint)) continue;
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

/// At rest every rotation is zero.
Result<Skeleton> skeletonOf(const BvhText& text) {
  std::vector<Joint> joints;
  joints.reserve(text.joints.size());
  for (const BvhJoint& from : text.joints) {
    Joint joint;
    joint.name = from.name;
    joint.parent = from.parent < 0 ? kNoJoint : from.parent;
    joint.rest.translation = from.offset;
    joints.push_back(std::move(joint));
  }
  return Skeleton::create(std::move(joints));
}

/// The same joints with another rest pose and no bones yet. Roots stay where they are: where a body stands in a frame
/// says nothing of its rest pose.
Result<Skeleton> withRest(const Skeleton& skeleton, std::span<const JointTransform> pose) {
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    joints[j].bone.reset();
    if (joints[j].parent != kNoJoint) joints[j].rest.translation = pose[j].translation;
    joints[j].rest.rotation = pose[j].rotation;
  }
  return Skeleton::create(std::move(joints));
}

/// The pose that was asked for, or the one that is found.
Result<RestPose> restOf(const SkeletalMotion& motion, const BvhRest& rest, std::string_view name) {
  if (rest.kind == BvhRest::Kind::kFound) return findRestPose(motion);
  RestPose asked{restPose(motion.skeleton), rest.kind == BvhRest::Kind::kZero, "the zero pose"};
  if (rest.kind == BvhRest::Kind::kFrame) {
    if (rest.frame >= motion.frameCount()) {
      return invalidArgument("{}: found {} frames, expected frame {} for the rest pose, counted from 0", name,
                             motion.frameCount(), rest.frame);
    }
    asked.pose.assign(motion.pose(rest.frame).begin(), motion.pose(rest.frame).end());
    asked.words = fmt::format("frame {}", rest.frame);
  } else if (rest.kind == BvhRest::Kind::kFile) {
    LORICA_TRY(const BvhFile other, readBvh(rest.file, {BvhRest::Kind::kZero, 0, {}}));
    const std::span<const Joint> theirs = other.motion.skeleton.joints();
    for (int j = 0; j < motion.skeleton.jointCount(); ++j) {
      const auto same = std::find_if(theirs.begin(), theirs.end(),
                                     [&](const Joint& joint) { return joint.name == motion.skeleton.joint(j).name; });
      if (same == theirs.end()) {
        return invalidArgument("{}: has no joint {}, expected all joints of {}", rest.file.string(),
                               motion.skeleton.joint(j).name, name);
      }
      asked.pose[j].rotation = other.motion.pose(0)[same - theirs.begin()].rotation;
    }
    asked.words = "the first frame of " + rest.file.filename().string();
  }
  asked.words += fmt::format(" as asked for, {}", namePose(motion.skeleton, asked.pose));
  return asked;
}

}  // namespace

Result<BvhRest> parseBvhRest(std::string_view text) {
  BvhRest rest;
  constexpr std::string_view kFrame = "frame:";
  if (text.empty()) return rest;
  if (text == "zero") {
    rest.kind = BvhRest::Kind::kZero;
  } else if (text.starts_with(kFrame)) {
    const std::string_view number = text.substr(kFrame.size());
    rest.kind = BvhRest::Kind::kFrame;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), rest.frame);
    if (error != std::errc() || end != number.data() + number.size() || rest.frame < 0) {
      return invalidArgument("found {}, expected frame:N with a number from 0 on", quotedWord(text));
    }
  } else {
    rest = {BvhRest::Kind::kFile, 0, std::filesystem::path(text)};
    if (lowerCase(rest.file.extension().string()) != ".bvh") {
      return invalidArgument("found {}, expected zero, frame:N or a .bvh file", quotedWord(text));
    }
  }
  return rest;
}

Result<BvhFile> parseBvh(std::string_view text, std::string_view name, const BvhRest& asked) {
  LORICA_TRY(BvhText parsed, parseBvhText(text, name));
  BvhFile out;
  out.notes = std::move(parsed.notes);
  const std::vector<bool> adds = positionsThatAdd(parsed, out);

  SkeletalMotion& motion = out.motion;
  motion.name = std::string(name);
  LORICA_TRY(motion.skeleton, skeletonOf(parsed));
  motion.poses = posesOf(parsed, adds);
  motion.times.reserve(parsed.frameCount);
  for (std::size_t f = 0; f < parsed.frameCount; ++f) {
    motion.times.push_back(static_cast<double>(f) * parsed.frameSeconds);
  }
  LORICA_TRY_DO(guessUnit(parsed, out));

  // Names identify head and feet in any axes. Shape works only in a rest pose with Y up, so it is evaluated again then.
  const auto findBones = [&] { motion.skeleton = withBones(motion.skeleton, guessHumanoid(motion.skeleton)); };
  findBones();
  const auto isBody = [&] { return motion.skeleton.jointOf(HumanBone::kHips) != kNoJoint; };
  const Skeleton zero = motion.skeleton;
  if (!isBody()) {
    LORICA_TRY(const Skeleton posed, withRest(motion.skeleton, motion.pose(0)));
    motion.skeleton = withBones(motion.skeleton, guessHumanoid(posed));
  }
  LORICA_TRY(const RestPose rest, restOf(motion, asked, name));
  out.firstGuess.push_back("rest pose: " + rest.words);
  motion.skeleton = zero;
  if (!rest.isZero) {
    LORICA_TRY(motion.skeleton, withRest(motion.skeleton, rest.pose));
    LORICA_TRY_DO(guessUnit(parsed, out));
    findBones();
  }
  sayUnit(parsed, out);
  const Quat turn = turnToYUp(motion, rest.isZero, out);
  if (turn.w() < 1.0) {
    LORICA_TRY_DO(changeMotion(motion, [&](const Joint& joint, JointTransform& t) {
      if (joint.parent != kNoJoint) return;
      t.translation = turn * t.translation;
      t.rotation = turn * t.rotation;
    }));
    findBones();
  }
  LORICA_TRY_DO(addLimbEnds(parsed, out.metresPerUnit, rest.isZero, motion));
  return out;
}

Result<BvhFile> readBvh(const std::filesystem::path& file, const BvhRest& rest) {
  LORICA_TRY(std::string text, readFile(file));
  text = asUtf8(std::move(text));
  LORICA_TRY(BvhFile out, parseBvh(text, file.string(), rest));
  out.motion.name = file.stem().string();
  return out;
}

}  // namespace lorica
