#include "bindings/character_body.h"

#include "geometry/errors.h"
#include "prepare/body.h"
#include "prepare/hull_fit.h"
#include "prepare/read_motion.h"
#include "prepare/shipped_motion.h"

#include <fmt/ranges.h>

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

/// The body of `lorica decompose --parts N`.
Result<DecompositionFile> decomposed(const Subject& subject, const CharacterBodySettings& settings, Host& host) {
  LORICA_TRY(const Training training, trainingMotions(subject, {}, host));
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
  return std::make_shared<const CharacterBody>(CharacterBody{std::move(owner), std::move(content), std::move(plan)});
}

/// A shipped recording by its name, without its file, which a program may not have.
Result<Motion> motionNamed(const std::string& name) {
  if (std::optional<Motion> made = shippedMotion(name)) return *std::move(made);
  std::array<std::string_view, kSyntheticMotionCount> names;
  for (int m = 0; m < kSyntheticMotionCount; ++m) names[std::size_t(m)] = nameOf(static_cast<SyntheticMotion>(m));
  return notFound(
      "{}: no such file and no shipped recording with that name, expected a motion (joints, .bvh, .oni, .glb, .vrm, "
      ".fbx, .dae) or one of {}",
      name, fmt::join(names, ", "));
}

}  // namespace

Result<CharacterPointer> openCharacter(const std::string& nameOrFile, Host& host) {
  LORICA_TRY(Subject read, readCharacter(nameOrFile, {}, host));
  return std::make_shared<const Subject>(std::move(read));
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
  if (!clip.empty() && !isCharacterFile(nameOrFile)) {
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

}  // namespace lorica
