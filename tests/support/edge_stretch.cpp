#include "tests/support/edge_stretch.h"

#include <algorithm>
#include <utility>

namespace lorica::test {

EdgeStretch::EdgeStretch(const Character& character) : height_(character.height) {
  std::vector<std::pair<VertexIndex, VertexIndex>> ends;
  for (const Triangle& t : character.shown.empty() ? character.mesh.triangles : character.shown) {
    for (std::size_t k = 0; k < 3; ++k) ends.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const std::vector<Vec3>& bind = character.mesh.vertices;
  for (const auto& [a, b] : ends) edges_.push_back({a, b, (bind[a] - bind[b]).norm()});
}

EdgeStretch::Worst EdgeStretch::in(std::span<const Vec3> posed) const {
  constexpr double kShort = 0.08;  // of the height
  Worst worst;
  for (const Edge& edge : edges_) {
    const double growth = (posed[edge.a] - posed[edge.b]).norm() - edge.length;
    const double stretch = growth / std::max(edge.length, kShort * height_);
    if (stretch > worst.stretch) worst = {stretch, edge.a, edge.b};
  }
  return worst;
}

JointIndex mainJoint(const Character& character, VertexIndex vertex) {
  const auto first = character.influences.begin() + character.influenceBegin[vertex];
  const auto last = character.influences.begin() + character.influenceBegin[vertex + 1];
  return std::max_element(first, last, [](const Influence& a, const Influence& b) { return a.weight < b.weight; })
      ->joint;
}

}  // namespace lorica::test
