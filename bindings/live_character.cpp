#include "bindings/live_character.h"

#include "bindings/mesh_parts.h"
#include "collision/hulls/character_walls.h"
#include "collision/hulls/hull_fit.h"
#include "collision/hulls/mesh_walls.h"
#include "collision/hulls/quality.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

Result<Character> characterOf(const GivenSkin& skin) {
  const std::size_t count = skin.positions.size() / 3, jointCount = skin.jointFromModel.size() / 16;
  if (jointCount < 1 || jointCount > kMaxJoints) {
    return invalidArgument("found {} joints, expected 1 to {}", jointCount, kMaxJoints);
  }
  Character character;
  character.name = skin.name;
  std::vector<Joint> joints;
  for (std::size_t j = 0; j < jointCount; ++j) {
    joints.push_back({fmt::format("joint {}", j), kNoJoint, {}, std::nullopt});
    const std::optional<Affine3> matrix = affineFrom(skin.jointFromModel.data() + 16 * j);
    if (!matrix) return invalidArgument("the inverse bind matrix of joint {} {}", j, kBadMatrix);
    character.jointFromModel.push_back(*matrix);
  }
  LORICA_TRY(character.skeleton, Skeleton::create(std::move(joints)));
  character.influenceBegin.push_back(0);
  for (std::size_t v = 0; v < count; ++v) {
    double sum = 0.0;
    for (std::size_t k = v * skin.perVertex; k < (v + 1) * skin.perVertex; ++k) {
      if (!(skin.weights[k] > 0.0 && skin.weights[k] < kInfinity)) continue;
      if (skin.joints[k] < 0 || std::cmp_greater_equal(skin.joints[k], jointCount)) {
        return invalidArgument("vertex {}: found joint {}, expected 0 to {}", v, skin.joints[k], jointCount - 1);
      }
      sum += skin.weights[k];
      character.influences.push_back({skin.joints[k], skin.weights[k]});
    }
    if (!(sum > 0.0)) return invalidArgument("vertex {}: no joint has a weight above 0", v);
    for (std::size_t k = character.influenceBegin.back(); k < character.influences.size(); ++k) {
      character.influences[k].weight /= sum;
    }
    character.influenceBegin.push_back(character.influences.size());
  }
  return character;
}

}  // namespace

std::optional<Affine3> affineFrom(const double* numbers) {
  const Eigen::Map<const Mat4> matrix(numbers);
  if (!matrix.allFinite() || !matrix.row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))) return std::nullopt;
  Affine3 affine;
  affine.matrix() = matrix;
  return affine;
}

std::vector<std::string> notesOf(const Subject& character) {
  std::vector<std::string> notes;
  if (character.file) notes = character.file->notes;
  if (character.body) notes.insert(notes.end(), character.body->notes.begin(), character.body->notes.end());
  return notes;
}

Result<void> checkLengths(const CharacterOptions& options) {
  for (const auto& [length, name] :
       {std::pair(options.bodyResolution, "body_resolution"), std::pair(options.thickness, "thickness")}) {
    if (!(length >= 0.0 && length < kInfinity))
      return invalidArgument("{}: found {}, expected 0 m or more", name, length);
  }
  return {};
}

Result<CharacterPointer> makeCharacter(const GivenSkin& skin, const CharacterOptions& options, Host& host) {
  LORICA_TRY_DO(checkLengths(options));
  const std::vector<std::int64_t> corners(skin.corners.begin(), skin.corners.end());
  LORICA_TRY(MeshSequence mesh, checkedMesh(skin.positions, skin.positions.size() / 3, corners));
  LORICA_TRY(Character character, characterOf(skin));
  character.mesh = {std::move(mesh.positions), std::move(mesh.triangles)};
  const Aabb box = boundsOf(character.mesh.vertices);
  character.height = box.empty() ? 0.0 : box.max.y() - box.min.y();
  LORICA_TRY_DO(checkCharacter(character));
  LORICA_TRY_DO(checkThickness(skin.name, options.thickness, character.mesh.vertices));
  CharacterFile file;
  file.character = std::move(character);
  Task task(host, "Making a closed body for " + skin.name, "steps");
  BodySettings settings;
  settings.resolution = options.bodyResolution;
  settings.keepClosed = options.body != BodyChoice::kAlways;
  settings.threads = host.threads;
  settings.progress = task.progress();
  LORICA_TRY(ClosedBody body, bodyWithWalls(file, options, [&](const Character& rest) {
               return prefixed(skin.name, makeBody(rest, settings));
             }));
  Subject made;
  made.name = skin.name;
  made.mesh = body.character.mesh;
  made.character = body.character;
  made.body = std::move(body);
  return std::make_shared<const Subject>(std::move(made));
}

Result<std::shared_ptr<const CharacterBody>> bodyOf(CharacterPointer owner, DecompositionFile content) {
  LORICA_TRY(std::shared_ptr<const BodyPlan> plan,
             BodyPlan::create(content.decomposition, *owner->character, content.cover));
  std::string warning = doubtAboutHulls(content.meanError);
  return std::make_shared<const CharacterBody>(
      CharacterBody{std::move(owner), std::move(content), std::move(plan), std::move(warning)});
}

Result<std::shared_ptr<const CharacterBody>> makeBodyInPoses(CharacterPointer owner,
                                                             std::span<const Affine3> worldFromJoint,
                                                             const CharacterBodySettings& settings, Host& host) {
  constexpr int kUsualParts = 16;  // as `lorica play`
  LORICA_TRY_DO(checkCounts(settings.parts, settings.cover.budget(), host.threads));
  const Character& character = *owner->character;
  LORICA_TRY_DO(checkCover(settings.cover, character));
  const std::size_t jointCount = character.skeleton.jointCount();
  std::vector<Affine3> bones(worldFromJoint.begin(), worldFromJoint.end());
  for (std::size_t b = 0; b < bones.size(); ++b) bones[b] = bones[b] * character.jointFromModel[b % jointCount];
  const Keyframes keyframes = trainingKeyframes(character, bones);
  CoverPoses poses;
  poses.jointCount = static_cast<int>(jointCount);
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const bool sampled = bones.size() == jointCount || b / jointCount % 2 == 0;
    (sampled ? poses.sampled : poses.heldOut).push_back(bones[b]);
  }
  if (poses.heldOut.empty()) poses.heldOut = poses.sampled;
  DecomposeSettings decomposing;
  decomposing.maxParts = settings.parts > 0 ? settings.parts : kUsualParts;
  decomposing.threads = host.threads;
  const FitRequest request{*owner,         keyframes, settings.cover.exact() ? nullptr : &poses,
                           settings.cover, false,     decomposing};
  LORICA_TRY(const Fit fit, fitHulls(request, host));
  return bodyOf(std::move(owner), fileContent(request, nullptr, fit));
}

Result<std::shared_ptr<const CharacterBody>> readCharacterBody(CharacterPointer owner,
                                                               const std::filesystem::path& file) {
  LORICA_TRY(DecompositionFile content, readDecompositionOf(*owner, file));
  return bodyOf(std::move(owner), std::move(content));
}

Result<std::shared_ptr<const CharacterBody>> parseCharacterBody(CharacterPointer owner, std::string_view bytes) {
  LORICA_TRY(DecompositionFile content, parseDecomposition(bytes, "bytes"));
  LORICA_TRY_DO(checkMadeFrom(*owner, content, "bytes"));
  return bodyOf(std::move(owner), std::move(content));
}

LiveCharacter::LiveCharacter(std::shared_ptr<const CharacterBody> body)
    : body_(std::move(body)),
      live_(body_->plan),
      worldFromJoint_(body_->character().skeleton.jointCount(), Affine3::Identity()),
      worldFromModel_(worldFromJoint_.size(), Affine3::Identity()),
      hulls_(live_.parts().size()) {
  for (std::size_t p = 0; p < hulls_.size(); ++p) {
    const std::size_t most = live_.candidateCount(p);
    hulls_[p].vertices.reserve(most);
    hulls_[p].pointOfVertex.reserve(most);
    hulls_[p].triangles.reserve(2 * most);
  }
}

void LiveCharacter::pose(std::span<const JointTransform> pose) {
  computeWorldFromJoint(body_->character().skeleton, pose, worldFromJoint_);
  move();
}

void LiveCharacter::place(std::span<const Affine3> worldFromJoint) {
  std::ranges::copy(worldFromJoint, worldFromJoint_.begin());
  move();
}

void LiveCharacter::move() {
  computeWorldFromModel(body_->character(), worldFromJoint_, worldFromModel_);
  live_.update(worldFromModel_);
  for (std::size_t p = 0; p < hulls_.size(); ++p) worldHull(live_.parts()[p], hulls_[p]);
  for (std::vector<Vec3>& points : swept_) points.clear();
  ++poses_;
  raysKnowPose_ = skinKnowsPose_ = false;
}

std::span<const Vec3> LiveCharacter::swept(PartIndex part) {
  if (swept_.empty()) {
    swept_.resize(hulls_.size());
    for (std::size_t p = 0; p < swept_.size(); ++p) swept_[p].reserve(2 * live_.candidateCount(p));
  }
  std::vector<Vec3>& points = swept_[part];
  if (points.empty()) sweptPoints(live_.parts()[part], points);
  return points;
}

const RayQuery& LiveCharacter::rays() {
  if (posed() && !raysKnowPose_) {
    const std::span<const LivePart> parts = live_.parts();
    rays_.update({&parts, 1});
    raysKnowPose_ = true;
  }
  return rays_;
}

SkinHit LiveCharacter::castOnSkin(const HullRay& ray) {
  if (!posed()) return {};
  if (!skin_) skin_.emplace(live_.decomposition(), body_->character());
  if (!skinKnowsPose_) skin_->update(worldFromModel_);
  skinKnowsPose_ = true;
  return rays().nearestOnSkin(ray, {&*skin_, 1});
}

Result<void> checkSeconds(double seconds) {
  if (seconds > 0.0 && seconds < kInfinity) return {};
  return invalidArgument("seconds: found {}, expected more than 0 s", seconds);
}

Result<void> checkCast(double reach, double radius, const Vec3& half) {
  if (!(reach >= 0.0)) return invalidArgument("reach: found {}, expected 0 m or more", reach);
  if (!(radius >= 0.0 && radius < kInfinity)) {
    return invalidArgument("radius: found {}, expected 0 m or more", radius);
  }
  if (half.allFinite()) return {};
  return invalidArgument("half: found {} {} {}, expected finite numbers", half.x(), half.y(), half.z());
}

}  // namespace lorica
