// The camera, and the pointer: orbits, or drags the prop that it meets.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const kSides = {
  front: [0.57, 0.12, 0.82],
  back: [0, 0.15, -1],
  left: [1, 0.1, 0.05],
  right: [-1, 0.1, 0.05],
  above: [0, 1, 0.02],
};
const kFilled = 0.9, // of the free area, by the avatars
  kNearer = 3; // in which the camera comes back most of the way [s]
const kAround = 0.12; // of an avatar's height: head, hands and feet reach so far beyond its joints
const kClick = 6; // a press that moves less is a click [CSS pixels]

export class View {
  follow = true;
  followed = -1; // an avatar, or all
  held = [null, null]; // of each hand { mesh, local }: the point of a prop that is held; the pointer is the first hand
  markers = [];
  #world;
  #caster = new THREE.Raycaster();
  #pointer = new THREE.Vector2();
  #center = new THREE.Vector3(0, 0.95, 0);
  #placed = false;
  #home = { eye: [1.8, 1.6, 3.6], target: [0, 0.95, 0], distance: 4 };
  #distance = 0; // from which all is seen
  #down = null;
  #touched = false; // the camera, since it was at home

  /// @param world  { stage, props, avatars, connection, mayDrag(), changed() }
  constructor(world, canvas) {
    this.#world = world;
    this.canvas = canvas;
    // Before those of the OrbitControls, which do not get a press that meets a prop.
    canvas.addEventListener('pointerdown', (event) => this.#press(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    for (const type of ['pointerup', 'pointercancel']) canvas.addEventListener(type, (event) => this.#up(event));
    this.controls = new OrbitControls(world.stage.camera, canvas);
    Object.assign(this.controls, {
      enableDamping: true,
      dampingFactor: 0.16,
      maxPolarAngle: Math.PI / 2 - 0.03,
      minDistance: 0.4,
      maxDistance: 40,
    });
    this.controls.addEventListener('start', () => {
      this.#touched = true;
    });
    this.controls.addEventListener('change', () => world.changed());
    const ball = new THREE.SphereGeometry(0.022, 16, 12),
      orange = new THREE.MeshBasicMaterial({ color: 0xff7a1a, depthTest: false, transparent: true });
    this.markers = this.held.map(() => new THREE.Mesh(ball, orange));
    for (const marker of this.markers) Object.assign(marker, { renderOrder: 7, visible: false });
    world.stage.scene.add(...this.markers);
    this.reset();
  }

  home({ eye, target, fov }) {
    this.#home = { eye, target, distance: new THREE.Vector3(...eye).distanceTo(new THREE.Vector3(...target)) };
    this.#world.stage.fov = fov;
    this.reset();
  }

  reset() {
    this.#world.stage.camera.position.set(...this.#home.eye);
    this.controls.target.set(...this.#home.target);
    this.#placed = this.#touched = false;
    this.#distance = 0;
    this.controls.update();
    this.#world.changed();
  }

  /// front, back, left, right, above: of the avatar that is followed
  look(side) {
    const avatar = this.#world.avatars[Math.max(this.followed, 0)],
      { camera } = this.#world.stage;
    if (!avatar) return;
    const facing = avatar.facing(new THREE.Vector3()),
      [x, y, z] = kSides[side];
    const distance = Math.min(Math.max(camera.position.distanceTo(this.controls.target), 2.5), 5);
    this.controls.target.copy(this.#center);
    const offset = new THREE.Vector3(facing.z * x + facing.x * z, y, -facing.x * x + facing.z * z).setLength(distance);
    camera.position.copy(this.#center).add(offset);
    this.controls.update();
    this.#world.changed();
  }

  /// What balls are thrown at, and the light is around.
  center(out) {
    const shown = this.#world.avatars.filter((a, i) => a.present && (this.followed < 0 || this.followed === i));
    if (shown.length === 0) return out.copy(this.controls.target);
    out.set(0, 0, 0);
    for (const avatar of shown) out.add(avatar.center);
    return out.divideScalar(shown.length);
  }

  /// Once a picture. @return whether the camera moved
  update(seconds, presents) {
    const { stage, connection } = this.#world,
      goal = this.center(point);
    if (!this.#placed) {
      this.#center.copy(goal);
      this.#placed = true;
    }
    const step = moved
      .copy(goal)
      .sub(this.#center)
      .multiplyScalar(1 - Math.exp(-seconds / 0.35));
    this.#center.add(step);
    if (this.follow && !presents && step.lengthSq() > 1e-9) {
      stage.camera.position.add(step);
      this.controls.target.add(step);
    }
    if (!presents && !this.#touched) this.#showWholly(seconds);
    stage.lightAt(this.#center);
    this.held.forEach((held, hand) => {
      if (held) this.markers[hand].position.copy(held.local).applyMatrix4(held.mesh.matrixWorld);
    });
    connection.drawn(this.#world.newest());
    return !presents && this.controls.update(seconds);
  }

  /// Keeps the avatars, whole, in the middle of what panels leave free, until the user moves the camera. It is no nearer than
  /// the server's, whose picture is wider where this one is upright. It goes back at once, and comes near again slowly.
  #showWholly(seconds) {
    const { stage, avatars } = this.#world,
      { camera, half, fov } = stage,
      { target } = this.controls,
      shown = avatars.filter((avatar) => avatar.present && !avatar.box.isEmpty());
    if (shown.length === 0) return;
    box.makeEmpty();
    for (const avatar of shown) box.union(avatar.box);
    const share = 1 - Math.exp(-seconds / 0.3);
    if (this.follow) {
      box.getCenter(moved).sub(target).multiplyScalar(share);
      target.add(moved);
      camera.position.add(moved);
    }
    const [right, up, back] = axes;
    camera.matrix.extractBasis(right, up, back);
    const around = kAround * box.getSize(moved).y;
    let needed = this.#home.distance * Math.min(1, Math.tan(fov / 2) / half.y);
    const fit = (joint) => {
      joint.sub(target);
      const across = Math.max((Math.abs(joint.dot(right)) + around) / half.x, (Math.abs(joint.dot(up)) + around) / half.y);
      needed = Math.max(needed, across / kFilled + joint.dot(back));
    };
    for (const avatar of shown) avatar.eachJoint(fit);
    this.#distance = needed + Math.exp(-seconds / kNearer) * Math.max(this.#distance - needed, 0);
    moved.copy(camera.position).sub(target);
    const distance = moved.length();
    camera.position.copy(target).add(moved.setLength(distance + (this.#distance - distance) * share));
  }

  hold(hit, hand = 0) {
    this.held[hand] = hit ? { mesh: hit.object, local: hit.object.worldToLocal(hit.point.clone()) } : null;
    this.markers[hand].visible = hit !== null;
    if (hit) this.markers[hand].position.copy(hit.point);
    this.#world.changed();
  }

  /// After other props came: what is held is held on.
  keep() {
    this.held.forEach((held, hand) => {
      if (!held) return;
      const mesh = this.#world.props.list[held.mesh.userData.index];
      if (mesh) held.mesh = mesh;
      else this.hold(null, hand);
    });
  }

  /// The first loose prop that a ray meets, if no fixed one is before it.
  hit(origin, direction) {
    this.#caster.set(origin, direction);
    const [first] = this.#caster.intersectObjects(
      this.#world.props.list.filter((mesh) => mesh.visible),
      false,
    );
    return first && !first.object.userData.fixed ? first : null;
  }

  #ray(event) {
    const box = this.canvas.getBoundingClientRect(),
      { camera } = this.#world.stage;
    this.#pointer.set(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
    camera.updateMatrixWorld();
    this.#caster.setFromCamera(this.#pointer, camera);
    const { origin, direction } = this.#caster.ray;
    return {
      origin: camera.position.toArray(),
      direction: direction.toArray(),
      forward: camera.getWorldDirection(new THREE.Vector3()).toArray(),
      ray: { origin, direction },
    };
  }

  #press(event) {
    if (event.button !== 0 || this.held[0]) return;
    this.#down = { id: event.pointerId, x: event.clientX, y: event.clientY };
    if (!this.#world.mayDrag() || !event.isPrimary) return;
    const { ray, ...wire } = this.#ray(event),
      hit = this.hit(ray.origin.clone(), ray.direction.clone());
    if (!hit) return;
    event.stopImmediatePropagation();
    this.controls.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
    this.#down.drags = true;
    this.hold(hit);
    this.canvas.style.cursor = 'grabbing';
    this.#world.connection.send('press', wire);
  }

  #move(event) {
    if (this.#down?.drags && event.pointerId === this.#down.id) {
      const { ray, ...wire } = this.#ray(event);
      this.#world.connection.drag(wire);
    } else if (event.pointerType === 'mouse' && event.buttons === 0 && this.#world.mayDrag()) {
      const { ray } = this.#ray(event);
      this.canvas.style.cursor = this.hit(ray.origin.clone(), ray.direction.clone()) ? 'grab' : '';
    }
  }

  #up(event) {
    const down = this.#down;
    if (!down || event.pointerId !== down.id) return;
    this.#down = null;
    if (down.drags) {
      this.#world.connection.send('release');
      this.controls.enabled = true;
      this.canvas.style.cursor = '';
      this.hold(null);
    } else if (Math.hypot(event.clientX - down.x, event.clientY - down.y) < kClick && event.type === 'pointerup') {
      this.#choose(this.#ray(event).ray);
    }
  }

  /// With several avatars: follows the clicked one; elsewhere, all.
  #choose({ origin, direction }) {
    const { avatars } = this.#world;
    if (avatars.length < 2) return;
    const ray = new THREE.Ray(origin, direction);
    const near = avatars
      .map((a, i) => [i, a.present ? ray.distanceToPoint(a.center) : Infinity, a.center.distanceTo(origin)])
      .filter(([, away]) => away < 0.45)
      .sort((a, b) => a[2] - b[2]);
    this.followed = near[0]?.[0] ?? -1;
  }
}

const box = new THREE.Box3(),
  axes = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()],
  point = new THREE.Vector3(),
  moved = new THREE.Vector3();
