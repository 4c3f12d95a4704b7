#include "skinning/import/character_parts.h"

#include "geometry/counts.h"

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

constexpr float kStill = 1e-7F;     // [m]
constexpr float kUnturned = 1e-5F;  // of a unit normal

}  // namespace

Morphs makeMorphs(const FileScene& scene, const BindFrames& frames, const Affine3& modelFromFile) {
  Morphs morphs;
  morphs.targets.reserve(scene.morphTargets.size());
  for (const FileMorphTarget& target : scene.morphTargets) {
    morphs.targets.push_back({target.name, target.defaultWeight, {}});
  }
  std::vector<std::size_t> counts(morphs.targets.size(), 0);
  for (const FileMesh& mesh : scene.meshes) {
    for (const FileMorph& morph : mesh.morphs) counts[morph.target] += morph.offsets.size();
  }
  for (std::size_t t = 0; t < counts.size(); ++t) morphs.targets[t].offsets.reserve(counts[t]);

  VertexIndex first = 0;
  for (const FileMesh& mesh : scene.meshes) {
    const Affine3& fileFromMesh = mesh.skin != -1 ? frames.fileFromSkin[mesh.skin] : frames.fileFromNode[mesh.node];
    const Mat3 modelFromMesh = modelFromFile.linear() * fileFromMesh.linear();
    // Offsets of normals are transformed like normals, by the inverse transpose, and scaled so that unit normals keep
    // their length under a uniform scale.
    const double scale = std::cbrt(std::abs(modelFromMesh.determinant()));
    const Mat3 normalFromMesh = scale * Mat3(modelFromMesh.inverse().transpose());
    for (const FileMorph& morph : mesh.morphs) {
      for (MorphOffset offset : morph.offsets) {
        offset.vertex += first;
        offset.position = (modelFromMesh * offset.position.cast<double>()).cast<float>();
        offset.normal = (normalFromMesh * offset.normal.cast<double>()).cast<float>();
        if (!offset.position.allFinite() || !offset.normal.allFinite()) continue;
        if (offset.position.norm() < kStill && offset.normal.norm() < kUnturned) continue;
        morphs.targets[morph.target].offsets.push_back(offset);
      }
    }
    first += countOf(mesh.positions);
  }
  return morphs;
}

LookAt makeLookAt(const FileScene& scene, const Skeleton& skeleton, std::span<const JointIndex> jointOfNode) {
  LookAt lookAt = scene.lookAt;
  if (lookAt.kind == LookAtKind::kNone) return {};
  const auto jointOf = [&](int node) { return node == -1 ? kNoJoint : jointOfNode[node]; };
  lookAt.head = skeleton.jointOf(HumanBone::kHead);
  lookAt.leftEye = jointOf(scene.leftEye);
  lookAt.rightEye = jointOf(scene.rightEye);
  const bool eyes = lookAt.leftEye != kNoJoint || lookAt.rightEye != kNoJoint;
  const bool expressions = std::any_of(scene.expressions.list.begin(), scene.expressions.list.end(),
                                       [](const Expression& e) { return e.kind == ProceduralKind::kLookAt; });
  if (lookAt.head == kNoJoint || !(lookAt.kind == LookAtKind::kBone ? eyes : expressions)) return {};

  const Pose rest = restPose(skeleton);
  std::vector<Quat> modelFromJoint(rest.size());
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const JointIndex parent = skeleton.joint(j).parent;
    modelFromJoint[j] = parent == kNoJoint ? rest[j].rotation : modelFromJoint[parent] * rest[j].rotation;
  }
  lookAt.modelFromHead = modelFromJoint[lookAt.head];
  if (lookAt.leftEye != kNoJoint) lookAt.modelFromLeftEye = modelFromJoint[lookAt.leftEye];
  if (lookAt.rightEye != kNoJoint) lookAt.modelFromRightEye = modelFromJoint[lookAt.rightEye];
  return lookAt;
}

}  // namespace lorica
