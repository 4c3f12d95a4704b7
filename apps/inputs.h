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

/// What the command line says of how to read a character.
struct CharacterOptions {
  std::string map;              ///< file that says which joint is which humanoid bone; empty = found by itself
  double bodyResolution = 0.0;  ///< of the voxels where a surface has to be made [m]; 0 = chosen
};

/// --map and --body-resolution.
void addCharacterOptions(CommandLine& app, CharacterOptions& options);

/// A thing that can be decomposed: a mesh, or a character whose bind pose is `mesh`.
struct Subject {
  std::string name;  ///< a file name without its folder, or "mannequin"
  TriMesh mesh;
  std::optional<Character> character;  ///< with a body that can be decomposed
  std::string mended;  ///< what had to be repaired to make the file's mesh a closed two-manifold; empty = nothing
  std::optional<CharacterFile> file;  ///< as read, where the subject is of a character file
  std::optional<Body> body;           ///< what was made of it

  /// The character's own clips; none of a mesh.
  [[nodiscard]] std::vector<Clip> clips() const { return file ? file->clips : std::vector<Clip>(); }
};

/// Reads INPUT of `decompose` and `info`: the name of a built-in character, a character file, or else a mesh file. A
/// mesh that is closed but for edges of more than two triangles is repaired, see repairClosedMesh; any other fault is
/// left for the check. Of a character file a body is made. What has neither skin nor clips is a mesh.
[[nodiscard]] Result<Subject> readSubject(const std::string& input, const CharacterOptions& options = {});

/// A character by its name or file, or a sentence that says what is expected.
[[nodiscard]] Result<Subject> readCharacter(const std::string& nameOrFile, const CharacterOptions& options = {});

}  // namespace lorica
