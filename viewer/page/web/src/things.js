// Props, hulls, bones, contacts and particles.
import * as THREE from 'three';
import { RoundedBoxGeometry } from 'three/addons/geometries/RoundedBoxGeometry.js';
import { lit } from './stage.js';
import { edgesOf, matrixOfPose, readMesh } from './wire.js';

const tint = new THREE.Color();
const position = new THREE.Vector3(),
  quaternion = new THREE.Quaternion(),
  one = new THREE.Vector3(1, 1, 1);

const kShapes = {
  box: ([x, y, z]) => new RoundedBoxGeometry(2 * x, 2 * y, 2 * z, 2, Math.min(0.12 * Math.min(x, y, z), 0.015)),
  sphere: ([r]) => new THREE.SphereGeometry(r, 32, 20),
  capsule: ([r, h]) => new THREE.CapsuleGeometry(r, Math.max(2 * (h - r), 0), 10, 28),
  cylinder: ([r, h]) => new THREE.CylinderGeometry(r, r, 2 * h, 40),
};

export class Props {
  group = new THREE.Group();
  version = -1;
  list = [];
  #texts = []; // of each prop, to see which are others
  #geometries = new Map();
  #materials = new Map();

  /// Props that are as before keep their places.
  /// @param fetchBytes  async (path) => ArrayBuffer, for props with meshes
  set({ version, props }, run, fetchBytes, problem) {
    const texts = props.map((prop) => JSON.stringify(prop) + (prop.shape === 'mesh' ? run : ''));
    this.list = props.map((prop, index) =>
      texts[index] === this.#texts[index] ? this.list[index] : this.#make(prop, index, run, fetchBytes, problem),
    );
    this.group.clear();
    if (this.list.length > 0) this.group.add(...this.list);
    this.#texts = texts;
    this.version = version;
    this.#forget();
  }

  /// Frees what no prop uses any more.
  #forget() {
    const used = new Set(this.list.flatMap(({ geometry, material }) => [geometry, material]));
    for (const cache of [this.#geometries, this.#materials]) {
      for (const [key, value] of cache) {
        if (used.has(value)) continue;
        value.dispose();
        cache.delete(key);
      }
    }
  }

  #make({ shape, half, color, fixed, mesh: number }, index, run, fetchBytes, problem) {
    const key = shape === 'mesh' ? `mesh ${number} of ${run}` : `${shape} ${half}`;
    if (!this.#geometries.has(key)) {
      this.#geometries.set(key, kShapes[shape]?.(half) ?? new THREE.BufferGeometry());
      if (shape === 'mesh') this.#fetch(number, this.#geometries.get(key), fetchBytes, problem);
    }
    const mesh = new THREE.Mesh(this.#geometries.get(key), this.#material(color));
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.matrixAutoUpdate = false;
    mesh.visible = false; // until its pose is known
    mesh.userData = { index, fixed: fixed === true };
    return mesh;
  }

  async #fetch(number, geometry, fetchBytes, problem) {
    try {
      const { positions, indices } = readMesh(await fetchBytes(`/mesh/${number}`));
      geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
      geometry.setIndex(new THREE.BufferAttribute(indices, 1));
      geometry.computeVertexNormals();
      geometry.computeBoundingSphere();
    } catch (error) {
      problem(`The mesh of a prop: ${error.message}`);
    }
  }

  #material(color) {
    const key = `${color}`;
    if (!this.#materials.has(key)) {
      this.#materials.set(
        key,
        lit(new THREE.MeshStandardMaterial({ color: new THREE.Color(...color), roughness: 0.55 })),
      );
    }
    return this.#materials.get(key);
  }

  move({ count, indices, poses }) {
    for (let i = 0; i < count; ++i) {
      const mesh = this.list[indices[i]];
      if (!mesh) continue;
      position.fromArray(poses, 7 * i);
      quaternion.fromArray(poses, 7 * i + 3);
      mesh.matrix.compose(position, quaternion, one);
      mesh.position.copy(position);
      mesh.matrixWorldNeedsUpdate = true;
      mesh.visible = Number.isFinite(position.x + position.y + position.z);
    }
  }
}

/// A buffer whose array grows; the part in use is uploaded.
function room(geometry, name, itemSize, count, Type = Float32Array, normalized = false) {
  const old = name === 'index' ? geometry.index : geometry.attributes[name];
  if (old && old.count >= count) return old;
  const fresh = new THREE.BufferAttribute(
    new Type(itemSize * Math.ceil(count * 1.5 + 64)),
    itemSize,
    normalized,
  ).setUsage(THREE.DynamicDrawUsage);
  if (old) geometry.dispose();
  if (name === 'index') geometry.setIndex(fresh);
  else geometry.setAttribute(name, fresh);
  return fresh;
}

function upload(attribute, count) {
  attribute.clearUpdateRanges();
  attribute.addUpdateRange(0, count * attribute.itemSize);
  attribute.needsUpdate = true;
}

function overlay(object, order) {
  object.frustumCulled = false;
  object.matrixAutoUpdate = false;
  object.renderOrder = order;
  return object;
}

/// @param look  of their material
const linesOf = (look, order) =>
  overlay(
    new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, ...look })),
    order,
  );

/// Whether all corners of the faces are there.
const fits = ({ triangles, vertices }) => triangles.every((v) => 3 * v < vertices.length);

/// Translucent hulls with edges, all parts of an avatar in two meshes.
export class Hulls {
  group = new THREE.Group();
  #faces = overlay(
    new THREE.Mesh(
      new THREE.BufferGeometry(),
      new THREE.MeshBasicMaterial({
        vertexColors: true,
        transparent: true,
        opacity: 0.38,
        depthWrite: false,
        polygonOffset: true,
        polygonOffsetFactor: -1,
        polygonOffsetUnits: -2,
      }),
    ),
    2,
  );
  #edges = linesOf({ vertexColors: true, opacity: 0.9 }, 3);
  #known = []; // shape, faces and edges of each part
  #matrix = new Float32Array(12);

  constructor() {
    this.group.add(this.#faces, this.#edges);
  }

  set(parts) {
    let vertices = 0,
      corners = 0,
      ends = 0;
    this.#known.length = Math.min(this.#known.length, parts.length);
    parts.forEach((part, i) => {
      const known = (this.#known[i] ??= { triangles: [], edges: [], vertices: [] });
      if (part.triangles.length > 0) {
        known.triangles = part.triangles.slice();
        known.edges = edgesOf(part.vertices, part.triangles);
      }
      if (part.vertices.length > 0) known.vertices = part.vertices.slice();
      if (part.vertices.length > 0 && part.triangles.length === 0 && !fits(known)) known.vertices = [];
      vertices += known.vertices.length / 3;
      corners += known.vertices.length > 0 ? known.triangles.length : 0;
      ends += known.vertices.length > 0 ? known.edges.length : 0;
    });
    const faces = this.#faces.geometry,
      edges = this.#edges.geometry;
    const places = room(faces, 'position', 3, vertices),
      tints = room(faces, 'color', 3, vertices),
      dark = room(edges, 'color', 3, vertices);
    const face = room(faces, 'index', 1, corners, Uint32Array),
      edge = room(edges, 'index', 1, ends, Uint32Array),
      m = this.#matrix;
    edges.setAttribute('position', places);
    let vertex = 0,
      corner = 0,
      end = 0;
    parts.forEach((part, i) => {
      const known = this.#known[i];
      if (known.vertices.length === 0) return;
      const first = (known.first = vertex),
        scale = part.extent / 32767,
        [red, green, blue] = part.color;
      tint.setRGB(red / 255, green / 255, blue / 255, THREE.SRGBColorSpace);
      tint.toArray((known.color ??= []));
      matrixOfPose(part.pose, 0, m, 0);
      for (let v = 0; v < known.vertices.length; v += 3, ++vertex) {
        const x = known.vertices[v] * scale,
          y = known.vertices[v + 1] * scale,
          z = known.vertices[v + 2] * scale;
        for (let row = 0; row < 3; ++row) {
          places.array[3 * vertex + row] = m[4 * row] * x + m[4 * row + 1] * y + m[4 * row + 2] * z + m[4 * row + 3];
        }
        tint.toArray(tints.array, 3 * vertex);
        for (let c = 0; c < 3; ++c) dark.array[3 * vertex + c] = 0.3 * tints.array[3 * vertex + c];
      }
      for (const v of known.triangles) face.array[corner++] = first + v;
      for (const v of known.edges) edge.array[end++] = first + v;
    });
    for (const attribute of [places, tints, dark]) upload(attribute, vertices);
    upload(face, corners);
    upload(edge, ends);
    faces.setDrawRange(0, corners);
    edges.setDrawRange(0, ends);
  }

  /// Of each part its colour and the planes of its faces: normals and offsets, four numbers each, in the world. As faces
  /// may be slivers, each plane is moved out until no corner is beyond it.
  planes() {
    const { array } = this.#faces.geometry.attributes.position;
    return this.#known
      .filter(({ vertices }) => vertices.length > 0)
      .map(({ first, vertices, triangles, color }) => {
        const points = Array.from({ length: vertices.length / 3 }, (_, v) =>
          new THREE.Vector3().fromArray(array, 3 * (first + v)),
        );
        const planes = [];
        for (let t = 0; t < triangles.length; t += 3) {
          const [a, b, c] = [0, 1, 2].map((k) => points[triangles[t + k]]),
            normal = c.clone().sub(b).cross(position.subVectors(a, b)).normalize();
          if (normal.lengthSq() > 0.5)
            planes.push(...normal.toArray(), -Math.max(...points.map((point) => normal.dot(point))));
        }
        return { color, planes };
      });
  }

  dispose() {
    this.group.removeFromParent();
    for (const { geometry, material } of [this.#faces, this.#edges]) {
      geometry.dispose();
      material.dispose();
    }
  }
}

const kDisc = {
  // as the window's: red with a white rim, 16 mm, never tiny
  uniforms: { height: { value: 720 } },
  vertexShader: `uniform float height; varying float radius;
    void main() {
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      radius = max(0.016 * 0.5 * height * projectionMatrix[1][1] / max(gl_Position.w, 0.001), 0.006 * height + 2.0);
      gl_PointSize = 2.0 * radius + 2.0;
    }`,
  fragmentShader: `varying float radius;
    void main() {
      float d = length(gl_PointCoord * 2.0 - 1.0) * (radius + 1.0);
      gl_FragColor = vec4(mix(vec3(1.0), vec3(1.0, 0.20, 0.12), clamp(0.62 * radius - d + 0.5, 0.0, 1.0)), clamp(radius - d + 0.5, 0.0, 1.0));
    }`,
};

const kGrain = {
  // a ball's front, lit by the key light
  uniforms: { height: { value: 720 }, radius: { value: 0.02 }, tint: { value: new THREE.Vector3() } },
  vertexShader: `uniform float height, radius; varying vec3 light;
    void main() {
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      gl_PointSize = max(height * projectionMatrix[1][1] * radius * length(viewMatrix[0].xyz) / max(gl_Position.w, 0.001), 1.5);
      light = normalize(mat3(viewMatrix) * vec3(-0.42, 1.0, 0.52)) * vec3(1.0, -1.0, 1.0);
    }`,
  fragmentShader: `uniform vec3 tint; varying vec3 light;
    void main() {
      vec2 d = gl_PointCoord * 2.0 - 1.0;
      float z = 1.0 - dot(d, d);
      if (z < 0.0) discard;
      gl_FragColor = vec4(tint * (0.72 + 0.42 * clamp(dot(vec3(d, sqrt(z)), light), 0.0, 1.0)), 1.0);
    }`,
};

export class Contacts {
  points = overlay(
    new THREE.Points(
      new THREE.BufferGeometry(),
      new THREE.ShaderMaterial({ ...kDisc, transparent: true, depthTest: false }),
    ),
    5,
  );
  arrows = linesOf({ color: 0xff3b22, depthTest: false }, 4);
  group = new THREE.Group().add(this.arrows, this.points);

  /// An arrow is as long as its impulse says, at most 30 cm.
  set({ count, values }) {
    const places = room(this.points.geometry, 'position', 3, count),
      ends = room(this.arrows.geometry, 'position', 3, 2 * count);
    for (let i = 0; i < count; ++i) {
      const length = Math.min(0.05 + 0.02 * values[7 * i + 6], 0.3);
      for (let k = 0; k < 3; ++k) {
        places.array[3 * i + k] = ends.array[6 * i + k] = values[7 * i + k];
        ends.array[6 * i + 3 + k] = values[7 * i + k] + length * values[7 * i + 3 + k];
      }
    }
    upload(places, count);
    upload(ends, 2 * count);
    this.points.geometry.setDrawRange(0, count);
    this.arrows.geometry.setDrawRange(0, 2 * count);
  }
}

export class Particles {
  all = 0;
  sent = 0;
  points = overlay(new THREE.Points(new THREE.BufferGeometry(), new THREE.ShaderMaterial(kGrain)), 0);

  /// The places go to the graphics card as they came; the box is the matrix. Where only some were sent they are larger.
  set({ all, sent, radius, color, lowest, size, places }) {
    Object.assign(this, { all, sent });
    const attribute = room(this.points.geometry, 'position', 3, sent, Uint16Array, true);
    attribute.array.set(places);
    upload(attribute, sent);
    this.points.geometry.setDrawRange(0, sent);
    const { uniforms } = this.points.material;
    uniforms.radius.value = radius * Math.min(Math.cbrt(all / Math.max(sent, 1)), 3);
    uniforms.tint.value.set(color[0], color[1], color[2]).divideScalar(255);
    this.points.matrix.makeScale(...size).setPosition(...lowest);
    this.points.matrixWorldNeedsUpdate = true;
  }
}

/// Lines from joint to joint, over everything.
export class Bones {
  lines = linesOf({ color: 0xff9d2e, depthTest: false }, 6);

  set(avatars) {
    const places = room(this.lines.geometry, 'position', 3, 512 * Math.max(avatars.length, 1));
    let at = 0;
    for (const avatar of avatars) if (avatar.present) at += avatar.bones(places.array.subarray(at));
    upload(places, at / 3);
    this.lines.geometry.setDrawRange(0, at / 3);
  }
}
