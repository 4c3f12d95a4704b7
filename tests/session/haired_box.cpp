#include "tests/session/haired_box.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <string>

namespace lorica::test {

namespace {

constexpr double kTop = 1.4, kLink = 0.2;

/// A closed box of several storeys.
TriMesh tower(const Vec3& min, const Vec3& max, int storeys) {
  TriMesh mesh;
  for (int level = 0; level <= storeys; ++level) {
    const double y = min.y() + (max.y() - min.y()) * level / storeys;
    for (const auto& [x, z] : {std::pair(min.x(), min.z()), std::pair(min.x(), max.z()), std::pair(max.x(), max.z()),
                               std::pair(max.x(), min.z())}) {
      mesh.vertices.emplace_back(x, y, z);
    }
  }
  const auto add = [&](VertexIndex a, VertexIndex b, VertexIndex c) { mesh.triangles.push_back({a, b, c}); };
  for (VertexIndex level = 0; level < storeys; ++level) {
    for (VertexIndex side = 0; side < 4; ++side) {
      const VertexIndex a = 4 * level + side;
      const VertexIndex b = 4 * level + (side + 1) % 4;
      add(a, b, b + 4);
      add(a, b + 4, a + 4);
    }
  }
  const VertexIndex top = 4 * storeys;
  add(0, 3, 2);
  add(0, 2, 1);
  add(top, top + 1, top + 2);
  add(top, top + 2, top + 3);
  return mesh;
}

TriMesh body() {
  return tower(Vec3(-0.2, 0.5, -0.2), Vec3(0.2, 1.5, 0.2), 1);
}

TriMesh hair() {
  return tower(Vec3(0.24, kTop - 3.0 * kLink, -0.01), Vec3(0.26, kTop, 0.01), 6);
}

}  // namespace

Character hairedBox() {
  Character character;
  character.name = "haired box";
  character.mesh = body();
  const auto firstOfHair = static_cast<VertexIndex>(character.mesh.vertices.size());
  const TriMesh strand = hair();
  character.mesh.vertices.insert(character.mesh.vertices.end(), strand.vertices.begin(), strand.vertices.end());
  for (Triangle t : strand.triangles) {
    for (VertexIndex& v : t) v += firstOfHair;
    character.mesh.triangles.push_back(t);
  }
  std::vector<Joint> joints(4);
  joints[0].name = "body";
  for (int j = 1; j < 4; ++j) {
    joints[j].name = "hair " + std::to_string(j);
    joints[j].parent = j - 1;
    joints[j].rest.translation = j == 1 ? Vec3(0.25, kTop, 0.0) : Vec3(0.0, -kLink, 0.0);
  }
  character.skeleton = Skeleton::create(joints).value();
  std::vector<Affine3> worldFromJoint(4);
  computeWorldFromJoint(character.skeleton, restPose(character.skeleton), worldFromJoint);
  for (const Affine3& world : worldFromJoint) character.jointFromModel.push_back(world.inverse());
  character.influenceBegin.push_back(0);
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    const double below = kTop - character.mesh.vertices[v].y();
    const int link = std::clamp(1 + static_cast<int>(below / kLink - 1e-9), 1, 3);
    character.influences.push_back({static_cast<VertexIndex>(v) < firstOfHair ? 0 : link, 1.0});
    character.influenceBegin.push_back(static_cast<std::uint32_t>(v) + 1);
  }
  character.height = 1.0;
  return character;
}

Decomposition hairedBoxParts() {
  const Character character = hairedBox();
  Decomposition parts;
  parts.vertexCount = static_cast<int>(character.mesh.vertices.size());
  parts.triangleCount = static_cast<int>(character.mesh.triangles.size());
  parts.splitFrom = {0};
  parts.parts.resize(2);
  const auto bodyVertices = static_cast<VertexIndex>(body().vertices.size());
  for (std::size_t t = 0; t < character.mesh.triangles.size(); ++t) {
    Part& part = parts.parts[character.mesh.triangles[t][0] < bodyVertices ? 0 : 1];
    part.triangles.push_back(character.mesh.triangles[t]);
    part.sourceTriangle.push_back(static_cast<std::int32_t>(t));
  }
  for (VertexIndex v = 0; v < parts.vertexCount; ++v) parts.parts[v < bodyVertices ? 0 : 1].points.push_back(v);
  return parts;
}

SpringBones hairedBoxSprings(const SpringJoint& like) {
  SpringBones springs;
  SpringChain& chain = springs.chains.emplace_back();
  for (int j = 1; j < 4; ++j) {
    SpringJoint joint = like;
    joint.joint = j;
    joint.tail = Vec3(0.0, -kLink, 0.0);
    chain.joints.push_back(joint);
  }
  return springs;
}

SkeletalMotion hairedBoxMotion(int frames, const std::function<JointTransform(double)>& place) {
  const Skeleton skeleton = hairedBox().skeleton;
  SkeletalMotion motion{"sway", skeleton, {}, {}};
  for (int frame = 0; frame < frames; ++frame) {
    motion.times.push_back(frame / 60.0);
    Pose pose = restPose(skeleton);
    pose[0] = place(motion.times.back());
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  return motion;
}

}  // namespace lorica::test
