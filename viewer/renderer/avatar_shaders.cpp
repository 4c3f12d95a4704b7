#include "viewer/renderer/avatar_shaders.h"

namespace lorica::shaders {
namespace {

// Must match SurfaceUniforms.
constexpr const char* kSurfaceBlock = R"(
layout(std140) uniform Surface {
  vec4 baseColor;
  vec4 emissive;
  vec4 physical;
  vec4 shade;
  vec4 toon;
  vec4 matcap;
  vec4 rim;
  vec4 outline;
  vec4 outlineColor;
  vec4 animation;
  vec4 uvRows[22];
};
vec2 uvOf(int slot, vec4 both) {
  vec4 u = uvRows[2 * slot];
  vec3 c = vec3(u.w > 0.5 ? both.zw : both.xy, 1.0);
  return vec2(dot(u.xyz, c), dot(uvRows[2 * slot + 1].xyz, c));
}
)";

constexpr const char* kVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec4 uvs;
layout(location = 4) in vec4 tint;
layout(location = 5) in uvec4 jointsA;
layout(location = 6) in vec4 weightsA;
layout(location = 7) in uvec4 jointsB;
layout(location = 8) in vec4 weightsB;
#ifdef POSED
vec3 turned(vec3 v) { return v; }
vec3 placed() { return position; }
#else
uniform samplerBuffer joints;
vec4 rowX = vec4(0.0), rowY = vec4(0.0), rowZ = vec4(0.0);
void follow(uint joint, float weight) {
  int at = 3 * int(joint);
  rowX += weight * texelFetch(joints, at);
  rowY += weight * texelFetch(joints, at + 1);
  rowZ += weight * texelFetch(joints, at + 2);
}
vec3 turned(vec3 v) { return vec3(dot(rowX.xyz, v), dot(rowY.xyz, v), dot(rowZ.xyz, v)); }
vec3 placed() {
  follow(jointsA.x, weightsA.x);
  follow(jointsA.y, weightsA.y);
  follow(jointsA.z, weightsA.z);
  follow(jointsA.w, weightsA.w);
#ifdef MANY_INFLUENCES
  follow(jointsB.x, weightsB.x);
  follow(jointsB.y, weightsB.y);
  follow(jointsB.z, weightsB.z);
  follow(jointsB.w, weightsB.w);
#endif
  vec4 p = vec4(position, 1.0);
  return vec3(dot(rowX, p), dot(rowY, p), dot(rowZ, p));
}
#endif
)";

constexpr const char* kSurfaceVertexMain = R"(
out vec3 toEye;
out vec3 worldNormal;
out vec4 worldTangent;
out vec4 uv;
out vec4 vertexColor;
out float vertexLit;
#ifdef OUTLINE_WIDTH_MAP
uniform sampler2D outlineWidthMap;
#endif
void main() {
  vec3 p = placed();
  vec3 n = turned(normal);
  n *= inversesqrt(max(dot(n, n), 1e-20));
#ifdef OUTLINE
  float width = outline.y;
#ifdef OUTLINE_WIDTH_MAP
  width *= textureLod(outlineWidthMap, uvOf(9, uvs), 0.0).g;
#endif
  if (outline.z > 0.5) width *= dot(p - eye.xyz, rayForward.xyz) / rayUp.w;
  p += width * n;
#endif
  toEye = eye.xyz - p;
  worldNormal = n;
  worldTangent = vec4(turned(tangent.xyz), tangent.w);
  uv = uvs;
  vertexColor = tint;
#if defined(PHYSICAL) && !defined(SHADOW_EACH_PIXEL)
  vertexLit = shadowAt(p, n);
#else
  vertexLit = 1.0;
#endif
  gl_Position = clipFromWorld * vec4(p, 1.0);
}
)";

constexpr const char* kFragmentInputs = R"(
in vec3 toEye;
in vec3 worldNormal;
in vec4 worldTangent;
in vec4 uv;
in vec4 vertexColor;
in float vertexLit;
out vec4 color;
)";

// Texture coordinates of toon materials may move: https://github.com/vrm-c/vrm-specification,
// VRMC_materials_mtoon-1.0, "UV Animation".
constexpr const char* kMoved = R"(
vec4 movedUv() {
#ifdef TOON
  float amount = 1.0;
#ifdef ANIMATION_MASK_MAP
  amount = texture(animationMaskMap, uvOf(10, uv)).b;
#endif
  float turn = animation.z * skyColor.w * amount;
  vec2 shifted = animation.xy * skyColor.w * amount;
  mat2 rotation = mat2(cos(turn), -sin(turn), sin(turn), cos(turn));
  return vec4(rotation * (uv.xy - 0.5) + 0.5 + shifted, rotation * (uv.zw - 0.5) + 0.5 + shifted);
#else
  return uv;
#endif
}
vec4 surfaceColor(vec4 at) {
  vec4 c = baseColor;
#ifdef BASE_MAP
  c *= texture(baseMap, uvOf(0, at));
#endif
#ifndef TOON
  c *= vertexColor;
#endif
#ifdef ALPHA_MASK
  if (c.a < physical.w) discard;
#endif
#ifndef ALPHA_BLEND
  c.a = 1.0;
#endif
  return c;
}
)";

constexpr const char* kNormal = R"(
vec3 surfaceNormal(vec4 at) {
#ifdef FLAT
  vec3 n = normalize(cross(dFdx(-toEye), dFdy(-toEye)));
#else
  vec3 n = normalize(worldNormal);
#ifndef OUTLINE
  if (!gl_FrontFacing) n = -n;
#endif
#endif
#ifdef NORMAL_MAP
  vec2 st = uvOf(2, at);
  vec3 m = texture(normalMap, st).xyz * 2.0 - 1.0;
  m.xy *= emissive.w;
  vec3 t, b;
  if (worldTangent.w != 0.0) {
    float side = gl_FrontFacing ? 1.0 : -1.0;
    t = side * normalize(worldTangent.xyz);
    b = cross(n, t) * worldTangent.w * side;
  } else {
    // The directions in which the texture coordinates grow on the surface; green points where v falls.
    vec3 alongX = cross(dFdy(-toEye), n), alongY = cross(n, dFdx(-toEye));
    vec2 stX = dFdx(st), stY = dFdy(st);
    t = alongX * stX.x + alongY * stY.x;
    b = -(alongX * stX.y + alongY * stY.y);
    float scale = (gl_FrontFacing ? 1.0 : -1.0) * inversesqrt(max(max(dot(t, t), dot(b, b)), 1e-30));
    t *= scale;
    b *= scale;
  }
  n = normalize(t * m.x + b * m.y + n * m.z);
#endif
  return n;
}
vec3 emitted(vec4 at) {
  vec3 e = emissive.rgb;
#ifdef EMISSIVE_MAP
  e *= texture(emissiveMap, uvOf(4, at)).rgb;
#endif
  return e;
}
vec3 ambientAt(vec3 n) { return mix(groundColor.rgb, skyColor.rgb, 0.5 + 0.5 * n.y); }
)";

// glTF 2.0, appendix B, with the energy that rough metals scatter several times (Fdez-Aguera 2019, "A Multiple-
// Scattering Microfacet Model for Real-Time Image-based Lighting") and Karis' fit of the environment term ("Physically
// Based Shading on Mobile", 2014). The environment is a sky over a ground: its blur by roughness has a closed form
// here.
constexpr const char* kPhysical = R"(
vec3 shaded(vec4 at, vec4 base, vec3 n) {
  float metallic = physical.x, roughness = physical.y;
#ifdef METALLIC_ROUGHNESS_MAP
  vec4 mr = texture(metallicRoughnessMap, uvOf(1, at));
  roughness *= mr.g;
  metallic *= mr.b;
#endif
  roughness = clamp(roughness, 0.0525, 1.0);
  float open = 1.0;
#ifdef OCCLUSION_MAP
  open = 1.0 + physical.z * (texture(occlusionMap, uvOf(3, at)).r - 1.0);
#endif
  vec3 v = normalize(toEye), l = toLight.xyz, h = normalize(l + v);
  float nl = max(dot(n, l), 0.0), nv = max(dot(n, v), 1e-4), nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 0.0);
  vec3 diffuse = base.rgb * (1.0 - metallic), f0 = mix(vec3(0.04), base.rgb, metallic);
#ifdef SHADOW_EACH_PIXEL
  float lit = shadowAt(eye.xyz - toEye, n);
#else
  float lit = vertexLit;
#endif

  float a2 = roughness * roughness;
  a2 *= a2;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float seen = 0.5 / max(nl * sqrt(a2 + (1.0 - a2) * nv * nv) + nv * sqrt(a2 + (1.0 - a2) * nl * nl), 1e-6);
  vec3 f = f0 + (1.0 - f0) * pow(1.0 - vh, 5.0);
  vec3 key = keyColor.rgb * nl * lit * (diffuse + f * (a2 / (d * d) * seen));

  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  vec2 ab = vec2(-1.04, 1.04) * (min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y) + r.zw;
  vec3 once = f0 * ab.x + ab.y;
  float lost = 1.0 - ab.x - ab.y;
  vec3 mean = f0 + (1.0 - f0) * 0.047619;
  vec3 again = once * mean / (1.0 - lost * mean) * lost;
  float up = reflect(-v, n).y, blur = 2.2 * roughness * roughness + 0.01;
  vec3 reflected = mix(groundColor.rgb, skyColor.rgb, 0.5 + 0.5 * up * (1.0 + blur) / (abs(up) + blur));
  vec3 around = ambientAt(n);
  vec3 both = once + again;
  vec3 ambient = reflected * once + around * again + around * diffuse * (1.0 - max(both.r, max(both.g, both.b)));
  return key + ambient * open + emitted(at);
}
)";

constexpr const char* kUnlit = R"(
vec3 shaded(vec4 at, vec4 base, vec3 n) { return base.rgb; }
)";

// VRMC_materials_mtoon-1.0, "Implementation"; no shadow falls on toon materials.
constexpr const char* kToon = R"(
vec3 shaded(vec4 at, vec4 base, vec3 n) {
  vec3 dark = shade.rgb;
#ifdef SHADE_MAP
  dark *= texture(shadeMap, uvOf(5, at)).rgb;
#endif
  float border = shade.w;
#ifdef SHIFT_MAP
  border += texture(shiftMap, uvOf(6, at)).r * toon.y;
#endif
  float lit = clamp((dot(n, toLight.xyz) + border + 1.0 - toon.x) / max(2.0 - 2.0 * toon.x, 1e-5), 0.0, 1.0);
  vec3 c = keyColor.rgb * mix(dark, base.rgb, lit);
  // Ambient light depends on the height of the normal alone, so its mean over all directions is that of level ones.
  vec3 around = ambientAt(vec3(n.x, n.y * (1.0 - toon.z), n.z));
  // As MToon 0.x does, so that strong light does not wash the colours out.
  c = min(c + around * base.rgb, base.rgb);

  vec3 v = normalize(toEye);
  vec3 glow = rim.rgb * pow(clamp(1.0 - dot(v, n) + outline.x, 0.0, 1.0), max(rim.w, 1e-5));
#ifdef MATCAP_MAP
  // Axes across the line of sight; x stays level in the picture.
  vec3 x = normalize(cross(rayUp.xyz, v)), y = cross(v, x);
  vec4 sphere = vec4(0.5 + 0.5 * vec2(dot(x, n), -dot(y, n)), 0.0, 0.0);
  glow += matcap.rgb * texture(matcapMap, uvOf(7, sphere.xyxy)).rgb;
#endif
#ifdef RIM_MAP
  glow *= texture(rimMap, uvOf(8, at)).rgb;
#endif
  return c + glow * mix(vec3(1.0), keyColor.rgb + around, toon.w) + emitted(at);
}
)";

constexpr const char* kSurfaceMain = R"(
void main() {
  vec4 at = movedUv();
  vec4 base = surfaceColor(at);
  vec3 n = surfaceNormal(at);
#ifdef OUTLINE
  vec3 c = outlineColor.rgb * mix(vec3(1.0), shaded(at, base, n), outline.w);
#else
  vec3 c = shaded(at, base, n);
#endif
  c = clamp(c, 0.0, 1.0);
  // IEC 61966-2-1. Exact, because the colours of a texture must come out as they are in it.
  color = vec4(mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThan(c, vec3(0.0031308))), base.a);
}
)";

constexpr const char* kDepthMain = R"(
void main() {
  if (surfaceColor(movedUv()).a < 0.5) discard;
  color = vec4(0.0);
}
)";

struct SlotName {
  const char* define;
  const char* sampler;
};
constexpr std::array<SlotName, kAvatarSlots> kSlots = {{{"BASE_MAP", "baseMap"},
                                                        {"METALLIC_ROUGHNESS_MAP", "metallicRoughnessMap"},
                                                        {"NORMAL_MAP", "normalMap"},
                                                        {"OCCLUSION_MAP", "occlusionMap"},
                                                        {"EMISSIVE_MAP", "emissiveMap"},
                                                        {"SHADE_MAP", "shadeMap"},
                                                        {"SHIFT_MAP", "shiftMap"},
                                                        {"MATCAP_MAP", "matcapMap"},
                                                        {"RIM_MAP", "rimMap"},
                                                        {"OUTLINE_WIDTH_MAP", "outlineWidthMap"},
                                                        {"ANIMATION_MASK_MAP", "animationMaskMap"}}};

using Draw = AvatarVariant::Draw;

[[nodiscard]] std::string headerOf(const AvatarVariant& variant) {
  std::string defines;
  const auto define = [&](bool is, const char* name) {
    if (is) defines += std::string("#define ") + name + "\n";
  };
  define(variant.shading == Shading::kPhysical, "PHYSICAL");
  define(variant.shading == Shading::kToon, "TOON");
  define(variant.alpha == AlphaMode::kMask, "ALPHA_MASK");
  define(variant.alpha == AlphaMode::kBlend, "ALPHA_BLEND");
  define(variant.draw == Draw::kOutline, "OUTLINE");
  define(variant.flat, "FLAT");
  define(variant.posed, "POSED");
  define(!variant.fewInfluences, "MANY_INFLUENCES");
  define(variant.shadowEachPixel, "SHADOW_EACH_PIXEL");
  for (std::size_t slot = 0; slot < kSlots.size(); ++slot) {
    define((variant.textures >> slot & 1u) != 0, kSlots[slot].define);
  }
  std::string text = frameBlock();
  text.insert(text.find('\n') + 1, defines);
  return text + kSurfaceBlock;
}

[[nodiscard]] std::string samplersOf(const AvatarVariant& variant) {
  std::string text;
  for (std::size_t slot = 0; slot < kSlots.size(); ++slot) {
    if ((variant.textures >> slot & 1u) != 0) text += std::string("uniform sampler2D ") + kSlots[slot].sampler + ";\n";
  }
  return text;
}

[[nodiscard]] std::string opaqueFragment(const AvatarVariant& variant) {
  std::string text = headerOf(variant) + samplersOf(variant);
  if (variant.draw == Draw::kShadow || variant.draw == Draw::kContact) {
    text += "in vec4 uv;\nin vec4 vertexColor;\nin float height;\nout vec4 color;\n";
    text += kMoved;
    text += R"(
void main() {
#ifdef ALPHA_MASK
  surfaceColor(movedUv());
#endif
#ifdef ALPHA_BLEND
  if (surfaceColor(movedUv()).a < 0.5) discard;
#endif
  float n = 1.0 - clamp(height, 0.0, 1.0);
  color = vec4(n * n);
}
)";
    return text;
  }
  text += kFragmentInputs;
  text += kMoved;
  if (variant.draw == Draw::kDepth) return text + kDepthMain;
  text += shadowLookup();
  text += kNormal;
  text += variant.shading == Shading::kPhysical ? kPhysical : variant.shading == Shading::kToon ? kToon : kUnlit;
  return text + kSurfaceMain;
}

}  // namespace

SurfaceUniforms surfaceUniforms(const Material& material) {
  SurfaceUniforms u = {};
  const ToonMaterial& toon = material.toon;
  u.baseColor = material.baseColor;
  u.emissive << material.emissiveStrength * material.emissive, material.normalScale;
  u.physical << material.metallic, material.roughness, material.occlusionStrength, material.alphaCutoff;
  u.shade << toon.shadeColor, toon.shift;
  u.toon << toon.toony, toon.shiftScale, toon.giEqualization, toon.rimLightingMix;
  u.matcap << toon.matcapFactor, 0.0f;
  u.rim << toon.rimColor, toon.rimPower;
  u.outline << toon.rimLift, toon.outlineWidth, toon.outline == OutlineMode::kScreen ? 1.0f : 0.0f,
      toon.outlineLightingMix;
  u.outlineColor << toon.outlineColor, 0.0f;
  u.animation << toon.uvScroll, toon.uvRotation, 0.0f;
  const auto uses = material.textures();
  for (std::size_t slot = 0; slot < uses.size(); ++slot) {
    u.uvRows[2 * slot] << uses[slot]->transform.row(0).transpose(), uses[slot]->uvSet;
    u.uvRows[2 * slot + 1] << uses[slot]->transform.row(1).transpose(), 0.0f;
  }
  return u;
}

AvatarVariant variantFor(const Material& material, Draw draw) {
  AvatarVariant variant;
  variant.draw = draw;
  const bool geometryOnly = draw == Draw::kShadow || draw == Draw::kContact;
  variant.shading = draw == Draw::kDepth || geometryOnly ? Shading::kUnlit : material.shading;
  variant.alpha = material.alpha;
  const auto uses = material.textures();
  const auto keep = [&](AvatarSlot slot) {
    const auto s = static_cast<std::size_t>(slot);
    if (uses[s]->given()) variant.textures |= 1u << s;
  };
  if (!geometryOnly || variant.alpha != AlphaMode::kOpaque) keep(AvatarSlot::kBase);
  if (variant.shading == Shading::kUnlit) return variant;
  keep(AvatarSlot::kNormal);
  keep(AvatarSlot::kEmissive);
  if (variant.shading == Shading::kPhysical) {
    keep(AvatarSlot::kMetallicRoughness);
    keep(AvatarSlot::kOcclusion);
    return variant;
  }
  for (const AvatarSlot slot :
       {AvatarSlot::kShade, AvatarSlot::kShift, AvatarSlot::kMatcap, AvatarSlot::kRim, AvatarSlot::kAnimationMask}) {
    keep(slot);
  }
  if (draw == Draw::kOutline) keep(AvatarSlot::kOutlineWidth);
  return variant;
}

std::string avatarVertex(const AvatarVariant& variant) {
  std::string text = headerOf(variant) + kVertex;
  if (variant.draw == Draw::kShadow || variant.draw == Draw::kContact) {
    text +=
        "out vec4 uv;\nout vec4 vertexColor;\nout float height;\nvoid main() {\n  vec3 p = placed();\n"
        "  uv = uvs;\n  vertexColor = tint;\n  height = p.y / contactArea.w;\n";
    text += variant.draw == Draw::kShadow
                ? "  gl_Position = vec4((shadowFromWorld * vec4(p, 1.0)).xyz * 2.0 - 1.0, 1.0);\n}\n"
                : "  gl_Position = vec4((p.xz - contactArea.xy) / contactArea.z, height * 2.0 - 1.0, 1.0);\n}\n";
    return text;
  }
  return text + shadowLookup() + kSurfaceVertexMain;
}

std::string avatarFragment(const AvatarVariant& variant) {
  const std::string text = opaqueFragment(variant);
  return variant.fading ? fading(text, variant.draw != Draw::kShadow && variant.draw != Draw::kContact) : text;
}

const char* samplerName(AvatarSlot slot) {
  return kSlots[static_cast<std::size_t>(slot)].sampler;
}

}  // namespace lorica::shaders
