#pragma once

#include "skinning/import/file_scene.h"

#include <vector>

namespace lorica {

/// Where nodes and skins lie in the bind pose, in the file's units and axes.
///
/// Skinning leaves the space of a skin's vertices free: vertices moved by any matrix, inverse bind matrices by its
/// inverse, give the same points. It is chosen so that the bind pose stands as the character does: the topmost bone of
/// a skin lies where it does at rest, and the skins of one skeleton agree where they share a bone.
struct BindFrames {
  std::vector<int> order;             ///< all nodes, parents before children
  std::vector<Affine3> fileFromNode;  ///< one a node, invertible
  std::vector<Affine3> fileFromSkin;  ///< one a skin, invertible: from the space of its vertices
};

[[nodiscard]] BindFrames findBindFrames(const FileScene& scene);

/// Whether a transform can be undone without losing most of its digits.
[[nodiscard]] bool isInvertible(const Affine3& transform);

}  // namespace lorica
