#include "skinning/body/weld.h"

#include "geometry/counts.h"
#include "geometry/near_positions.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kSamePosition = 1e-6;  // of the diagonal
constexpr double kSameWeights = 1e-3;   // sum of differences

/// One entry per joint, ascending, without zero weights, normalised to a sum of 1.
std::vector<Influence> tidied(std::vector<Influence> influences) {
  std::sort(influences.begin(), influences.end(),
            [](const Influence& a, const Influence& b) { return a.joint < b.joint; });
  std::vector<Influence> result;
  double sum = 0.0;
  for (const Influence& influence : influences) {
    if (influence.weight <= 0.0) continue;
    sum += influence.weight;
    if (!result.empty() && result.back().joint == influence.joint) {
      result.back().weight += influence.weight;
    } else {
      result.push_back(influence);
    }
  }
  for (Influence& influence : result) influence.weight /= sum;
  return result;
}

double difference(const std::vector<Influence>& a, const std::vector<Influence>& b) {
  double sum = 0.0;
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() || j != b.end()) {
    if (j == b.end() || (i != a.end() && i->joint < j->joint)) {
      sum += (i++)->weight;
    } else if (i == a.end() || j->joint < i->joint) {
      sum += (j++)->weight;
    } else {
      sum += std::abs((i++)->weight - (j++)->weight);
    }
  }
  return sum;
}

}  // namespace

std::vector<Influence> blended(std::span<const std::vector<Influence>* const> lists, std::span<const double> shares) {
  std::vector<Influence> all;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    for (const Influence& influence : *lists[i]) all.push_back({influence.joint, shares[i] * influence.weight});
  }
  return tidied(std::move(all));
}

Welded weld(const Character& character, const Limbs& limbs) {
  Welded welded;
  const std::span<const Vec3> vertices = character.mesh.vertices;
  const std::vector<bool> used = usedVertices(vertices.size(), character.mesh.triangles);
  const Aabb box = surfaceBounds(character.mesh);
  NearPositions positions(kSamePosition * box.diagonal(), box.min);
  const auto jointOf = [&](VertexIndex v) {
    const std::size_t i = v;
    const std::uint32_t begin = character.influenceBegin[i];
    return strongest(std::span(character.influences).subspan(begin, character.influenceBegin[i + 1] - begin));
  };
  std::vector<VertexIndex> numberOf(vertices.size(), -1);
  std::vector<std::vector<VertexIndex>> members;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (!used[v]) {
      ++welded.unusedVertices;
      continue;
    }
    const VertexIndex own = v;
    const JointIndex joint = jointOf(own);
    const VertexIndex first = positions.firstAt(own, vertices, [&](VertexIndex kept) {
      return limbs.onOneBranch(jointOf(kept), joint) || !limbs.apart(jointOf(kept), joint, vertices[v]);
    });
    if (first == own) {
      numberOf[v] = countOf(welded.mesh.vertices);
      welded.mesh.vertices.push_back(vertices[v]);
      members.emplace_back();
    } else {
      numberOf[v] = numberOf[first];
      ++welded.weldedVertices;
    }
    members[numberOf[v]].push_back(own);
  }

  welded.influences.reserve(members.size());
  for (const std::vector<VertexIndex>& group : members) {
    std::vector<std::vector<Influence>> lists;
    lists.reserve(group.size());
    bool mixed = false;
    for (const VertexIndex v : group) {
      const auto begin = character.influences.begin() + character.influenceBegin[v];
      const auto end = character.influences.begin() + character.influenceBegin[v + 1];
      lists.push_back(tidied({begin, end}));
      mixed = mixed || difference(lists.front(), lists.back()) > kSameWeights;
    }
    if (!mixed) {
      welded.influences.push_back(std::move(lists.front()));
      continue;
    }
    ++welded.mixedVertices;
    std::vector<const std::vector<Influence>*> pointers;
    pointers.reserve(lists.size());
    for (const std::vector<Influence>& list : lists) pointers.push_back(&list);
    const std::vector<double> shares(lists.size(), 1.0 / lists.size());
    welded.influences.push_back(blended(pointers, shares));
  }

  welded.mesh.triangles.reserve(character.mesh.triangles.size());
  for (const Triangle& old : character.mesh.triangles) {
    Triangle t{};
    for (std::size_t i = 0; i < 3; ++i) t[i] = numberOf[old[i]];
    if (hasRepeatedCorner(t)) {
      ++welded.droppedTriangles;
    } else {
      welded.mesh.triangles.push_back(t);
    }
  }
  return welded;
}

}  // namespace lorica
