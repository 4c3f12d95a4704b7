// Try Lorica: a file is dropped, cut into parts in a Worker, and its hulls follow it and catch balls, all in the page.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { load } from 'lorica';
import { addParts, followLive } from 'lorica/rapier';
import { startWorker } from 'lorica/worker';
import { Stage, lit } from '../src/stage.js';
import { makeSnake, readModel, Subject } from './model.js';

const $ = (id) => document.getElementById(id);
const kColors = [0x2fb5a6, 0xe08f3c, 0x6c86d9, 0xc2577f, 0x8fae3e, 0x9b6bc4, 0x3f9fd0, 0xd9b23a];
const kBall = 0.07; // of the model's size

const say = (sentence) => { $('status').textContent = sentence; };
const note = (sentence) => {
  const line = document.createElement('li');
  line.textContent = sentence;
  $('notices').append(line);
  setTimeout(() => line.remove(), 15000);
};

let stage;
try {
  stage = new Stage($('view'));
} catch {
  say('This browser has no WebGL 2.');
  throw new Error('no WebGL 2');
}
const dark = matchMedia('(prefers-color-scheme: dark)');
const showStage = () => stage.show({ background: dark.matches ? 'dark' : 'light', ground: true });
dark.addEventListener('change', showStage);
showStage();
stage.setQuality('medium');
const controls = new OrbitControls(stage.camera, $('view'));
controls.enableDamping = true;
const resize = () => {
  const beside = innerWidth > 640, panel = $('panel').getBoundingClientRect();
  stage.resize({ width: innerWidth, height: innerHeight, right: beside ? panel.width + 24 : 0,
    bottom: beside ? 0 : panel.height + 16 });
};
addEventListener('resize', resize);
resize();

// The hulls of all parts as one mesh with flat faces.
const hullMesh = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshStandardMaterial({ vertexColors: true,
  flatShading: true, transparent: true, opacity: 0.55, roughness: 0.8 }));
hullMesh.frustumCulled = false;
stage.scene.add(hullMesh);
const tone = new THREE.Color();
const drawHulls = (hulls) => {
  const { geometry } = hullMesh;
  const count = hulls.reduce((sum, { indices, triangleCount = indices.length / 3 }) => sum + 3 * triangleCount, 0);
  if (!geometry.attributes.position || geometry.attributes.position.count < count) {
    for (const name of ['position', 'color']) geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(6 * count), 3));
  }
  const { position, color } = geometry.attributes;
  let at = 0;
  hulls.forEach(({ positions, indices, triangleCount = indices.length / 3 }, part) => {
    tone.set(kColors[part % kColors.length]);
    for (let i = 0; i < 3 * triangleCount; ++i, at += 3) {
      for (let k = 0; k < 3; ++k) position.array[at + k] = positions[3 * indices[i] + k];
      color.array[at] = tone.r;
      color.array[at + 1] = tone.g;
      color.array[at + 2] = tone.b;
    }
  });
  geometry.setDrawRange(0, at / 3);
  position.needsUpdate = color.needsUpdate = true;
};

const lorica = await load();
const worker = startWorker();
const balls = [];
let model, subject, mixer, action, made, live, bodies, world, size = 1, cutting = null;
let RAPIER = null; // not before balls are thrown

/// A floor, what was made of the model, and no balls.
const startWorld = () => {
  for (const { mesh } of balls.splice(0)) stage.scene.remove(mesh);
  world = null;
  if (!RAPIER) return;
  world = new RAPIER.World({ x: 0, y: -9.81 * Math.max(size / 1.7, 0.05), z: 0 });
  world.createCollider(RAPIER.ColliderDesc.cuboid(50 * size, 0.1, 50 * size).setTranslation(0, -0.1, 0));
  bodies = null;
  if (live) bodies = followLive(RAPIER, world, live);
  else if (made) addParts(RAPIER, world, made, RAPIER.RigidBodyDesc.fixed());
};

const facts = (rows) => {
  $('facts').replaceChildren(...rows.map(([label, value]) => {
    const row = document.createElement('tr');
    for (const text of [label, value]) row.insertCell().textContent = text;
    return row;
  }));
};

const forget = () => {
  live?.body.free();
  live?.free();
  live = made = null;
  hullMesh.geometry.setDrawRange(0, 0);
  facts([]);
  for (const id of ['save-obj', 'save-glb', 'save-lorica', 'throw']) $(id).disabled = true;
};

const cut = async () => {
  cutting?.abort();
  const stop = new AbortController();
  cutting = stop;
  forget();
  const options = { parts: Number($('parts').value), hullVertices: Number($('points').value), signal: stop.signal,
    onProgress: (done, wanted) => {
      $('loaded').value = wanted > 0 ? done / wanted : 0;
      $('loading').querySelector('label').textContent = wanted > 0 ? `${done} of ${wanted} parts` : 'Preparing';
    } };
  if ($('walls').value === 'shell') options.walls = 'shell';
  say(`Cutting ${model.name}`);
  $('loading').hidden = false;
  $('loaded').removeAttribute('value');
  const started = performance.now();
  try {
    let result;
    if (subject.moves) {
      action?.stop();
      subject.pose(model.root, mixer, model.clips);
      try {
        result = await worker.makeBody(subject.skin, options);
      } catch (error) {
        if (error.kind !== 'unsupported' || options.walls) throw error;
        note('It is open: its surface gets thin walls.');
        options.walls = 'shell';
        result = await worker.makeBody(subject.skin, options);
      }
      if (stop.signal.aborted) return;
      live = lorica.openBody(result.bytes, subject.skin, { walls: options.walls }).live();
      live.update(subject.place());
      playClip();
    } else {
      result = await worker.decompose(subject.mesh.positions, subject.mesh.indices, options);
    }
    if (stop.signal.aborted) return;
    made = result;
    const seconds = (performance.now() - started) / 1000, count = live ? live.hulls.length : made.hulls.length;
    facts([['Parts', count], ['Made in', `${seconds.toFixed(1)} s`],
      ['Triangles', subject.mesh.indices.length / 3], ...(made.error === undefined ? []
        : [['Volume more than the mesh', `${(100 * made.error).toFixed(0)} %`]])]);
    for (const sentence of [made.repaired, made.warning, ...(made.notes ?? [])]) if (sentence) note(sentence);
    drawHulls(live ? live.hulls : made.hulls);
    for (const id of ['save-obj', 'save-glb', 'save-lorica', 'throw']) $(id).disabled = false;
    startWorld();
    say(`${model.name}: ${count} hulls`);
    document.body.dataset.hulls = count;
  } catch (error) {
    if (error.kind !== 'cancelled') say(`${model.name}: ${error.message}`);
    else if (cutting === stop) say(`${model.name}: cancelled`);
  } finally {
    if (cutting === stop) {
      cutting = null;
      $('loading').hidden = true;
    }
  }
};

const playClip = () => {
  action?.stop();
  const clip = model.clips[$('clips').selectedIndex] ?? model.clips[0];
  action = clip ? mixer.clipAction(clip).reset().play() : null;
};

/// Onto the floor, in the middle, and the camera before it.
const show = (next) => {
  if (model) stage.scene.remove(model.root);
  model = next;
  model.root.traverse((node) => {
    if (!node.isMesh) return;
    node.castShadow = node.receiveShadow = true;
    node.frustumCulled = false;
    for (const material of [node.material].flat()) lit(material);
  });
  const box = new THREE.Box3().setFromObject(model.root, true), middle = box.getCenter(new THREE.Vector3());
  size = Math.max(...box.getSize(new THREE.Vector3()).toArray(), 1e-6);
  model.root.position.sub(new THREE.Vector3(middle.x, box.min.y, middle.z));
  stage.scene.add(model.root);
  model.root.updateMatrixWorld(true);
  mixer = new THREE.AnimationMixer(model.root);
  action = null;
  subject = new Subject(model);
  $('clips').replaceChildren(...model.clips.map(({ name }) => new Option(name)));
  $('clips-row').hidden = model.clips.length < 2;
  const height = (box.max.y - box.min.y) / 2, far = size / Math.min(stage.half.x, stage.half.y);
  controls.target.set(0, height, 0);
  stage.camera.near = 0.01 * size;
  stage.camera.far = 120 * size;
  stage.camera.position.set(0.55, 0.4, 0.8).normalize().multiplyScalar(0.75 * far).add(controls.target);
  stage.lightAt(controls.target);
  resize();
  cut();
};

const open = async (file) => {
  say(`Reading ${file.name}`);
  try {
    show(await readModel(file.name, await file.arrayBuffer()));
  } catch (error) {
    say(`${file.name}: ${error.message.startsWith(file.name) ? error.message.slice(file.name.length + 2) : error.message}`);
  }
};

const throwBalls = async () => {
  if (!made) return;
  if (!RAPIER) {
    const { default: rapier } = await import('@dimforge/rapier3d-compat');
    await rapier.init();
    RAPIER = rapier;
    startWorld();
  }
  const radius = kBall * size, from = stage.camera.position, aim = new THREE.Vector3();
  for (let i = 0; i < 6; ++i) {
    const [a, b] = [Math.cos((i * Math.PI) / 3), Math.sin((i * Math.PI) / 3)];
    const mesh = new THREE.Mesh(new THREE.SphereGeometry(radius, 24, 16),
      new THREE.MeshStandardMaterial({ color: kColors[(balls.length + 1) % kColors.length], roughness: 0.5 }));
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.position.set(a, b, 0).multiplyScalar(2.6 * radius).applyQuaternion(stage.camera.quaternion).add(controls.target)
      .addScaledVector(aim.subVectors(from, controls.target).normalize(), size);
    aim.subVectors(controls.target, mesh.position).multiplyScalar(2.2);
    const body = world.createRigidBody(RAPIER.RigidBodyDesc.dynamic().setCcdEnabled(true)
      .setTranslation(...mesh.position.toArray()).setLinvel(...aim.toArray()));
    world.createCollider(RAPIER.ColliderDesc.ball(radius).setRestitution(0.5), body);
    stage.scene.add(lit(mesh.material) && mesh);
    balls.push({ mesh, body });
  }
  document.body.dataset.balls = balls.length;
};

const save = (name, parts, type) => {
  const link = Object.assign(document.createElement('a'), { download: name, href: URL.createObjectURL(new Blob(parts, { type })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
const stem = () => model.name.replace(/\.[^.]*$/, '');
const shownHulls = () => live ? live.hulls.map(({ positions, vertexCount, indices, triangleCount }) =>
  ({ positions: positions.slice(0, 3 * vertexCount), indices: indices.slice(0, 3 * triangleCount) })) : made.hulls;

$('save-obj').onclick = () => {
  let before = 1;
  const lines = shownHulls().flatMap(({ positions, indices }, part) => {
    const own = [`o part_${part}`];
    for (let i = 0; i < positions.length; i += 3) own.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
    for (let i = 0; i < indices.length; i += 3) own.push(`f ${[0, 1, 2].map((k) => indices[i + k] + before).join(' ')}`);
    before += positions.length / 3;
    return own;
  });
  save(`${stem()}_hulls.obj`, [`${lines.join('\n')}\n`], 'text/plain');
};
$('save-glb').onclick = async () => {
  const scene = new THREE.Scene();
  shownHulls().forEach(({ positions, indices }, part) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
    geometry.setIndex([...indices]);
    scene.add(Object.assign(new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color: kColors[part % kColors.length] })),
      { name: `part_${part}` }));
  });
  save(`${stem()}_hulls.glb`, [await new GLTFExporter().parseAsync(scene, { binary: true })], 'model/gltf-binary');
};
$('save-lorica').onclick = () => save(`${stem()}.lorica`, [made.bytes], 'application/octet-stream');
$('file').onchange = () => { if ($('file').files[0]) open($('file').files[0]); };
$('cut').onclick = cut;
$('cancel').onclick = () => cutting?.abort();
$('throw').onclick = throwBalls;
$('clips').onchange = playClip;
addEventListener('dragover', (event) => { event.preventDefault(); document.body.classList.add('dropping'); });
addEventListener('dragleave', () => document.body.classList.remove('dropping'));
addEventListener('drop', (event) => {
  event.preventDefault();
  document.body.classList.remove('dropping');
  if (event.dataTransfer.files[0]) open(event.dataTransfer.files[0]);
});
addEventListener('keydown', (event) => {
  if (event.target.matches?.('input, select, button')) return;
  if (event.key === 'b') throwBalls();
  else if (event.key === ' ') $('play').checked = !$('play').checked;
  else return;
  event.preventDefault();
});

/// For tests: where the first hull begins.
window.firstCorner = () => live?.hulls[0].positions.slice(0, 3) ?? null;

let before = 0;
const frame = (now) => {
  const seconds = Math.min((now - before) / 1000, 0.1);
  before = now;
  if ($('play').checked && mixer) mixer.update(seconds);
  if (model) {
    model.root.visible = $('skin').checked;
    model.root.updateMatrixWorld(true);
  }
  if (live) {
    live.update(subject.place());
    drawHulls(live.hulls);
  }
  hullMesh.visible = $('hulls').checked;
  if (world && balls.length > 0) {
    bodies?.update();
    world.timestep = Math.max(seconds, 1e-3);
    world.step();
    for (const { mesh, body } of balls) {
      mesh.position.copy(body.translation());
      mesh.quaternion.copy(body.rotation());
    }
  }
  controls.update();
  stage.renderer.render(stage.scene, stage.camera);
};
show(makeSnake());
stage.renderer.setAnimationLoop(frame);
