#include "tests/collision/world/mesh_props.h"

#include "geometry/mass_properties.h"
#include "tests/support/meshes.h"

#include <array>

namespace lorica::test {

Prop propOfBoxes(std::span<const Aabb> boxes) {
  Aabb all;
  for (const Aabb& box : boxes) {
    all.extend(box.min);
    all.extend(box.max);
  }
  auto shape = std::make_shared<PropMeshShape>();
  for (const Aabb& box : boxes) {
    const TriMesh mesh = makeBox(box.min - all.center(), box.max - all.center());
    shape->hulls.push_back(convexHull(mesh.vertices));
    shape->shown = joined(shape->shown, mesh);
  }
  shape->solid = massProperties(shape->shown.vertices, shape->shown.triangles);
  return meshProp(std::move(shape));
}

Prop propOfLShape(double side) {
  const double s = side;
  const std::array<Aabb, 2> boxes = {{{Vec3(0, 0, 0), Vec3(2 * s, s, s)}, {Vec3(0, s, 0), Vec3(s, 2 * s, s)}}};
  return propOfBoxes(boxes);
}

Prop propOfFrame(double inner, double width) {
  const double h = 0.5 * inner, o = h + width, y = 0.5 * width;
  const std::array<Aabb, 4> bars = {{{Vec3(-o, -y, -o), Vec3(o, y, -h)},
                                     {Vec3(-o, -y, h), Vec3(o, y, o)},
                                     {Vec3(-o, -y, -h), Vec3(-h, y, h)},
                                     {Vec3(h, -y, -h), Vec3(o, y, h)}}};
  return propOfBoxes(bars);
}

}  // namespace lorica::test
