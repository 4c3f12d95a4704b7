// VR and AR: the same scene from inside. Controllers and pinching hands hold props along a ray.
import * as THREE from 'three';
import { lit } from './stage.js';

const kModes = { vr: 'immersive-vr', ar: 'immersive-ar' };
const kBeside = { vr: 1.6, ar: 1.9 }; // distance to the avatar at first [m]
const kWalk = 1.4; // [m/s]
const kBetweenHeads = 0.03; // poses that are sent [s]
const kSettles = 1; // in which the eyes come to the avatar's, whose camera is late [s]
const kReach = 2.5; // length of a ray that meets nothing [m]
const kFastestThrow = 15; // [m/s]
const kThrowPictures = 5; // in which a throw's velocity is measured,
const kLongestThrow = 2; // if they take no longer [s]

export class Headset {
  mode = null; // vr, ar
  presence = 'beside';
  #world;
  #hands = [];
  #placed = false;
  #worn = null;
  #sentAt = 0; // when the last pose was sent [s]
  #registration = null; // of this headset and the depth camera
  #turned = 0; // what the stick for turning wanted before
  #flat = { position: new THREE.Vector3(), quaternion: new THREE.Quaternion() };

  /// @param world  that of the View, with { view, panel, avatars }
  constructor(world) {
    this.#world = world;
    const { xr } = world.stage.renderer;
    xr.setReferenceSpaceType('local-floor');
    xr.addEventListener('sessionstart', () => this.#started());
    xr.addEventListener('sessionend', () => this.#ended());
    this.#hands = [0, 1].map((i) => this.#makeHand(i, xr.getController(i), xr.getControllerGrip(i), xr.getHand(i)));
  }

  /// Where the depth camera sees the wearer, once that is known.
  registered(registration) {
    this.#registration = registration;
    if (this.mode && registration.advice) this.#world.panel.notice(registration.advice, false);
  }

  get registration() {
    return this.#registration;
  }

  async offer() {
    const can = async (mode) => Boolean(await navigator.xr?.isSessionSupported(mode).catch(() => false));
    const vr = await can(kModes.vr),
      ar = await can(kModes.ar);
    let sentence = 'Trigger or pinch: holds a prop. Squeeze: throws a ball. Sticks: walk and turn.';
    if (!window.isSecureContext) sentence = 'VR and AR need a link with https.';
    else if (!navigator.xr) sentence = 'This browser has no VR or AR. The one in a headset has.';
    else if (!vr && !ar) sentence = 'There is no headset at this device.';
    this.#world.panel.xr({ vr, ar, sentence });
  }

  async enter(mode) {
    const { stage, panel } = this.#world;
    try {
      const session = await navigator.xr.requestSession(kModes[mode], {
        requiredFeatures: ['local-floor'],
        optionalFeatures: ['hand-tracking'],
      });
      this.mode = mode;
      await stage.renderer.xr.setSession(session);
    } catch (error) {
      this.mode = null;
      panel.notice(`${mode.toUpperCase()} does not start: ${error.message}`, true);
    }
  }

  #started() {
    const { stage, view } = this.#world;
    this.#flat.position.copy(stage.camera.position);
    this.#flat.quaternion.copy(stage.camera.quaternion);
    view.controls.enabled = false;
    this.#placed = false;
    this.#world.restage();
  }

  #ended() {
    const { stage, view } = this.#world;
    this.mode = null;
    this.#wear(null);
    stage.rig.position.set(0, 0, 0);
    stage.rig.rotation.set(0, 0, 0);
    stage.camera.position.copy(this.#flat.position);
    stage.camera.quaternion.copy(this.#flat.quaternion);
    stage.camera.scale.set(1, 1, 1);
    view.controls.enabled = true;
    for (const hand of this.#hands) this.#release(hand);
    this.#world.restage();
  }

  #wear(avatar) {
    if (avatar === this.#worn) return;
    if (!this.#worn?.disposed) this.#worn?.wear(this.#world.stage.camera, false);
    avatar?.wear(this.#world.stage.camera, true);
    this.#worn = avatar;
  }

  #makeHand(index, ray, grip, joints) {
    const gray = lit(new THREE.MeshStandardMaterial({ color: 0x5d7088, roughness: 0.5 })),
      orange = new THREE.MeshBasicMaterial({ color: 0xff7a1a });
    const line = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3(0, 0, -1)]),
      new THREE.LineBasicMaterial({ color: 0xff7a1a, transparent: true, opacity: 0.75 }),
    );
    const dot = new THREE.Mesh(new THREE.SphereGeometry(0.011, 16, 12), orange);
    const body = new THREE.Mesh(new THREE.CapsuleGeometry(0.019, 0.07, 6, 16).rotateX(Math.PI / 2), gray);
    const fingers = new THREE.InstancedMesh(new THREE.SphereGeometry(1, 12, 8), gray, 25);
    line.frustumCulled = fingers.frustumCulled = false;
    fingers.count = 0;
    ray.add(line);
    grip.add(body);
    joints.add(fingers);
    this.#world.stage.rig.add(ray, grip, joints);
    this.#world.stage.scene.add(dot);
    line.visible = dot.visible = false;
    const hand = {
      index,
      ray,
      grip,
      line,
      dot,
      body,
      joints,
      fingers,
      origin: new THREE.Vector3(),
      direction: new THREE.Vector3(),
      was: Array.from({ length: kThrowPictures }, () => ({ time: 0, at: new THREE.Vector3() })), // the oldest first
    };
    ray.addEventListener('connected', ({ data }) => {
      hand.side = data.handedness;
      hand.line.visible = true;
      hand.body.visible = !data.hand;
    });
    ray.addEventListener('disconnected', () => {
      this.#release(hand);
      hand.line.visible = hand.dot.visible = false;
    });
    ray.addEventListener('selectstart', () => this.#grab(hand));
    ray.addEventListener('selectend', () => this.#release(hand));
    ray.addEventListener('squeezestart', () => {
      this.#aim(hand);
      const target = hand.direction.clone().multiplyScalar(4).add(hand.origin);
      this.#world.connection.send('throw', { origin: hand.origin.toArray(), target: target.toArray() });
    });
    return hand;
  }

  #aim(hand) {
    hand.ray.updateWorldMatrix(true, false);
    hand.origin.setFromMatrixPosition(hand.ray.matrixWorld);
    hand.direction.setFromMatrixColumn(hand.ray.matrixWorld, 2).normalize().negate();
  }

  /// With which what a hand lets go leaves it, as in the last pictures; 0: with its own.
  #velocityOf({ was }) {
    const first = was[0],
      last = was.at(-1),
      velocity = new THREE.Vector3();
    if (last.time - first.time > kLongestThrow) return velocity;
    return velocity.subVectors(last.at, first.at).divideScalar(last.time - first.time).clampLength(0, kFastestThrow);
  }

  #remember({ ray, grip, was }, time) {
    const shown = grip.visible ? grip : ray,
      oldest = was.shift();
    shown.updateWorldMatrix(true, false);
    oldest.time = time;
    oldest.at.setFromMatrixPosition(shown.matrixWorld);
    was.push(oldest);
  }

  #wire({ origin, direction }) {
    return { origin: origin.toArray(), direction: direction.toArray(), forward: direction.toArray() };
  }

  #grab(hand) {
    const { view, connection } = this.#world;
    if (view.held[hand.index] || !this.#world.mayDrag()) return;
    this.#aim(hand);
    const hit = view.hit(hand.origin, hand.direction);
    if (!hit) return;
    view.hold(hit, hand.index);
    connection.send('press', { hand: hand.index, ...this.#wire(hand) });
  }

  #release(hand) {
    const { view, connection } = this.#world;
    if (!view.held[hand.index]) return;
    view.hold(null, hand.index);
    connection.send('release', { hand: hand.index, velocity: this.#velocityOf(hand).toArray() });
  }

  /// Once a picture in a headset, before it is drawn.
  update(frame, seconds) {
    const { stage, view, avatars, connection } = this.#world;
    const pose = frame?.getViewerPose(stage.renderer.xr.getReferenceSpace());
    const avatar = avatars[Math.max(view.followed, 0)];
    if (pose) this.#walk(pose.transform, seconds);
    if (pose && avatar?.loaded && avatar.present) this.#place(pose.transform, avatar, seconds);
    if (pose && this.#world.live()) this.#sendPose(pose.transform);
    for (const hand of this.#hands) {
      this.#aim(hand);
      const holds = view.held[hand.index] !== null;
      if (holds) connection.drag(this.#wire(hand), hand.index);
      const hit = holds || !hand.line.visible ? null : view.hit(hand.origin, hand.direction);
      hand.dot.visible = hit !== null;
      if (hit) hand.dot.position.copy(hit.point);
      const marker = view.markers[hand.index].position;
      hand.line.scale.z = holds ? hand.origin.distanceTo(marker) : hit ? hit.distance : kReach;
      this.#remember(hand, performance.now() / 1000);
      this.#showFingers(hand);
    }
  }

  #sendPose({ position, orientation }) {
    const time = performance.now() / 1000;
    if (time - this.#sentAt < kBetweenHeads) return;
    this.#sentAt = time;
    const pose = { time, ...wired(position, orientation) };
    if (this.#registration?.alone) pose.hands = ['left', 'right'].map((side) => this.#gripOf(side));
    this.#world.connection.send('head', pose);
  }

  #gripOf(side) {
    const hand = this.#hands.find((one) => one.side === side && one.grip.visible);
    if (!hand) return null;
    hand.grip.matrix.decompose(local, turn, scale);
    return wired(local, turn);
  }

  /// The left stick walks where the head looks, the right one turns by 30 degrees around the head.
  #walk({ position, orientation }, seconds) {
    const { rig, renderer } = this.#world.stage;
    for (const { handedness, gamepad } of renderer.xr.getSession().inputSources) {
      const [, , x = 0, y = 0] = gamepad?.axes ?? [];
      if (handedness === 'left' && this.#placed === 'beside' && Math.hypot(x, y) > 0.15) {
        look.set(x, 0, y).applyQuaternion(turn.copy(orientation)).setY(0).applyAxisAngle(kUp, rig.rotation.y);
        rig.position.addScaledVector(look, kWalk * seconds);
      } else if (handedness === 'right') {
        const wants = Math.abs(x) > 0.7 ? Math.sign(x) : Math.abs(x) < 0.3 ? 0 : this.#turned;
        if (wants !== 0 && wants !== this.#turned) {
          rig.position.add(local.copy(position).applyAxisAngle(kUp, rig.rotation.y));
          rig.rotation.y -= (wants * Math.PI) / 6;
          rig.position.sub(local.copy(position).applyAxisAngle(kUp, rig.rotation.y));
        }
        this.#turned = wants;
      }
    }
  }

  #showFingers({ joints, fingers }) {
    fingers.count = 0;
    for (const joint of Object.values(joints.joints ?? {})) {
      if (!joint.visible || fingers.count === 25) continue;
      matrix.makeScale(joint.jointRadius, joint.jointRadius, joint.jointRadius).setPosition(joint.position);
      fingers.setMatrixAt(fingers.count++, matrix);
    }
    fingers.instanceMatrix.needsUpdate = true;
  }

  /// Beside the avatar once, looking at it; inside, the eyes are where its eyes are, and turn freely.
  /// With a registration the head's own motion counts at once, and the avatar's place slowly.
  #place({ position, orientation }, avatar, seconds) {
    const { rig } = this.#world.stage,
      inside = this.presence === 'inside' && this.mode === 'vr';
    this.#wear(inside ? avatar : null);
    if (!inside && this.#placed === 'beside') return;
    look.set(0, 0, -1).applyQuaternion(turn.copy(orientation));
    if (this.#placed !== (inside ? 'inside' : 'beside')) {
      avatar.facing(wanted);
      if (!inside) wanted.negate();
      rig.rotation.y = Math.atan2(wanted.x, wanted.z) - Math.atan2(look.x, look.z);
      this.#placed = inside ? 'inside' : 'beside';
    }
    const { known, alone, yaw } = this.#registration ?? {};
    const registered = inside && (known || alone) && this.#world.live();
    if (registered) rig.rotation.y = alone ? 0 : yaw;
    local.copy(position).applyAxisAngle(kUp, rig.rotation.y);
    if (registered) rig.position.lerp(avatar.eye(eye).sub(local), 1 - Math.exp(-seconds / kSettles));
    else if (inside) rig.position.copy(avatar.eye(eye)).sub(local);
    else rig.position.copy(avatar.center).addScaledVector(wanted, -kBeside[this.mode]).sub(local).setY(0);
    rig.updateMatrixWorld();
  }
}

const wired = (p, o) => ({ position: [p.x, p.y, p.z], orientation: [o.x, o.y, o.z, o.w] });

const kUp = new THREE.Vector3(0, 1, 0),
  scale = new THREE.Vector3(),
  matrix = new THREE.Matrix4(),
  turn = new THREE.Quaternion();
const look = new THREE.Vector3(),
  wanted = new THREE.Vector3(),
  local = new THREE.Vector3(),
  eye = new THREE.Vector3();
