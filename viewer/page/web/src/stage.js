// What is around the avatars: renderer, light, sky, ground, shadows.
import * as THREE from 'three';

const kKeyDirection = new THREE.Vector3(-0.42, 1, 0.52).normalize();
const kLight = { key: [0.98, 0.95, 0.9], sky: [0.4, 0.42, 0.46], ground: [0.27, 0.26, 0.25] }; // AvatarLight of the window
const kShadowReach = 3.2; // half a side of what has shadows [m]

/// sRGB. `null` = nothing is drawn there.
export const kBackgrounds = {
  light: { horizon: [0.908, 0.92, 0.932], zenith: [0.69, 0.75, 0.812], floor: [0.745, 0.762, 0.785] },
  dark: { horizon: [0.2, 0.222, 0.258], zenith: [0.1, 0.115, 0.15], floor: [0.115, 0.127, 0.148] },
  green: { flat: [0, 1, 0] },
  transparent: { flat: null },
};
const kShadowsOf = { low: 0, medium: 1024, high: 2048 };
const kShareOf = { low: 0.6, medium: 0.8, high: 1 };

// The window's tone curve: dark and middle tones stay, highlights are compressed to below 1.
THREE.ShaderChunk.tonemapping_pars_fragment = THREE.ShaderChunk.tonemapping_pars_fragment.replace(
  'vec3 CustomToneMapping( vec3 color ) { return color; }',
  'vec3 CustomToneMapping( vec3 color ) { vec3 t = max( color - 0.5, 0.0 ) * 2.0; return min( color, 0.5 ) + 0.5 * t / ( 1.0 + t ); }',
);

const kWithoutHemisphere = THREE.ShaderChunk.lights_fragment_begin.replaceAll('NUM_HEMI_LIGHTS', '0');

/// The environment replaces the hemisphere's light, whose diffuse part is the same.
export function lit(material) {
  if (material.isMeshStandardMaterial) {
    material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace('#include <lights_fragment_begin>', kWithoutHemisphere);
    };
  }
  return material;
}

/// A sky of one colour over a ground of another, for reflections.
function environment() {
  const width = 64,
    height = 32,
    texels = new Float32Array(4 * width * height);
  for (let i = 0; i < width * height; ++i)
    texels.set([...(i < (width * height) / 2 ? kLight.ground : kLight.sky), 1], 4 * i);
  const texture = new THREE.DataTexture(texels, width, height, THREE.RGBAFormat, THREE.FloatType);
  texture.mapping = THREE.EquirectangularReflectionMapping;
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

function makeSky(colors) {
  const sky = new THREE.Mesh(
    new THREE.SphereGeometry(1, 32, 24),
    new THREE.ShaderMaterial({
      uniforms: colors,
      side: THREE.BackSide,
      depthWrite: false,
      depthTest: false,
      vertexShader: `varying vec3 ray;
      void main() { ray = position; gl_Position = projectionMatrix * vec4(mat3(modelViewMatrix) * position * 10.0, 1.0); }`,
      fragmentShader: `uniform vec3 horizon, zenith; varying vec3 ray;
      void main() { float t = clamp(normalize(ray).y * 1.6, 0.0, 1.0); gl_FragColor = vec4(mix(horizon, zenith, t * (2.0 - t)), 1.0); }`,
    }),
  );
  sky.renderOrder = -2;
  sky.frustumCulled = false;
  return sky;
}

/// A floor with lines each metre and each 25 cm, that fades into the horizon, with the shadow of the key light.
function makeGround(colors) {
  const material = new THREE.ShadowMaterial({ transparent: false, toneMapped: false });
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, colors);
    shader.vertexShader = shader.vertexShader
      .replace('#include <shadowmap_pars_vertex>', '#include <shadowmap_pars_vertex>\nvarying vec2 place;')
      .replace(
        '#include <worldpos_vertex>',
        '#include <worldpos_vertex>\nplace = (modelMatrix * vec4(position, 1.0)).xz;',
      );
    shader.fragmentShader = shader.fragmentShader
      .replace(
        '#include <common>',
        `#include <common>
      uniform vec3 horizon, floorColor; varying vec2 place;
      float lines(vec2 p, vec2 footprint, float width) { // share of a pixel that is covered by lines at integers
        vec2 w = footprint + width, away = abs(fract(p - 0.5) - 0.5);
        vec2 cover = clamp((0.5 * w - away) / footprint + 0.5, 0.0, 1.0) * (2.0 * width / w);
        return max(cover.x, cover.y);
      }`,
      )
      .replace(
        /gl_FragColor = [^;]*;/,
        `
      vec2 footprint = fwidth(place);
      float grid = max(0.085 * lines(place, footprint, 0.010), 0.06 * lines(place * 4.0, footprint * 4.0, 0.016));
      vec3 base = floorColor * (floorColor.g > 0.5 ? 1.0 - grid : 1.0 + 4.0 * grid) * mix(vec3(0.735, 0.755, 0.785), vec3(1.0), getShadowMask());
      float fade = clamp((length(place) - 5.0) / 25.0, 0.0, 1.0);
      gl_FragColor = vec4(mix(base, horizon, fade * (2.0 - fade)), 1.0);`,
      )
      .replace('#include <colorspace_fragment>', ''); // the colours are sRGB
  };
  const ground = new THREE.Mesh(new THREE.CircleGeometry(60, 48).rotateX(-Math.PI / 2), material);
  ground.receiveShadow = true;
  ground.renderOrder = -1;
  return ground;
}

export class Stage {
  scene = new THREE.Scene();
  camera = new THREE.PerspectiveCamera(34, 1, 0.05, 120);
  rig = new THREE.Group(); // where the floor of a headset is
  fov = 0.6; // [rad], vertical, in a picture that is not upright
  quality = 'high';
  half = { x: 0.5, y: 0.3 }; // tangents of the half angles that panels leave free
  #colors = {
    horizon: { value: new THREE.Vector3() },
    zenith: { value: new THREE.Vector3() },
    floorColor: { value: new THREE.Vector3() },
  };
  #layout = { width: 1, height: 1, right: 0, bottom: 0 };

  /// @throws if the browser has no WebGL 2
  constructor(canvas) {
    this.renderer = new THREE.WebGLRenderer({
      canvas,
      antialias: true,
      alpha: true,
      powerPreference: 'high-performance',
    });
    this.renderer.toneMapping = THREE.CustomToneMapping;
    this.renderer.xr.enabled = true;
    this.renderer.shadowMap.enabled = true;
    this.sky = makeSky(this.#colors);
    this.ground = makeGround(this.#colors);
    this.key = new THREE.DirectionalLight(new THREE.Color(...kLight.key), Math.PI);
    this.key.castShadow = true;
    this.key.shadow.normalBias = 0.012;
    Object.assign(this.key.shadow.camera, {
      left: -kShadowReach,
      right: kShadowReach,
      bottom: -kShadowReach,
      top: kShadowReach,
      near: 0.5,
      far: 14,
    });
    this.scene.add(
      this.sky,
      this.ground,
      this.key,
      this.key.target,
      this.rig,
      new THREE.HemisphereLight(new THREE.Color(...kLight.sky), new THREE.Color(...kLight.ground), Math.PI),
    );
    this.rig.add(this.camera);
    this.scene.environment = environment();
    this.lightAt(new THREE.Vector3(0, 0.9, 0));
  }

  /// Shadows are drawn around this point; they stay while it moves little, so that they do not shimmer.
  lightAt(point) {
    if (this.key.target.position.distanceTo(point) < 0.6 && this.key.position.y > 1) return;
    this.key.target.position.copy(point);
    this.key.position.copy(kKeyDirection).multiplyScalar(7).add(point);
    this.key.target.updateMatrixWorld();
  }

  /// @param through  AR: the room is the background
  show({ background, ground, through = false }) {
    const { flat, horizon, zenith, floor } = kBackgrounds[background];
    const around = flat === undefined && !through;
    this.sky.visible = around;
    this.ground.visible = around && ground;
    if (around) {
      this.#colors.horizon.value.fromArray(horizon);
      this.#colors.zenith.value.fromArray(zenith);
      this.#colors.floorColor.value.fromArray(floor);
    }
    this.renderer.setClearColor(
      flat && !through ? new THREE.Color().setRGB(...flat, THREE.SRGBColorSpace) : 0,
      flat && !through ? 1 : 0,
    );
  }

  setQuality(quality) {
    this.quality = quality;
    const side = kShadowsOf[quality];
    this.key.castShadow = side > 0;
    if (side > 0 && this.key.shadow.mapSize.x !== side) {
      this.key.shadow.mapSize.set(side, side);
      this.key.shadow.map?.dispose();
      this.key.shadow.map = null;
    }
    this.resize(this.#layout);
  }

  /// @param layout  size of the canvas, and what panels cover at the right and at the bottom [CSS pixels]
  resize(layout) {
    this.#layout = layout;
    if (this.renderer.xr.isPresenting) return;
    const { width, height, right, bottom } = layout;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * kShareOf[this.quality]);
    this.renderer.setSize(width, height, false);
    const freeWidth = Math.max(width - right, 1),
      freeHeight = Math.max(height - bottom, 1);
    // The free area sees the field of view, in an upright one horizontally most of it; the rest is behind the panels.
    const tangent = Math.tan(this.fov / 2) * Math.max(1, (0.82 * freeHeight) / freeWidth);
    this.half = { x: (tangent * freeWidth) / freeHeight, y: tangent };
    this.camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan((tangent * height) / freeHeight));
    this.camera.aspect = width / height;
    if (right || bottom) this.camera.setViewOffset(width, height, right / 2, bottom / 2, width, height);
    else this.camera.clearViewOffset();
    this.camera.updateProjectionMatrix();
  }

  /// A PNG without panels.
  picture() {
    const layout = this.#layout;
    this.resize({ ...layout, right: 0, bottom: 0 });
    this.renderer.render(this.scene, this.camera);
    const blob = new Promise((resolve) => {
      this.renderer.domElement.toBlob(resolve, 'image/png');
    });
    this.resize(layout);
    return blob;
  }
}
