#include "player/parts_picture.h"

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

constexpr double kSize = 1.8;  // of the longest diagonal in the picture's world [m]

/// One mesh of all objects, moved onto the floor and scaled.
TriMesh joined(std::span<const NamedMesh> objects, std::vector<PartIndex>& partOfTriangle) {
  TriMesh all;
  Aabb box;
  for (const NamedMesh& object : objects) {
    const VertexIndex first = all.vertices.size();
    for (const Vec3& p : object.mesh.vertices) {
      all.vertices.push_back(p);
      box.extend(p);
    }
    for (const Triangle& t : object.mesh.triangles) {
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      partOfTriangle.push_back(&object - objects.data());
    }
  }
  const double scale = box.diagonal() > 0.0 ? kSize / box.diagonal() : 1.0;
  const Vec3 middle = 0.5 * (box.min + box.max);
  for (Vec3& p : all.vertices) p = scale * (p - Vec3(middle.x(), box.min.y(), middle.z()));
  return all;
}

}  // namespace

Image drawParts(std::span<const NamedMesh> parts, SnapshotCamera& camera) {
  std::vector<PartIndex> partOfTriangle;
  const TriMesh mesh = joined(parts, partOfTriangle);
  Scene scene;
  scene.vertices = mesh.vertices;
  scene.triangles = mesh.triangles;
  scene.partOfTriangle = partOfTriangle;
  SceneOptions show;
  show.hulls = false;
  double top = 0.0;
  for (const Vec3& p : mesh.vertices) top = std::max(top, p.y());
  Camera view;
  view.target = Vec3(0.0, 0.5 * top, 0.0);
  view.eye = view.target + Vec3(1.6, 1.1, 2.6);
  return camera.draw(scene, show, view);
}

}  // namespace lorica
