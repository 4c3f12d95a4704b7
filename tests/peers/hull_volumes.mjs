// usage: node hull_volumes.mjs FILE.obj OUT.json
// Volumes of the hulls that Rapier and Jolt build from the vertices of each object: {name: {"rapier", "jolt"}}.
import fs from 'node:fs';
import RAPIER from '@dimforge/rapier3d-compat';
import loadJolt from 'jolt-physics';

const [file, out] = process.argv.slice(2);
const objects = {};
let object;
for (const line of fs.readFileSync(file, 'utf8').split('\n')) {
  const words = line.split(' ');
  if (words[0] === 'o') object = objects[words[1]] = [];
  if (words[0] === 'v') object.push(words.slice(1).map(Number));
}

const Jolt = await loadJolt();
// Its default tolerance of 1 mm drops vertices of thin hulls; with a small one it refuses some hulls with nearly flat faces.
function joltVolume(points) {
  for (const tolerance of [1e-6, 1e-5, 1e-4]) {
    const settings = new Jolt.ConvexHullShapeSettings();
    settings.mHullTolerance = tolerance;
    for (const [x, y, z] of points) settings.mPoints.push_back(new Jolt.Vec3(x, y, z));
    const result = settings.Create();
    if (!result.HasError()) return result.Get().GetVolume();
  }
  throw new Error('Jolt builds no hull');
}

await RAPIER.init();
const world = new RAPIER.World({ x: 0, y: 0, z: 0 });
function rapierVolume(points) {
  return world.createCollider(RAPIER.ColliderDesc.convexHull(new Float32Array(points.flat()))).volume();
}

const found = {};
for (const [name, points] of Object.entries(objects)) {
  found[name] = { rapier: rapierVolume(points), jolt: joltVolume(points) };
}
fs.writeFileSync(out, JSON.stringify(found));
