#include "viewer/renderer/shaders.h"

namespace lorica::shaders {
namespace {

// Depths beyond this mean that there is no water.
constexpr const char* kNoDepth = "const float kNoDepth = 1e5;\n";

}  // namespace

Sources drops() {
  return {frameBlock() + R"(
layout(location = 0) in vec3 center;
layout(location = 1) in vec2 foamAndSize;
uniform vec4 grain;
flat out vec3 ball;  // depth, radius, foam
void main() {
  vec4 c = clipFromWorld * vec4(center, 1.0);
  float depth = max(c.w, 1e-3), radius = grain.x * foamAndSize.y;
  gl_Position = dot(center, center) < 1e8 && c.w > radius ? c : vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = clamp(rayUp.w * viewport.y * grain.y * radius / depth, 1.0, grain.z);
  ball = vec3(depth, radius, foamAndSize.x);
}
)",
          R"(#version 330 core
flat in vec3 ball;
out vec2 surface;
void main() {
  vec2 d = gl_PointCoord * 2.0 - 1.0;
  float away = dot(d, d);
  if (away > 1.0) discard;
  surface = vec2(ball.x - ball.y * sqrt(1.0 - away), -ball.z);
}
)"};
}

Sources waterSmoothing() {
  // A neighbour counts as no more than a little behind, and none that is well in front counts; nor does the one
  // opposite, so that edges stay where they are.
  return {fullVertex(), frameBlock() + kNoDepth + R"(
uniform sampler2D source;
uniform vec4 direction;  // x, y; radius of a drop [m]; pixels of the map to one of the picture
out vec2 surface;
const int kMost = 14;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), step = ivec2(direction.xy);
  surface = texelFetch(source, at, 0).xy;
  float depth = surface.x;
  if (depth > kNoDepth) return;
  float sigma = clamp(1.3 * 0.5 * rayUp.w * viewport.y * direction.w * direction.z / depth, 0.8, 0.5 * float(kMost));
  int reach = int(ceil(2.0 * sigma));
  float falloff = -0.5 / (sigma * sigma), near = depth - 2.5 * direction.z, far = depth + direction.z;
  float weights = 1.0;
  for (int i = 1; i <= reach; ++i) {
    vec2 a = texelFetch(source, at + i * step, 0).xy, b = texelFetch(source, at - i * step, 0).xy;
    if (min(a.x, b.x) < near || max(a.x, b.x) > kNoDepth || min(a.x, b.x) <= 0.0) continue;
    float weight = exp(falloff * float(i * i));
    surface += weight * vec2(min(a.x, far) + min(b.x, far), a.y + b.y);
    weights += 2.0 * weight;
  }
  surface /= weights;
}
)"};
}

Sources waterNormals() {
  return {fullVertex(), frameBlock() + kNoDepth + R"(
uniform sampler2D source;
out vec4 water;
vec3 at(ivec2 texel, float depth, vec2 size) {
  vec2 clip = (vec2(texel) + 0.5) / size * 2.0 - 1.0 - vec2(rayForward.w, rayRight.w);
  return depth * (rayForward.xyz + clip.x * rayRight.xyz + clip.y * rayUp.xyz);
}
// Along a direction: towards the neighbour whose depth is more alike.
vec3 along(ivec2 texel, ivec2 step, float depth, vec2 size) {
  float a = texelFetch(source, texel + step, 0).x, b = texelFetch(source, texel - step, 0).x;
  bool forward = a > 0.0 && (b <= 0.0 || abs(a - depth) < abs(b - depth));
  vec3 here = at(texel, depth, size);
  return forward ? at(texel + step, a, size) - here : here - at(texel - step, b, size);
}
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec2 surface = texelFetch(source, texel, 0).xy;
  water = vec4(0.0, 0.0, surface.x, 0.0);
  if (surface.x > kNoDepth) return;
  vec2 size = vec2(textureSize(source, 0));
  vec3 n = normalize(cross(along(texel, ivec2(1, 0), surface.x, size), along(texel, ivec2(0, 1), surface.x, size)));
  vec3 right = rayRight.xyz * inversesqrt(dot(rayRight.xyz, rayRight.xyz));
  water = vec4(dot(n, right), dot(n, rayUp.xyz) * rayUp.w, surface.x, -surface.y);
}
)"};
}

Sources water() {
  return {fullVertex(), frameBlock() + colorCurves() + kNoDepth + R"(
uniform sampler2D source;
uniform sampler2DShadow shadowMap;
uniform sampler2D behind;
uniform sampler2D behindDepth;
uniform sampler2D thickness;
uniform vec4 water;
in vec2 place;
out vec4 color;
vec3 linear(vec3 c) { return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878); }  // of sRGB
float depthBehind(vec2 p, vec2 range) { return range.y / (texture(behindDepth, p).x * 2.0 - 1.0 - range.x); }
void main() {
  // Between the four nearest pixels of the map, as far as there is water.
  vec2 size = vec2(textureSize(source, 0)), p = place * size - 0.5;
  ivec2 corner = ivec2(floor(p)), last = ivec2(size) - 1;
  vec2 f = p - vec2(corner);
  vec4 seen = vec4(0.0);
  float covered = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 k = ivec2(i & 1, i >> 1);
    vec4 s = texelFetch(source, clamp(corner + k, ivec2(0), last), 0);
    float weight = (k.x == 1 ? f.x : 1.0 - f.x) * (k.y == 1 ? f.y : 1.0 - f.y);
    if (s.z > kNoDepth) continue;
    seen += weight * s;
    covered += weight;
  }
  if (covered < 0.5) discard;
  seen /= covered;

  // Depth in clip space is (range.x w + range.y) / w.
  vec2 one = (clipFromWorld * vec4(eye.xyz + rayForward.xyz, 1.0)).zw;
  vec2 two = (clipFromWorld * vec4(eye.xyz + 2.0 * rayForward.xyz, 1.0)).zw;
  vec2 range = vec2(two.x - one.x, 2.0 * one.x - two.x);
  float depth = seen.z, end = depthBehind(place, range);
  if (end < depth) discard;

  vec2 clip = place * 2.0 - 1.0 - vec2(rayForward.w, rayRight.w);
  vec3 ray = rayForward.xyz + clip.x * rayRight.xyz + clip.y * rayUp.xyz;
  vec3 right = rayRight.xyz * inversesqrt(dot(rayRight.xyz, rayRight.xyz)), up = rayUp.xyz * rayUp.w;
  vec3 n = right * seen.x + up * seen.y - rayForward.xyz * sqrt(max(1.0 - dot(seen.xy, seen.xy), 0.0));
  vec3 v = -normalize(ray), position = eye.xyz + depth * ray;
  gl_FragDepth = 0.5 + 0.5 * (range.x + range.y / depth);

  float through = texture(thickness, (place * 2.0 - 1.0) / water.w * 0.5 + 0.5).x;
  float shift = 0.12 * min(min(through, (end - depth) * length(ray)), 0.5) * rayUp.w / depth;
  vec2 bent = place - seen.xy * vec2(viewport.y * viewport.z, 1.0) * shift;
  float bentEnd = depthBehind(bent, range);
  if (bentEnd < depth) {
    bent = place;
    bentEnd = end;
  }
  through = min(through, (bentEnd - depth) * length(ray));
  vec3 passed = exp(-through * (1.0 - water.rgb) * vec3(5.0, 3.6, 3.6));

  float lit = texture(shadowMap, (shadowFromWorld * vec4(position + n * 0.03, 1.0)).xyz);
  float key = max(dot(n, toLight.xyz), 0.0) * lit;
  vec3 scattered = water.rgb * (vec3(0.50, 0.545, 0.60) + vec3(0.61, 0.575, 0.525) * lit);
  vec4 beyond = texture(behind, bent);  // without colour where nothing is drawn
  vec3 body = mix(scattered, linear(beyond.rgb), passed);

  float edge = 1.0 - max(dot(n, v), 0.0);
  float mirrored = 0.02 + 0.98 * edge * edge * edge * edge * edge;
  vec3 r = reflect(-v, n);
  float t = clamp(r.y * 1.6, 0.0, 1.0);
  vec3 sky = linear(mix(mix(horizon.rgb, floorColor.rgb * 0.8, clamp(-r.y * 4.0, 0.0, 1.0)), zenith.rgb, t * (2.0 - t)));
  float gloss = max(dot(n, normalize(toLight.xyz + v)), 0.0);
  for (int i = 0; i < 8; ++i) gloss *= gloss;
  gloss *= lit;
  vec3 surface = mix(body, sky, mirrored) + 2.0 * gloss;

  vec3 foam = vec3(0.56, 0.60, 0.64) + vec3(0.42, 0.40, 0.37) * key;
  float white = 0.85 * clamp(seen.w, 0.0, 1.0);
  float clear = (1.0 - beyond.a) * (1.0 - white) * dot(passed, vec3(0.3333));
  color = vec4(toSrgb(toneMap(mix(surface, foam, white))), 1.0 - clear);
}
)"};
}

}  // namespace lorica::shaders
