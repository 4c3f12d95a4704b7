#include "bindings/playable_character.h"

#include "bindings/file_reading.h"
#include "bindings/motion_files.h"
#include "collision/live/lifted_point.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "prepare/body_cache.h"
#include "prepare/decomposition_cache.h"
#include "prepare/training.h"
#include "prepare/used_hulls.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin.h"

#include <utility>

namespace lorica {
namespace {

DecompositionCache userCache() {
  return {userCacheFolder(), {}};
}

Result<Training> usualTraining(const PlayableCharacter& owner) {
  return trainingMotions(owner.character, {}, owner.clips,
                         []() -> Result<std::vector<Motion>> { return shippedMotions(); });
}

/// A decomposition into a number of parts other than the usual one.
Result<DecompositionFile> decomposed(const PlayableCharacter& owner, const Training& training,
                                     const DecomposeSettings& settings) {
  const Character& character = owner.character;
  LORICA_TRY(const Keyframes keyframes, trainingKeyframes(character, training, std::nullopt));
  const PoseView poses{keyframes.positions, countOf(character.mesh.vertices)};
  LORICA_TRY(Decomposition made, prefixed(character.name, decompose(character.mesh, poses, settings)));
  const HullCover exact = coverExactly(made, liftPoints(character, made));
  const UsedHulls hulls =
      liveHulls(character, made, exact, {keyframes.worldFromModel, character.skeleton.jointCount()});
  return fileContent(character.name, character.mesh, &character, &training, poses, std::move(made), hulls);
}

Result<std::shared_ptr<const CharacterBody>> bodyOf(std::shared_ptr<const PlayableCharacter> owner,
                                                    DecompositionFile content) {
  LORICA_TRY(std::shared_ptr<const BodyPlan> plan,
             BodyPlan::create(content.decomposition, owner->character, content.cover));
  return std::make_shared<const CharacterBody>(CharacterBody{std::move(owner), std::move(content), std::move(plan)});
}

}  // namespace

Result<std::shared_ptr<const PlayableCharacter>> readPlayable(const std::string& nameOrFile) {
  if (nameOrFile == "mannequin") {
    return std::make_shared<const PlayableCharacter>(PlayableCharacter{makeMannequin(), {}, {}});
  }
  if (!isCharacterFile(nameOrFile)) {
    return notFound(
        "{}: no character with that name, expected mannequin or a character file (.glb, .gltf, .vrm, .fbx, .dae)",
        nameOrFile);
  }
  LORICA_TRY(CharacterFile file, readCharacterFile(nameOrFile, fileReading()));
  if (file.isMesh()) {
    return invalidArgument("{}: found a mesh without skin and clips, expected a character", nameOrFile);
  }
  if (file.character.mesh.triangles.empty()) {
    return badMesh(nameOrFile + ": no triangles, expected a character with a surface");
  }
  LORICA_TRY(ClosedBody body, prefixed(nameOrFile, cachedBody(file.character, {}, userCache())));
  PlayableCharacter playable{std::move(body.character), std::move(file.clips), std::move(file.notes)};
  playable.notes.insert(playable.notes.end(), body.notes.begin(), body.notes.end());
  return std::make_shared<const PlayableCharacter>(std::move(playable));
}

Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(std::shared_ptr<const PlayableCharacter> owner,
                                                               const CharacterBodySettings& settings) {
  LORICA_TRY(const Training training, usualTraining(*owner));
  DecomposeSettings decomposing;
  decomposing.threads = settings.threads;
  decomposing.progress = settings.progress;
  DecompositionFile content;
  if (settings.parts == 0) {
    LORICA_TRY(CachedDecomposition usual, defaultDecomposition(owner->character, training, decomposing, userCache()));
    content = std::move(usual.file);
  } else {
    decomposing.maxParts = settings.parts;
    LORICA_TRY(content, decomposed(*owner, training, decomposing));
  }
  if (!settings.cover.exact()) {
    LORICA_TRY(const CoverPoses poses, coverPoses(owner->character, training.motions));
    LORICA_TRY(content.cover, chooseCover(owner->character, content.decomposition, poses, settings.cover,
                                          settings.threads, settings.progress));
  }
  return bodyOf(std::move(owner), std::move(content));
}

Result<std::shared_ptr<const CharacterBody>> readCharacterBody(std::shared_ptr<const PlayableCharacter> owner,
                                                               const std::filesystem::path& file) {
  LORICA_TRY(DecompositionFile content, readDecomposition(file));
  const Character& character = owner->character;
  if (content.meshHash != topologyHash(character.mesh)) {
    return invalidArgument("{}: made from {} with {} vertices, expected a decomposition of {} with {}", file.string(),
                           content.source, content.decomposition.vertexCount, character.name,
                           character.mesh.vertices.size());
  }
  return bodyOf(std::move(owner), std::move(content));
}

Result<SkeletalMotion> performanceOf(const Character& character, const std::string& nameOrFile,
                                     const PerformanceSettings& settings) {
  LORICA_TRY(Motion motion, readMotionNamed(nameOrFile, settings.clip));
  JointSettings joints;
  joints.mirror = settings.mirror;
  return performedBy(character, motion, joints);
}

}  // namespace lorica
