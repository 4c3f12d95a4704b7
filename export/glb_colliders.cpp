#include "export/glb_colliders.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "skinning/import/character_parts.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kOmiBody = "OMI_physics_body";
constexpr const char* kOmiShape = "OMI_physics_shape";
constexpr const char* kKhr = "KHR_physics_rigid_bodies";

void useExtension(Json& document, const char* name) {
  Json& used = document["extensionsUsed"];
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

/// A mesh of one hull. @return its index
int addHullMesh(GltfWriter& writer, const TriMesh& hull, const std::string& name, int material) {
  std::vector<float> positions;
  for (const Vec3& p : hull.vertices) positions.insert(positions.end(), p.begin(), p.end());
  std::vector<std::uint32_t> indices;
  for (const Triangle& t : hull.triangles) indices.insert(indices.end(), t.begin(), t.end());
  const int points = writer.addNumbers(positions, "VEC3", true);
  const int corners = writer.addNumbers(std::span<const std::uint32_t>(indices), "SCALAR");
  const Json primitive = {{"attributes", {{"POSITION", points}}}, {"indices", corners}, {"material", material}};
  return writer.add("meshes", {{"name", name}, {"primitives", Json::array({primitive})}});
}

/// What is not drawn has a material whose every point is cut out, since programs import nodes that are switched off
/// without what makes them colliders.
int addGlass(GltfWriter& writer, bool shown) {
  const Json colour = {{"baseColorFactor", {0.2, 0.6, 1.0, shown ? 0.3 : 0.0}}, {"metallicFactor", 0.0}};
  return writer.add(
      "materials",
      {{"name", kColliderMaterial}, {"pbrMetallicRoughness", colour}, {"alphaMode", shown ? "BLEND" : "MASK"}});
}

/// A node with a hull and what makes it a collider. @return its index
int addHullNode(GltfWriter& writer, const TriMesh& hull, const std::string& plain, int material, const char* motion,
                const GlbColliderSettings& settings) {
  const std::string name = settings.prefix + plain + settings.postfix;
  const int mesh = addHullMesh(writer, hull, name, material);
  Json& shapes = writer.document["extensions"][kOmiShape]["shapes"];
  Json node = {{"name", name}, {"mesh", mesh}};
  node["extensions"][kOmiBody] = {{"motion", {{"type", motion}}}, {"collider", {{"shape", shapes.size()}}}};
  shapes.push_back({{"type", "convex"}, {"convex", {{"mesh", mesh}}}});
  useExtension(writer.document, kOmiBody);
  useExtension(writer.document, kOmiShape);
  if (settings.khr) {
    Json& rigid = node["extensions"][kKhr];
    if (std::string_view(motion) == "kinematic") rigid["motion"]["isKinematic"] = true;
    rigid["collider"]["geometry"] = {{"mesh", mesh}, {"convexHull", true}};
    useExtension(writer.document, kKhr);
  }
  return writer.add("nodes", std::move(node));
}

/// Puts a node below another one, or into the scene.
void hang(Json& document, int node, int parent) {
  if (parent >= 0) {
    document["nodes"][parent]["children"].push_back(node);
    return;
  }
  if (!document.contains("scenes")) document["scenes"] = Json::array({Json::object()});
  const auto scene = document.value("scene", std::size_t{0});
  document["scenes"][scene]["nodes"].push_back(node);
}

constexpr int kMaxBalls = 12;  // of a capsule

/// A capsule in the frame of a node.
struct NodeCapsule {
  int node = 0;
  Capsule capsule;
};

/// Joints that swing, or hang on one that does.
std::vector<bool> swingingJoints(const Skeleton& skeleton, const SpringBones& springs) {
  std::vector<bool> swings(skeleton.joints().size(), false);
  for (const SpringChain& chain : springs.chains) {
    for (const SpringJoint& joint : chain.joints) swings[joint.joint] = true;
  }
  for (std::size_t j = 0; j < swings.size(); ++j) {
    const JointIndex parent = skeleton.joints()[j].parent;
    if (parent != kNoJoint && swings[parent]) swings[j] = true;
  }
  return swings;
}

std::vector<NodeCapsule> capsulesOnNodes(const CharacterDocument& document, std::span<const RigidCollider> colliders,
                                         const std::vector<bool>& swings) {
  std::vector<NodeCapsule> capsules;
  for (const RigidCollider& collider : colliders) {
    const int node = document.hangOn[collider.joint];
    if (node < 0 || swings[collider.joint]) continue;
    const Affine3& nodeFromModel = document.nodeFromModel[collider.joint];
    const Capsule capsule = withVolume(collider.capsule, std::min(collider.volume, collider.capsule.volume()));
    const double scale = std::cbrt(std::abs(nodeFromModel.linear().determinant()));
    capsules.push_back({node, {nodeFromModel * capsule.from, nodeFromModel * capsule.to, scale * capsule.radius}});
  }
  return capsules;
}

/// VRMC_springBone 1.0: a group of spheres and capsules, used by every spring.
int addToVrm1(Json& springBone, std::span<const NodeCapsule> capsules) {
  Json group = {{"name", "Lorica"}};
  for (const auto& [node, capsule] : capsules) {
    const bool ball = (capsule.to - capsule.from).norm() < 1e-3 * capsule.radius;
    Json collider = {{"node", node}};
    Json& shape = collider["shape"][ball ? "sphere" : "capsule"];
    shape["offset"] = listOf(capsule.from);
    shape["radius"] = capsule.radius;
    if (!ball) shape["tail"] = listOf(capsule.to);
    group["colliders"].push_back(springBone["colliders"].size());
    springBone["colliders"].push_back(std::move(collider));
  }
  const std::size_t index = springBone["colliderGroups"].size();
  springBone["colliderGroups"].push_back(std::move(group));
  for (Json& spring : springBone["springs"]) spring["colliderGroups"].push_back(index);
  return countOf(capsules);
}

/// VRM 0.x: balls by node, used by every group of bones. Offsets are left-handed: z is negated.
int addToVrm0(Json& animation, std::span<const NodeCapsule> capsules) {
  int added = 0;
  const std::size_t first = animation["colliderGroups"].size();
  for (const auto& [node, capsule] : capsules) {
    const double length = (capsule.to - capsule.from).norm();
    const int balls = std::clamp(1 + static_cast<int>(std::ceil(length / capsule.radius)), 1, kMaxBalls);
    Json group = {{"node", node}};
    for (int b = 0; b < balls; ++b) {
      const double t = balls == 1 ? 0.5 : static_cast<double>(b) / (balls - 1);
      const Vec3 center = (1.0 - t) * capsule.from + t * capsule.to;
      group["colliders"].push_back(
          {{"offset", {{"x", center.x()}, {"y", center.y()}, {"z", -center.z()}}}, {"radius", capsule.radius}});
      ++added;
    }
    animation["colliderGroups"].push_back(std::move(group));
  }
  for (Json& bones : animation["boneGroups"]) {
    for (std::size_t g = first; g < animation["colliderGroups"].size(); ++g) bones["colliderGroups"].push_back(g);
  }
  return added;
}

}  // namespace

void addColliders(CharacterDocument& document, std::span<const RigidCollider> colliders,
                  std::span<const std::string> names, const GlbColliderSettings& settings) {
  GltfWriter& writer = document.writer;
  const int material = addGlass(writer, settings.shown);
  for (std::size_t i = 0; i < colliders.size(); ++i) {
    const JointIndex joint = colliders[i].joint;
    TriMesh hull = colliders[i].hull;
    const Affine3& nodeFromModel = document.nodeFromModel[joint];
    for (Vec3& p : hull.vertices) p = nodeFromModel * p;
    if (nodeFromModel.linear().determinant() < 0.0) {
      for (Triangle& t : hull.triangles) std::swap(t[1], t[2]);
    }
    const int node = addHullNode(writer, hull, names[i], material, "kinematic", settings);
    hang(writer.document, node, document.hangOn[joint]);
  }
}

Result<void> writeGlbHulls(const std::filesystem::path& file, const std::vector<NamedMesh>& hulls,
                           const GlbColliderSettings& settings) {
  CharacterDocument document;
  GltfWriter& writer = document.writer;
  writer.document["asset"] = {{"version", "2.0"}, {"generator", "Lorica"}};
  writer.document["scene"] = 0;
  const int material = addGlass(writer, true);
  for (const NamedMesh& hull : hulls) {
    hang(writer.document, addHullNode(writer, hull.mesh, hull.name, material, "static", settings), -1);
  }
  return writeDocument(file, document);
}

Result<void> writeDocument(const std::filesystem::path& file, CharacterDocument& document) {
  LORICA_TRY(const std::string bytes, document.writer.glb(file.string()));
  return writeFileAtomically(file, bytes);
}

Result<int> addSpringColliders(CharacterDocument& document, std::span<const RigidCollider> colliders,
                               const Skeleton& skeleton, const SpringBones& springs, const std::string& name) {
  Json& all = document.writer.document;
  Json none = Json::object();
  Json& extensions = all.contains("extensions") ? all["extensions"] : none;
  const bool vrm1 = extensions.contains("VRMC_vrm");
  if (!vrm1 && !extensions.contains("VRM")) {
    return unsupported("{}: no VRM, so a .vrm cannot be made of it; expected OUT.glb", name);
  }
  if (springs.chains.empty()) {
    return unsupported("{}: has no springs that colliders could touch; expected OUT.glb", name);
  }
  const std::vector<NodeCapsule> capsules = capsulesOnNodes(document, colliders, swingingJoints(skeleton, springs));
  if (vrm1) return addToVrm1(extensions["VRMC_springBone"], capsules);
  return addToVrm0(extensions["VRM"]["secondaryAnimation"], capsules);
}

}  // namespace lorica
