#pragma once

#include "geometry/tri_mesh.h"
#include "skinning/import/bind_frames.h"
#include "skinning/import/file_scene.h"

#include <span>
#include <string>
#include <vector>

// Steps from a file's content to a character.

namespace lorica {

/// The material of colliders in files that `lorica export` wrote.
inline constexpr const char* kColliderMaterial = "lorica_collider";

/// The meshes of a file and their nodes, each pair once: the first 1,000.
[[nodiscard]] std::vector<MeshName> meshNamesOf(const FileScene& scene);

/// Takes meshes out of a scene, see CharacterFileSettings::hidden, and colliders of `lorica export`, which are no part
/// of a character.
/// @param fileName  for messages
/// @return the meshes; or an error if a name is unknown, which lists the known ones, or if no mesh is left
[[nodiscard]] Result<std::vector<FileMesh>> takeHiddenMeshes(FileScene& scene, std::span<const std::string> hidden,
                                                             const std::string& fileName);

/// Gives the bones of a skin that an FBX or COLLADA file lists side by side, without a hierarchy, the parents that
/// their names mean, as files of tools for Second Life need. Each stays where it is. Adds a note.
void hangFlatBones(FileScene& scene);

/// Whether a file's own list of bones is not a humanoid's: hips, spine, head, arms or legs are not all in it. Then
/// names tell the others. An animation may list any.
[[nodiscard]] bool lacksBones(const FileScene& scene);

/// Gives a humanoid of rigid meshes a skin of its bones, which moves nothing: each mesh follows its node. For a file
/// without skins and clips whose humanoid bones are listed, or known by their names. Adds a note.
void addRigidSkin(FileScene& scene);

/// The morph targets in metres and Lorica's axes, over the vertices of all meshes in their order. Vertices that move
/// less than 0.1 micrometres and turn less than 1e-5 are left out.
/// @param modelFromFile  the bind pose's units and axes
[[nodiscard]] Morphs makeMorphs(const FileScene& scene, const BindFrames& frames, const Affine3& modelFromFile);

/// The scene's gaze with joints; none if nothing of the character could follow it.
/// @param jointOfNode  for each node its joint, or kNoJoint
[[nodiscard]] LookAt makeLookAt(const FileScene& scene, const Skeleton& skeleton,
                                std::span<const JointIndex> jointOfNode);

enum class ContraryNormals { kNone, kNormalsReplaced, kTrianglesTurned };

/// Repairs a smooth surface on which more than a tenth of the area faces away from all its normals, which would be
/// drawn with dark stripes. Where neighbouring triangles agree about the outside, the normals are replaced by the mean
/// of the triangles around each position, weighted by area, but for edges of more than 60 degrees. Where they do not,
/// the triangles are turned to agree with the normals, if that leaves fewer edges at which neighbours disagree.
/// @param triangles  of one surface, over all vertices
/// @param normals    one per vertex; those of other vertices are not changed
ContraryNormals mendContraryNormals(std::span<const Vec3> vertices, std::span<Triangle> triangles,
                                    std::span<Vec3f> normals);

}  // namespace lorica
