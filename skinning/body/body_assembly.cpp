#include "skinning/body/body_assembly.h"

#include "geometry/counts.h"

namespace lorica {

void appendVertex(Character& character, const Vec3& vertex, std::span<const Influence> influences) {
  character.mesh.vertices.push_back(vertex);
  character.influences.insert(character.influences.end(), influences.begin(), influences.end());
  character.influenceBegin.push_back(character.influences.size());
}

Character bonesOf(const Character& character) {
  Character bones;
  bones.name = character.name;
  bones.skeleton = character.skeleton;
  bones.jointFromModel = character.jointFromModel;
  bones.height = character.height;
  bones.influenceBegin = {0};
  return bones;
}

Character assembleBody(const Character& character, const TriMesh& surface,
                       std::span<const std::vector<Influence>> weights) {
  Character made = bonesOf(character);
  for (std::size_t v = 0; v < weights.size(); ++v) appendVertex(made, surface.vertices[v], weights[v]);
  made.mesh.triangles = surface.triangles;

  std::vector<VertexIndex> numberOf(character.mesh.vertices.size(), -1);
  const std::vector<bool> used = usedVertices(numberOf.size(), character.mesh.triangles);
  for (std::size_t v = 0; v < numberOf.size(); ++v) {
    if (!used[v]) continue;
    numberOf[v] = countOf(made.mesh.vertices);
    appendVertex(
        made, character.mesh.vertices[v],
        std::span(character.influences)
            .subspan(character.influenceBegin[v], character.influenceBegin[v + 1] - character.influenceBegin[v]));
  }
  made.shown.reserve(character.mesh.triangles.size());
  for (Triangle t : character.mesh.triangles) {
    for (VertexIndex& v : t) v = numberOf[v];
    made.shown.push_back(t);
  }
  return made;
}

}  // namespace lorica
