#include "export/robots/rest_contacts.h"

#include "acd/separating_plane.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <set>

namespace lorica {
namespace {

constexpr int kMostNear = 20'000;                   // pairs of geoms whose boxes overlap
constexpr std::size_t kMostTriangles = 50'000'000;  // of all pairs of meshes that are compared

TriMesh placed(const TriMesh& mesh, const Isometry3& pose) {
  TriMesh moved = mesh;
  for (Vec3& p : moved.vertices) p = pose * p;
  return moved;
}

bool touch(std::span<const TriMesh> a, std::span<const TriMesh> b) {
  for (const TriMesh& first : a) {
    const Aabb box = boundsOf(first.vertices);
    for (const TriMesh& second : b) {
      if (overlap(box, boundsOf(second.vertices)) && !separatingPlane(first.vertices, second.vertices)) return true;
    }
  }
  return false;
}

/// Whether two surfaces meet, or one is inside the other.
bool meet(const TriMesh& a, const TriMesh& b) {
  const TriangleTree tree(b.vertices, b.triangles);
  const TriangleTree other(a.vertices, a.triangles);
  if (tree.windingNumber(a.vertices[a.triangles[0][0]]) > 0.5) return true;
  if (other.windingNumber(b.vertices[b.triangles[0][0]]) > 0.5) return true;
  const Aabb box = boundsOf(b.vertices);
  for (const Triangle& t : a.triangles) {
    const std::array<Vec3, 3> corners{a.vertices[t[0]], a.vertices[t[1]], a.vertices[t[2]]};
    if (!overlap(boundsOf(corners), box)) continue;
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    double radius = 0.0;
    for (const Vec3& p : corners) radius = std::max(radius, (p - middle).norm());
    bool found = false;
    tree.forEachWithin(middle, radius, [&](std::int32_t i, double) {
      if (found) return;
      const Triangle& s = b.triangles[i];
      const std::array<Vec3, 3> theirs{b.vertices[s[0]], b.vertices[s[1]], b.vertices[s[2]]};
      found = !separatingPlane(corners, theirs);
    });
    if (found) return true;
  }
  return false;
}

}  // namespace

NewContacts newContacts(const RobotFile& robot, std::span<const GeomShapes> geoms) {
  std::vector<Isometry3> poses;
  std::vector<Aabb> boxes;
  for (std::size_t g = 0; g < robot.geoms.size(); ++g) {
    const RobotGeom& geom = robot.geoms[g];
    poses.push_back(robot.links[geom.link].worldFromLink * geom.linkFromParent * geom.parentFromGeom);
    boxes.emplace_back();
    for (const TriMesh& shape : *geoms[g].shapes) {
      for (const Vec3& p : shape.vertices) boxes.back().extend(poses.back() * p);
    }
  }
  const auto shapesOf = [&](std::size_t g) {
    std::vector<TriMesh> there;
    for (const TriMesh& shape : *geoms[g].shapes) there.push_back(placed(shape, poses[g]));
    return there;
  };
  const auto weldOf = [&](int link) { return robot.links[link].weld; };
  const auto hangsOn = [&](int a, int b) {
    const int parent = robot.links[weldOf(a)].parent;
    return parent >= 0 && weldOf(parent) == weldOf(b);
  };
  NewContacts found;
  std::set<std::pair<int, int>> touching, meeting;
  int near = 0;
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < robot.geoms.size() && found.all; ++i) {
    for (std::size_t j = i + 1; j < robot.geoms.size() && found.all; ++j) {
      const RobotGeom& a = robot.geoms[i];
      const RobotGeom& b = robot.geoms[j];
      const std::pair<int, int> pair = std::minmax(a.link, b.link);
      if (weldOf(a.link) == weldOf(b.link) || hangsOn(a.link, b.link) || hangsOn(b.link, a.link)) continue;
      if ((a.contype & b.conaffinity) == 0 && (b.contype & a.conaffinity) == 0) continue;
      if (robot.excluded.contains(pair) || meeting.contains(pair) || !overlap(boxes[i], boxes[j])) continue;
      found.all = ++near <= kMostNear && triangles <= kMostTriangles;
      if (!found.all || !touch(shapesOf(i), shapesOf(j))) continue;
      touching.insert(pair);
      triangles += geoms[i].surface->triangles.size() + geoms[j].surface->triangles.size();
      if (meet(placed(*geoms[i].surface, poses[i]), placed(*geoms[j].surface, poses[j]))) meeting.insert(pair);
    }
  }
  std::ranges::set_difference(touching, meeting, std::back_inserter(found.links));
  return found;
}

}  // namespace lorica
