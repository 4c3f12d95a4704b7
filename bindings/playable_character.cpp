#include "bindings/playable_character.h"

#include "bindings/file_reading.h"
#include "bindings/motion_files.h"
#include "collision/live/lifted_point.h"
#include "prepare/body_cache.h"
#include "prepare/decomposition_cache.h"
#include "prepare/training.h"
#include "prepare/used_hulls.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>

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
  const Result<Keyframes> keyframes = trainingKeyframes(character, training, std::nullopt);
  if (!keyframes) return keyframes.error();
  const PoseView poses{keyframes->positions, static_cast<int>(character.mesh.vertices.size())};
  Result<Decomposition> made = decompose(character.mesh, poses, settings);
  if (!made) return Error{made.error().code, character.name + ": " + made.error().message};
  const HullCover exact = coverExactly(*made, liftPoints(character, *made));
  const UsedHulls hulls =
      liveHulls(character, *made, exact, {keyframes->worldFromModel, character.skeleton.jointCount()});
  return fileContent(character.name, character.mesh, &character, &training, poses, std::move(*made), hulls);
}

Result<std::shared_ptr<const CharacterBody>> bodyOf(std::shared_ptr<const PlayableCharacter> owner,
                                                    DecompositionFile content) {
  Result<std::shared_ptr<const BodyPlan>> plan =
      BodyPlan::create(content.decomposition, owner->character, content.cover);
  if (!plan) return plan.error();
  return std::make_shared<const CharacterBody>(CharacterBody{std::move(owner), std::move(content), std::move(*plan)});
}

}  // namespace

Result<std::shared_ptr<const PlayableCharacter>> readPlayable(const std::string& nameOrFile) {
  if (nameOrFile == "mannequin") {
    return std::make_shared<const PlayableCharacter>(PlayableCharacter{makeMannequin(), {}, {}});
  }
  if (!isCharacterFile(nameOrFile)) {
    return Error{ErrorCode::kNotFound, fmt::format("{}: no character with that name, expected mannequin or a character "
                                                   "file (.glb, .gltf, .vrm, .fbx, .dae)",
                                                   nameOrFile)};
  }
  Result<CharacterFile> file = readCharacterFile(nameOrFile, fileReading());
  if (!file) return file.error();
  if (file->isMesh()) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: found a mesh without skin and clips, expected a character", nameOrFile)};
  }
  if (file->character.mesh.triangles.empty()) {
    return Error{ErrorCode::kBadMesh, nameOrFile + ": no triangles, expected a character with a surface"};
  }
  Result<ClosedBody> body = cachedBody(file->character, {}, userCache());
  if (!body) return Error{body.error().code, nameOrFile + ": " + body.error().message};
  PlayableCharacter playable{std::move(body->character), std::move(file->clips), std::move(file->notes)};
  playable.notes.insert(playable.notes.end(), body->notes.begin(), body->notes.end());
  return std::make_shared<const PlayableCharacter>(std::move(playable));
}

Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(std::shared_ptr<const PlayableCharacter> owner,
                                                               const CharacterBodySettings& settings) {
  const Result<Training> training = usualTraining(*owner);
  if (!training) return training.error();
  DecomposeSettings decomposing;
  decomposing.threads = settings.threads;
  decomposing.progress = settings.progress;
  DecompositionFile content;
  if (settings.parts == 0) {
    Result<CachedDecomposition> usual = defaultDecomposition(owner->character, *training, decomposing, userCache());
    if (!usual) return usual.error();
    content = std::move(usual->file);
  } else {
    decomposing.maxParts = settings.parts;
    Result<DecompositionFile> made = decomposed(*owner, *training, decomposing);
    if (!made) return made.error();
    content = std::move(*made);
  }
  if (!settings.cover.exact()) {
    const Result<CoverPoses> poses = coverPoses(owner->character, training->motions);
    if (!poses) return poses.error();
    Result<HullCover> cover = chooseCover(owner->character, content.decomposition, *poses, settings.cover,
                                          settings.threads, settings.progress);
    if (!cover) return cover.error();
    content.cover = std::move(*cover);
  }
  return bodyOf(std::move(owner), std::move(content));
}

Result<std::shared_ptr<const CharacterBody>> readCharacterBody(std::shared_ptr<const PlayableCharacter> owner,
                                                               const std::filesystem::path& file) {
  Result<DecompositionFile> content = readDecomposition(file);
  if (!content) return content.error();
  const Character& character = owner->character;
  if (content->meshHash != topologyHash(character.mesh)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: made from {} with {} vertices, expected a decomposition of {} with {}", file.string(),
                             content->source, content->decomposition.vertexCount, character.name,
                             character.mesh.vertices.size())};
  }
  return bodyOf(std::move(owner), std::move(*content));
}

Result<SkeletalMotion> performanceOf(const Character& character, const std::string& nameOrFile,
                                     const PerformanceSettings& settings) {
  Result<Motion> motion = readMotionNamed(nameOrFile, settings.clip);
  if (!motion) return motion.error();
  JointSettings joints;
  joints.mirror = settings.mirror;
  return performedBy(character, *motion, joints);
}

}  // namespace lorica
