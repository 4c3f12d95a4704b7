#pragma once

#include "geometry/named_file.h"
#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/clip.h"
#include "skinning/look/look.h"
#include "skinning/morphs/expressions.h"
#include "skinning/morphs/look_at.h"
#include "skinning/morphs/morphs.h"
#include "skinning/springs/spring_bones.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A process of its own that reads FBX and COLLADA files, whose reader (assimp) can be made to crash, to hang and to
/// take all memory. It gets the file's bytes, has limits of time, memory and stack (docs/SECURITY.md), and its result
/// is checked before it is used. What happens in there is one error here. It leaves no process and no file behind.
struct IsolatedReader {
  std::filesystem::path program;       ///< calls serveIsolatedReader() when it is run with these arguments
  std::vector<std::string> arguments;  ///< without the program
  std::function<bool()> cancelled{};   ///< asked about every 20 ms; true ends the process, the error is kCancelled
};

/// What of a file is read.
struct CharacterFileSettings {
  /// Meshes that are left out, such as weapons: names of meshes or of the nodes that carry them; case is ignored.
  std::vector<std::string> hidden = {};
  PathTrust paths = PathTrust::kBeneath;                  ///< which files a character file may name
  std::optional<IsolatedReader> isolated = std::nullopt;  ///< reads FBX and COLLADA; none: this process, unbounded
};

/// A mesh and the node that carries it, which often has the better name: "1H_Axe" and "Cube.001".
struct MeshName {
  std::string node;  ///< that carries the mesh
  std::string mesh;  ///< may be empty

  /// "1H_Axe (Cube.001)", or the one name if both are equal.
  [[nodiscard]] std::string text() const { return mesh.empty() || mesh == node ? node : node + " (" + mesh + ")"; }
};

/// The content of a character file, in Lorica's units and axes: metres, Y up, facing +Z.
///
/// The skeleton has a joint for each node that moves something: bones, their ancestors, and nodes with a rigid mesh.
/// Its first joint converts the file's units and axes to Lorica's, so that the joints below it keep the file's numbers.
/// A mesh without a skin follows its node's joint alone.
struct CharacterFile {
  /// Every triangle of the file, as drawn, in the bind pose. The surface may be open, torn and consist of many shells:
  /// makeBody() turns it into one that can be decomposed. No vertices if the file has only motion.
  Character character;
  /// For each joint its node's index in a glTF file; -1 for the first joint and for those added to nodes that are
  /// sheared or have several bind matrices. Of other formats the indices only tell which joints were added.
  std::vector<int> nodeOfJoint;
  std::vector<Clip> clips;  ///< in the order of the file
  Morphs morphs;            ///< of `character.mesh`; its clips are those above
  Expressions expressions;  ///< of the morph targets
  LookAt lookAt;            ///< how its eyes move
  SpringBones springs;      ///< of VRM; empty if the file has none. Its joints are among the character's
  Look look;                ///< of `character.mesh`, as its maker drew it; not given if the file has no materials

  std::string format;               ///< "glTF 2.0", "VRM 0.x", "VRM 1.0", "VRM animation 1.0", "FBX", "COLLADA"
  int meshes = 0;                   ///< of the file
  std::vector<MeshName> meshNames;  ///< of those that are not hidden; at most 1,000
  int primitives = 0;               ///< of all meshes, of which the mesh consists
  int skins = 0;                    ///< in the file
  int morphTargets = 0;             ///< in the file
  int maxInfluences = 0;            ///< of any vertex
  int repairedVertices = 0;        ///< with weights that did not sum to 1, were negative or not finite, or had no joint
  double metresPerUnit = 1.0;      ///< factor by which the file's lengths were multiplied
  std::vector<std::string> notes;  ///< what was repaired, guessed or skipped: one sentence each

  /// Whether it is a mesh and no character: nothing moves it.
  [[nodiscard]] bool isMesh() const { return skins == 0 && clips.empty(); }
};

/// Reads a character from glTF 2.0 (.gltf, .glb), VRM 0.x and 1.0, FBX or COLLADA (.dae), detected from the content.
///
/// Humanoid bones come from VRM's own list, and what that lacks of a humanoid from guessHumanoid(). Reading glTF or VRM
/// needs at most 250 bytes of memory per byte of the file, or 130 MB if that is more, whatever the file's content.
/// @return the content; or an error with file, element, what was found and what was expected; kInvalidArgument if a
/// mesh to hide is unknown, or none is left
[[nodiscard]] Result<CharacterFile> readCharacterFile(const std::filesystem::path& file,
                                                      const CharacterFileSettings& settings = {});

/// The same from bytes; a glTF that refers to other files is rejected.
/// @param name  of the file, for messages and the character's name
[[nodiscard]] Result<CharacterFile> parseCharacterFile(std::span<const std::byte> bytes, const std::string& name,
                                                       const CharacterFileSettings& settings = {});

/// Whether a file has the extension of a character: .gltf, .glb, .vrm, .vrma, .fbx, .dae; case is ignored.
[[nodiscard]] bool isCharacterFile(const std::filesystem::path& file);

/// The other side of IsolatedReader: reads one file from standard input and writes the result to standard output, both
/// as IsolatedReader's process gets them. @return the exit status of the process
[[nodiscard]] int serveIsolatedReader();

}  // namespace lorica
