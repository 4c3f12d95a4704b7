#pragma once

#include "acd/decomposition_file.h"
#include "bindings/program_host.h"
#include "collision/live/body_plan.h"
#include "prepare/cover_choice.h"
#include "prepare/subject.h"
#include "skinning/clip.h"

#include <filesystem>
#include <memory>
#include <string>

namespace lorica {

/// A subject with a character.
using CharacterPointer = std::shared_ptr<const Subject>;

/// @param nameOrFile  "mannequin", or a .glb, .gltf, .vrm, .fbx or .dae file with a skin or clips
[[nodiscard]] Result<CharacterPointer> openCharacter(const std::string& nameOrFile, Host& host);

/// A decomposed character, ready to be moved. Immutable.
struct CharacterBody {
  CharacterPointer owner;
  DecompositionFile content;
  std::shared_ptr<const BodyPlan> plan;

  [[nodiscard]] const Character& character() const { return *owner->character; }
};

struct CharacterBodySettings {
  int parts = 0;       ///< at most; 0 = the body of `lorica play`, 16 parts, kept in the user's cache
  CoverRequest cover;  ///< not given = exact
};

/// Decomposes a character, trained on its own clips and on the shipped recordings: as `lorica decompose` does with a
/// number of parts, else as `lorica play` does.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(CharacterPointer owner,
                                                                             const CharacterBodySettings& settings,
                                                                             Host& host);

/// The body in a .lorica file that was made from this character.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> readCharacterBody(CharacterPointer owner,
                                                                             const std::filesystem::path& file);

struct Performance {
  SkeletalMotion motion;
  std::string firstGuess;  ///< what its file was taken to be; empty for one that has nothing to guess
};

/// A motion as the character performs it: of any file that `lorica play` knows, or a shipped recording by its name,
/// such as "walk", which is made again.
/// @param clip  of a character file with several; empty = the first
[[nodiscard]] Result<Performance> performanceOf(const Character& character, const std::string& nameOrFile,
                                                const std::string& clip, bool mirror, Host& host);

}  // namespace lorica
