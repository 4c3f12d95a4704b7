#include "viewer/shaders.h"

namespace lorica::shaders {
namespace {

// Must agree with FrameUniforms in frame_setup.h.
constexpr const char* kFrame = R"(#version 330 core
layout(std140) uniform Frame {
  mat4 clipFromWorld;
  mat4 shadowFromWorld;  // to texture coordinates and depth, 0 to 1
  vec4 eye;
  vec4 rayForward;  // a pixel's ray is forward + x right + y up, x and y in clip space
  vec4 rayRight;
  vec4 rayUp;  // w: cotangent of half the vertical angle of view
  vec4 toLight;      // w: one shadow texel in texture coordinates
  vec4 contactArea;  // centre x, z; half side; height that still counts [m]
  vec4 floorFade;    // x, z of the middle; distances where fading starts and ends [m]
  vec4 viewport;     // width, height and their inverses
};
)";

// The shoulder leaves dark and middle tones as they are and rolls highlights off below 1.
constexpr const char* kColor = R"(
vec3 toSrgb(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThan(c, vec3(0.0031308))));
}
vec3 toneMap(vec3 c) {
  vec3 t = max(c - 0.5, 0.0) * 2.0;
  return min(c, 0.5) + 0.5 * t / (1.0 + t);
}
// Studio backdrop, linear RGB: the horizon is the colour of the far floor.
vec3 backdrop(float elevation) {
  float t = clamp(elevation * 1.6, 0.0, 1.0);
  return mix(vec3(0.800, 0.825, 0.850), vec3(0.430, 0.520, 0.620), t * (2.0 - t));
}
)";

constexpr const char* kShadow = R"(
uniform sampler2DShadow shadowMap;
)";

constexpr const char* kSurface = R"(
in vec3 worldPosition;
in vec3 worldNormal;
flat in vec3 albedo;
out vec4 color;

float keyLight(vec3 n) {
  // Moved off the surface along its normal, by more where light grazes it: no surface shades itself.
  vec3 p = worldPosition + n * 0.012;
  vec3 s = (shadowFromWorld * vec4(p, 1.0)).xyz;
  float d = 0.9 * toLight.w;
  return 0.25 * (texture(shadowMap, s + vec3(-d, -0.4 * d, 0.0)) + texture(shadowMap, s + vec3(0.4 * d, -d, 0.0)) +
                 texture(shadowMap, s + vec3(d, 0.4 * d, 0.0)) + texture(shadowMap, s + vec3(-0.4 * d, d, 0.0)));
}

void main() {
  vec3 n = normalize(worldNormal);
  if (!gl_FrontFacing) n = -n;
  vec3 v = normalize(eye.xyz - worldPosition);
  float facing = dot(n, toLight.xyz);
  float key = max(facing, 0.0) * keyLight(n);
  float up = 0.5 + 0.5 * n.y;

  // Near the floor, what looks down sees little of the room.
  float open = 1.0 - 0.5 * (1.0 - up) * (1.0 - clamp(worldPosition.y * 2.5, 0.0, 1.0));
  vec3 ambient = mix(vec3(0.30, 0.285, 0.27), vec3(0.50, 0.545, 0.60), up) * open;
  vec3 light = ambient + vec3(1.22, 1.15, 1.05) * key;

  vec3 h = normalize(toLight.xyz + v);
  float gloss = pow(max(dot(n, h), 0.0), 36.0) * 0.16 * key;
  float edge = 1.0 - max(dot(n, v), 0.0);
  float rim = edge * edge * edge * (0.10 + 0.22 * up);
  color = vec4(toSrgb(toneMap(albedo * light + gloss + rim * vec3(0.75, 0.85, 1.0))), 1.0);
}
)";

}  // namespace

std::string skinVertex(Pass pass) {
  std::string text = kFrame;
  text += R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tint;
)";
  if (pass == Pass::kLit) {
    return text + R"(
out vec3 worldPosition;
out vec3 worldNormal;
flat out vec3 albedo;
void main() {
  worldPosition = position;
  worldNormal = normal;
  albedo = tint;
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
)";
  }
  if (pass == Pass::kShadow) {
    return text + "void main() { gl_Position = vec4((shadowFromWorld * vec4(position, 1.0)).xyz * 2.0 - 1.0, 1.0); }\n";
  }
  return text + R"(
out float height;
void main() {
  height = position.y / contactArea.w;
  gl_Position = vec4((position.xz - contactArea.xy) / contactArea.z, height * 2.0 - 1.0, 1.0);
}
)";
}

std::string propVertex(Pass pass) {
  std::string text = kFrame;
  text += R"(
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 columnX;
layout(location = 3) in vec3 columnY;
layout(location = 4) in vec3 columnZ;
layout(location = 5) in vec3 origin;
layout(location = 6) in vec4 extentsAndBevel;
layout(location = 7) in vec3 tint;
vec3 place() {
  vec3 p = corner * extentsAndBevel.xyz + normal * extentsAndBevel.w;
  return columnX * p.x + columnY * p.y + columnZ * p.z + origin;
}
)";
  if (pass == Pass::kLit) {
    return text + R"(
out vec3 worldPosition;
out vec3 worldNormal;
flat out vec3 albedo;
void main() {
  worldPosition = place();
  worldNormal = columnX * normal.x + columnY * normal.y + columnZ * normal.z;
  albedo = tint;
  gl_Position = clipFromWorld * vec4(worldPosition, 1.0);
}
)";
  }
  if (pass == Pass::kShadow) {
    return text + "void main() { gl_Position = vec4((shadowFromWorld * vec4(place(), 1.0)).xyz * 2.0 - 1.0, 1.0); }\n";
  }
  return text + R"(
out float height;
void main() {
  vec3 p = place();
  height = p.y / contactArea.w;
  gl_Position = vec4((p.xz - contactArea.xy) / contactArea.z, height * 2.0 - 1.0, 1.0);
}
)";
}

std::string surfaceFragment(Pass pass) {
  if (pass == Pass::kLit) return std::string(kFrame) + kColor + kShadow + kSurface;
  if (pass == Pass::kShadow) return "#version 330 core\nvoid main() {}\n";
  return R"(#version 330 core
in float height;
out vec4 nearness;
void main() {
  float n = 1.0 - clamp(height, 0.0, 1.0);
  nearness = vec4(n * n);
}
)";
}

std::string skyVertex() {
  return std::string(kFrame) + R"(
out vec3 ray;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  ray = rayForward.xyz + p.x * rayRight.xyz + p.y * rayUp.xyz;
  gl_Position = vec4(p, 1.0, 1.0);
}
)";
}

std::string skyFragment() {
  return std::string(kFrame) + kColor + R"(
in vec3 ray;
out vec4 color;
void main() { color = vec4(toSrgb(backdrop(normalize(ray).y)), 1.0); }
)";
}

std::string groundVertex() {
  return std::string(kFrame) + R"(
layout(location = 0) in vec2 place;
out vec2 ground;
void main() {
  ground = place;
  gl_Position = clipFromWorld * vec4(place.x, 0.0, place.y, 1.0);
}
)";
}

std::string groundFragment(bool shaded) {
  std::string text = std::string(kFrame) + kColor + kShadow + R"(
uniform sampler2D contactMap;
in vec2 ground;
out vec4 color;
// Share of a pixel that lines of this width cover, one line at each whole number.
float lines(vec2 p, vec2 footprint, float width) {
  vec2 w = footprint + width;
  vec2 distance = abs(fract(p - 0.5) - 0.5);
  vec2 cover = clamp((0.5 * w - distance) / footprint + 0.5, 0.0, 1.0) * (width / w) * 2.0;
  return max(cover.x, cover.y);
}
void main() {
  float away = length(ground - floorFade.xy);
  float fade = smoothstep(floorFade.z, floorFade.w, away);
  vec3 base = vec3(0.700, 0.720, 0.740);
  vec2 footprint = fwidth(ground);
  float grid = max(0.20 * lines(ground, footprint, 0.010), 0.14 * lines(ground * 4.0, footprint * 4.0, 0.016));
  base *= 1.0 - grid;
)";
  if (shaded) {
    text += R"(
  vec3 s = (shadowFromWorld * vec4(ground.x, 0.0, ground.y, 1.0)).xyz;
  float d = 1.7 * toLight.w;
  // Eight taps in a turned square and one in the middle; each is already a blend of four texels.
  float lit = 0.2 * texture(shadowMap, s);
  lit += 0.1 * (texture(shadowMap, s + vec3(d, 0.4 * d, 0.0)) + texture(shadowMap, s + vec3(-0.4 * d, d, 0.0)) +
                texture(shadowMap, s + vec3(-d, -0.4 * d, 0.0)) + texture(shadowMap, s + vec3(0.4 * d, -d, 0.0)) +
                texture(shadowMap, s + vec3(1.6 * d, -1.6 * d, 0.0)) + texture(shadowMap, s + vec3(1.6 * d, 1.6 * d, 0.0)) +
                texture(shadowMap, s + vec3(-1.6 * d, 1.6 * d, 0.0)) + texture(shadowMap, s + vec3(-1.6 * d, -1.6 * d, 0.0)));
  float contact = texture(contactMap, (ground - contactArea.xy) / contactArea.z * 0.5 + 0.5).r;
  base *= mix(vec3(0.50, 0.53, 0.58), vec3(1.0), lit) * (1.0 - 0.62 * contact);
)";
  }
  text += "  color = vec4(toSrgb(mix(base, backdrop(0.0), fade)), 1.0);\n}\n";
  return text;
}

std::string overlayVertex() {
  return std::string(kFrame) + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 tint;
layout(location = 3) in vec4 strength;
out vec3 toEye;
out vec3 corner;
flat out vec3 faceNormal;
flat out vec4 faceColor;
flat out vec3 edgeStrength;
void main() {
  toEye = eye.xyz - position;
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  faceNormal = normal.xyz;
  faceColor = tint;
  edgeStrength = strength.xyz;
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
)";
}

std::string overlayFragment() {
  return std::string(kFrame) + kColor + R"(
in vec3 toEye;
in vec3 corner;
flat in vec3 faceNormal;
flat in vec4 faceColor;
flat in vec3 edgeStrength;
out vec4 color;
void main() {
  vec3 n = normalize(faceNormal);
  float facing = dot(n, normalize(toEye));
  bool behind = facing < 0.0;
  float shade = 0.62 + 0.38 * dot(n, toLight.xyz) * (behind ? -0.5 : 1.0);

  // Distance to each side in pixels, from how fast the barycentric coordinate changes.
  vec3 dx = dFdx(corner), dy = dFdy(corner);
  vec3 pixels = corner * inversesqrt(max(dx * dx + dy * dy, 1e-12));
  float halfWidth = 0.0011 * viewport.y + 0.35;
  vec3 cover = edgeStrength * (1.0 - smoothstep(halfWidth - 0.5, halfWidth + 0.5, pixels));
  float edge = max(cover.x, max(cover.y, cover.z));

  bool solid = faceColor.a > 0.5;
  float grazing = 1.0 - abs(facing);
  float alpha = solid ? 1.0 : (behind ? 0.10 : 0.24 + 0.26 * grazing * grazing);
  float edgeAlpha = solid ? 0.55 : (behind ? 0.22 : 0.85);
  vec3 fill = faceColor.rgb * shade * 1.15 + (behind ? 0.0 : 0.06);
  vec3 ink = solid ? faceColor.rgb * 0.25 : faceColor.rgb * 0.38;
  vec3 mixed = mix(fill, ink, edge * edgeAlpha);
  color = vec4(toSrgb(toneMap(mixed)), max(alpha, edge * edgeAlpha));
}
)";
}

std::string markerVertex() {
  return std::string(kFrame) + R"(
layout(location = 0) in vec3 center;
layout(location = 1) in vec2 corner;
out vec2 disc;
flat out float radius;  // [pixels]
void main() {
  vec4 c = clipFromWorld * vec4(center, 1.0);
  // 16 mm large, but never below what can be seen.
  float pixelsPerMetre = 0.5 * viewport.y * rayUp.w / max(c.w, 1e-3);
  radius = max(0.016 * pixelsPerMetre, 0.006 * viewport.y + 2.0);
  disc = corner * (radius + 1.0);
  c.xy += disc * 2.0 * viewport.zw * c.w;
  gl_Position = c;
}
)";
}

std::string markerFragment() {
  return std::string(kFrame) + R"(
uniform vec4 tint;
in vec2 disc;
flat in float radius;
out vec4 color;
void main() {
  float d = length(disc);
  float inside = clamp(radius - d + 0.5, 0.0, 1.0);
  float core = clamp(0.62 * radius - d + 0.5, 0.0, 1.0);
  color = vec4(mix(vec3(1.0), vec3(1.0, 0.20, 0.12), core), inside * tint.a);
}
)";
}

std::string fullVertex() {
  return R"(#version 330 core
out vec2 place;
void main() {
  place = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(place * 2.0 - 1.0, 0.0, 1.0);
}
)";
}

std::string blurFragment() {
  // Binomial weights 1 8 28 56 70 56 28 8 1, taken in pairs between texels: five reads.
  return R"(#version 330 core
uniform sampler2D source;
uniform vec4 stride;
in vec2 place;
out vec4 color;
void main() {
  vec2 a = stride.xy * 1.3333, b = stride.xy * 3.1111;
  color = 0.2734375 * texture(source, place) +
          0.328125 * (texture(source, place + a) + texture(source, place - a)) +
          0.03515625 * (texture(source, place + b) + texture(source, place - b));
}
)";
}

std::string panelVertex() {
  return R"(#version 330 core
uniform vec4 rectangle;
out vec2 place;
void main() {
  vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  place = vec2(p.x, 1.0 - p.y);
  gl_Position = vec4(mix(rectangle.xy, rectangle.zw, p), 0.0, 1.0);
}
)";
}

std::string panelFragment() {
  return R"(#version 330 core
uniform sampler2D source;
in vec2 place;
out vec4 color;
void main() { color = texture(source, place); }
)";
}

}  // namespace lorica::shaders
