#include "viewer/renderer/shaders.h"

#include <string_view>

namespace lorica::shaders {

// Must match FrameUniforms in frame_setup.h.
std::string frameBlock() {
  return R"(#version 330 core
layout(std140) uniform Frame {
  mat4 clipFromWorld;
  mat4 shadowFromWorld;  // to texture coordinates and depth, 0 to 1
  vec4 eye;
  vec4 rayForward;  // a pixel's ray is forward + x right + y up, x and y in clip space from (forward.w, right.w)
  vec4 rayRight;
  vec4 rayUp;  // w: cotangent of half the vertical field of view
  vec4 toLight;      // w: one shadow texel in texture coordinates
  vec4 contactArea;  // centre x, z; half side; maximum height [m]
  vec4 floorFade;    // centre x, z; distances where fading starts and ends [m]
  vec4 viewport;     // width, height and their inverses
  vec4 keyColor;     // light on avatars, linear RGB
  vec4 skyColor;     // w: time [s]
  vec4 groundColor;
  vec4 horizon;      // of sky and floor, in sRGB: their shaders need no conversion
  vec4 zenith;
  vec4 floorColor;   // w: how much brighter its lines are
};
)";
}

// sRGB by I. Taylor's fit with square roots, within 0.003 of the standard, at a third of the cost of pow on a CPU. The
// tone curve keeps dark and middle tones and compresses highlights to below 1.
std::string colorCurves() {
  return R"(
vec3 toSrgb(vec3 c) {
  vec3 a = sqrt(c), b = sqrt(a), d = sqrt(b);
  return max(0.662002687 * a + 0.684122060 * b - 0.323583601 * d - 0.0225411470 * c, 0.0);
}
vec3 toneMap(vec3 c) {
  vec3 t = max(c - 0.5, 0.0) * 2.0;
  return min(c, 0.5) + 0.5 * t / (1.0 + t);
}
)";
}

std::string shadowLookup() {
  return R"(
uniform sampler2DShadow shadowMap;
float shadowAt(vec3 p, vec3 n) {
  // Offset from the surface along its normal, so that no surface shadows itself: 6 mm, in large scenes a texel.
  float away = max(0.006, 2.0 * contactArea.z * toLight.w);
  vec3 s = (shadowFromWorld * vec4(p + n * away, 1.0)).xyz;
  float d = 0.9 * toLight.w;
  return 0.25 * (texture(shadowMap, s + vec3(-d, -0.4 * d, 0.0)) + texture(shadowMap, s + vec3(0.4 * d, -d, 0.0)) +
                 texture(shadowMap, s + vec3(d, 0.4 * d, 0.0)) + texture(shadowMap, s + vec3(-0.4 * d, d, 0.0)));
}
)";
}

namespace {

constexpr const char* kSurface = R"(
in vec3 toEye;
in vec3 worldNormal;
in vec2 openAndLit;  // share of the ambient light, and of the key light, that is visible here
flat in vec3 albedo;
out vec4 color;

void main() {
  vec3 n = normalize(worldNormal);
  if (!gl_FrontFacing) n = -n;
  vec3 v = normalize(toEye);
#ifdef SHADOW_EACH_PIXEL
  float lit = shadowAt(eye.xyz - toEye, n);
#else
  float lit = openAndLit.y;
#endif
  float key = max(dot(n, toLight.xyz), 0.0) * lit;
  float up = 0.5 + 0.5 * n.y;
  float open = 1.0 - (1.0 - up) * openAndLit.x;
  vec3 ambient = mix(vec3(0.30, 0.285, 0.27), vec3(0.50, 0.545, 0.60), up) * open;
  vec3 light = ambient + vec3(1.22, 1.15, 1.05) * key;

  float gloss = max(dot(n, normalize(toLight.xyz + v)), 0.0);
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss * 0.16 * key;
  float edge = 1.0 - max(dot(n, v), 0.0);
  float rim = edge * edge * edge * (0.10 + 0.22 * up);
  color = vec4(toSrgb(toneMap(albedo * light + gloss + rim * vec3(0.75, 0.85, 1.0))), 1.0);
}
)";

// End of the vertex shader of a lit surface with `p` and `n`.
constexpr const char* kLitVertexEnd = R"(
out vec3 toEye;
out vec3 worldNormal;
out vec2 openAndLit;
flat out vec3 albedo;
void finish(vec3 p, vec3 n) {
  toEye = eye.xyz - p;
  worldNormal = n;
  // Near the floor, surfaces that face down receive little ambient light.
  openAndLit.x = 0.5 * (1.0 - clamp(p.y * 2.5, 0.0, 1.0));
#ifdef SHADOW_EACH_PIXEL
  openAndLit.y = 1.0;
#else
  openAndLit.y = shadowAt(p, n);
#endif
  albedo = tint;
  gl_Position = clipFromWorld * vec4(p, 1.0);
}
)";

/// The end of the vertex shader of a surface that only casts shadows. @param point  where a vertex is
std::string casterEnd(Pass pass, const std::string& point) {
  if (pass == Pass::kShadow) {
    return "void main() { gl_Position = vec4((shadowFromWorld * vec4(" + point + ", 1.0)).xyz * 2.0 - 1.0, 1.0); }\n";
  }
  return "out float height;\nvoid main() {\n  vec3 p = " + point + R"(;
  height = p.y / contactArea.w;
  gl_Position = vec4((p.xz - contactArea.xy) / contactArea.z, height * 2.0 - 1.0, 1.0);
}
)";
}

std::string header(bool shadowEachPixel) {
  std::string text = frameBlock();
  if (shadowEachPixel) text.insert(text.find('\n') + 1, "#define SHADOW_EACH_PIXEL\n");
  return text;
}

}  // namespace

std::string skinVertex(Pass pass, bool shadowEachPixel) {
  std::string text = header(shadowEachPixel);
  text += R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tint;
)";
  if (pass == Pass::kLit) return text + shadowLookup() + kLitVertexEnd + "void main() { finish(position, normal); }\n";
  return text + casterEnd(pass, "position");
}

std::string propVertex(Pass pass) {
  std::string text = header(true);
  text += R"(
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 columnX;
layout(location = 3) in vec3 columnY;
layout(location = 4) in vec3 columnZ;
layout(location = 5) in vec3 origin;
layout(location = 6) in vec4 extentsAndBevel;
layout(location = 7) in vec4 paint;
vec3 place() {
  vec3 p = corner * extentsAndBevel.xyz + normal * extentsAndBevel.w;
  return columnX * p.x + columnY * p.y + columnZ * p.z + origin;
}
)";
  if (pass == Pass::kLit) {
    return text + "uniform vec4 which;\nflat out vec4 opacity;\n#define tint paint.rgb\n" + shadowLookup() +
           kLitVertexEnd +
           R"(void main() {
  opacity = paint.aaaa;
  finish(place(), columnX * normal.x + columnY * normal.y + columnZ * normal.z);
  if ((paint.a < 1.0) != (which.x > 0.0)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside
}
)";
  }
  return text + casterEnd(pass, "place()");
}

std::string surfaceFragment(Pass pass, bool shadowEachPixel) {
  if (pass == Pass::kLit) return header(shadowEachPixel) + colorCurves() + shadowLookup() + kSurface;
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

std::string fading(const std::string& fragment, bool lit, const std::string& from) {
  std::string text = fragment;
  if (lit) {
    text.insert(text.rfind('}'), "  color.a *= opacity.x;\n");
  } else {
    // "Interleaved gradient noise": Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", 2014.
    constexpr std::string_view kMain = "void main() {";
    text.insert(text.find(kMain) + kMain.size(), R"(
  float turn = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  if (turn >= opacity.x) discard;
)");
  }
  text.insert(text.find('\n') + 1, from + " vec4 opacity;\n");
  return text;
}

Sources sky() {
  return {frameBlock() + R"(
layout(location = 0) in vec2 place;
out vec3 tint;
void main() {
  vec2 at = place - vec2(rayForward.w, rayRight.w);
  vec3 ray = normalize(rayForward.xyz + at.x * rayRight.xyz + at.y * rayUp.xyz);
  float t = clamp(ray.y * 1.6, 0.0, 1.0);
  tint = mix(horizon.rgb, zenith.rgb, t * (2.0 - t));
  gl_Position = vec4(place, 1.0, 1.0);
}
)",
          R"(#version 330 core
in vec3 tint;
out vec4 color;
void main() { color = vec4(tint, 1.0); }
)"};
}

Sources ground(bool shaded) {
  std::string text = frameBlock() + R"(
uniform sampler2DShadow shadowMap;
uniform sampler2D contactMap;
in vec2 ground;
in vec3 shadowPosition;
in vec2 contactPosition;
out vec4 color;
// Share of a pixel that is covered by lines of this width at integer coordinates.
float lines(vec2 p, vec2 footprint, float width) {
  vec2 w = footprint + width;
  vec2 distance = abs(fract(p - 0.5) - 0.5);
  vec2 cover = clamp((0.5 * w - distance) / footprint + 0.5, 0.0, 1.0) * (2.0 * width / w);
  return max(cover.x, cover.y);
}
void main() {
  vec2 away = ground - floorFade.xy;
  float fade = clamp((sqrt(dot(away, away)) - floorFade.z) / (floorFade.w - floorFade.z), 0.0, 1.0);
  vec2 footprint = fwidth(ground);
  float grid = max(0.085 * lines(ground, footprint, 0.010), 0.06 * lines(ground * 4.0, footprint * 4.0, 0.016));
  vec3 base = floorColor.rgb * (1.0 + floorColor.w * grid);
)";
  if (shaded) {
    text += R"(
  // One tap at the centre and four around it; each already interpolates four texels.
  float d = 1.6 * toLight.w;
  float lit = 0.2 * (texture(shadowMap, shadowPosition) + texture(shadowMap, shadowPosition + vec3(d, 0.45 * d, 0.0)) +
                     texture(shadowMap, shadowPosition + vec3(-0.45 * d, d, 0.0)) +
                     texture(shadowMap, shadowPosition + vec3(-d, -0.45 * d, 0.0)) +
                     texture(shadowMap, shadowPosition + vec3(0.45 * d, -d, 0.0)));
  float contact = texture(contactMap, contactPosition).r;
  base *= mix(vec3(0.735, 0.755, 0.785), vec3(1.0), lit) * (1.0 - 0.34 * contact);
)";
  }
  text += "  color = vec4(mix(base, horizon.rgb, fade * (2.0 - fade)), 1.0);\n}\n";
  return {frameBlock() + R"(
layout(location = 0) in vec2 place;
out vec2 ground;
out vec3 shadowPosition;
out vec2 contactPosition;
void main() {
  ground = place;
  shadowPosition = (shadowFromWorld * vec4(place.x, 0.0, place.y, 1.0)).xyz;
  contactPosition = (place - contactArea.xy) / contactArea.z * 0.5 + 0.5;
  gl_Position = clipFromWorld * vec4(place.x, 0.0, place.y, 1.0);
}
)",
          text};
}

Sources overlay() {
  return {frameBlock() + colorCurves() + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 other;
layout(location = 2) in vec4 normal;
layout(location = 3) in vec4 tint;
flat out vec4 faceColor;
out float across;  // distance from the centre line of an edge [pixels]
flat out float halfWidth;
void main() {
  bool isEdge = normal.w != 0.0;
  // Offset slightly toward the viewer: hulls touch the skin, and edges are on their faces.
  vec3 toEye = normalize(eye.xyz - position);
  vec3 p = position + toEye * (isEdge ? 0.004 : 0.002);
  gl_Position = clipFromWorld * vec4(p, 1.0);
  across = 0.0;
  halfWidth = 1.0;
  float shade = 1.0;
  if (isEdge) {
    // Direction of the edge on screen, correct even if its other end is behind the viewer.
    vec4 q = clipFromWorld * vec4(other, 1.0);
    vec2 along = (q.xy * gl_Position.w - gl_Position.xy * q.w) * viewport.xy;
    along *= inversesqrt(max(dot(along, along), 1e-20));
    halfWidth = 0.45 + 0.0007 * viewport.y;
    float reach = normal.w * (halfWidth + 0.5);
    across = reach * normal.x;
    gl_Position.xy += vec2(-along.y, along.x) * reach * 2.0 * viewport.zw * gl_Position.w;
  } else {
    float side = dot(normal.xyz, toEye) < 0.0 ? -0.5 : 1.0;
    shade = 0.74 + 0.44 * dot(normal.xyz, toLight.xyz) * side;
  }
  faceColor = vec4(toSrgb(toneMap(tint.rgb * shade)), tint.a);
}
)",
          R"(#version 330 core
flat in vec4 faceColor;
in float across;
flat in float halfWidth;
out vec4 color;
void main() { color = vec4(faceColor.rgb, faceColor.a * clamp(halfWidth - abs(across) + 0.5, 0.0, 1.0)); }
)"};
}

Sources markers() {
  return {frameBlock() + R"(
layout(location = 0) in vec3 center;
layout(location = 1) in vec2 corner;
out vec2 disc;
flat out float radius;  // [pixels]
void main() {
  vec4 c = clipFromWorld * vec4(center, 1.0);
  // 16 mm, but with a minimum size on screen.
  float pixelsPerMetre = 0.5 * viewport.y * rayUp.w / max(c.w, 1e-3);
  radius = max(0.016 * pixelsPerMetre, 0.006 * viewport.y + 2.0);
  disc = corner * (radius + 1.0);
  c.xy += disc * 2.0 * viewport.zw * c.w;
  gl_Position = c;
}
)",
          frameBlock() + R"(
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
)"};
}

namespace {

std::string grainVertex(Pass pass) {
  std::string text = frameBlock() + R"(
layout(location = 0) in vec3 center;
layout(location = 1) in vec4 tintAndSize;
uniform vec4 grain;
#define tint tintAndSize.rgb
#define size (grain.x * tintAndSize.a)
)";
  if (pass == Pass::kShadow) {
    // The map's side is 1 in texture coordinates: rows of shadowFromWorld are texture lengths per metre.
    return text + R"(
void main() {
  vec3 s = (shadowFromWorld * vec4(center, 1.0)).xyz * 2.0 - 1.0;
  gl_Position = dot(center, center) < 1e8 ? vec4(s, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
  float perMetre = length(vec3(shadowFromWorld[0].x, shadowFromWorld[1].x, shadowFromWorld[2].x)) / toLight.w;
  gl_PointSize = clamp(2.0 * size * perMetre, grain.y, grain.z);
}
)";
  }
  return text + colorCurves() + shadowLookup() + R"(
flat out vec3 dark;   // final colour away from the key light
flat out vec3 bright;
flat out vec3 light;  // towards the key light, in the camera's axes
flat out vec3 depths; // of the ball's centre and of its front; 1 / radius in pixels
void main() {
  vec4 c = clipFromWorld * vec4(center, 1.0);
  float distance = max(c.w, 1e-3);
  // Move grains that are not finite or behind the viewer outside the clip volume.
  gl_Position = dot(center, center) < 1e8 && c.w > size ? c : vec4(2.0, 2.0, 2.0, 1.0);
  float pixels = rayUp.w * viewport.y * size / distance;
  gl_PointSize = clamp(pixels, grain.y, grain.z);
  vec4 front = clipFromWorld * vec4(center - rayForward.xyz * size, 1.0);
  depths = vec3(0.5 + 0.5 * c.z / distance, 0.5 + 0.5 * front.z / max(front.w, 1e-3), 2.0 / gl_PointSize);

  float lit = shadowAt(center + toLight.xyz * (1.5 * grain.x), vec3(0.0));
  float open = 1.0 - 0.25 * (1.0 - clamp(center.y * 2.5, 0.0, 1.0));
  vec3 ambient = vec3(0.42, 0.44, 0.46) * open;
  dark = toSrgb(toneMap(tint * ambient * 0.80));
  bright = toSrgb(toneMap(tint * (ambient + vec3(1.22, 1.15, 1.05) * lit)));
  vec3 side = rayRight.xyz * inversesqrt(dot(rayRight.xyz, rayRight.xyz));
  light = vec3(dot(toLight.xyz, side), -dot(toLight.xyz, rayUp.xyz) * rayUp.w, -dot(toLight.xyz, rayForward.xyz));
}
)";
}

std::string grainFragment(Pass pass, bool fine) {
  if (pass == Pass::kShadow) return "#version 330 core\nvoid main() {}\n";
  std::string text = R"(#version 330 core
flat in vec3 dark;
flat in vec3 bright;
flat in vec3 light;
flat in vec3 depths;
out vec4 color;
void main() {
  vec2 d = gl_PointCoord * 2.0 - 1.0;
  float away = dot(d, d);
  float z = sqrt(max(1.0 - away, 0.0));
  float key = clamp(0.15 + 0.85 * dot(vec3(d, z), light), 0.0, 1.0);
  vec3 seen = mix(dark, bright, key);
)";
  if (!fine) return text + "  color = vec4(seen, 1.0);\n}\n";
  return text + R"(
  float cover = clamp((1.0 - sqrt(away)) / depths.z + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  gl_FragDepth = mix(depths.x, depths.y, z);
  color = vec4(seen, cover);
}
)";
}

}  // namespace

Sources grains(Pass pass, bool fine) {
  return {grainVertex(pass), grainFragment(pass, fine)};
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

Sources blur() {
  // Binomial weights 1 8 28 56 70 56 28 8 1, read in pairs between texels: five lookups.
  return {fullVertex(), R"(#version 330 core
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
)"};
}

Sources panel() {
  return {R"(#version 330 core
uniform vec4 rectangle;
out vec2 place;
void main() {
  vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  place = vec2(p.x, 1.0 - p.y);
  gl_Position = vec4(mix(rectangle.xy, rectangle.zw, p), 0.0, 1.0);
}
)",
          R"(#version 330 core
uniform sampler2D source;
in vec2 place;
out vec4 color;
void main() { color = texture(source, place); }
)"};
}

}  // namespace lorica::shaders
