/// Lorica and cannon-es.

/// One hull as a shape of cannon. @param hull  of Parts.hulls or Live.hulls
export function hullShape(CANNON, { positions, indices, vertexCount = positions.length / 3,
  triangleCount = indices.length / 3 }) {
  const vertices = Array.from({ length: vertexCount }, (_, v) => new CANNON.Vec3(...positions.subarray(3 * v, 3 * v + 3)));
  const faces = Array.from({ length: triangleCount }, (_, t) => [...indices.subarray(3 * t, 3 * t + 3)]);
  return new CANNON.ConvexPolyhedron({ vertices, faces });
}

/// The hulls of a decomposed mesh as one body, whose mass is at the hulls' centre.
export function addParts(CANNON, world, parts, mass = 1) {
  const { hulls } = parts;
  const centre = new CANNON.Vec3(), volume = hulls.reduce((sum, hull) => sum + hull.volume, 0);
  for (const { positions, volume: own } of hulls) {
    for (let i = 0; i < positions.length; ++i) centre['xyz'[i % 3]] += positions[i] * 3 / positions.length * own / volume;
  }
  const body = new CANNON.Body({ mass, position: centre });
  for (const hull of hulls) body.addShape(hullShape(CANNON, hull), centre.scale(-1));
  world.addBody(body);
  return body;
}

/// A kinematic body of live hulls; call the returned `update` after each Live.update() and before the world's step.
export function followLive(CANNON, world, live) {
  const body = new CANNON.Body({ type: CANNON.Body.KINEMATIC });
  world.addBody(body);
  const update = () => {
    for (const shape of [...body.shapes]) body.removeShape(shape);
    for (const hull of live.hulls) body.addShape(hullShape(CANNON, hull));
    body.aabbNeedsUpdate = true;
  };
  return { body, update };
}
