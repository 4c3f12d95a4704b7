/// Lorica and Rapier (@dimforge/rapier3d, rapier3d-compat).

/// The hulls of a decomposed mesh as the colliders of one body.
export function addParts(RAPIER, world, parts, description = RAPIER.RigidBodyDesc.dynamic()) {
  const body = world.createRigidBody(description);
  for (const { positions } of parts.hulls) {
    const shape = RAPIER.ColliderDesc.convexHull(Float32Array.from(positions));
    if (shape) world.createCollider(shape, body);
  }
  return body;
}

/// Kinematic bodies of live hulls; call the returned function after each Live.update() and before the world's step.
/// The hulls are made anew each frame, since they change shape. @return also `parts`: the part of each collider's handle
export function followLive(RAPIER, world, live) {
  const body = world.createRigidBody(RAPIER.RigidBodyDesc.kinematicPositionBased());
  const colliders = live.hulls.map(() => null), parts = new Map();
  const update = () => live.hulls.forEach(({ positions, vertexCount }, part) => {
    if (colliders[part]) {
      parts.delete(colliders[part].handle);
      world.removeCollider(colliders[part], false);
    }
    const shape = RAPIER.ColliderDesc.convexHull(Float32Array.from(positions.subarray(0, 3 * vertexCount)));
    colliders[part] = shape ? world.createCollider(shape, body) : null;
    if (shape) parts.set(colliders[part].handle, part);
  });
  return { body, parts, update };
}
