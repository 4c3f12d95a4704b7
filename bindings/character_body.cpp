#include "bindings/character_body.h"

#include "capture/files/joint_csv.h"
#include "collision/hulls/hull_fit.h"
#include "collision/hulls/quality.h"
#include "geometry/errors.h"
#include "session/prepare/body.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/first_guess.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/training_motions.h"

#include <fmt/ranges.h>

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
  LORICA_TRY_DO(checkLengths(reading));
  LORICA_TRY(Subject read, readCharacter(nameOrFile, reading, host));
  return std::make_shared<const Subject>(std::move(read));
}

Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(CharacterPointer owner,
                                                               const CharacterBodySettings& settings, Host& host) {
  LORICA_TRY_DO(checkCounts(settings.parts, settings.cover.budget(), host.threads));
  LORICA_TRY_DO(checkCover(settings.cover, *owner->character));
  LORICA_TRY(DecompositionFile content,
             settings.parts > 0 ? decomposed(*owner, settings, host) : chooseBody({"", settings.cover}, *owner, host));
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

std::string guessAbout(const Subject& character) {
  return character.file ? firstGuessOf(*character.file) : std::string();
}

}  // namespace lorica
