#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "collision/live/body_plan.h"
#include "prepare/cover_choice.h"
#include "prepare/motion.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// A character whose surface is closed, and its own clips.
struct PlayableCharacter {
  Character character;
  std::vector<Clip> clips;
  std::vector<std::string> notes;  ///< what was repaired, guessed or skipped: one sentence each
};

/// @param nameOrFile  "mannequin", or a .glb, .gltf, .vrm, .fbx or .dae file with a skin or clips
[[nodiscard]] Result<std::shared_ptr<const PlayableCharacter>> readPlayable(const std::string& nameOrFile);

/// A decomposed character, ready to be moved. Immutable.
struct CharacterBody {
  std::shared_ptr<const PlayableCharacter> owner;
  DecompositionFile content;
  std::shared_ptr<const BodyPlan> plan;

  [[nodiscard]] const Character& character() const { return owner->character; }
};

struct CharacterBodySettings {
  int parts = 0;       ///< at most; 0 = the body of `lorica play`, 16 parts, kept in the user's cache
  CoverRequest cover;  ///< not given = exact
  int threads = 0;     ///< 0 = all of the machine's
  DecomposeProgress progress = {};
};

/// Decomposes a character, trained on its own clips and on the shipped recordings, as `lorica play` does.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(
    std::shared_ptr<const PlayableCharacter> owner, const CharacterBodySettings& settings);

/// The body in a .lorica file that was made from this character.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> readCharacterBody(
    std::shared_ptr<const PlayableCharacter> owner, const std::filesystem::path& file);

/// How a motion is read and performed.
struct PerformanceSettings {
  std::string clip;     ///< of a character file with several; empty = the first
  bool mirror = false;  ///< left and right are swapped
};

/// A motion as the character performs it: recorded joints, BVH or a clip of a character file, or a shipped recording by
/// its name, such as "walk".
[[nodiscard]] Result<SkeletalMotion> performanceOf(const Character& character, const std::string& nameOrFile,
                                                   const PerformanceSettings& settings);

}  // namespace lorica
