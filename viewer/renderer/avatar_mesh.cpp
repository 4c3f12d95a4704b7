#include "viewer/renderer/avatar_mesh.h"

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

/// The heaviest influences of a vertex, their weights summing to 1.
void setInfluences(std::span<const Influence> all, AvatarVertex& vertex) {
  std::vector<Influence> heaviest(all.begin(), all.end());
  std::stable_sort(heaviest.begin(), heaviest.end(),
                   [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  heaviest.resize(std::min<std::size_t>(heaviest.size(), kAvatarInfluences));
  double sum = 0.0;
  for (const Influence& influence : heaviest) sum += influence.weight;
  vertex.joints.fill(0);
  vertex.weights.fill(0.0f);
  for (std::size_t i = 0; i < heaviest.size(); ++i) {
    vertex.joints[i] = heaviest[i].joint;
    vertex.weights[i] = heaviest[i].weight / sum;
  }
}

}  // namespace

AvatarMesh makeAvatarMesh(const Avatar& avatar) {
  const Character& character = avatar.character;
  const Look& look = avatar.look;
  const std::size_t count = character.mesh.vertices.size();
  AvatarMesh mesh;
  mesh.shapes.resize(count);
  mesh.vertices.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    mesh.shapes[v] = {character.mesh.vertices[v].cast<float>(),
                      look.normals.empty() ? Vec3f(Vec3f::Zero()) : look.normals[v]};
    AvatarVertex& vertex = mesh.vertices[v];
    vertex.tangent = look.tangents.empty() ? Eigen::Vector4f(Eigen::Vector4f::Zero()) : look.tangents[v];
    vertex.uv.setZero();
    if (!look.uv[0].empty()) vertex.uv.head<2>() = look.uv[0][v];
    if (!look.uv[1].empty()) vertex.uv.tail<2>() = look.uv[1][v];
    vertex.color = look.colors.empty() ? Eigen::Vector4f(Eigen::Vector4f::Ones()) : look.colors[v];
    const std::uint32_t begin = character.influenceBegin[v];
    const std::uint32_t end = character.influenceBegin[v + 1];
    setInfluences(std::span(character.influences).subspan(begin, end - begin), vertex);
    mesh.fewInfluences = mesh.fewInfluences && vertex.weights[4] == 0.0f;
  }
  mesh.indices.reserve(3 * character.mesh.triangles.size());
  for (const Triangle& triangle : character.mesh.triangles) {
    for (const VertexIndex v : triangle) mesh.indices.push_back(v);
  }
  return mesh;
}

void fillJointRows(std::span<const Affine3> worldFromModel, std::vector<Eigen::Vector4f>& rows) {
  rows.resize(3 * worldFromModel.size());
  for (std::size_t j = 0; j < worldFromModel.size(); ++j) {
    for (Eigen::Index row = 0; row < 3; ++row) {
      rows[3 * j + row] = worldFromModel[j].matrix().row(row).cast<float>().transpose();
    }
  }
}

void poseAvatar(std::span<const AvatarShape> shapes, std::span<const AvatarVertex> vertices,
                std::span<const Eigen::Vector4f> jointRows, std::span<AvatarPosed> posed) {
  using Row = Eigen::Vector4f;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const AvatarVertex& vertex = vertices[v];
    const Row* joint = jointRows.data() + 3 * vertex.joints[0];
    Row x = vertex.weights[0] * joint[0], y = vertex.weights[0] * joint[1], z = vertex.weights[0] * joint[2];
    for (std::size_t i = 1; i < kAvatarInfluences && vertex.weights[i] > 0.0f; ++i) {  // heaviest first
      joint = jointRows.data() + 3 * vertex.joints[i];
      x += vertex.weights[i] * joint[0];
      y += vertex.weights[i] * joint[1];
      z += vertex.weights[i] * joint[2];
    }
    const Row position = shapes[v].position.homogeneous();
    Row normal = Row::Zero();
    normal.head<3>() = shapes[v].normal;
    Row tangent = vertex.tangent;
    tangent.w() = 0.0f;
    AvatarPosed& out = posed[v];
    out.position = {x.dot(position), y.dot(position), z.dot(position)};
    out.normal = {x.dot(normal), y.dot(normal), z.dot(normal)};
    out.normal /= std::sqrt(std::max(out.normal.squaredNorm(), 1e-20f));
    out.tangent = {x.dot(tangent), y.dot(tangent), z.dot(tangent), vertex.tangent.w()};
  }
}

}  // namespace lorica
