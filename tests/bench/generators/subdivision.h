#pragma once

#include "geometry/math.h"

#include <Eigen/SparseCore>

#include <vector>

namespace lorica {

/// Faces of a closed polygon mesh: corners counter-clockwise from outside; every edge in two faces, once each way.
using PolygonFaces = std::vector<std::vector<int>>;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// One step of Catmull-Clark subdivision (Catmull and Clark 1978) as a linear map, so that positions and blend
/// weights are refined in the same way.
struct Refinement {
  PolygonFaces faces;           ///< all quads, grouped by coarse face, in the coarse faces' order
  SparseMatrix fineFromCoarse;  ///< fineCount x coarseCount, rows sum to 1; coarse vertices keep their indices
};
[[nodiscard]] Refinement refineCatmullClark(int vertexCount, const PolygonFaces& faces);

}  // namespace lorica
