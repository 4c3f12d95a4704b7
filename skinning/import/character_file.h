#pragma once

#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// What a character file holds, in Lorica's units and axes: metres, Y up, facing +Z.
///
/// The skeleton has a joint for each node that moves something: bones, the nodes above them, nodes that carry a rigid
/// mesh. Its first joint turns the file's units and axes into Lorica's, so the file's numbers stand below it as they
/// are. A mesh without a skin hangs on its node's joint alone.
struct CharacterFile {
  /// Every triangle of the file, as drawn, in the bind pose. It may be open, torn and of many shells: makeBody() makes
  /// of it what can be decomposed. No vertices where the file has only motion.
  Character character;
  std::vector<Clip> clips;

  std::string format;  ///< "glTF 2.0", "VRM 0.x", "VRM 1.0", "FBX", "COLLADA"
  int meshes = 0;
  int primitives = 0;
  int skins = 0;
  int morphTargets = 0;
  int mostInfluences = 0;          ///< of one vertex
  int mendedVertices = 0;          ///< whose weights did not sum to 1, were negative or not finite, or named no joint
  double metresPerUnit = 1.0;      ///< that the file's lengths were multiplied by
  std::vector<std::string> notes;  ///< what was mended, guessed or left out: one sentence each
};

/// Reads a character by what is in the file: glTF 2.0 (.gltf, .glb), VRM 0.x and 1.0, FBX, COLLADA (.dae).
///
/// Humanoid bones come from VRM's own list, else from guessHumanoid(). Reading glTF or VRM takes at most 250 bytes of
/// memory for each byte of the file, or 130 MB where that is more, whatever the file says.
/// @return what it holds; or a sentence with file, element, found and expected
[[nodiscard]] Result<CharacterFile> readCharacterFile(const std::filesystem::path& file);

/// The same from bytes; a glTF that draws in other files is refused.
/// @param name  of the file, for sentences and the character
[[nodiscard]] Result<CharacterFile> parseCharacterFile(std::span<const std::byte> bytes, const std::string& name);

/// Whether a file's name ends like one of a character: .gltf, .glb, .vrm, .fbx, .dae; in capitals too.
[[nodiscard]] bool isCharacterFile(const std::filesystem::path& file);

}  // namespace lorica
