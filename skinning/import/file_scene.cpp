#include "skinning/import/file_scene.h"

#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <fmt/format.h>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

constexpr std::size_t kMaxSentences = 4;

constexpr double kHuman = 1.7;  ///< [m]

/// @return the unit that brings a size nearest to a human's, as a ratio; metres if none is nearer
[[nodiscard]] double factorFor(double metres) {
  const auto away = [&](double factor) { return std::abs(std::log(metres * factor / kHuman)); };
  constexpr std::array kFactors = {1.0, 0.01, 0.001, 100.0, 1000.0};
  return *std::ranges::min_element(kFactors, {}, away);
}

}  // namespace

void setMatrix(FileNode& node, const Affine3& parentFromNode) {
  node.local = {};
  node.inner.reset();
  node.local.translation = parentFromNode.translation();

  const Mat3 linear = parentFromNode.linear();
  const Vec3 lengths = linear.colwise().norm();
  if (lengths.minCoeff() > 1e-12 * lengths.maxCoeff()) {
    Mat3 axes = linear * lengths.cwiseInverse().asDiagonal();
    const double skew = std::max({std::abs(axes.col(0).dot(axes.col(1))), std::abs(axes.col(1).dot(axes.col(2))),
                                  std::abs(axes.col(2).dot(axes.col(0)))});
    if (skew < 1e-6) {
      node.local.scale = lengths;
      if (axes.determinant() < 0.0) {
        axes.col(0) = -axes.col(0);
        node.local.scale.x() = -lengths.x();
      }
      node.local.rotation = Quat(axes).normalized();
      return;
    }
  }

  // linear = U S V^T: a rotation V^T, then a scale, then a rotation U.
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  Mat3 v = svd.matrixV();
  node.local.scale = svd.singularValues();
  for (Mat3* turn : {&u, &v}) {
    if (turn->determinant() > 0.0) continue;
    turn->col(2) = -turn->col(2);
    node.local.scale.z() = -node.local.scale.z();
  }
  node.local.rotation = Quat(u).normalized();
  node.inner = Quat(Mat3(v.transpose())).normalized();
}

void FileScene::note(std::uint64_t count, std::string_view one, std::string_view many) {
  if (count > 0) notes.push_back(counted(static_cast<long long>(count), one, many));
}

std::vector<char> movingNodes(const FileScene& scene) {
  const bool all = scene.meshes.empty() && scene.skins.empty();
  std::vector<char> moves(scene.nodes.size(), all ? 1 : 0);
  const auto mark = [&](int node) {
    for (; node != -1 && moves[node] == 0; node = scene.nodes[node].parent) moves[node] = 1;
  };
  for (const FileSkin& skin : scene.skins) std::for_each(skin.nodes.begin(), skin.nodes.end(), mark);
  for (const FileMesh& mesh : scene.meshes) {
    if (mesh.skin == -1) mark(mesh.node);
  }
  for (const auto& [bone, node] : scene.bones) mark(node);
  const std::vector<int> swinging = nodesOfSprings(scene.springs);
  std::for_each(swinging.begin(), swinging.end(), mark);
  return moves;
}

Result<void> checkWork(const FileScene& scene, const std::string& fileName) {
  const auto beyond = [&](std::uint64_t count, const char* what, std::uint64_t most) {
    return unsupported("{}: {} {}, expected at most {}", fileName, grouped(count), what, grouped(most));
  };
  std::uint64_t triangles = 0;
  for (const FileMesh& mesh : scene.meshes) triangles += mesh.triangles.size();
  if (triangles > kMaxTriangles) return beyond(triangles, "triangles", kMaxTriangles);
  if (scene.clips.size() > kMaxClips) return beyond(scene.clips.size(), "clips", kMaxClips);
  if (scene.skins.empty() && scene.clips.empty() && scene.springs.empty()) return {};
  const std::vector<char> moves = movingNodes(scene);
  const std::uint64_t joints = std::count(moves.begin(), moves.end(), 1);
  return joints > kMaxJoints ? Result<void>(beyond(joints, "joints", kMaxJoints)) : Result<void>();
}

LookNeeds needsOf(const Material& material) {
  LookNeeds needs;
  needs.tangents = material.normal.given();
  needs.colors = material.shading != Shading::kToon;
  for (const TextureUse* use : material.textures()) {
    const bool byNormal = use == &material.toon.matcap;  // no coordinates
    if (use->given() && !byNormal) needs.uv[use->uvSet] = true;
  }
  return needs;
}

void CountedNotes::add(const std::string& kind, std::string sentence) {
  const auto known = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& k) { return k.name == kind; });
  Kind& same = known == kinds_.end() ? kinds_.emplace_back(Kind{kind, 0, {}}) : *known;
  ++same.count;
  if (same.sentences.size() < kMaxSentences) same.sentences.push_back(std::move(sentence));
}

void CountedNotes::appendTo(std::vector<std::string>& notes) const {
  for (const Kind& kind : kinds_) {
    if (kind.count <= kMaxSentences) {
      notes.insert(notes.end(), kind.sentences.begin(), kind.sentences.end());
    } else {
      notes.push_back(fmt::format("{} {}; the first: {}", grouped(kind.count), kind.name, kind.sentences.front()));
    }
  }
}

std::string titled(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {} '{}'", kind, index, name);
}

std::vector<int> nodesOfSprings(const SpringBones& springs) {
  std::vector<int> nodes;
  for (const SpringChain& chain : springs.chains) {
    for (const SpringJoint& joint : chain.joints) nodes.push_back(joint.joint);
    if (chain.center != kNoJoint) nodes.push_back(chain.center);
  }
  for (const SpringCollider& collider : springs.colliders) nodes.push_back(collider.joint);
  for (const NodeConstraint& constraint : springs.constraints) {
    nodes.push_back(constraint.joint);
    nodes.push_back(constraint.source);
  }
  return nodes;
}

SpringBones withJoints(SpringBones springs, const std::function<JointIndex(int)>& jointOfNode) {
  for (SpringChain& chain : springs.chains) {
    for (SpringJoint& joint : chain.joints) joint.joint = jointOfNode(joint.joint);
    if (chain.center != kNoJoint) chain.center = jointOfNode(chain.center);
  }
  for (SpringCollider& collider : springs.colliders) collider.joint = jointOfNode(collider.joint);
  for (NodeConstraint& constraint : springs.constraints) {
    constraint.joint = jointOfNode(constraint.joint);
    constraint.source = jointOfNode(constraint.source);
  }
  return springs;
}

UnitGuess guessUnit(double longestSide, std::optional<double> saidByFile) {
  const double said = saidByFile.value_or(1.0);
  const double metres = longestSide * said;
  if (longestSide <= 0.0 || (metres >= 0.02 && metres <= (saidByFile ? 100.0 : 10.0))) return {said, ""};
  const double unit = metres >= 0.02 && metres <= 55.0 ? said : said * factorFor(metres);
  return {unit, fmt::format("the bind pose is {:.4g} units long, {:.4g} m in the {}: {} {:.4g} m per unit, which gives "
                            "{:.4g} m",
                            longestSide, metres, saidByFile ? "file's own unit" : "format's unit",
                            unit == said ? "it stays at" : "assuming", unit, longestSide * unit)};
}

}  // namespace lorica
