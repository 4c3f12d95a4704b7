#include "skinning/mannequin/mannequin.h"

#include "geometry/byte_reader.h"
#include "geometry/counts.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace lorica {

std::span<const std::uint8_t> mannequinFile();  // mannequin.bin, see CMakeLists.txt

Character makeMannequin() {
  Character character;
  character.name = "mannequin";
  character.skeleton = makeMannequinSkeleton();
  for (const Joint& joint : character.skeleton.joints()) {
    character.jointFromModel.emplace_back(Eigen::Translation3d(-mannequinJoint(*joint.bone)));
  }

  // The left half of the surface, x >= 0: counts of vertices and triangles; for each vertex its position, the number of
  // its bones, each bone and its weight; for each triangle its vertices.
  const std::span<const std::uint8_t> bytes = mannequinFile();
  ByteReader table(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const std::size_t halfCount = table.take<std::uint32_t>();
  const std::size_t halfTriangles = table.take<std::uint32_t>();
  std::vector<Vec3>& vertices = character.mesh.vertices;
  std::vector<Influence>& influences = character.influences;
  character.influenceBegin.assign(1, 0);
  for (std::size_t v = 0; v < halfCount; ++v) {
    vertices.push_back(Vec3{table.take<double>(), table.take<double>(), table.take<double>()});
    for (int left = table.take<std::uint8_t>(); left > 0; --left) {
      const auto bone = static_cast<HumanBone>(table.take<std::uint8_t>());
      influences.push_back({character.skeleton.jointOf(bone), table.take<double>()});
    }
    character.influenceBegin.push_back(influences.size());
  }
  std::vector<Triangle>& triangles = character.mesh.triangles;
  for (std::size_t t = 0; t < halfTriangles; ++t) {
    triangles.push_back({table.take<std::uint16_t>(), table.take<std::uint16_t>(), table.take<std::uint16_t>()});
  }

  // Its mirror image, joined in the plane x = 0.
  std::vector<VertexIndex> twin(halfCount);
  for (std::size_t v = 0; v < halfCount; ++v) {
    const Vec3 p = vertices[v];
    twin[v] = v;
    if (p.x() == 0.0) continue;
    twin[v] = countOf(vertices);
    vertices.emplace_back(-p.x(), p.y(), p.z());
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      const Influence one = influences[i];
      const HumanBone bone = mirrored(*character.skeleton.joint(one.joint).bone);
      influences.push_back({character.skeleton.jointOf(bone), one.weight});
    }
    character.influenceBegin.push_back(influences.size());
  }
  for (std::size_t t = 0; t < halfTriangles; ++t) {
    const Triangle left = triangles[t];
    triangles.push_back({twin[left[0]], twin[left[2]], twin[left[1]]});
  }
  character.height = boundsOf(vertices).max.y();  // the feet are on the floor

  const Result<void> checked = checkCharacter(character);
  LORICA_CHECK(checked.ok(), "the mannequin is a valid character");
  return character;
}

}  // namespace lorica
