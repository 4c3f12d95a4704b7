#include "skinning/linear_blend.h"

namespace lorica {

void computeWorldFromModel(const Character& character, std::span<const Affine3> worldFromJoint,
                           std::span<Affine3> worldFromModel) {
  const std::size_t jointCount = character.jointFromModel.size();
  LORICA_CHECK(worldFromJoint.size() == jointCount, "one transform per joint");
  LORICA_CHECK(worldFromModel.size() == jointCount, "worldFromModel must have one element per joint");
  for (std::size_t j = 0; j < jointCount; ++j) worldFromModel[j] = worldFromJoint[j] * character.jointFromModel[j];
}

void skinLinearBlend(const Character& character, std::span<const Affine3> worldFromModel, std::span<Vec3> posed) {
  const std::size_t vertexCount = character.mesh.vertices.size();
  LORICA_CHECK(worldFromModel.size() == character.jointFromModel.size(), "one transform per joint");
  LORICA_CHECK(posed.size() == vertexCount, "posed must have one element per vertex");

  for (std::size_t v = 0; v < vertexCount; ++v) {
    posed[v] = skinLinearBlend(character, worldFromModel, static_cast<VertexIndex>(v));
  }
}

Vec3 skinLinearBlend(const Character& character, std::span<const Affine3> worldFromModel, VertexIndex vertex) {
  const Vec3& bind = character.mesh.vertices[vertex];
  Vec3 sum = Vec3::Zero();
  for (std::uint32_t i = character.influenceBegin[vertex]; i < character.influenceBegin[vertex + 1]; ++i) {
    const Influence& influence = character.influences[i];
    sum += influence.weight * (worldFromModel[influence.joint] * bind);
  }
  for (const ShapeOffset& shape : character.shapes.of(vertex)) {
    const JointIndex bone = character.skeleton.joint(shape.joint).parent;
    sum += (worldFromModel[shape.joint].linear() - worldFromModel[bone].linear()) * shape.offset;
  }
  return sum;
}

}  // namespace lorica
