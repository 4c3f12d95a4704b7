#pragma once

#include "geometry/tri_mesh.h"
#include "skinning/skeleton.h"

#include <memory>
#include <string>
#include <vector>

namespace lorica {

struct Avatar;

/// A joint that moves a vertex.
struct Influence {
  JointIndex joint = 0;  ///< of the character's skeleton
  double weight = 0.0;   ///< above 0; those of a vertex sum to 1
};

/// A skinned character. `mesh` is the bind pose in model space; influences of vertex v are
/// influences[influenceBegin[v] .. influenceBegin[v + 1]) and their weights sum to 1.
struct Character {
  std::string name;                           ///< of the file, without its ending
  TriMesh mesh;                               ///< in the bind pose, model space [m]
  Skeleton skeleton;                          ///< parents precede children
  std::vector<Affine3> jointFromModel;        ///< inverse bind matrices, one per joint
  std::vector<Influence> influences;          ///< of all vertices, one after the other
  std::vector<std::uint32_t> influenceBegin;  ///< vertexCount + 1 entries
  double height = 0.0;                        ///< of the mesh in the bind pose [m]
  /// The visible triangles, over the same vertices; empty = those of `mesh`. Vertices that only these triangles use are
  /// skinned and covered by the hulls, but not decomposed.
  std::vector<Triangle> shown;
  /// How viewers draw it, see skinning/look/avatar.h; null = plain.
  std::shared_ptr<const Avatar> avatar;
};

/// Checks all that skinning relies on: counts agree, joints in range, weights finite, >= 0, summing to 1 +- 0.001.
[[nodiscard]] Result<void> checkCharacter(const Character& character);

}  // namespace lorica
