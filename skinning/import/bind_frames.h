#pragma once

#include "skinning/import/file_scene.h"

#include <vector>

namespace lorica {

/// Transforms of nodes and skins in the bind pose, in the file's units and axes.
///
/// Skinning does not define the space of a skin's vertices: transforming the vertices by any matrix and the inverse
/// bind matrices by its inverse gives the same points. The space is chosen so that the bind pose stands like the
/// character: the topmost bone of a skin has its rest transform, and the skins of one skeleton agree on the bones that
/// they share.
struct BindFrames {
  std::vector<int> order;             ///< all nodes, parents before children
  std::vector<Affine3> fileFromNode;  ///< one per node, invertible
  std::vector<Affine3> fileFromSkin;  ///< one per skin, invertible: from the space of its vertices
};

[[nodiscard]] BindFrames findBindFrames(const FileScene& scene);

/// Whether a transform can be inverted without losing most of its precision.
[[nodiscard]] bool isInvertible(const Affine3& transform);

}  // namespace lorica
