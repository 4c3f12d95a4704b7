#include "tests/skinning/import/assimp_truth.h"

#include "tests/skinning/import/gltf_truth.h"

#include <algorithm>
#include <cmath>

namespace lorica::test {

namespace {

Mat4 matrixOf(const aiMatrix4x4& m) {
  Mat4 out;
  out << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  return out;
}

template <typename Key>
std::pair<unsigned, double> keyAt(const Key* keys, unsigned count, double tick) {
  if (tick <= keys[0].mTime) return {0, 0.0};
  if (tick >= keys[count - 1].mTime) return {count - 1, 0.0};
  unsigned k = 0;
  while (keys[k + 1].mTime <= tick) ++k;
  return {k, (tick - keys[k].mTime) / (keys[k + 1].mTime - keys[k].mTime)};
}

Vec3 vectorAt(const aiVectorKey* keys, unsigned count, double tick) {
  const auto [k, part] = keyAt(keys, count, tick);
  const aiVector3D& a = keys[k].mValue;
  const aiVector3D& b = keys[std::min(k + 1, count - 1)].mValue;
  return (1.0 - part) * Vec3(a.x, a.y, a.z) + part * Vec3(b.x, b.y, b.z);
}

Eigen::Vector4d rotationAt(const aiQuatKey* keys, unsigned count, double tick) {
  const auto [k, part] = keyAt(keys, count, tick);
  const aiQuaternion& qa = keys[k].mValue;
  const aiQuaternion& qb = keys[std::min(k + 1, count - 1)].mValue;
  const Eigen::Vector4d a = Eigen::Vector4d(qa.x, qa.y, qa.z, qa.w).normalized();
  Eigen::Vector4d b = Eigen::Vector4d(qb.x, qb.y, qb.z, qb.w).normalized();
  if (a.dot(b) < 0.0) b = -b;
  const double angle = std::acos(std::min(1.0, a.dot(b)));
  if (angle < 1e-6) return a;
  return std::sin((1.0 - part) * angle) / std::sin(angle) * a + std::sin(part * angle) / std::sin(angle) * b;
}

void addNode(const aiScene& scene, const aiNode& node, const Mat4& parent, int animation, double seconds,
             std::map<std::string, Mat4>& all) {
  Mat4 local = matrixOf(node.mTransformation);
  if (animation >= 0) {
    const aiAnimation& clip = *scene.mAnimations[animation];
    const double tick = seconds * (clip.mTicksPerSecond > 0.0 ? clip.mTicksPerSecond : 25.0);
    for (unsigned c = 0; c < clip.mNumChannels; ++c) {
      const aiNodeAnim& channel = *clip.mChannels[c];
      if (channel.mNodeName != node.mName) continue;
      const Eigen::Vector4d q = rotationAt(channel.mRotationKeys, channel.mNumRotationKeys, tick);
      local = rotationMatrix(q);
      const Vec3 scale = vectorAt(channel.mScalingKeys, channel.mNumScalingKeys, tick);
      for (int i = 0; i < 3; ++i) local.col(i) *= scale[i];
      local.block<3, 1>(0, 3) = vectorAt(channel.mPositionKeys, channel.mNumPositionKeys, tick);
    }
  }
  const Mat4 global = parent * local;
  all.emplace(node.mName.C_Str(), global);
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    addNode(scene, *node.mChildren[c], global, animation, seconds, all);
  }
}

void addCorners(const aiScene& scene, const aiNode& node, const std::map<std::string, Mat4>& nodes,
                std::vector<Vec3>& corners) {
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    std::vector<Eigen::Vector4d> placed(mesh.mNumVertices, Eigen::Vector4d::Zero());
    std::vector<double> sums(mesh.mNumVertices, 0.0);
    const auto point = [&](unsigned v) {
      return Eigen::Vector4d(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z, 1.0);
    };
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const Mat4 carry = nodes.at(mesh.mBones[b]->mName.C_Str()) * matrixOf(mesh.mBones[b]->mOffsetMatrix);
      for (unsigned w = 0; w < mesh.mBones[b]->mNumWeights; ++w) {
        const aiVertexWeight& weight = mesh.mBones[b]->mWeights[w];
        placed[weight.mVertexId] += static_cast<double>(weight.mWeight) * (carry * point(weight.mVertexId));
        sums[weight.mVertexId] += static_cast<double>(weight.mWeight);
      }
    }
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      if (mesh.mNumBones == 0) placed[v] = nodes.at(node.mName.C_Str()) * point(v);
      if (mesh.mNumBones > 0) placed[v] /= sums[v];
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      if (mesh.mFaces[f].mNumIndices != 3) continue;
      for (unsigned c = 0; c < 3; ++c) corners.emplace_back(placed[mesh.mFaces[f].mIndices[c]].head<3>());
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) addCorners(scene, *node.mChildren[c], nodes, corners);
}

}  // namespace

std::map<std::string, Mat4> assimpNodes(const aiScene& scene, int animation, double seconds) {
  std::map<std::string, Mat4> all;
  addNode(scene, *scene.mRootNode, Mat4::Identity(), animation, seconds, all);
  return all;
}

std::vector<Vec3> assimpCorners(const aiScene& scene, int animation, double seconds) {
  std::vector<Vec3> corners;
  addCorners(scene, *scene.mRootNode, assimpNodes(scene, animation, seconds), corners);
  return corners;
}

}  // namespace lorica::test
