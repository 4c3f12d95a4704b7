/// The npm package `lorica`, installed into a folder as a user does it, beside the real three, Rapier, Jolt and cannon-es.
/// usage: HASHES=<what tests/consumer/core/interface.c printed> node --test package_test.mjs
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { load, LoricaError } from 'lorica';
import { startWorker } from 'lorica/worker';
import * as adapt from 'lorica/three';
import * as rapier from 'lorica/rapier';
import * as jolt from 'lorica/jolt';
import * as cannon from 'lorica/cannon';
import { fnv, hex, makeTube, poseAt } from './tube.mjs';

const expected = Object.fromEntries(fs.readFileSync(process.env.HASHES, 'utf8').trim().split('\n').map((l) => l.split(' ')));
const lorica = await load();
const tube = makeTube();

test('parts, hulls and their file have the hashes of the C interface', () => {
  const calls = [];
  const parts = lorica.decompose(tube.positions, tube.indices, { parts: 6, onProgress: (done) => { calls.push(done); } });
  assert.equal(parts.hash, expected.parts);
  let hash;
  for (const hull of parts.hulls) hash = fnv(hull.indices, fnv(hull.positions, hash));
  assert.equal(hex(hash), expected.hulls);
  assert.ok(calls.length > 0 && parts.error > 0 && parts.repaired === '' && parts.warning === '');
  const again = lorica.openParts(parts.bytes(), tube.positions, tube.indices);
  assert.equal(again.hash, expected.parts);
  const flat = lorica.decompose(tube.positions, tube.indices, { parts: 6, hullPlanes: 8 });
  assert.ok(flat.hulls.every((hull) => hull.positions.length <= 3 * 12));  // three planes in each corner
  parts.free();
  assert.throws(() => parts.hulls, /freed/);
  again.free();
});

test('live hulls and rays have the hashes of the C interface', () => {
  const body = lorica.makeBody(tube, { parts: 5 });
  assert.equal(body.partCount, 5);
  const bytes = body.bytes();
  assert.equal(hex(fnv(bytes)), expected.body);
  const live = lorica.openBody(bytes, tube).live();
  let hulls, rays;
  for (let f = 0; f < 50; ++f) {
    live.update(poseAt(0.007 * f));
    for (const { positions, vertexCount, indices, triangleCount } of live.hulls) {
      hulls = fnv(indices.subarray(0, 3 * triangleCount), fnv(positions.subarray(0, 3 * vertexCount), hulls));
    }
    const hit = live.castRay([0.02 * f - 0.4, 5, 0.05 * f], [0.01, -1, 0.02]);
    rays = fnv(Float64Array.of(hit.distance), fnv(Int32Array.of(hit.part), rays));
    if (hit.part >= 0) rays = fnv(hit.position, rays);
  }
  assert.equal(hex(hulls), expected.live);
  assert.equal(hex(rays), expected.rays);
});

test('a frame makes no new views', () => {
  const live = lorica.makeBody(tube, { parts: 3 }).live();
  for (let f = 0; f < 60; ++f) live.update(poseAt(0.007 * f));
  const before = live.hulls.map(({ positions, indices }) => [positions, indices]);
  for (let f = 0; f < 60; ++f) live.update(poseAt(0.007 * f));
  live.hulls.forEach(({ positions, indices }, p) => assert.ok(positions === before[p][0] && indices === before[p][1]));
});

test('bad input is a sentence, and the next call works', () => {
  const refused = [
    [() => lorica.decompose([0, 0], tube.indices), 'invalid argument', /multiples of 3/],
    [() => lorica.decompose([0, 0, NaN, 1, 0, 0, 0, 1, 0], [0, 1, 2]), 'bad mesh', /vertex 0: z is nan/],
    [() => lorica.decompose(tube.positions, [0, 1, 9999]), 'bad mesh', /triangle 0: found vertex 9999/],
    [() => lorica.decompose(tube.positions, tube.indices, { preset: 'best' }), 'invalid argument', /preset: found "best"/],
    [() => lorica.decompose(tube.positions, tube.indices, { parts: '6' }), 'invalid argument', /parts: found "6"/],
    [() => lorica.decompose(tube.positions, tube.indices, { onProgress: () => false }), 'cancelled', /cancelled/],
    [() => lorica.openParts(new Uint8Array(100), tube.positions, tube.indices), 'bad format', /bytes/],
    [() => lorica.makeBody({ ...tube, weights: tube.weights.slice(4) }), 'invalid argument', /weights: found/],
    [() => lorica.makeBody({ ...tube, indices: tube.indices.slice(0, 900) }), 'unsupported', /OpenVDB/],
    [() => lorica.makeBody(tube).live().update([1, 2, 3]), 'invalid argument', /found 3 numbers/],
  ];
  for (const [call, kind, sentence] of refused) {
    assert.throws(call, (error) => error instanceof LoricaError && error.kind === kind && sentence.test(error.message),
      call.toString());
  }
  assert.throws(() => lorica.decompose(tube.positions, tube.indices, { onProgress: () => { throw new Error('mine'); } }), /mine/);
  assert.equal(lorica.decompose(tube.positions, tube.indices, { parts: 6 }).hash, expected.parts);
  const shell = lorica.makeBody({ ...tube, indices: tube.indices.slice(0, 900) }, { walls: 'shell', parts: 4 });
  assert.ok(shell.partCount <= 4);
});

test('beside the page: progress, the same parts, and cancelling', async () => {
  const worker = startWorker(), calls = [];
  const made = await worker.decompose(tube.positions, tube.indices, { parts: 6, onProgress: (done) => calls.push(done) });
  assert.equal(made.hash, expected.parts);
  assert.ok(calls.length > 0 && made.hulls.length === 6);
  const body = await worker.makeBody(tube, { parts: 5 });
  assert.equal(hex(fnv(body.bytes)), expected.body);
  const stop = new AbortController();
  const cancelled = worker.decompose(tube.positions, tube.indices, { concavity: 0.001, signal: stop.signal,
    onProgress: () => stop.abort() });
  await assert.rejects(cancelled, (error) => error.kind === 'cancelled');
  await assert.rejects(worker.decompose([0], []), (error) => error.kind === 'invalid argument');
});

test('npx lorica decompose', () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'lorica-'));
  const obj = path.join(folder, 'tube.obj'), out = path.join(folder, 'hulls.obj');
  const lines = [];
  for (let v = 0; v < tube.positions.length; v += 3) lines.push(`v ${tube.positions.slice(v, v + 3).join(' ')}`);
  for (let t = 0; t < tube.indices.length; t += 3) lines.push(`f ${tube.indices.slice(t, t + 3).map((i) => i + 1).join(' ')}`);
  fs.writeFileSync(obj, lines.join('\n'));
  const run = (...words) => execFileSync('npx', ['lorica', ...words],
    { cwd: path.dirname(fileURLToPath(import.meta.url)), encoding: 'utf8', stdio: 'pipe' });
  assert.match(run('decompose', obj, '--parts', '6', '-o', out), new RegExp(`6 hulls, .* hash ${expected.parts}`));
  assert.equal(fs.readFileSync(out, 'utf8').match(/^o part_/gm).length, 6);
  assert.throws(() => run('decompose', obj, '--part', '6', '-o', out), /expected one of --parts/);
  assert.throws(() => run('decompose', path.join(folder, 'none.obj'), '-o', out), /none\.obj/);
  fs.rmSync(folder, { recursive: true });
});

test('three: a skinned mesh, its bones, and the lines of its hulls', async () => {
  const THREE = await import('three');
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(tube.positions), 3));
  geometry.setAttribute('skinIndex', new THREE.BufferAttribute(Uint16Array.from(tube.joints), 4));
  geometry.setAttribute('skinWeight', new THREE.BufferAttribute(Float32Array.from(tube.weights), 4));
  geometry.setIndex(tube.indices);
  const bones = [0, 1, 2].map((j) => Object.assign(new THREE.Bone(), { name: `b${j}` }));
  bones[0].add(bones[1]);
  bones[1].add(bones[2]);
  bones[1].position.z = bones[2].position.z = 0.8;
  const mesh = new THREE.SkinnedMesh(geometry), root = new THREE.Group();
  root.add(mesh);
  mesh.add(bones[0]);
  root.updateMatrixWorld(true);
  mesh.bind(new THREE.Skeleton(bones));
  const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(1, 0, 0), 0.6);
  const clip = new THREE.AnimationClip('bend', 1, [
    new THREE.QuaternionKeyframeTrack('b1.quaternion', [0, 1], [0, 0, 0, 1, ...turn.toArray()])]);
  const mixer = new THREE.AnimationMixer(mesh);
  const poses = adapt.posesOf(mesh, root, mixer, [clip], 6);
  assert.equal(poses.length, 6 * 16 * 3);
  const live = lorica.makeBody(adapt.skinOf(mesh, poses), { parts: 4, hullVertices: 32 }).live();
  const { lines, update } = adapt.hullLines(THREE, live);
  const point = new THREE.Vector3();
  for (let f = 0; f < 6; ++f) {
    bones[1].quaternion.setFromAxisAngle(new THREE.Vector3(1, 0, 0), 0.1 * f);
    root.updateMatrixWorld(true);
    live.update(adapt.bonesOf(mesh));
    update();
    assert.ok(lines.geometry.drawRange.count > 100);
    // Every vertex, as three poses it, is in a hull: in no direction is it farther than all of them.
    for (let v = 0; v < geometry.attributes.position.count; v += 7) {
      mesh.getVertexPosition(v, point);
      mesh.localToWorld(point);
      for (const direction of [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0], [-1, 0, 0], [0, 0, -1]]) {
        let farthest = -Infinity;
        for (const { positions, vertexCount } of live.hulls) {
          for (let i = 0; i < vertexCount; ++i) {
            farthest = Math.max(farthest, positions[3 * i] * direction[0] + positions[3 * i + 1] * direction[1] +
              positions[3 * i + 2] * direction[2]);
          }
        }
        assert.ok(point.dot(new THREE.Vector3(...direction)) <= farthest + 1e-5);
      }
    }
  }
});

test('Rapier: of a hull that it cannot build the one before stays', async () => {
  const RAPIER = await import('@dimforge/rapier3d-compat');
  await RAPIER.init();
  const world = new RAPIER.World({ x: 0, y: 0, z: 0 });
  const hull = { positions: Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), vertexCount: 4 };
  const body = rapier.followLive(RAPIER, world, { hulls: [hull] });
  body.update();
  hull.positions.fill(NaN);
  body.update();
  assert.equal(body.parts.size, 1);
  assert.equal(world.colliders.len(), 1);
});

test('Rapier: parts fall as one body, a ball lands on live hulls', async () => {
  const RAPIER = await import('@dimforge/rapier3d-compat');
  await RAPIER.init();
  const world = new RAPIER.World({ x: 0, y: -9.81, z: 0 });
  const live = lorica.makeBody(tube, { parts: 5, hullVertices: 32 }).live();
  const body = rapier.followLive(RAPIER, world, live);
  const ball = world.createRigidBody(RAPIER.RigidBodyDesc.dynamic().setTranslation(0.36, 1.5, 1.2));
  world.createCollider(RAPIER.ColliderDesc.ball(0.1), ball);
  let bounced = false, before = 0;
  for (let f = 0; f < 90; ++f) {
    live.update(poseAt(0));
    body.update();
    world.step();
    const { y } = ball.linvel();
    if (!bounced && y > before + 0.5) {  // no longer falling
      bounced = true;
      const { x, y: height, z } = ball.translation(), swept = live.castRay([x, 5, z], [0, -1, 0], Infinity, 0.1);
      assert.ok(Math.abs(height - (5 - swept.distance)) < 0.05, `the ball turned at ${height}`);
    }
    before = y;
  }
  assert.equal(body.parts.size, 5);
  assert.ok(bounced);
  const hit = live.castRay([0.36, 5, 1.2], [0, -1, 0]);
  const ray = world.castRay(new RAPIER.Ray({ x: 0.36, y: 5, z: 1.2 }, { x: 0, y: -1, z: 0 }), 10, true, undefined, undefined,
    undefined, ball);
  assert.ok(Math.abs(ray.timeOfImpact - hit.distance) < 1e-4);
  const parts = lorica.decompose(tube.positions, tube.indices, { parts: 4 });
  const falling = rapier.addParts(RAPIER, world, parts, RAPIER.RigidBodyDesc.dynamic().setTranslation(5, 3, 0));
  assert.equal(falling.numColliders(), 4);
  for (let f = 0; f < 30; ++f) world.step();
  assert.ok(falling.translation().y < 2.5);
});

test('Jolt: a ray meets live hulls where Lorica says', async () => {
  const Jolt = await (await import('jolt-physics')).default();
  const settings = new Jolt.JoltSettings();
  const pairs = new Jolt.ObjectLayerPairFilterTable(1);
  pairs.EnableCollision(0, 0);
  const layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1), layer = new Jolt.BroadPhaseLayer(0);
  layers.MapObjectToBroadPhaseLayer(0, layer);
  Object.assign(settings, { mObjectLayerPairFilter: pairs, mBroadPhaseLayerInterface: layers,
    mObjectVsBroadPhaseLayerFilter: new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, pairs, 1) });
  const jolted = new Jolt.JoltInterface(settings), system = jolted.GetPhysicsSystem();
  const live = lorica.makeBody(tube, { parts: 5, hullVertices: 32 }).live();
  live.update(poseAt(0.1));
  const body = jolt.followLive(Jolt, system.GetBodyInterface(), live, 0);
  for (let f = 0; f < 20; ++f) {
    live.update(poseAt(0.01 * f));
    body.update();
    jolted.Step(1 / 60, 1);
    const from = [0.05, 4, 0.1 * f + 0.2], hit = live.castRay(from, [0, -1, 0]);
    const ray = new Jolt.RRayCast(new Jolt.RVec3(...from), new Jolt.Vec3(0, -8, 0));
    const found = new Jolt.CastRayClosestHitCollisionCollector(), how = new Jolt.RayCastSettings();
    system.GetNarrowPhaseQuery().CastRay(ray, how, found, new Jolt.BroadPhaseLayerFilter(), new Jolt.ObjectLayerFilter(),
      new Jolt.BodyFilter(), new Jolt.ShapeFilter());
    assert.equal(found.HadHit(), hit.part >= 0);
    if (hit.part >= 0) assert.ok(Math.abs(8 * found.mHit.mFraction - hit.distance) < 2e-3, `frame ${f}`);
  }
  const shape = jolt.partsShape(Jolt, lorica.decompose(tube.positions, tube.indices, { parts: 4 }));
  assert.ok(shape.GetVolume() > 0.1);
});

test('cannon-es: a ball lands on live hulls, parts fall as one body', async () => {
  const CANNON = await import('cannon-es');
  const world = new CANNON.World({ gravity: new CANNON.Vec3(0, -9.81, 0) });
  const live = lorica.makeBody(tube, { parts: 5, hullVertices: 24 }).live();
  const body = cannon.followLive(CANNON, world, live);
  const ball = new CANNON.Body({ mass: 1, position: new CANNON.Vec3(0.36, 1.2, 1.2), shape: new CANNON.Sphere(0.1) });
  world.addBody(ball);
  const touched = new Set();
  ball.addEventListener('collide', ({ body: other }) => { touched.add(other); });
  for (let f = 0; f < 40; ++f) {
    live.update(poseAt(0));
    body.update();
    world.step(1 / 60);
  }
  assert.ok(touched.has(body.body));
  const falling = cannon.addParts(CANNON, world, lorica.decompose(tube.positions, tube.indices, { parts: 4, hullVertices: 24 }));
  assert.equal(falling.shapes.length, 4);
});
