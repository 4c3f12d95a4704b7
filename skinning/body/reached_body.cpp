#include "geometry/convex_hull.h"
#include "geometry/triangle_tree.h"
#include "skinning/body/closed_body.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

namespace lorica {

namespace {

constexpr double kInside = 0.5;  // winding number

/// The joint that moves a vertex most.
JointIndex strongestJoint(const Character& character, std::size_t vertex) {
  const auto begin = character.influences.begin() + character.influenceBegin[vertex];
  const auto end = character.influences.begin() + character.influenceBegin[vertex + 1];
  return std::max_element(begin, end, [](const Influence& a, const Influence& b) { return a.weight < b.weight; })
      ->joint;
}

/// The hulls of the vertices that each joint moves most.
std::map<JointIndex, ConvexHull> hullsOfJoints(const Character& character) {
  std::map<JointIndex, std::vector<Vec3>> points;
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    points[strongestJoint(character, v)].push_back(character.mesh.vertices[v]);
  }
  std::map<JointIndex, ConvexHull> hulls;
  for (const auto& [joint, own] : points) hulls[joint] = convexHull(own);
  return hulls;
}

}  // namespace

int coverReached(ClosedBody& body, const Character& character, std::span<const ReachedPosition> reached) {
  if (reached.empty()) return 0;

  // 1. How far each position is outside of what holds it anyway.
  Character& made = body.character;
  const TriangleTree tree(made.mesh.vertices, made.mesh.triangles);
  const std::map<JointIndex, ConvexHull> hulls = hullsOfJoints(made);
  std::vector<double> outside(reached.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, reached.size(), [&](std::size_t i) {
    const Vec3& p = reached[i].position;
    const auto hull = hulls.find(strongestJoint(character, reached[i].vertex));
    const bool solid = hull != hulls.end() && !hull->second.degenerate();
    const double ofHull = solid ? largestViolation(hull->second, std::span(&p, 1)) : kInfinity;
    if (ofHull < kReachTolerance || tree.windingNumber(p) >= kInside) return;
    outside[i] = std::min(ofHull, tree.nearest(p).distance);
  });

  // 2. Those that are far enough become vertices.
  int added = 0;
  double farthest = 0.0;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (outside[i] < kReachTolerance) continue;
    const std::size_t v = reached[i].vertex;
    made.mesh.vertices.push_back(reached[i].position);
    made.influences.insert(made.influences.end(), character.influences.begin() + character.influenceBegin[v],
                           character.influences.begin() + character.influenceBegin[v + 1]);
    made.influenceBegin.push_back(made.influences.size());
    farthest = std::max(farthest, outside[i]);
    ++added;
  }
  body.reachedVertices += added;
  if (added > 0) {
    body.notes.push_back(
        fmt::format("the hulls hold morph targets at their largest weights: {} positions up to {:.0f} mm outside the "
                    "body were added",
                    added, 1000.0 * farthest));
  }
  return added;
}

}  // namespace lorica
