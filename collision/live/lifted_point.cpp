#include "collision/live/lifted_point.h"

#include "acd/transfer.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lorica {
namespace {

/// Adds `scale` times another lifted point. Joints are ascending in both, and stay so in the sum.
void add(LiftedPoint& sum, const LiftedPoint& other, double scale) {
  for (const LiftedTerm& term : other) {
    auto at = std::lower_bound(sum.begin(), sum.end(), term.joint,
                               [](const LiftedTerm& t, JointIndex joint) { return t.joint < joint; });
    if (at == sum.end() || at->joint != term.joint) at = sum.insert(at, LiftedTerm{term.joint, Vec3::Zero(), 0.0});
    at->moment += scale * term.moment;
    at->weight += scale * term.weight;
  }
}

/// Points with the same key are moved by the same affine map. Weights of cut points contain rounding errors, so
/// differences of 1e-12 are ignored.
using BoneKey = std::vector<std::pair<JointIndex, std::int64_t>>;

BoneKey boneKeyOf(const LiftedPoint& point) {
  BoneKey key;
  key.reserve(point.size());
  for (const LiftedTerm& t : point) key.emplace_back(t.joint, std::llround(t.weight * 1e12));
  return key;
}

/// Whether the point moves as a mesh vertex does, with one bind position for all its bones. A cut point between
/// vertices of different weights does not.
bool hasOneBindPosition(const LiftedPoint& point) {
  const Vec3 bind = bindPositionOf(point);
  return std::all_of(point.begin(), point.end(), [&](const LiftedTerm& t) {
    return (t.moment - t.weight * bind).norm() <= 1e-12 * (1.0 + bind.norm());
  });
}

}  // namespace

Vec3 bindPositionOf(const LiftedPoint& point) {
  Vec3 sum = Vec3::Zero();
  for (const LiftedTerm& t : point) sum += t.moment;
  return sum;
}

std::vector<LiftedPoint> liftPoints(const Character& character, const Decomposition& decomposition) {
  LORICA_CHECK(decomposition.vertexCount == countOf(character.mesh.vertices),
               "the decomposition must have been made from the character's mesh");
  std::vector<LiftedPoint> lifted;
  lifted.reserve(decomposition.pointCount());
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    LiftedPoint point;
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      const Influence& influence = character.influences[i];
      if (influence.weight == 0.0) continue;
      add(point, {{influence.joint, character.mesh.vertices[v], 1.0}}, influence.weight);
    }
    for (const ShapeOffset& shape : character.shapes.of(v)) {
      add(point, {{shape.joint, shape.offset, 0.0}}, 1.0);
      add(point, {{character.skeleton.joint(shape.joint).parent, shape.offset, 0.0}}, -1.0);
    }
    lifted.push_back(std::move(point));
  }
  for (const CutPoint& cut : decomposition.cutPoints) {
    LiftedPoint point;
    add(point, lifted[cut.first], cut.lambda);
    add(point, lifted[cut.second], 1.0 - cut.lambda);
    lifted.push_back(std::move(point));
  }
  return lifted;
}

Vec3 positionOf(const LiftedPoint& point, std::span<const Affine3> worldFromModel) {
  Vec3 sum = Vec3::Zero();
  for (const LiftedTerm& t : point) {
    const Affine3& bone = worldFromModel[t.joint];
    sum += bone.linear() * t.moment + t.weight * bone.translation();
  }
  return sum;
}

std::vector<PointIndex> hullCandidates(const Decomposition& decomposition, const Part& part,
                                       std::span<const LiftedPoint> lifted, std::span<const PointIndex> attached) {
  std::map<BoneKey, std::vector<PointIndex>> together;
  std::vector<PointIndex> candidates;
  std::vector<PointIndex> spanning = spanningPoints(decomposition, part);
  spanning.insert(spanning.end(), attached.begin(), attached.end());
  for (const PointIndex p : spanning) {
    const LiftedPoint& point = lifted[p];
    if (hasOneBindPosition(point)) {
      together[boneKeyOf(point)].push_back(p);
    } else {
      candidates.push_back(p);
    }
  }
  std::vector<Vec3> positions;
  for (const auto& [key, points] : together) {
    positions.clear();
    for (const PointIndex p : points) positions.push_back(bindPositionOf(lifted[p]));
    for (const VertexIndex i : convexHullOutline(positions).points) candidates.push_back(points[i]);
  }
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

}  // namespace lorica
