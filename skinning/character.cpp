#include "skinning/character.h"

#include "geometry/counts.h"
#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {

namespace {

constexpr double kWeightSumTolerance = 1e-3;

}  // namespace

Result<void> checkCharacter(const Character& character) {
  const std::size_t vertexCount = character.mesh.vertices.size();
  const int jointCount = character.skeleton.jointCount();

  // Counts first: the checks below use them as index bounds.
  if (jointCount < 1) return badMesh("the character has no joints, expected at least one");
  if (vertexCount < 1) return badMesh("the character has no vertices, expected at least one");
  if (countOf(character.jointFromModel) != jointCount) {
    return badMesh("{} inverse bind matrices for {} joints, expected one per joint", character.jointFromModel.size(),
                   jointCount);
  }
  if (character.influenceBegin.size() != vertexCount + 1) {
    return badMesh("{} entries in influenceBegin for {} vertices, expected {}", character.influenceBegin.size(),
                   vertexCount, vertexCount + 1);
  }
  if (character.influenceBegin.front() != 0 || character.influenceBegin.back() != character.influences.size()) {
    return badMesh("influenceBegin runs from {} to {}, expected 0 to {}", character.influenceBegin.front(),
                   character.influenceBegin.back(), character.influences.size());
  }

  for (std::size_t j = 0; j < character.jointFromModel.size(); ++j) {
    if (!character.jointFromModel[j].matrix().allFinite()) {
      return badMesh("joint {} '{}': its inverse bind matrix is not finite", j, character.skeleton.joint(j).name);
    }
  }
  for (std::size_t t = 0; t < character.mesh.triangles.size(); ++t) {
    for (const VertexIndex v : character.mesh.triangles[t]) {
      if (v < 0 || std::cmp_greater_equal(v, vertexCount)) {
        return badMesh("triangle {}: vertex {}, expected 0 to {}", t, v, vertexCount - 1);
      }
    }
  }
  for (std::size_t v = 0; v < vertexCount; ++v) {
    if (!character.mesh.vertices[v].allFinite()) return badMesh("vertex {}: its position is not finite", v);
    const std::uint32_t begin = character.influenceBegin[v];
    const std::uint32_t end = character.influenceBegin[v + 1];
    if (begin > end || end > character.influences.size()) {
      return badMesh("vertex {}: influences {} to {}, expected an ascending range within {}", v, begin, end,
                     character.influences.size());
    }
    double sum = 0.0;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Influence& influence = character.influences[i];
      if (influence.joint < 0 || influence.joint >= jointCount) {
        return badMesh("vertex {}: joint {}, expected 0 to {}", v, influence.joint, jointCount - 1);
      }
      if (!std::isfinite(influence.weight) || influence.weight < 0.0) {
        return badMesh("vertex {}: weight {} of joint {}, expected a finite number >= 0", v, influence.weight,
                       influence.joint);
      }
      sum += influence.weight;
    }
    if (std::abs(sum - 1.0) > kWeightSumTolerance) {
      return badMesh("vertex {}: weights sum to {}, expected 1 +- {}", v, sum, kWeightSumTolerance);
    }
  }
  if (!std::ranges::is_sorted(character.shapes.begin) || character.shapes.begin.size() > vertexCount + 1 ||
      (!character.shapes.begin.empty() && character.shapes.begin.back() > character.shapes.offsets.size())) {
    return badMesh("the offsets of its shapes do not belong to its {} vertices", vertexCount);
  }
  for (const ShapeOffset& shape : character.shapes.offsets) {
    if (shape.joint < 0 || shape.joint >= jointCount || character.skeleton.joint(shape.joint).parent == kNoJoint) {
      return badMesh("a shape has joint {}, expected one below another, at most {}", shape.joint, jointCount - 1);
    }
    if (!shape.offset.allFinite()) return badMesh("an offset of a shape is not finite");
  }
  return {};
}

}  // namespace lorica
