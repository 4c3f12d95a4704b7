#pragma once

#include "skinning/import/file_scene.h"

#include <optional>
#include <vector>

namespace lorica {

/// Transforms of nodes and skins in the bind pose, in the file's units and axes.
///
/// Skinning does not define the space of a skin's vertices: transforming the vertices by any matrix and the inverse
/// bind matrices by its inverse gives the same points. The space is chosen so that the bind pose stands like the
/// character: the topmost bone of a skin has its rest transform, and the skins of one skeleton agree on the bones that
/// they share.
///
/// A file that was saved in a pose has nodes that contradict the inverse bind matrices. Then each bone is where its
/// inverse bind matrix says, and nodes outside the skins follow their parents. No two bones need agree there, so the
/// space of a skin's vertices is that of the node with its mesh, unless other bones agree with the topmost one.
/// Matrices may have a scale or shear that their nodes lack, such as those of Second Life's collision volumes. Only
/// bones whose nodes leave the vertices the shape and the scale that most bones leave them say where a skin stands.
struct BindFrames {
  std::vector<int> order;             ///< all nodes, parents before children
  std::vector<Affine3> fileFromNode;  ///< one per node, invertible
  std::vector<Affine3> fileFromSkin;  ///< one per skin, invertible: from the space of its vertices
  std::vector<JointTransform> local;  ///< parentFromNode without `inner`: the node's own, unless posed
  /// The rotation before `local`: FileNode::inner, unless the bind pose has another shear. If the node has one, it has.
  std::vector<std::optional<Quat>> inner;
  /// Per node: the bones of its skin have one scale, but its matrix another, with which its node would make it more
  /// than twice as large. So the node says nothing about it.
  std::vector<char> scaledByMatrix;
  bool posed = false;  ///< the file was saved in another pose than the bind pose
  // By how much; of the nodes relative to their parents.
  int posedNodes = 0;      ///< that are turned by at least 1 degree or moved by 1 % of the skin's size
  int scaledNodes = 0;     ///< whose scale or shear is that of their inverse bind matrix and not their own
  double posedTurn = 0.0;  ///< the largest of their rotations [rad]
  double posedMove = 0.0;  ///< the largest of their translations [units of the file]
};

[[nodiscard]] BindFrames findBindFrames(const FileScene& scene);

/// Whether a transform can be inverted without losing most of its precision.
[[nodiscard]] bool isInvertible(const Affine3& transform);

}  // namespace lorica
