#pragma once

#include "bindings/live_character.h"
#include "bindings/program_host.h"
#include "session/prepare/subject.h"
#include "skinning/clip.h"

#include <memory>
#include <string>

namespace lorica {

/// @param nameOrFile  "mannequin", or a .glb, .gltf, .vrm, .fbx or .dae file with a skin or clips
[[nodiscard]] Result<CharacterPointer> openCharacter(const std::string& nameOrFile, const CharacterOptions& reading,
                                                     Host& host);

/// Decomposes a character, trained on its own clips and on the shipped recordings: as `lorica decompose` does with a
/// number of parts, else as `lorica play` does.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(CharacterPointer owner,
                                                                             const CharacterBodySettings& settings,
                                                                             Host& host);

struct Performance {
  SkeletalMotion motion;
  std::string firstGuess;  ///< what its file was taken to be; empty for one that has nothing to guess
};

/// A motion as the character performs it: of any file that `lorica play` knows, or a shipped recording by its name,
/// such as "walk", which is made again.
/// @param clip  of a character file with several; empty = the first
[[nodiscard]] Result<Performance> performanceOf(const Character& character, const std::string& nameOrFile,
                                                const std::string& clip, bool mirror, Host& host);

/// What the file of a character was taken to be, in words; empty if it has none.
[[nodiscard]] std::string guessAbout(const Subject& character);

}  // namespace lorica
