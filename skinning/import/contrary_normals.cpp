#include "skinning/import/character_parts.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace lorica {

namespace {

constexpr double kShare = 0.1;    ///< of the area
constexpr double kCrease = 0.5;   ///< cosine of the sharpest angle that is drawn smooth
constexpr double kAgainst = 0.1;  ///< sine by which normals are behind their triangle

/// A number for each position, from 0 on, the same for vertices at the same position; -1 for those of no triangle.
[[nodiscard]] std::vector<int> positionsOf(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  std::vector<VertexIndex> used;
  used.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
  const auto key = [&](VertexIndex v) { return std::tie(vertices[v].x(), vertices[v].y(), vertices[v].z()); };
  std::sort(used.begin(), used.end(), [&](VertexIndex a, VertexIndex b) { return key(a) < key(b); });
  std::vector<int> positions(vertices.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (i > 0 && key(used[i]) != key(used[i - 1])) ++count;
    positions[used[i]] = count;
  }
  return positions;
}

/// Edges at which both triangles run the same way, so that one of them is inside out.
/// @param turned  per triangle, whether it is taken the other way round
[[nodiscard]] std::size_t disagreements(std::span<const Triangle> triangles, std::span<const int> positions,
                                        const std::vector<char>& turned) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int a = positions[triangles[t][i]];
      const int b = positions[triangles[t][(i + 1) % 3]];
      if (a != b) edges.push_back(turned[t] != 0 ? std::pair(b, a) : std::pair(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t count = 0;
  for (std::size_t i = 1; i < edges.size(); ++i) count += edges[i] == edges[i - 1] ? 1 : 0;
  return count;
}

/// @return whether any normal was replaced; that of a vertex whose triangles face both ways is not
[[nodiscard]] bool replaceNormals(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                  std::span<const int> positions, std::span<Vec3f> normals) {
  std::vector<Vec3> own(vertices.size(), Vec3::Zero());
  std::vector<double> sizes(vertices.size(), 0.0);
  for (const Triangle& t : triangles) {
    const Vec3 area = areaNormal(vertices, t);
    for (const VertexIndex v : t) {
      own[v] += area;
      sizes[v] += area.norm();
    }
  }
  std::vector<VertexIndex> byPosition;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (positions[v] != -1 && own[v].norm() > 0.01 * sizes[v]) byPosition.push_back(v);
  }
  std::stable_sort(byPosition.begin(), byPosition.end(),
                   [&](VertexIndex a, VertexIndex b) { return positions[a] < positions[b]; });
  for (std::size_t begin = 0, end = 0; begin < byPosition.size(); begin = end) {
    while (end < byPosition.size() && positions[byPosition[end]] == positions[byPosition[begin]]) ++end;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 direction = own[byPosition[i]].stableNormalized();
      Vec3 sum = own[byPosition[i]];
      // At most so many that one position with thousands of vertices does not take their square.
      for (std::size_t j = begin; j < std::min(end, begin + 256); ++j) {
        const Vec3& other = own[byPosition[j]];
        if (i != j && other.stableNormalized().dot(direction) >= kCrease) sum += other;
      }
      normals[byPosition[i]] = sum.stableNormalized().cast<float>();
    }
  }
  return !byPosition.empty();
}

}  // namespace

ContraryNormals mendContraryNormals(std::span<const Vec3> vertices, std::span<Triangle> triangles,
                                    std::span<Vec3f> normals) {
  std::vector<char> contrary(triangles.size(), 0);
  double area = 0.0, contraryArea = 0.0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vec3 face = areaNormal(vertices, triangles[t]);
    const double size = face.norm();
    const bool away = std::all_of(triangles[t].begin(), triangles[t].end(), [&](VertexIndex v) {
      return face.dot(normals[v].cast<double>()) < -kAgainst * size;
    });
    area += size;
    if (!away) continue;
    contrary[t] = 1;
    contraryArea += size;
  }
  if (!(contraryArea > kShare * area)) return ContraryNormals::kNone;

  const std::vector<int> positions = positionsOf(vertices, triangles);
  const std::vector<char> unturned(triangles.size(), 0);
  if (disagreements(triangles, positions, contrary) < disagreements(triangles, positions, unturned)) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (contrary[t] != 0) std::swap(triangles[t][1], triangles[t][2]);
    }
    return ContraryNormals::kTrianglesTurned;
  }
  return replaceNormals(vertices, triangles, positions, normals) ? ContraryNormals::kNormalsReplaced
                                                                 : ContraryNormals::kNone;
}

}  // namespace lorica
