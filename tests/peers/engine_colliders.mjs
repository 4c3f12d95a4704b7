// usage: node engine_colliders.mjs FILE.glb OUT.json
// What docs/samples/engines/three_colliders.mjs makes of a GLB: {"colliders", "low", "high"}: their number, and the lowest and
// highest corner in Rapier.
import fs from 'node:fs';
import RAPIER from '@dimforge/rapier3d-compat';
import { Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { addToRapier, takeColliders } from './three_colliders.mjs';

// Pictures are not needed, and Node has none.
globalThis.self = globalThis;
const loaded = (name, call) => name === 'load' && setTimeout(call);
globalThis.document = { createElementNS: () => ({ addEventListener: loaded, removeEventListener() {} }) };
globalThis.createImageBitmap = undefined;

const [file, out] = process.argv.slice(2);
const bytes = fs.readFileSync(file);
const { scene } = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
await RAPIER.init();
const world = new RAPIER.World({ x: 0, y: -9.81, z: 0 });
const follow = addToRapier(RAPIER, world, takeColliders(scene));
follow();
world.step();
const heights = [];
world.forEachCollider((collider) => {
  const points = collider.vertices();
  for (let i = 0; i < points.length; i += 3) {
    const corner = new Vector3(points[i], points[i + 1], points[i + 2]);
    heights.push(corner.applyQuaternion(collider.rotation()).y + collider.translation().y);
  }
});
fs.writeFileSync(out, JSON.stringify({ colliders: world.colliders.len(), low: Math.min(...heights), high: Math.max(...heights) }));
