#include "tests/apps/mannequin_glb.h"

#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/import/glb_writer.h"

#include <fmt/format.h>

#include <array>
#include <numbers>

namespace lorica::test {
namespace {

using Json = nlohmann::json;

/// Mixamo's name of a bone; the mannequin's own if Mixamo has none.
std::string mixamoName(const Joint& joint) {
  static constexpr std::array<std::pair<const char*, const char*>, 22> kNames = {{
      {"hips", "Hips"},
      {"spine", "Spine"},
      {"chest", "Spine1"},
      {"upperChest", "Spine2"},
      {"neck", "Neck"},
      {"head", "Head"},
      {"leftUpperLeg", "LeftUpLeg"},
      {"leftLowerLeg", "LeftLeg"},
      {"leftFoot", "LeftFoot"},
      {"leftToes", "LeftToeBase"},
      {"rightUpperLeg", "RightUpLeg"},
      {"rightLowerLeg", "RightLeg"},
      {"rightFoot", "RightFoot"},
      {"rightToes", "RightToeBase"},
      {"leftShoulder", "LeftShoulder"},
      {"leftUpperArm", "LeftArm"},
      {"leftLowerArm", "LeftForeArm"},
      {"leftHand", "LeftHand"},
      {"rightShoulder", "RightShoulder"},
      {"rightUpperArm", "RightArm"},
      {"rightLowerArm", "RightForeArm"},
      {"rightHand", "RightHand"},
  }};
  for (const auto& [ours, mixamo] : kNames) {
    if (joint.bone && nameOf(*joint.bone) == ours) return std::string("mixamorig:") + mixamo;
  }
  return joint.name;
}

Json numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Json numbers(const Quat& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

/// Adds a clip that rotates one joint forward and back.
void addClip(GlbWriter& writer, const std::string& name, int node, float seconds, float angle) {
  const float s = std::sin(0.5F * angle);
  const float c = std::cos(0.5F * angle);
  const std::vector<float> times = {0.0F, 0.5F * seconds, seconds};
  const std::vector<float> turns = {0, 0, 0, 1, s, 0, 0, c, 0, 0, 0, 1};
  const int input = writer.accessor(times, "SCALAR");
  const int output = writer.accessor(turns, "VEC4");
  writer.add("animations", {{"name", name},
                            {"samplers", {{{"input", input}, {"output", output}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "rotation"}}}}}}});
}

}  // namespace

std::string mannequinGlb(bool torn, bool named) {
  return mannequinWriter(torn, named).glb();
}

GlbWriter mannequinWriter(bool torn, bool named) {
  const Character character = makeMannequin();
  const Skeleton& skeleton = character.skeleton;
  GlbWriter writer;
  Json joints = Json::array();
  Json roots = Json::array();
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const Joint& joint = skeleton.joint(j);
    Json node = {{"name", named ? mixamoName(joint) : fmt::format("bone {}", j)},
                 {"translation", numbers(joint.rest.translation)},
                 {"rotation", numbers(joint.rest.rotation)}};
    for (JointIndex c = j + 1; c < skeleton.jointCount(); ++c) {
      if (skeleton.joint(c).parent == j) node["children"].push_back(c);
    }
    writer.add("nodes", node);
    joints.push_back(j);
    if (joint.parent == kNoJoint) roots.push_back(j);
  }
  std::vector<Affine3> jointFromMesh = character.jointFromModel;
  if (!named) {
    // Bones in centimetres and facing sideways, under an armature that corrects both.
    const Quat turned(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY()));
    const Affine3 worldFromArmature = JointTransform{Vec3::Zero(), turned, Vec3::Constant(0.01)}.matrix();
    const Affine3 larger = worldFromArmature.inverse();
    for (const Json& root : roots) {
      const JointTransform& rest = skeleton.joint(root.get<JointIndex>()).rest;
      const Affine3 local = larger * rest.matrix();
      Json& node = writer.document["nodes"][root.get<std::size_t>()];
      node.erase("translation");
      node.erase("rotation");
      node["matrix"] = std::vector<double>(local.data(), local.data() + 16);
    }
    const int armature = writer.add(
        "nodes",
        {{"name", "armature"}, {"rotation", numbers(turned)}, {"scale", {0.01, 0.01, 0.01}}, {"children", roots}});
    roots = Json::array({armature});
  }

  std::vector<Triangle> triangles = character.mesh.triangles;
  if (torn) {
    std::vector<Triangle> left;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (t % 1000 >= 6) left.push_back(triangles[t]);
    }
    triangles = std::move(left);
  }
  std::vector<std::uint16_t> joint4;
  std::vector<float> weight4;
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t i = character.influenceBegin[v] + k;
      const bool there = i < character.influenceBegin[v + 1];
      joint4.push_back(there ? static_cast<std::uint16_t>(character.influences[i].joint) : std::uint16_t{0});
      weight4.push_back(there ? static_cast<float>(character.influences[i].weight) : 0.0F);
    }
  }
  // Separate statements: the order in the file must not depend on the compiler.
  const int positions = writer.positions(character.mesh.vertices);
  const int indices = writer.triangles(triangles);
  const int jointsOf = writer.accessor(joint4, "VEC4");
  const int weightsOf = writer.accessor(weight4, "VEC4");
  const int matrices = writer.matrices(jointFromMesh);
  const Json attributes = {{"POSITION", positions}, {"JOINTS_0", jointsOf}, {"WEIGHTS_0", weightsOf}};
  writer.add("meshes", {{"primitives", {{{"attributes", attributes}, {"indices", indices}}}}});
  writer.add("skins", {{"joints", joints}, {"inverseBindMatrices", matrices}});
  roots.push_back(writer.add("nodes", {{"name", "skin"}, {"mesh", 0}, {"skin", 0}}));
  writer.add("scenes", {{"nodes", roots}});
  writer.document["scene"] = 0;
  addClip(writer, "Bow", skeleton.jointOf(HumanBone::kSpine), 1.0F, 0.9F);
  addClip(writer, "Nod", skeleton.jointOf(HumanBone::kHead), 0.5F, 0.4F);
  return writer;
}

std::string facesGlb(bool breathes) {
  GlbWriter writer = mannequinWriter(false);
  const Character mannequin = makeMannequin();
  const JointIndex spine = mannequin.skeleton.jointOf(HumanBone::kSpine);
  const Vec3 middle = mannequin.jointFromModel[spine].inverse().translation();
  std::vector<float> belly;
  std::vector<float> frown;
  for (const Vec3& p : mannequin.mesh.vertices) {
    const double away = (p - middle).head<2>().norm();
    const bool moves = p.z() > middle.z() && away < 0.2;
    belly.insert(belly.end(), {0.0F, 0.0F, moves ? static_cast<float>(0.12 * (1.0 - away / 0.2)) : 0.0F});
    frown.insert(frown.end(), {0.0F, 0.001F, 0.0F});
  }
  const int bellyOffsets = writer.accessor(belly, "VEC3");
  const int frownOffsets = writer.accessor(frown, "VEC3");
  nlohmann::json& mesh = writer.document["meshes"][0];
  mesh["primitives"][0]["targets"] = {{{"POSITION", bellyOffsets}}, {{"POSITION", frownOffsets}}};
  mesh["primitives"][0]["material"] = writer.add("materials", {{"name", "skin"}});
  mesh["extras"] = {{"targetNames", {"Belly", "Frown"}}};
  if (!breathes) return writer.glb();
  const int times = writer.accessor(std::vector<float>{0.0F, 0.5F, 1.0F}, "SCALAR");
  const int weights = writer.accessor(std::vector<float>{0, 0, 1, 0, 0, 0}, "SCALAR");
  const auto node = writer.document["nodes"].size() - 1;
  writer.add("animations", {{"name", "Breathe"},
                            {"samplers", {{{"input", times}, {"output", weights}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}}}}});
  return writer.glb();
}

}  // namespace lorica::test
