#pragma once

#include "geometry/tri_mesh.h"
#include "skinning/skeleton.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct Avatar;

/// A joint that moves a vertex.
struct Influence {
  JointIndex joint = 0;  ///< of the character's skeleton
  double weight = 0.0;   ///< above 0; those of a vertex sum to 1
};

/// What a joint's scale adds to a vertex, see Shapes.
struct ShapeOffset {
  JointIndex joint = 0;        ///< has a parent
  Vec3 offset{0.0, 0.0, 0.0};  ///< [m], model space
};

/// How a mesh deforms before its bones move it: by morph targets, or from frame to frame of a sequence.
///
/// A weight is the scale of a joint of its own. That joint hangs at the bone that moves the vertex, with the bone's
/// inverse bind matrix and a rest pose of identity; at a scale of s it moves the vertex by (s - 1) x offset, turned and
/// scaled as the bone. So a pose holds all weights, a clip is a clip of joints, and a vertex is a linear function of
/// the joints' matrices, as in linear blend skinning: (worldFromModel of the joint - that of its parent) x offset.
struct Shapes {
  std::vector<ShapeOffset> offsets;  ///< of all vertices, one after the other
  /// Those of vertex v are offsets[begin[v] .. begin[v + 1]); vertices beyond have none. Empty = nothing deforms.
  std::vector<std::uint32_t> begin;

  [[nodiscard]] bool empty() const { return offsets.empty(); }  ///< whether nothing deforms
  /// Of a vertex, in any order.
  [[nodiscard]] std::span<const ShapeOffset> of(std::size_t vertex) const {
    if (vertex + 1 >= begin.size()) return {};
    return std::span(offsets).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
  }
  /// Appends the next vertex's, for vertices 0, 1, 2 ... in turn.
  void append(std::span<const ShapeOffset> ofVertex) {
    if (begin.empty()) begin.push_back(0);
    offsets.insert(offsets.end(), ofVertex.begin(), ofVertex.end());
    begin.push_back(static_cast<std::uint32_t>(offsets.size()));
  }
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
  Shapes shapes;                              ///< how its mesh deforms; most do not
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
