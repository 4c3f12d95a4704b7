#include "tests/session/prepare/vessels.h"

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "geometry/counts.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

namespace lorica::test {

TriMesh revolved(const std::vector<std::pair<double, double>>& profile, int segments) {
  TriMesh mesh;
  std::vector<std::vector<VertexIndex>> rings;
  for (const auto& [radius, y] : profile) {
    std::vector<VertexIndex>& ring = rings.emplace_back();
    for (int s = 0; s < segments; ++s) {
      if (s == 0 || radius > 0.0) {
        const double angle = 2.0 * std::numbers::pi * s / segments;
        mesh.vertices.emplace_back(radius * std::cos(angle), y, radius * std::sin(angle));
      }
      ring.push_back(countOf(mesh.vertices) - 1);
    }
  }
  for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
    for (int s = 0; s < segments; ++s) {
      const int next = (s + 1) % segments;
      const VertexIndex a = rings[r][s], b = rings[r][next], c = rings[r + 1][next], d = rings[r + 1][s];
      if (a != b) mesh.triangles.push_back({a, b, c});
      if (c != d) mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

TriMesh makeBowl() {
  return revolved({{0, 0}, {0.6, 0}, {1.0, 0.7}}, 24);
}

TriMesh openBox(double size) {
  TriMesh box = makeBox(Vec3::Constant(-size), Vec3::Constant(size));
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return box.vertices[t[0]].y() > 0.0 && box.vertices[t[1]].y() > 0.0 && box.vertices[t[2]].y() > 0.0;
  });
  return box;
}

WallBody wallsOf(const TriMesh& mesh, const CharacterOptions& options) {
  std::optional<WallBody> body = valueOf(makeWalls(mesh, options, {}));
  if (!body) throw std::runtime_error("the test needs walls");
  return std::move(*body);
}

std::vector<ConvexHull> hullsOf(const TriMesh& mesh, int parts) {
  DecomposeSettings settings;
  settings.maxParts = parts;
  const Decomposition made = valueOf(decompose(mesh, {mesh.vertices, countOf(mesh.vertices)}, settings));
  std::vector<ConvexHull> hulls;
  std::vector<Vec3> points(made.pointCount());
  transfer(made, mesh.vertices, points);
  for (const Part& part : made.parts) {
    std::vector<Vec3> own;
    for (const PointIndex p : part.points) own.push_back(points[p]);
    hulls.push_back(convexHull(own));
  }
  return hulls;
}

}  // namespace lorica::test
