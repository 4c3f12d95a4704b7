#include "skinning/body/transfer_weights.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lorica {
namespace {

constexpr int kVoteRounds = 3;
constexpr int kSmoothRounds = 3;
constexpr double kReach = 4.0;  // voxels: farther triangles are used whichever way they face
constexpr std::size_t kKeptInfluences = 8;
constexpr double kMinWeight = 2e-3;

class Carrier {
 public:
  Carrier(const TriMesh& body, const SolidSource& source, double voxel) : body_(body), source_(source), voxel_(voxel) {
    originalNormals_.reserve(source.mesh.triangles.size());
    for (const Triangle& t : source.mesh.triangles) originalNormals_.push_back(areaNormal(source.mesh.vertices, t));
    normals_.assign(body.vertices.size(), Vec3::Zero());
    neighbours_.resize(body.vertices.size());
    for (const Triangle& t : body.triangles) {
      const Vec3 normal = areaNormal(body.vertices, t);
      for (std::size_t i = 0; i < 3; ++i) {
        normals_[t[i]] += normal;
        // Each edge occurs twice, once in each direction.
        neighbours_[t[i]].push_back(t[(i + 1) % 3]);
      }
    }
  }

  std::vector<std::vector<Influence>> run() {
    weights_.resize(body_.vertices.size());
    parallelFor(weights_.size(), [&](std::size_t v) { weights_[v] = weightsAt(v, [](std::int32_t) { return true; }); });
    for (int round = 0; round < kVoteRounds; ++round) vote();
    const std::vector<std::vector<Influence>> carried = weights_;
    for (int round = 0; round < kSmoothRounds; ++round) smooth(carried);
    parallelFor(weights_.size(), [&](std::size_t v) { weights_[v] = pruned(std::move(weights_[v])); });
    return std::move(weights_);
  }

 private:
  [[nodiscard]] TriangleTree::Hit nearestTo(std::size_t v, const auto& accept) const {
    const auto faces = [&](std::int32_t t) { return originalNormals_[t].dot(normals_[v]) >= 0.0; };
    const auto solid = [&](std::int32_t t) { return source_.isSkin(t); };
    const Vec3& at = body_.vertices[v];
    TriangleTree::Hit hit =
        source_.tree->nearest(at, kReach * voxel_, [&](std::int32_t t) { return solid(t) && faces(t) && accept(t); });
    if (hit.triangle >= 0) return hit;
    hit = source_.tree->nearest(at, std::numeric_limits<double>::infinity(),
                                [&](std::int32_t t) { return solid(t) && accept(t); });
    if (hit.triangle >= 0) return hit;
    return source_.tree->nearest(at, std::numeric_limits<double>::infinity(), accept);
  }

  [[nodiscard]] std::vector<Influence> weightsAt(std::size_t v, const auto& accept) const {
    const TriangleTree::Hit hit = nearestTo(v, accept);
    if (hit.triangle < 0) return {};
    const Triangle& t = source_.mesh.triangles[hit.triangle];
    std::array<const std::vector<Influence>*, 3> lists{};
    for (std::size_t i = 0; i < 3; ++i) lists[i] = &source_.influences[t[i]];
    const std::array<double, 3> shares{hit.shares[0], hit.shares[1], hit.shares[2]};
    return blended(lists, shares);
  }

  /// If most neighbours follow another limb, the vertex follows it too.
  void vote() {
    std::vector<std::vector<Influence>> next = weights_;
    parallelFor(weights_.size(), [&](std::size_t v) {
      const Vec3& at = body_.vertices[v];
      const JointIndex own = strongest(weights_[v]);
      std::size_t others = 0;
      JointIndex other = own;
      for (const VertexIndex n : neighbours_[v]) {
        const JointIndex joint = strongest(weights_[n]);
        if (!source_.limbs.apart(own, joint, at)) continue;
        ++others;
        other = joint;
      }
      if (2 * others <= neighbours_[v].size()) return;
      std::vector<Influence> found =
          weightsAt(v, [&](std::int32_t t) { return !source_.limbs.apart(source_.jointOfTriangle[t], other, at); });
      if (!found.empty()) next[v] = std::move(found);
    });
    weights_ = std::move(next);
  }

  /// Replaces half of each vertex's weights by the mean of its neighbours.
  void smooth(const std::vector<std::vector<Influence>>& carried) {
    std::vector<std::vector<Influence>> next(weights_.size());
    parallelFor(weights_.size(), [&](std::size_t v) {
      std::vector<const std::vector<Influence>*> lists{&weights_[v]};
      const JointIndex own = strongest(carried[v]);
      for (const VertexIndex n : neighbours_[v]) {
        const std::vector<Influence>& list = weights_[n];
        if (!source_.limbs.apart(own, strongest(list), body_.vertices[v])) lists.push_back(&list);
      }
      std::vector<double> shares(lists.size(), 0.5 / std::max<std::size_t>(lists.size() - 1, 1));
      shares.front() = lists.size() > 1 ? 0.5 : 1.0;
      std::vector<Influence> mean = blended(lists, shares);
      // A bone outside the vertex's own branch is kept only if it was there before: a thigh never follows the other
      // one.
      std::erase_if(mean, [&](const Influence& i) {
        if (source_.limbs.onOneBranch(i.joint, own)) return false;
        return std::none_of(carried[v].begin(), carried[v].end(),
                            [&](const Influence& was) { return was.joint == i.joint; });
      });
      const std::array<const std::vector<Influence>*, 1> one{&mean};
      const std::array<double, 1> whole{1.0};
      next[v] = blended(one, whole);
    });
    weights_ = std::move(next);
  }

  const TriMesh& body_;
  const SolidSource& source_;
  double voxel_;
  std::vector<Vec3> originalNormals_;  ///< scaled by twice the area
  std::vector<Vec3> normals_;
  std::vector<std::vector<VertexIndex>> neighbours_;
  std::vector<std::vector<Influence>> weights_;
};

}  // namespace

std::vector<Influence> pruned(std::vector<Influence> weights) {
  std::stable_sort(weights.begin(), weights.end(),
                   [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
  if (weights.size() > kKeptInfluences) weights.resize(kKeptInfluences);
  while (weights.size() > 1 && weights.back().weight < kMinWeight) weights.pop_back();
  const std::array<const std::vector<Influence>*, 1> one{&weights};
  const std::array<double, 1> whole{1.0};
  return blended(one, whole);
}

std::vector<std::vector<Influence>> transferWeights(const TriMesh& body, const SolidSource& source, double voxel) {
  return Carrier(body, source, voxel).run();
}

}  // namespace lorica
