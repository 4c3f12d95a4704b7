#pragma once

#include "apps/command_line.h"
#include "apps/motions.h"
#include "geometry/result.h"
#include "geometry/tri_mesh.h"
#include "skinning/body/closed_body.h"
#include "skinning/character.h"
#include "skinning/import/character_file.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Options for reading a character.
struct CharacterOptions {
  std::string map;              ///< file that assigns humanoid bones to joints; empty = automatic
  double bodyResolution = 0.0;  ///< of the voxels if a closed surface has to be made [m]; 0 = automatic
  bool drawn = false;           ///< the character is drawn: decode the pictures of its materials
  int textureSize = 0;          ///< largest side of those pictures [pixels]; 0 = as stored
  std::vector<std::string> expressions = {};  ///< see chosenExpressions()
  std::optional<std::string> ownClip = {};    ///< name of the own clip that the character plays, see findClip()
};

/// --map, --body-resolution and --expression.
void addCharacterOptions(CommandLine& app, CharacterOptions& options);
/// --texture-size, for commands that draw.
void addTextureOption(CommandLine& app, int& textureSize);

/// Something that can be decomposed: a mesh, or a character whose bind pose is `mesh`.
struct Subject {
  std::string name;  ///< a file name without its folder, or "mannequin"
  TriMesh mesh;
  std::optional<Character> character;  ///< with a body that can be decomposed
  std::string repaired;                ///< repairs that made the file's mesh a closed two-manifold; empty = none
  std::optional<CharacterFile> file;   ///< as read, if the subject comes from a character file
  std::optional<ClosedBody> body;      ///< the body of that character

  /// The character's own clips; empty for a mesh.
  [[nodiscard]] std::vector<Clip> clips() const { return file ? file->clips : std::vector<Clip>(); }
};

/// Reads INPUT of `decompose` and `info`: the name of a built-in character, a character file, or else a mesh file. A
/// mesh whose only fault is edges with more than two triangles is repaired, see repairClosedMesh; other faults are left
/// for the check. A body is made for a character file. A file with neither skin nor clips is a mesh.
[[nodiscard]] Result<Subject> readSubject(const std::string& input, const CharacterOptions& options = {});

/// A character by its name or file, or an error that says what is expected.
[[nodiscard]] Result<Subject> readCharacter(const std::string& nameOrFile, const CharacterOptions& options = {});

}  // namespace lorica
