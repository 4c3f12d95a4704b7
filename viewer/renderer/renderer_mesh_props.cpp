#include "viewer/renderer/crease_mesh.h"
#include "viewer/renderer/renderer_impl.h"

#include <algorithm>

namespace lorica {

/// The GPU data of a shape, uploaded if it is new. Data of shapes that no longer exist is reused.
MeshPropGpu& Renderer::Impl::meshPropOf(const std::shared_ptr<const PropMeshShape>& shape) {
  for (MeshPropGpu& known : meshProps) {
    if (known.shape.lock() == shape) return known;
  }
  auto position =
      std::find_if(meshProps.begin(), meshProps.end(), [](const MeshPropGpu& known) { return known.shape.expired(); });
  const PropMesh mesh = makeCreasedMesh(shape->shown);
  if (position == meshProps.end()) {
    position = meshProps.emplace(meshProps.end());
    createPropShape(position->gpu, mesh);
  } else {
    fillPropShape(position->gpu, mesh);
  }
  position->shape = shape;
  return *position;
}

void Renderer::Impl::uploadMeshProps(std::span<const Prop> props, bool shown, const UnhiddenView& view) {
  for (MeshPropGpu& mesh : meshProps) mesh.gpu.instances.clear();
  if (!shown) return;
  for (const Prop& prop : props) {
    if (prop.shape != PropShape::kMesh || prop.mesh == nullptr || !prop.worldFromProp.matrix().allFinite()) continue;
    const Eigen::Matrix4f m = prop.worldFromProp.matrix().cast<float>();
    meshPropOf(prop.mesh).gpu.instances.push_back({m.col(0).head<3>(), m.col(1).head<3>(), m.col(2).head<3>(),
                                                   m.col(3).head<3>(), Vec3f::Ones(), 0.0f, prop.color,
                                                   view.opacityOf(prop)});
  }
  for (MeshPropGpu& mesh : meshProps) {
    if (!mesh.gpu.instances.empty()) gpu.upload(mesh.gpu.instanceBuffer, mesh.gpu.instances);
  }
}

}  // namespace lorica
