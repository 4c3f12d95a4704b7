// The page of `lorica serve`: draws what the wire says and sends what the user wants.
import * as THREE from 'three';
import { Avatar } from './avatar.js';
import { Connection } from './connection.js';
import { Headset } from './headset.js';
import { Panel, make, row } from './panel.js';
import { Stage, kBackgrounds } from './stage.js';
import { Bones, Contacts, Hulls, Particles, Props } from './things.js';
import { View } from './view.js';
import { FrameError, FrameReader } from './wire.js';

const kSent = ['hulls', 'contacts', 'particles', 'depth']; // layers that cost something to send
const kVideoRate = 30, // [1/s]
  kVideoBits = 8e6, // a second
  kLargestVideo = 2 ** 30; // which the browser keeps until it is saved [bytes]
const canvas = document.getElementById('view'),
  depth = document.getElementById('depth'),
  connectionText = document.getElementById('connection');
/// What a link asks for: ?scene=none&background=transparent. One with a background shows the picture alone, as OBS takes it.
const asked = new URLSearchParams(location.search);
let askedScene = asked.get('scene'),
  askedBackground = null;
const dark = matchMedia('(prefers-color-scheme: dark)');

/// What the page's help has beside the server's list of controls.
const kHelp = [
  ['drag', 'on a prop: drags it; elsewhere: orbits. With two fingers: pans and zooms'],
  ['shift + arrows', 'orbits the camera'],
  ['M', 'shows and hides the settings'],
];
const kKeyNames = { ' ': 'space', Home: 'home', ArrowLeft: 'left', ArrowRight: 'right' };

let frames = 0,
  pictures = 0,
  video = null, // that is recorded
  videos = 0,
  drawnPictures = 0,
  dirty = true,
  newest = 0,
  hello = null,
  repaint = false; // another level of detail was asked for
const problems = [];
const reader = new FrameReader();

const panel = new Panel({
  set: (id, values) => connection.set(id, values),
  choice: () => {
    applyChoices();
    askForLayers();
  },
  act: (id) => act(id),
});
function problem(sentence) {
  problems.push(sentence);
  console.warn(sentence);
  panel.notice(sentence, true);
}

let stage;
try {
  stage = new Stage(canvas);
} catch {
  const sentence = 'This page needs WebGL 2, which this browser does not have or has switched off.';
  document.body.replaceChildren(make('p', { className: 'lone', role: 'alert' }, sentence));
  window.loricaPage = { frames: 0, problems: [sentence] };
  throw new Error(sentence);
}

const props = new Props(),
  contacts = new Contacts(),
  particles = new Particles(),
  bones = new Bones();
const world = {
  stage,
  props,
  panel,
  avatars: [],
  hulls: [],
  connection: null,
  view: null,
  mayDrag: () => Boolean(hello) && !hello.watched,
  live: () => Boolean(hello) && hello.live,
  changed: () => {
    dirty = true;
  },
  newest: () => newest,
  restage,
};
stage.scene.add(props.group, contacts.group, particles.points, bones.lines);
const view = (world.view = new View(world, canvas));
const headset = new Headset(world);

const connection = (world.connection = new Connection({
  opened: () => {
    newest = 0;
    askForLayers();
  },
  message,
  frame,
  says: (sentence) => {
    connectionText.textContent = sentence;
    document.body.classList.toggle('away', sentence !== '');
    dirty = true;
  },
}));

/// Hulls are also needed once, to know the colours of the skin.
const wantsHulls = () => panel.shows('colors') && world.avatars.some(({ painted }) => painted === 0 || repaint);
function askForLayers() {
  const wanted = (layer) => panel.shows(layer) || (layer === 'hulls' && wantsHulls());
  connection?.send('show', { layers: [...kSent.filter(wanted), 'face'] });
}

function message(news) {
  if (news.type === 'hello') start(news);
  else if (news.type === 'props') {
    props.set(news, hello?.run ?? 0, connection.fetchBytes, problem);
    view.keep();
    world.floor = news.floor !== false;
    applyChoices();
  } else if (news.type === 'controls') {
    const before = panel.controls.parts?.value;
    panel.set(news.controls);
    askForScene(panel.controls.scene);
    const { value } = panel.controls.parts;
    if (before !== value && world.avatars[0]?.painted !== value) {
      repaint = true;
      askForLayers();
    }
  } else if (news.type === 'state') panel.update(news, hello);
  else if (news.type === 'registration') headset.registered(news);
  else if (news.type === 'notice') panel.notice(news.text, news.problem);
}

/// Once, so that others may choose another one.
function askForScene(scene) {
  if (!askedScene || !scene?.choices) return;
  const to = scene.choices.indexOf(askedScene);
  if (to < 0) problem(`${askedScene}: no scene with this name, expected one of ${scene.choices.join(', ')}`);
  else if (to !== scene.value) connection.set('scene', { to });
  askedScene = null;
}

/// Everything from before is void, but props stay until others are named. After a lost connection the same characters need
/// not be loaded again.
function start(next) {
  const again = hello && hello.run === next.run && hello.name === next.name;
  const same = again && JSON.stringify(hello.avatars) === JSON.stringify(next.avatars);
  hello = next;
  for (const hand of [0, 1]) view.hold(null, hand);
  contacts.set({ count: 0, values: [] });
  particles.points.geometry.setDrawRange(0, 0);
  depth.hidden = true;
  if (!same) load(next.avatars);
  if (!again) view.home(next.camera);
  panel.chose();
}

function load(avatars) {
  for (const old of [...world.avatars, ...world.hulls]) old.dispose();
  world.avatars = avatars.map((avatar) => new Avatar(avatar));
  world.hulls = avatars.map(() => new Hulls());
  for (const avatar of world.avatars) {
    stage.scene.add(avatar.root);
    avatar
      .load(connection.fetchBytes)
      .then(world.changed)
      .catch((error) => {
        avatar.failed = true;
        problem(`The avatar ${avatar.hello.name} cannot be shown: ${error.message}`);
      });
  }
  for (const hull of world.hulls) stage.scene.add(hull.group);
  panel.plain = avatars.some((avatar) => avatar.plain);
  view.followed = -1;
}

function frame(buffer) {
  let read;
  try {
    read = reader.read(buffer);
  } catch (error) {
    if (!(error instanceof FrameError)) throw error;
    problem(`A frame cannot be read: ${error.message}.`);
    newest = Number(new DataView(buffer).byteLength >= 24 ? new DataView(buffer).getBigUint64(16, true) : newest); // else none comes any more
    return;
  }
  newest = read.number;
  dirty = true;
  if (!hello || read.run !== hello.run) return;
  ++frames;
  for (const pose of read.avatars) world.avatars[pose.index]?.pose(pose);
  for (const { index, weights } of read.faces) world.avatars[index]?.face(weights);
  if (read.props && read.version === props.version) props.move(read.props);
  for (const { index, parts } of read.hulls) setHulls(index, parts);
  if (read.contacts) contacts.set(read.contacts);
  if (read.particles) particles.set(read.particles);
  if (read.depth && panel.shows('depth')) showDepth(read.depth);
  if (panel.shows('bones')) bones.set(world.avatars);
}

function setHulls(index, parts) {
  const hulls = world.hulls[index],
    avatar = world.avatars[index];
  hulls?.set(parts);
  if (!avatar?.loaded || !panel.shows('colors')) return;
  if (avatar.painted !== parts.length) avatar.paint(hulls.planes());
  if (index === 0 && avatar.painted === panel.controls.parts?.value) repaint = false;
  if (!panel.shows('hulls') && !wantsHulls()) askForLayers();
}

function showDepth(jpeg) {
  if (depth.busy) return;
  const url = URL.createObjectURL(new Blob([jpeg], { type: 'image/jpeg' }));
  depth.busy = true;
  depth.onload = depth.onerror = () => {
    URL.revokeObjectURL(url);
    depth.busy = false;
  };
  depth.src = url;
  depth.hidden = false;
}

/// A headset is put on or taken off.
function restage() {
  applyChoices();
  layout();
}

function applyChoices() {
  const { choices } = panel,
    shows = (layer) => panel.shows(layer);
  const through = stage.renderer.xr.isPresenting && headset.mode === 'ar';
  const chosen = askedBackground ?? choices.background;
  const background = chosen === 'as the system' ? (dark.matches ? 'dark' : 'light') : chosen;
  stage.show({ background, ground: shows('ground') && world.floor !== false, through });
  for (const avatar of world.avatars) {
    avatar.show(shows('character'));
    avatar.colorByParts(panel.shows('colors'));
  }
  for (const hulls of world.hulls) hulls.group.visible = shows('hulls');
  props.group.visible = shows('props');
  contacts.group.visible = shows('contacts');
  particles.points.visible = shows('particles');
  bones.lines.visible = shows('bones');
  if (shows('bones')) bones.set(world.avatars);
  if (!shows('depth')) depth.hidden = true;
  view.follow = shows('follow');
  headset.presence = choices.presence;
  if (choices.quality !== 'automatic' && stage.quality !== choices.quality) {
    stage.setQuality(choices.quality);
    layout();
  }
  dirty = true;
}

/// What controls do that the server does not do alone, and what this page has besides.
const actions = {
  pause: () => (panel.state?.ended ? connection.set('restart') : connection.set('pause', { by: 1 })),
  throw: () =>
    connection.send('throw', {
      origin: stage.camera.position.toArray(),
      target: view.center(new THREE.Vector3()).toArray(),
    }),
  open: () => chosen.click(),
  record: () => connection.set('record', { to: !panel.controls.record.value }),
  reset: () => view.reset(),
  panel: () => {
    const shut = document.body.classList.toggle('shut');
    panel.menu.setAttribute('aria-expanded', String(!shut));
    if (shut && document.activeElement.closest('#panel')) panel.menu.focus();
    layout();
  },
  help: () => {
    const rows = Object.values(panel.controls).filter(({ keys }) => keys);
    const lines = [...kHelp, ...rows.map(({ keys, help: what, label }) => [keys, what ?? label])];
    help.querySelector('tbody').replaceChildren(
      ...lines.map(([keys, what]) => row(make('kbd', {}, keys), what)),
    );
    help.showModal();
  },
  vr: () => headset.enter('vr'),
  ar: () => headset.enter('ar'),
  picture: async () => {
    save(await stage.picture(), ++pictures, 'png');
    dirty = true;
  },
  video: () => (video ? endVideo() : startVideo()),
};

/// Does what a key or a button stands for. @param by  steps; below 0: back
function act(id, by = 1) {
  const control = panel.controls[id];
  if (control?.no) panel.notice(control.no);
  else if (control?.absent) return;
  else if (actions[id]) actions[id]();
  else if (control?.own) panel.toggle(id);
  else if (control) connection.set(id, { by });
  else view.look(id);
}

function save(blob, number, ending) {
  const url = URL.createObjectURL(blob);
  make('a', { href: url, download: `lorica-${String(number).padStart(3, '0')}.${ending}` }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

const sizeOf = ({ width, height }) => `${width} x ${height}`;

/// A video of the picture without panels. The browser encodes it, and ends it where the window does: when the size changes.
function startVideo() {
  const ending = ['webm', 'mp4'].find((one) => window.MediaRecorder?.isTypeSupported(`video/${one}`));
  if (!ending || !canvas.captureStream) return panel.notice('This browser records no videos.', true);
  const stream = canvas.captureStream(kVideoRate),
    parts = [];
  let bytes = 0;
  video = new MediaRecorder(stream, { mimeType: `video/${ending}`, videoBitsPerSecond: kVideoBits });
  video.size = sizeOf(canvas);
  const busy = panel.busy('a video is recorded, V to stop');
  video.ondataavailable = ({ data }) => {
    parts.push(data);
    bytes += data.size;
    if (bytes > kLargestVideo) endVideo();
  };
  video.onerror = ({ error }) => panel.notice(`The video ends: ${error.message}`, true);
  video.onstop = () => {
    video = null;
    busy.remove();
    panel.video(false);
    for (const track of stream.getTracks()) track.stop();
    if (bytes > 0) save(new Blob(parts, { type: `video/${ending}` }), ++videos, ending);
  };
  video.start(1000);
  panel.video(true);
}
function endVideo() {
  if (video.state === 'recording') video.stop();
}

const chosen = make('input', { type: 'file', onchange: () => openFiles(chosen.files).finally(() => (chosen.value = '')) });

/// What was chosen or dropped goes to the server, which opens it for all who watch.
async function openFiles([file, ...more]) {
  const why = panel.controls.open?.no;
  if (!file || why) return why && panel.notice(why);
  if (more.length > 0) panel.notice(`One file at a time: took ${file.name}`);
  const busy = panel.busy(`sending ${file.name}`);
  const refused = await connection.sendFile(file);
  busy.remove();
  if (refused) panel.notice(`${file.name}: ${refused}`, true);
}
for (const type of ['dragenter', 'dragover', 'dragleave', 'drop'])
  addEventListener(type, (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = panel.controls.open?.no ? 'none' : 'copy';
    document.body.classList.toggle('dropping', type === 'dragenter' || type === 'dragover');
    if (type === 'drop') openFiles(event.dataTransfer.files);
  });

const help = document.getElementById('help');
help.append(
  make('h2', {}, 'Keys and pointer'),
  make('table', {}, make('tbody')),
  make('form', { method: 'dialog' }, make('button', { className: 'wide' }, 'Close')),
);

addEventListener('keydown', (event) => {
  const on = event.target.closest?.('select, input, button, summary, a, dialog'),
    { key } = event;
  if (event.ctrlKey || event.metaKey || event.altKey || on?.matches('select')) return;
  if (help.open) {
    if (key.toUpperCase() === 'H') help.close();
    return;
  }
  if (on && (key === ' ' || (on.matches('[type=range]') && /^(Arrow|Home)/.test(key)))) return; // the control's own keys
  const name = kKeyNames[key] ?? key.toUpperCase(),
    [control, by] = named(name);
  if (event.shiftKey && key.startsWith('Arrow')) orbit(key);
  else if (name === 'M') actions.panel();
  else if (control && mayRepeat(event, control)) act(control.id, by);
  else return;
  event.preventDefault();
});

/// The control that has a key, and which way it goes.
function named(key) {
  for (const control of Object.values(panel.controls)) {
    const keys = (control.keys ?? '').split(' ');
    if (keys.at(-1) === key) return [control, 1];
    if (keys.length === 2 && keys[0] === key) return [control, -1];
  }
  return [null, 0];
}

/// Held keys act ten times a second, and only where that is of use.
let repeated = 0;
function mayRepeat({ repeat, timeStamp }, { repeats }) {
  if (repeat && (!repeats || timeStamp - repeated < 100)) return false;
  repeated = timeStamp;
  return true;
}

function orbit(key) {
  const { camera } = stage,
    { target } = view.controls,
    place = new THREE.Spherical().setFromVector3(camera.position.clone().sub(target));
  place.theta += { ArrowLeft: -0.1, ArrowRight: 0.1 }[key] ?? 0;
  place.phi = Math.min(
    Math.max(place.phi + ({ ArrowUp: -0.1, ArrowDown: 0.1 }[key] ?? 0), 0.05),
    view.controls.maxPolarAngle,
  );
  camera.position.setFromSpherical(place).add(target);
  view.controls.update();
  dirty = true;
}

/// What sizes of points count in [pixels].
function setHeight(pixels) {
  for (const { material } of [contacts.points, particles.points]) material.uniforms.height.value = pixels;
}

function layout() {
  stage.resize({ width: innerWidth, height: innerHeight, ...panel.covered() });
  if (video && video.size !== sizeOf(canvas)) endVideo();
  setHeight(canvas.height);
  dirty = true;
}
addEventListener('resize', layout);
new ResizeObserver(layout).observe(document.getElementById('bar'));
new ResizeObserver(layout).observe(document.getElementById('panel'));
dark.addEventListener('change', applyChoices);

/// Lower if pictures come slowly for a second, higher after three good ones; a level that was too slow waits twice as long.
const automatic = { levels: ['low', 'medium', 'high'], since: 0, patience: 3, slow: 0.016 };
function adapt(seconds, now) {
  if (panel.choices.quality !== 'automatic' || video || stage.renderer.xr.isPresenting || seconds > 0.5) return;
  automatic.slow += (seconds - automatic.slow) * 0.05;
  const level = automatic.levels.indexOf(stage.quality),
    waited = now - automatic.since;
  let next = level;
  if (automatic.slow > 0.04 && waited > 1 && level > 0) {
    next = level - 1;
    automatic.patience = Math.min(automatic.patience * 2, 160);
  } else if (automatic.slow < 0.02 && waited > automatic.patience && level < 2) next = level + 1;
  if (next === level) return;
  stage.setQuality(automatic.levels[next]);
  automatic.since = now;
  layout();
}

const rates = { at: 0, frames: 0, pictures: 0, bytes: 0 };
function showRates(now) {
  if (now - rates.at < 1) return;
  const per = (count, before) => ((count - before) / (now - rates.at)).toFixed(0);
  panel.numbers([
    ['frames a second', per(frames, rates.frames)],
    ['pictures a second', per(drawnPictures, rates.pictures)],
    ['received', `${per(connection.received / 1000, rates.bytes / 1000)} kB/s`],
    ['quality', stage.quality],
  ]);
  Object.assign(rates, { at: now, frames, pictures: drawnPictures, bytes: connection.received });
}

let before = 0;
stage.renderer.setAnimationLoop((milliseconds, xrFrame) => {
  const now = milliseconds / 1000,
    seconds = Math.min(now - before, 1);
  before = now;
  const presents = stage.renderer.xr.isPresenting;
  adapt(seconds, now);
  showRates(now);
  if (presents) {
    headset.update(xrFrame, seconds);
    const [eye] = stage.renderer.xr.getCamera().cameras;
    if (eye) setHeight(eye.viewport.w);
  }
  if (view.update(seconds, presents) || video) dirty = true;
  if (!dirty && !presents) return; // a paused page costs nothing
  dirty = false;
  for (const avatar of world.avatars) avatar.advance(seconds);
  stage.renderer.render(stage.scene, stage.camera);
  ++drawnPictures;
});
if (asked.has('background')) {
  const name = asked.get('background');
  if (name in kBackgrounds) askedBackground = name;
  else problem(`${name}: no background with this name, expected one of ${Object.keys(kBackgrounds).join(', ')}`);
  document.body.classList.toggle('bare', askedBackground !== null);
}
layout();
applyChoices();
headset.offer();

/// For tests: numbers only.
const shown = {
  frames: () => frames,
  pictures: () => drawnPictures,
  newest: () => newest,
  open: () => connection.open,
  says: () => connectionText.textContent,
  run: () => hello?.run ?? 0,
  state: () => panel.state,
  controls: () => panel.controls,
  quality: () => stage.quality,
  avatars: () => world.avatars.map((a) => ({
    name: a.hello.name,
    loaded: a.loaded,
    failed: a.failed === true,
    present: a.present,
    vrm: a.vrm !== null,
    center: a.center.toArray(),
    painted: a.painted,
  })),
  props: () => props.list.map((mesh) => ({
    position: mesh.position.toArray(),
    fixed: mesh.userData.fixed,
    visible: mesh.visible && mesh.geometry.attributes.position !== undefined,
  })),
  particles: () => ({ all: particles.all, sent: particles.sent }),
  held: () => shown.inHands().find((index) => index >= 0) ?? -1,
  inHands: () => view.held.map((held) => held?.mesh.userData.index ?? -1),
  videos: () => videos,
  mode: () => headset.mode,
  live: () => world.live(),
  registration: () => headset.registration,
  /// The first avatar's joints in the picture, and what panels leave free of it: left, top, right, bottom [CSS pixels].
  framed: () => {
    const { x, y } = new THREE.Vector2(innerWidth, innerHeight),
      { right, bottom } = panel.covered(),
      seen = new THREE.Box3(),
      { min, max } = world.avatars[0]?.box ?? seen;
    for (let i = 0; i < 8; ++i)
      seen.expandByPoint(
        new THREE.Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z).project(stage.camera),
      );
    const at = (u, size) => ((1 + u) / 2) * size;
    return {
      avatar: [at(seen.min.x, x), at(-seen.max.y, y), at(seen.max.x, x), at(-seen.min.y, y)],
      free: [0, 0, x - right, y - bottom],
    };
  },
  camera: () => new THREE.Vector3().setFromMatrixPosition(stage.camera.matrixWorld).toArray(),
  rig: () => ({ position: stage.rig.position.toArray(), yaw: stage.rig.rotation.y }),
};
window.loricaPage = {
  problems,
  /// A PNG of some layers, from where the hello says and without panels.
  picture(layers, background) {
    for (const { id, own, kind } of Object.values(panel.controls))
      if (own && kind === 'toggle' && id !== 'colors' && id !== 'follow') panel.choices.layers[id] = layers.includes(id);
    panel.choices.background = background;
    askForLayers();
    applyChoices();
    view.reset();
    return stage.picture();
  },
  /// Where a prop is seen on the page, if a press there would take it [CSS pixels].
  screenOf(index) {
    const mesh = props.list[index],
      { camera } = stage;
    camera.updateMatrixWorld();
    const from = camera.position.clone(),
      at = mesh.position.clone(),
      hit = view.hit(from, at.clone().sub(from).normalize());
    at.project(camera);
    if (hit?.object !== mesh || Math.abs(at.x) > 1 || Math.abs(at.y) > 1) return null;
    return [((at.x + 1) / 2) * innerWidth, ((1 - at.y) / 2) * innerHeight];
  },
};
for (const [name, get] of Object.entries(shown)) Object.defineProperty(window.loricaPage, name, { get, enumerable: true });
