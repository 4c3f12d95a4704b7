// Colliders of the hulls of `lorica export hero.fbx hero.glb`, for three.js and Rapier.

/// Hides the hulls of a scene that GLTFLoader has read. Returns for each hull its name, the bone that moves it and its
/// points in the bone's frame, x y z x y z ..., for any engine that takes convex hulls.
export function takeColliders(scene) {
  const hulls = [];
  scene.traverse((node) => {
    if (node.isMesh && node.material.name === 'lorica_collider') hulls.push(node);
  });
  return hulls.map((node) => {
    node.visible = false;
    return { name: node.name, bone: node.parent, points: Float32Array.from(node.geometry.attributes.position.array) };
  });
}

/// Kinematic bodies of Rapier. Call the returned function before each step of the world. Bones must not be scaled.
export function addToRapier(RAPIER, world, colliders) {
  const bodies = colliders.map(({ bone, points }) => {
    const body = world.createRigidBody(RAPIER.RigidBodyDesc.kinematicPositionBased());
    const shape = RAPIER.ColliderDesc.convexHull(points);
    if (shape === null) throw new Error(`${bone.name}: Rapier makes no hull of these points`);
    world.createCollider(shape, body);
    return { body, bone };
  });
  return () => {
    for (const { body, bone } of bodies) {
      bone.updateWorldMatrix(true, false);
      const place = bone.matrixWorld.clone();
      const position = bone.position.clone(), turn = bone.quaternion.clone(), size = bone.scale.clone();
      place.decompose(position, turn, size);
      body.setNextKinematicTranslation(position);
      body.setNextKinematicRotation(turn);
    }
  };
}
