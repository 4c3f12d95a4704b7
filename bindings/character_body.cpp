#include "bindings/character_body.h"

#include "capture/files/joint_csv.h"
#include "geometry/errors.h"
#include "session/prepare/body.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/hull_fit.h"
#include "session/prepare/quality.h"
#include "session/prepare/read_motion.h"
#include "skinning/linear_blend.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

/// The body of `lorica decompose --parts N`.
Result<DecompositionFile> decomposed(const Subject& subject, const CharacterBodySettings& settings, Host& host) {
  LORICA_TRY(const Training training, trainingMotions(subject, {}));
  LORICA_TRY(const Keyframes keyframes, trainingKeyframes(*subject.character, training, std::nullopt));
  CoverPoses poses;
  if (!settings.cover.exact()) {
    LORICA_TRY(poses, coverPoses(*subject.character, training.motions));
  }
  DecomposeSettings decomposing;
  decomposing.maxParts = settings.parts;
  decomposing.threads = host.threads;
  const FitRequest request{subject,        keyframes, settings.cover.exact() ? nullptr : &poses,
                           settings.cover, false,     decomposing};
  LORICA_TRY(const Fit fit, fitHulls(request, host));
  return fileContent(request, &training, fit);
}

Result<std::shared_ptr<const CharacterBody>> bodyOf(CharacterPointer owner, DecompositionFile content) {
  LORICA_TRY(std::shared_ptr<const BodyPlan> plan,
             BodyPlan::create(content.decomposition, *owner->character, content.cover));
  std::string warning = doubtAboutHulls(content.meanError);
  return std::make_shared<const CharacterBody>(
      CharacterBody{std::move(owner), std::move(content), std::move(plan), std::move(warning)});
}

/// A shipped recording by its name, without its file, which a program may not have.
Result<Motion> motionNamed(const std::string& name) {
  if (std::optional<Motion> shipped = shippedMotion(name)) return *std::move(shipped);
  return notFound(
      "{}: no such file and no shipped recording with that name, expected a motion (joints, .bvh, .oni, .glb, .vrm, "
      ".fbx, .dae) or one of {}",
      name, fmt::join(kShippedMotions, ", "));
}

}  // namespace

Result<CharacterPointer> openCharacter(const std::string& nameOrFile, const CharacterOptions& reading, Host& host) {
  for (const auto& [length, name] :
       {std::pair(reading.bodyResolution, "body_resolution"), std::pair(reading.thickness, "thickness")}) {
    if (!(length >= 0.0 && length < kInfinity))
      return invalidArgument("{}: found {}, expected 0 m or more", name, length);
  }
  LORICA_TRY(Subject read, readCharacter(nameOrFile, reading, host));
  return std::make_shared<const Subject>(std::move(read));
}

std::vector<std::string> notesOf(const Subject& character) {
  std::vector<std::string> notes;
  if (character.file) notes = character.file->notes;
  if (character.body) notes.insert(notes.end(), character.body->notes.begin(), character.body->notes.end());
  return notes;
}

Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(CharacterPointer owner,
                                                               const CharacterBodySettings& settings, Host& host) {
  LORICA_TRY_DO(checkCounts(settings.parts, settings.cover.hullVertices, host.threads));
  LORICA_TRY_DO(checkCover(settings.cover, *owner->character));
  LORICA_TRY(DecompositionFile content,
             settings.parts > 0 ? decomposed(*owner, settings, host) : chooseBody({"", settings.cover}, *owner, host));
  return bodyOf(std::move(owner), std::move(content));
}

Result<std::shared_ptr<const CharacterBody>> readCharacterBody(CharacterPointer owner,
                                                               const std::filesystem::path& file) {
  LORICA_TRY(DecompositionFile content, readDecompositionOf(*owner, file));
  return bodyOf(std::move(owner), std::move(content));
}

Result<Performance> performanceOf(const Character& character, const std::string& nameOrFile, const std::string& clip,
                                  bool mirror, Host& host) {
  if (!clip.empty() && kindOf(nameOrFile) != FileKind::kCharacter) {
    return invalidArgument("{}: clip {} was asked for, but only character files have clips", nameOrFile, clip);
  }
  MotionOptions options;
  options.clip = clip;
  options.mirror = mirror;
  LORICA_TRY(const Motion motion,
             isBareName(nameOrFile) ? motionNamed(nameOrFile) : readMotion(nameOrFile, options, host));
  LORICA_TRY(SkeletalMotion performed, performedBy(character, motion, options.joints()));
  return Performance{std::move(performed), motion.firstGuess};
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
  posed_ = true;
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

std::span<const SelfContact> LiveCharacter::selfContacts() {
  if (!posed_) return {};
  if (!contacts_) contacts_.emplace(live_, body_->character().mesh.vertices);
  return contacts_->find(live_.parts());
}

std::span<const ShapeContact> LiveCharacter::touches(const RoundedShape& shape) {
  if (!posed_) return {};
  if (!touches_) touches_.emplace(live_);
  return touches_->find(live_.parts(), shape);
}

const RayQuery& LiveCharacter::rays() {
  if (posed_ && !raysKnowPose_) {
    const std::span<const LivePart> parts = live_.parts();
    rays_.update({&parts, 1});
    raysKnowPose_ = true;
  }
  return rays_;
}

SkinHit LiveCharacter::castOnSkin(const HullRay& ray) {
  if (!posed_) return {};
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

Result<void> checkShape(const RoundedShape& shape) {
  constexpr double kFarthest = 1e6;  // [m]; single precision has nothing to say beyond
  if (shape.points.empty()) return invalidArgument("points: found none, expected at least one");
  if (!(shape.radius >= 0.0 && shape.radius <= kFarthest)) {
    return invalidArgument("radius: found {}, expected 0 to 1,000,000 m", shape.radius);
  }
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    const Vec3& p = shape.points[i];
    if (p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest) continue;
    return invalidArgument("point {}: found {} {} {}, expected -1,000,000 to 1,000,000 m", i, p.x(), p.y(), p.z());
  }
  return {};
}

}  // namespace lorica
