#include "viewer/player/parts_picture.h"

#include "collision/live/part_bones.h"
#include "viewer/renderer/skin_mesh.h"

#include <algorithm>
#include <memory>

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

constexpr double kSize = 1.8;    // of the longest diagonal in the picture's world [m]
constexpr double kLevel = 0.01;  // what is so near the lowest point stands on the floor [of the extent]
constexpr double kBroader = 3.0;

/// The area of the box around what would stand on the floor if an axis were up.
double baseOf(std::span<const NamedMesh> parts, const Aabb& box, int axis) {
  Aabb base;
  for (const NamedMesh& part : parts) {
    for (const Vec3& p : part.mesh.vertices) {
      if (p[axis] <= box.min[axis] + kLevel * (box.max[axis] - box.min[axis])) base.extend(p);
    }
  }
  const Vec3 size = base.max - base.min;
  return size[(axis + 1) % 3] * size[(axis + 2) % 3];
}

Aabb boxOf(std::span<const NamedMesh> parts) {
  Aabb box;
  for (const NamedMesh& part : parts) {
    for (const Vec3& p : part.mesh.vertices) box.extend(p);
  }
  return box;
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

UpAxis likelyUp(std::span<const NamedMesh> parts) {
  const Aabb box = boxOf(parts);
  return baseOf(parts, box, 2) > kBroader * baseOf(parts, box, 1) ? UpAxis::kZ : UpAxis::kY;
}

Image drawParts(std::span<const NamedMesh> parts, UpAxis up, SnapshotCamera& camera) {
  const Aabb box = boxOf(parts);
  const double scale = box.diagonal() > 0.0 ? kSize / box.diagonal() : 1.0;
  const Mat3 turned = up == UpAxis::kY ? Mat3(Mat3::Identity()) : Mat3{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  const Vec3 half = (turned * (box.max - box.min)).cwiseAbs() * 0.5 * scale;
  std::vector<Prop> props;
  for (const NamedMesh& part : parts) {
    const auto shape = std::make_shared<PropMeshShape>();
    shape->shown = part.mesh;
    for (Vec3& p : shape->shown.vertices) p = scale * (turned * (p - box.center())) + Vec3(0.0, half.y(), 0.0);
    Prop& prop = props.emplace_back();
    prop.shape = PropShape::kMesh;
    prop.halfExtents = half;  // of all parts
    prop.mesh = shape;
    prop.color = SkinMesh::colorOf(static_cast<PartIndex>(&part - parts.data()));
  }
  Scene scene;
  scene.props = props;
  Camera view;
  view.target = Vec3(0.0, half.y(), 0.0);
  view.eye = view.target + Vec3(1.6, 1.1, 2.6);
  return camera.draw(scene, {}, view);
}

}  // namespace lorica
