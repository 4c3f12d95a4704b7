#include "collision/live/part_bones.h"

#include "acd/decomposition_file.h"
#include "acd/transfer.h"
#include "geometry/counts.h"

#include <algorithm>

namespace lorica {
namespace {

/// Computes weights of a part's mesh vertices by the area of the part's surface that they move.
/// @param points  in the bind pose [m]
/// @param weight  one per point, output [m^2]
void weighPoints(const Decomposition& decomposition, const Part& part, std::span<const Vec3> points,
                 std::span<double> weight) {
  std::fill(weight.begin(), weight.end(), 0.0);
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    if (part.sourceTriangle[i] < 0) continue;
    const Triangle& t = part.triangles[i];
    const double area = 0.5 * areaNormal(points, t).norm();
    for (const PointIndex p : t) weight[p] += area / 3.0;
  }
  // A cut point is a blend of two earlier points: distribute its weight to them, from the last cut point to the first.
  for (std::size_t i = decomposition.cutPoints.size(); i-- > 0;) {
    const CutPoint& cut = decomposition.cutPoints[i];
    const double own = weight[decomposition.vertexCount + i];
    weight[cut.first] += cut.lambda * own;
    weight[cut.second] += (1.0 - cut.lambda) * own;
  }
}

}  // namespace

std::vector<std::vector<JointShare>> jointsOfParts(const Decomposition& decomposition, const Character& character) {
  LORICA_CHECK(decomposition.vertexCount == countOf(character.mesh.vertices),
               "the decomposition must be of the character's mesh");
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, character.mesh.vertices, points);
  std::vector<double> weight(points.size());
  std::vector<std::vector<JointShare>> jointsOfPart;
  jointsOfPart.reserve(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    weighPoints(decomposition, part, points, weight);
    std::vector<double> moved(character.skeleton.jointCount(), 0.0);
    double all = 0.0;
    for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
      for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
        const double share = weight[v] * character.influences[i].weight;
        moved[character.influences[i].joint] += share;
        all += share;
      }
    }
    std::vector<JointShare> joints;
    for (std::size_t j = 0; j < moved.size(); ++j) {
      if (moved[j] > 0.0) joints.push_back({static_cast<JointIndex>(j), std::min(moved[j] / all, 1.0)});
    }
    std::stable_sort(joints.begin(), joints.end(),
                     [](const JointShare& a, const JointShare& b) { return a.share > b.share; });
    jointsOfPart.push_back(std::move(joints));
  }
  return jointsOfPart;
}

std::vector<std::vector<BoneShare>> bonesOfParts(const Decomposition& decomposition, const Character& character) {
  std::vector<std::vector<BoneShare>> bonesOfPart;
  bonesOfPart.reserve(decomposition.parts.size());
  for (const std::vector<JointShare>& joints : jointsOfParts(decomposition, character)) {
    std::vector<BoneShare>& bones = bonesOfPart.emplace_back();
    bones.reserve(joints.size());
    for (const JointShare& j : joints) bones.push_back({character.skeleton.joint(j.joint).name, j.share});
  }
  return bonesOfPart;
}

}  // namespace lorica
