#include "viewer/player/parts_picture.h"

#include "collision/live/part_bones.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr PartIndex kBones =
    static_cast<PartIndex>(HumanBone::kRightHand) + 1;  // fingers have the colour of their hand

/// The bone at a joint or above it; of what has none the joint.
PartIndex colorOf(const Skeleton& skeleton, JointIndex joint) {
  for (JointIndex j = joint; j != kNoJoint; j = skeleton.joint(j).parent) {
    const auto bone = skeleton.joint(j).bone;
    if (bone && *bone <= HumanBone::kRightHand) return static_cast<PartIndex>(*bone);
  }
  return joint;
}

constexpr double kSize = 1.8;  // of the longest diagonal in the picture's world [m]

/// One mesh of all objects, moved onto the floor and scaled.
TriMesh joined(std::span<const NamedMesh> objects, std::vector<PartIndex>& partOfTriangle) {
  TriMesh all;
  Aabb box;
  for (const NamedMesh& object : objects) {
    const VertexIndex first = all.vertices.size();
    for (const Vec3& p : object.mesh.vertices) {
      all.vertices.push_back(p);
      box.extend(p);
    }
    for (const Triangle& t : object.mesh.triangles) {
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      partOfTriangle.push_back(&object - objects.data());
    }
  }
  const double scale = box.diagonal() > 0.0 ? kSize / box.diagonal() : 1.0;
  const Vec3 middle = 0.5 * (box.min + box.max);
  for (Vec3& p : all.vertices) p = scale * (p - Vec3(middle.x(), box.min.y(), middle.z()));
  return all;
}

}  // namespace

std::vector<PartIndex> colorsOfParts(const Decomposition& decomposition, const Character& character) {
  std::vector<PartIndex> colors;
  for (const std::vector<JointShare>& joints : jointsOfParts(decomposition, character)) {
    PartIndex color = joints.empty() ? 0 : colorOf(character.skeleton, joints.front().joint);
    while (std::find(colors.begin(), colors.end(), color) != colors.end()) color += kBones;  // another of the bone
    colors.push_back(color);
  }
  return colors;
}

Image drawParts(std::span<const NamedMesh> parts, SnapshotCamera& camera) {
  std::vector<PartIndex> partOfTriangle;
  const TriMesh mesh = joined(parts, partOfTriangle);
  Scene scene;
  scene.vertices = mesh.vertices;
  scene.triangles = mesh.triangles;
  scene.partOfTriangle = partOfTriangle;
  SceneOptions show;
  show.hulls = false;
  double top = 0.0;
  for (const Vec3& p : mesh.vertices) top = std::max(top, p.y());
  Camera view;
  view.target = Vec3(0.0, 0.5 * top, 0.0);
  view.eye = view.target + Vec3(1.6, 1.1, 2.6);
  return camera.draw(scene, show, view);
}

}  // namespace lorica
