/// Lorica and Rapier (@dimforge/rapier3d, rapier3d-compat).

/// A collider of a convex hull; null of a sliver: Rapier makes nothing of it, and then throws that this is no shape.
function addHull(RAPIER, world, points, body) {
  const shape = RAPIER.ColliderDesc.convexHull(Float32Array.from(points));
  try {
    return shape && world.createCollider(shape, body);
  } catch (error) {
    if (/expected instance/.test(error.message)) return null;
    throw error;
  }
}

/// The hulls of a decomposed mesh as the colliders of one body.
export function addParts(RAPIER, world, parts, description = RAPIER.RigidBodyDesc.dynamic()) {
  const body = world.createRigidBody(description);
  for (const { positions } of parts.hulls) addHull(RAPIER, world, positions, body);
  return body;
}

/// Kinematic bodies of live hulls; call the returned function after each Live.update() and before the world's step.
/// The hulls are made anew each frame, since they change shape. @return also `parts`: the part of each collider's handle
export function followLive(RAPIER, world, live) {
  const body = world.createRigidBody(RAPIER.RigidBodyDesc.kinematicPositionBased());
  const colliders = live.hulls.map(() => null), parts = new Map();
  const update = () => live.hulls.forEach(({ positions, vertexCount }, part) => {
    const made = addHull(RAPIER, world, positions.subarray(0, 3 * vertexCount), body);
    if (!made) return;  // the one of the frame before stays
    if (colliders[part]) {
      parts.delete(colliders[part].handle);
      world.removeCollider(colliders[part], false);
    }
    colliders[part] = made;
    parts.set(made.handle, part);
  });
  return { body, parts, update };
}
