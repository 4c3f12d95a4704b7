/// Lorica and Jolt (jolt-physics).

/// The shape of settings, which are given back.
const made = (Jolt, settings, what) => {
  const result = settings.Create();
  if (result.HasError()) throw new Error(`Jolt makes no ${what}: ${result.GetError().c_str()}`);
  const shape = result.Get();
  shape.AddRef();
  Jolt.destroy(settings);
  return shape;
};

/// One hull as a shape of Jolt. @param positions  x y z of each vertex   @param count  of them, none = all
export function hullShape(Jolt, positions, count = positions.length / 3) {
  const settings = new Jolt.ConvexHullShapeSettings(), point = new Jolt.Vec3();
  settings.mMaxConvexRadius = 0;
  for (let v = 0; v < count; ++v) {
    point.Set(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    settings.mPoints.push_back(point);
  }
  Jolt.destroy(point);
  return made(Jolt, settings, 'hull');
}

/// The hulls of a decomposed mesh as one shape.
export function partsShape(Jolt, parts) {
  const settings = new Jolt.StaticCompoundShapeSettings();
  const still = new Jolt.Quat(0, 0, 0, 1), origin = new Jolt.Vec3(0, 0, 0);
  const shapes = parts.hulls.map(({ positions }) => hullShape(Jolt, positions));
  for (const shape of shapes) settings.AddShapeShape(origin, still, shape, 0);
  Jolt.destroy(still);
  Jolt.destroy(origin);
  const shape = made(Jolt, settings, 'compound');
  for (const part of shapes) part.Release();
  return shape;
}

/// Kinematic bodies of live hulls, one a part; call the returned `update` after each Live.update() and before the step.
export function followLive(Jolt, bodyInterface, live, layer) {
  const still = new Jolt.Quat(0, 0, 0, 1), origin = new Jolt.RVec3(0, 0, 0);
  const bodies = live.hulls.map(({ positions, vertexCount }) => {
    const shape = hullShape(Jolt, positions, vertexCount);
    const creation = new Jolt.BodyCreationSettings(shape, origin, still, Jolt.EMotionType_Kinematic, layer);
    const body = bodyInterface.CreateBody(creation);
    Jolt.destroy(creation);
    bodyInterface.AddBody(body.GetID(), Jolt.EActivation_Activate);
    shape.Release();
    return body;
  });
  const update = () => live.hulls.forEach(({ positions, vertexCount }, part) => {
    const shape = hullShape(Jolt, positions, vertexCount);
    bodyInterface.SetShape(bodies[part].GetID(), shape, false, Jolt.EActivation_Activate);
    // A shape lies about its own centre of mass: the body's place keeps the hull where it is.
    bodyInterface.SetPositionAndRotation(bodies[part].GetID(), origin, still, Jolt.EActivation_Activate);
    shape.Release();
  });
  return { bodies, update };
}
