#include "session/prepare/smpl.h"

#include "geometry/arrays/array_file.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "session/prepare/first_guess.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// A joint of the body models: names and parents are in their publications.
struct ModelJoint {
  const char* name;
  int parent;  ///< in this list
  std::optional<HumanBone> bone;
};
constexpr std::array<ModelJoint, 24> kBody = {{{"pelvis", -1, HumanBone::kHips},
                                               {"left_hip", 0, HumanBone::kLeftUpperLeg},
                                               {"right_hip", 0, HumanBone::kRightUpperLeg},
                                               {"spine1", 0, HumanBone::kSpine},
                                               {"left_knee", 1, HumanBone::kLeftLowerLeg},
                                               {"right_knee", 2, HumanBone::kRightLowerLeg},
                                               {"spine2", 3, HumanBone::kChest},
                                               {"left_ankle", 4, HumanBone::kLeftFoot},
                                               {"right_ankle", 5, HumanBone::kRightFoot},
                                               {"spine3", 6, HumanBone::kUpperChest},
                                               {"left_foot", 7, HumanBone::kLeftToes},
                                               {"right_foot", 8, HumanBone::kRightToes},
                                               {"neck", 9, HumanBone::kNeck},
                                               {"left_collar", 9, HumanBone::kLeftShoulder},
                                               {"right_collar", 9, HumanBone::kRightShoulder},
                                               {"head", 12, HumanBone::kHead},
                                               {"left_shoulder", 13, HumanBone::kLeftUpperArm},
                                               {"right_shoulder", 14, HumanBone::kRightUpperArm},
                                               {"left_elbow", 16, HumanBone::kLeftLowerArm},
                                               {"right_elbow", 17, HumanBone::kRightLowerArm},
                                               {"left_wrist", 18, HumanBone::kLeftHand},
                                               {"right_wrist", 19, HumanBone::kRightHand},
                                               {"left_hand", 20, std::nullopt},
                                               {"right_hand", 21, std::nullopt}}};
constexpr int kBodyJoints = 22;  // that all models have
constexpr std::array<const char*, 3> kFace = {"jaw", "left_eye", "right_eye"};
constexpr int kHead = 15;
constexpr std::size_t kMostShapes = 16;  // of the model's, the strongest first
/// Fingers in the order of the models, and VRM's names of them.
constexpr std::array<std::pair<const char*, const char*>, 5> kFingers = {
    {{"index", "Index"}, {"middle", "Middle"}, {"pinky", "Little"}, {"ring", "Ring"}, {"thumb", "Thumb"}}};

/// The joints of a model with so many: 22 or 24 (SMPL), 52 (SMPL-H) or 55 (SMPL-X); of others none. Rest transforms are
/// to be set.
std::vector<Joint> jointsOf(std::size_t count) {
  const std::size_t body = count == 24 ? 24 : kBodyJoints;
  if (count != 22 && count != 24 && count != 52 && count != 55) return {};
  std::vector<Joint> joints;
  for (std::size_t j = 0; j < body; ++j) joints.push_back({kBody[j].name, kBody[j].parent, {}, kBody[j].bone});
  if (count == 55) {
    for (const char* name : kFace) joints.push_back({name, kHead, {}, {}});
  }
  for (int side = 0; side < 2 && count > 24; ++side) {
    for (const auto& [name, vrm] : kFingers) {
      const bool thumb = std::string_view(name) == "thumb";
      const std::array<const char*, 3> phalanges = {thumb ? "Metacarpal" : "Proximal",
                                                    thumb ? "Proximal" : "Intermediate", "Distal"};
      for (int i = 0; i < 3; ++i) {
        const JointIndex parent = i == 0 ? 20 + side : countOf(joints) - 1;
        joints.push_back({fmt::format("{}_{}{}", side == 0 ? "left" : "right", name, i + 1),
                          parent,
                          {},
                          humanBoneNamed(fmt::format("{}{}{}", side == 0 ? "left" : "right", vrm, phalanges[i]))});
      }
    }
  }
  return joints;
}

const NamedArray* arrayNamed(std::span<const NamedArray> arrays, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(arrays, name, &NamedArray::name);
    if (found != arrays.end()) return &*found;
  }
  return nullptr;
}

/// Numbers of an array that must be there, with a shape that fits. A size of 0 fits any.
Result<std::vector<double>> tableOf(std::span<const NamedArray> arrays, const char* name,
                                    const std::vector<std::size_t>& shape, const fs::path& file) {
  const NamedArray* array = arrayNamed(arrays, {name});
  const auto same = [](std::size_t found, std::size_t wanted) { return wanted == 0 ? found > 0 : found == wanted; };
  if (array == nullptr) return badFormat("{}: has no array `{}`", file.string(), name);
  if (!std::ranges::equal(array->shape, shape, same)) {
    return badFormat("{}: {} has the shape ({}), expected ({}), 0 for any", file.string(), name,
                     fmt::join(array->shape, ", "), fmt::join(shape, ", "));
  }
  LORICA_TRY(std::vector<double> numbers, prefixed(file.string(), numbersOf(*array)));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i])) {
      return badFormat("{}: {}: element {} is {}, expected a finite number", file.string(), name, i, numbers[i]);
    }
  }
  return numbers;
}

Quat rotationOf(const double* axisAngle) {
  const Vec3 axis(axisAngle[0], axisAngle[1], axisAngle[2]);
  const double angle = axis.norm();
  return angle < 1e-12 ? Quat::Identity() : Quat(Eigen::AngleAxisd(angle, axis / angle));
}

/// Puts the mannequin's bones into joints, which rest as a T with the axes of the world.
void restAsMannequin(std::vector<Joint>& joints) {
  const Skeleton mannequin = makeMannequin().skeleton;
  std::vector<Affine3> world(mannequin.jointCount());
  computeWorldFromJoint(mannequin, restPose(mannequin), world);
  std::vector<Vec3> at(joints.size(), Vec3::Zero());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointIndex parent = joints[j].parent;
    const JointIndex own = joints[j].bone ? mannequin.jointOf(*joints[j].bone) : kNoJoint;
    const Vec3 above = parent == kNoJoint ? Vec3::Zero() : at[parent];
    at[j] = own != kNoJoint ? Vec3(world[own].translation()) : above;
    joints[j].rest.translation = at[j] - above;
  }
}

}  // namespace

ArchiveKind archiveKindOf(const fs::path& file) {
  const std::vector<std::string> names = arrayNames(file);
  const auto has = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
  if (has("v_template") && has("weights")) return ArchiveKind::kSmplModel;
  return has("poses") && !has("vertices") ? ArchiveKind::kSmplMotion : ArchiveKind::kOther;
}

Result<Motion> readSmplMotion(const fs::path& file) {
  LORICA_TRY(const std::vector<NamedArray> arrays, readArrays(file));
  const NamedArray* found = arrayNamed(arrays, {"poses"});
  std::size_t each = 1;
  for (std::size_t i = 1; found != nullptr && i < found->shape.size(); ++i) each *= found->shape[i];
  std::vector<Joint> joints = each % 3 == 0 ? jointsOf(each / 3) : std::vector<Joint>();
  if (found == nullptr || found->shape.empty() || found->shape[0] == 0 || joints.empty()) {
    return badFormat(
        "{}: {}, expected `poses` of frames x 66, 72, 156 or 165 numbers: axis and angle of 22, 24, 52 or "
        "55 joints",
        file.string(),
        found == nullptr ? "has no `poses`" : fmt::format("poses has the shape ({})", fmt::join(found->shape, ", ")));
  }
  const std::size_t frames = found->shape[0];
  if (static_cast<double>(frames) * static_cast<double>(joints.size()) > kMaxClipPoses) {
    return unsupported("{}: {} frames, expected at most {:.0f} with {} joints", file.string(), frames,
                       kMaxClipPoses / static_cast<double>(joints.size()), joints.size());
  }
  LORICA_TRY(const std::vector<double> poses, tableOf(arrays, "poses", found->shape, file));
  std::vector<double> trans(3 * frames, 0.0);
  if (arrayNamed(arrays, {"trans"}) != nullptr) {
    LORICA_TRY(trans, tableOf(arrays, "trans", {frames, 3}, file));
  }
  Motion motion;
  motion.name = file.stem().string();
  motion.format = joints.size() == 55 ? "SMPL-X" : joints.size() == 52 ? "SMPL-H" : "SMPL";
  double rate = 30.0;
  const NamedArray* rateArray = arrayNamed(arrays, {"mocap_framerate", "mocap_frame_rate", "fps"});
  if (rateArray == nullptr) {
    motion.notes.push_back("has no rate (mocap_framerate), so it plays 30 frames a second");
  } else {
    const Result<std::vector<double>> given = numbersOf(*rateArray);
    if (!given || given->size() != 1 || !(given->front() > 0.0 && given->front() <= 10'000.0)) {
      return badFormat("{}: {} is no number of frames a second", file.string(), rateArray->name);
    }
    rate = given->front();
  }
  // Where a body's own Y axis mostly points is up: AMASS has Z, the models themselves have Y.
  Vec3 up = Vec3::Zero();
  for (std::size_t f = 0; f < frames; ++f) up += rotationOf(&poses[f * each]) * Vec3::UnitY();
  const bool zUp = std::abs(up.z()) > std::abs(up.y());
  const Quat upright = zUp ? Quat(Eigen::AngleAxisd(-std::numbers::pi / 2.0, Vec3::UnitX())) : Quat::Identity();
  restAsMannequin(joints);
  LORICA_TRY(Skeleton skeleton, Skeleton::create(joints));
  SkeletalMotion bones{motion.name, std::move(skeleton), {}, {}};
  bones.poses.reserve(frames * joints.size());
  for (std::size_t f = 0; f < frames; ++f) {
    bones.times.push_back(static_cast<double>(f) / rate);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      JointTransform transform = joints[j].rest;
      transform.rotation = rotationOf(&poses[f * each + 3 * j]);
      if (j == 0) {
        transform.rotation = upright * transform.rotation;
        transform.translation = upright * Vec3(&trans[3 * f]);
      }
      bones.poses.push_back(transform);
    }
  }
  motion.bones = std::move(bones);
  motion.firstGuess =
      firstGuessOf({"rest pose: a T, as the models have", "metres", zUp ? "Z is up" : "Y is up"}, motion);
  return motion;
}

Result<CharacterFile> readSmplModel(const fs::path& file) {
  LORICA_TRY(const std::vector<NamedArray> arrays, readArrays(file));
  LORICA_TRY(std::vector<double> points, tableOf(arrays, "v_template", {0, 3}, file));
  const std::size_t count = points.size() / 3;
  LORICA_TRY(const std::vector<double> weights, tableOf(arrays, "weights", {count, 0}, file));
  const std::size_t jointCount = weights.size() / count;
  LORICA_TRY(const std::vector<double> tree, tableOf(arrays, "kintree_table", {2, jointCount}, file));
  LORICA_TRY(const std::vector<double> regressor, tableOf(arrays, "J_regressor", {jointCount, count}, file));
  LORICA_TRY(const std::vector<double> faces, tableOf(arrays, "f", {0, 3}, file));
  CharacterFile read;
  std::vector<double> shapes, betas;
  if (arrayNamed(arrays, {"shapedirs"}) != nullptr) {
    LORICA_TRY(shapes, tableOf(arrays, "shapedirs", {count, 3, 0}, file));
  }
  const std::size_t shapeCount = shapes.size() / points.size();
  if (arrayNamed(arrays, {"betas"}) != nullptr) {
    LORICA_TRY(betas, tableOf(arrays, "betas", {0}, file));
    if (betas.size() > shapeCount) {
      return badFormat("{}: betas has {} numbers, expected at most {}, as shapedirs has", file.string(), betas.size(),
                       shapeCount);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t s = 0; s < betas.size(); ++s) points[i] += betas[s] * shapes[i * shapeCount + s];
    }
  }
  for (std::size_t s = 0; s < std::min(shapeCount, kMostShapes); ++s) {
    MorphTarget& target = read.morphs.targets.emplace_back(MorphTarget{fmt::format("shape {}", s), 0.0F, {}});
    for (std::size_t v = 0; v < count; ++v) {
      const auto along = [&](std::size_t axis) { return static_cast<float>(shapes[(3 * v + axis) * shapeCount + s]); };
      const Vec3f offset(along(0), along(1), along(2));
      if (!offset.isZero(0.0F)) target.offsets.push_back({static_cast<VertexIndex>(v), offset, Vec3f::Zero()});
    }
  }
  read.morphTargets = countOf(read.morphs.targets);
  Character& character = read.character;
  character.name = file.stem().string();
  double floor = points[1];
  for (std::size_t v = 0; v < count; ++v) floor = std::min(floor, points[3 * v + 1]);
  for (std::size_t v = 0; v < count; ++v) {
    character.mesh.vertices.emplace_back(points[3 * v], points[3 * v + 1] - floor, points[3 * v + 2]);
    character.height = std::max(character.height, points[3 * v + 1] - floor);
  }
  for (std::size_t t = 0; t < faces.size(); t += 3) {
    Triangle& triangle = character.mesh.triangles.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(faces[t + c] >= 0.0 && faces[t + c] < static_cast<double>(count))) {
        return badMesh("{}: f: triangle {}: found point {:.0f}, expected 0 to {}", file.string(), t / 3, faces[t + c],
                       count - 1);
      }
      triangle[c] = static_cast<VertexIndex>(faces[t + c]);
    }
  }
  std::vector<Joint> joints = jointsOf(jointCount);
  std::vector<Vec3> at(jointCount, Vec3::Zero());
  for (std::size_t j = 0; j < jointCount; ++j) {
    if (joints.size() == j) joints.push_back({fmt::format("joint_{}", j), kNoJoint, {}, {}});
    const double parent = tree[j];
    if (j > 0 && !(parent >= 0.0 && parent < static_cast<double>(j))) {
      return badFormat("{}: kintree_table: joint {} has the parent {:.0f}, expected one before it", file.string(), j,
                       parent);
    }
    joints[j].parent = j == 0 ? kNoJoint : static_cast<JointIndex>(parent);
    for (std::size_t v = 0; v < count; ++v) at[j] += regressor[j * count + v] * character.mesh.vertices[v];
    joints[j].rest.translation = j == 0 ? at[0] : Vec3(at[j] - at[joints[j].parent]);
    character.jointFromModel.emplace_back(Eigen::Translation3d(-at[j]));
  }
  LORICA_TRY(character.skeleton, Skeleton::create(std::move(joints)));
  character.influenceBegin.push_back(0);
  for (std::size_t v = 0; v < count; ++v) {
    const std::span<const double> own = std::span(weights).subspan(v * jointCount, jointCount);
    double sum = 0.0;
    for (const double weight : own) sum += std::max(weight, 0.0);
    if (!(sum > 0.0)) return badFormat("{}: weights: point {} has no joint", file.string(), v);
    std::size_t used = 0;
    for (std::size_t j = 0; j < jointCount; ++j) {
      if (own[j] <= 0.0) continue;
      character.influences.push_back({static_cast<JointIndex>(j), own[j] / sum});
      ++used;
    }
    read.maxInfluences = std::max(read.maxInfluences, static_cast<int>(used));
    character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  }
  LORICA_TRY_DO(prefixed(file.string(), checkCharacter(character)));
  read.nodeOfJoint.assign(jointCount, -1);
  read.format = jointCount == 55 ? "SMPL-X model" : jointCount == 52 ? "SMPL-H model" : "SMPL model";
  read.meshes = read.primitives = read.skins = 1;
  read.notes.push_back(fmt::format("its {} shape is read; shapes that depend on the pose (posedirs) are left out",
                                   betas.empty() ? "mean" : "betas'"));
  return read;
}

}  // namespace lorica
