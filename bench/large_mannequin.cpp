#include "bench/large_mannequin.h"

#include "skinning/mannequin/mannequin.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace lorica::bench {
namespace {

/// Appends the mean of some vertices, with the mean of their weights.
void addMean(Character& character, std::span<const VertexIndex> of) {
  Vec3 sum = Vec3::Zero();
  std::map<JointIndex, double> weights;
  const double share = 1.0 / static_cast<double>(of.size());
  for (const VertexIndex v : of) {
    sum += character.mesh.vertices[v];
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[static_cast<std::size_t>(v) + 1];
         ++i) {
      weights[character.influences[i].joint] += share * character.influences[i].weight;
    }
  }
  character.mesh.vertices.emplace_back(share * sum);
  for (const auto& [joint, weight] : weights) character.influences.push_back({joint, weight});
  character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
}

}  // namespace

Character largeMannequin(std::size_t triangleCount) {
  Character character = makeMannequin();
  std::vector<Triangle>& triangles = character.mesh.triangles;
  while (4 * triangles.size() <= triangleCount) {
    std::map<std::pair<VertexIndex, VertexIndex>, VertexIndex> middles;
    const auto middle = [&](VertexIndex a, VertexIndex b) {
      const auto [found, isNew] = middles.try_emplace(std::minmax(a, b), 0);
      if (isNew) {
        found->second = static_cast<VertexIndex>(character.mesh.vertices.size());
        addMean(character, std::array<VertexIndex, 2>{a, b});
      }
      return found->second;
    };
    std::vector<Triangle> finer;
    finer.reserve(4 * triangles.size());
    for (const Triangle& t : triangles) {
      const VertexIndex a = middle(t[0], t[1]);
      const VertexIndex b = middle(t[1], t[2]);
      const VertexIndex c = middle(t[2], t[0]);
      for (const Triangle& part :
           {Triangle{t[0], a, c}, Triangle{t[1], b, a}, Triangle{t[2], c, b}, Triangle{a, b, c}}) {
        finer.push_back(part);
      }
    }
    triangles = std::move(finer);
  }
  for (std::size_t i = 0; triangles.size() < triangleCount; ++i) {
    const Triangle t = triangles[i];
    const auto middle = static_cast<VertexIndex>(character.mesh.vertices.size());
    addMean(character, t);
    triangles[i] = {t[0], t[1], middle};
    triangles.push_back({t[1], t[2], middle});
    triangles.push_back({t[2], t[0], middle});
  }
  return character;
}

}  // namespace lorica::bench
