#pragma once

#include "geometry/result.h"
#include "geometry/tri_mesh.h"
#include "skinning/body/closed_body.h"
#include "skinning/character.h"
#include "skinning/import/character_file.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// When a closed body takes the place of a surface.
enum class BodyChoice : std::uint8_t {
  kIfNeeded,  ///< if the surface is not closed and cannot be repaired
  kNever,  ///< not for a mesh, whose surface is left as it is; a character's body is made, to be refused or described
  kAlways  ///< even if it is closed
};

/// What a surface stands for where it is not closed.
enum class WallChoice : std::uint8_t {
  kByReach,  ///< the border of space that cannot be reached from outside, else a thin wall
  kSolid,    ///< the border of a solid, whatever its openings
  kShell     ///< a thin wall, also where it is closed
};

/// Of a WallChoice: "auto", "solid" or "shell"; nothing for another name.
[[nodiscard]] std::optional<WallChoice> wallChoiceNamed(std::string_view name);
/// "auto", "solid" or "shell".
[[nodiscard]] const char* nameOf(WallChoice walls);

/// Options for reading a character or a mesh.
struct CharacterOptions {
  std::string map;              ///< file that assigns humanoid bones to joints; empty = automatic
  double bodyResolution = 0.0;  ///< of the voxels if a closed surface has to be made [m; a mesh's unit]; 0 = automatic
  BodyChoice body = BodyChoice::kIfNeeded;    ///< whether a closed surface is made
  std::optional<WallChoice> walls = {};       ///< hollow things stay hollow; none: a mesh by reach, a character solid
  double thickness = 0.0;                     ///< of thin walls [m; a mesh's unit]; 0 = automatic
  bool drawn = false;                         ///< the character is drawn: decode the pictures of its materials
  int textureSize = 0;                        ///< largest side of those pictures [pixels]; 0 = as stored
  std::vector<std::string> expressions = {};  ///< see chosenExpressions()
  std::vector<std::string> hidden = {};       ///< names of meshes, see CharacterFileSettings
  std::optional<std::string> ownClip = {};    ///< name of the own clip that the character plays, see findClip()
  /// Whether the character can do what it is read for: called before its body is made, which takes up to seconds. Its
  /// error ends the reading. None = anything will do.
  std::function<Result<void>(const CharacterFile& file)> suits = {};
};

/// A closed body that was made for a mesh. Lengths are in the mesh's unit.
struct RebuiltMesh {
  std::string problem;                  ///< what was wrong with the mesh; empty if a body was asked for
  double resolution = 0.0;              ///< voxel edge; 0 if there are only walls and closed pieces
  BodyDistances distances;              ///< between body and mesh
  VertexIndex firstOriginal = 0;        ///< vertex v of the file is vertex firstOriginal + v of Subject::mesh
  std::size_t shells = 0;               ///< pieces that became thin walls
  std::size_t solids = 0;               ///< pieces that are closed
  double shellShare = 0.0;              ///< of the surface, which became walls
  double thickness = 0.0;               ///< of the walls
  std::vector<Triangle> original = {};  ///< of the file, over its vertices
};

/// Something that can be decomposed: a mesh, or a character whose bind pose is `mesh`. A mesh has the file's units and
/// coordinates; a character is in metres, Y up, facing +Z.
struct Subject {
  std::string name;                         ///< a file name without its folder, or "mannequin"
  TriMesh mesh;                             ///< closed; in the bind pose of a character [m; a mesh's unit]
  std::optional<Character> character;       ///< with a body that can be decomposed
  std::string repaired;                     ///< what was repaired to make the file's mesh closed; empty = nothing
  std::optional<CharacterFile> file;        ///< as read, if the subject comes from a character file
  std::optional<ClosedBody> body;           ///< the body of that character
  std::optional<RebuiltMesh> rebuilt = {};  ///< if `mesh` is a body made for a mesh that is no character
  /// Of a mesh that is no character: vertices of the file's surface that no triangle of `mesh` uses, ascending. The
  /// hulls must contain them too.
  std::vector<VertexIndex> held = {};

  /// The character's own clips; empty for a mesh.
  [[nodiscard]] std::vector<Clip> clips() const { return file ? file->clips : std::vector<Clip>(); }
};

}  // namespace lorica
