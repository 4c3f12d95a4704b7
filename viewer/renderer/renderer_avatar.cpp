#include "viewer/renderer/renderer_impl.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lorica {

namespace {

using shaders::AvatarSlot;
using shaders::AvatarVariant;
using Draw = AvatarVariant::Draw;

/// Avatars with more vertices are skinned once on the CPU if the renderer is software, which would skin them in each
/// pass anew.
constexpr std::size_t kPosedVertices = 2000;

[[nodiscard]] GLint wrapOf(TextureWrap wrap) {
  return wrap == TextureWrap::kRepeat   ? GL_REPEAT
         : wrap == TextureWrap::kMirror ? GL_MIRRORED_REPEAT
                                        : GL_CLAMP_TO_EDGE;
}

/// Whether a slot's picture holds colours, which are stored as sRGB, or numbers.
[[nodiscard]] bool holdsColor(std::size_t slot) {
  constexpr std::array kColors = {AvatarSlot::kBase, AvatarSlot::kEmissive, AvatarSlot::kShade, AvatarSlot::kMatcap,
                                  AvatarSlot::kRim};
  return std::find(kColors.begin(), kColors.end(), static_cast<AvatarSlot>(slot)) != kColors.end();
}

/// The joint that moves a vertex most.
[[nodiscard]] JointIndex mainJoint(const Character& character, VertexIndex v) {
  const auto begin = character.influences.begin() + character.influenceBegin[v];
  const auto end = character.influences.begin() + character.influenceBegin[v + 1];
  return std::max_element(begin, end, [](const Influence& a, const Influence& b) { return a.weight < b.weight; })
      ->joint;
}

/// Whether a group can be drawn together with groups before it to cast shadows.
[[nodiscard]] bool castAlike(const AvatarGroup& first, GLsizei indexCount, const AvatarGroup& next) {
  const Material& a = *first.material;
  const Material& b = *next.material;
  return a.alpha == AlphaMode::kOpaque && b.alpha == AlphaMode::kOpaque && a.doubleSided == b.doubleSided &&
         first.firstIndex + indexCount == next.firstIndex;
}

[[nodiscard]] bool isOutlined(const Material& material) {
  return material.shading == Shading::kToon && material.toon.outline != OutlineMode::kNone &&
         material.toon.outlineWidth > 0.0f;
}

}  // namespace

GLuint Renderer::Impl::avatarTexture(AvatarGpu& made, const Avatar& drawn, const TextureUse& use, bool srgb) {
  if (!use.given()) return 0;
  const Picture& picture = drawn.pictures[use.picture];
  if (picture.width == 0) return 0;
  for (const AvatarTexture& known : made.textures) {
    if (known.use.picture == use.picture && known.srgb == srgb && known.use.wrapU == use.wrapU &&
        known.use.wrapV == use.wrapV && known.use.smooth == use.smooth) {
      return known.texture;
    }
  }
  const GLuint texture = gpu.makeTexture(GL_LINEAR);
  made.textures.push_back({use, srgb, texture});
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage2D(GL_TEXTURE_2D, 0, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, picture.width, picture.height, 0, GL_RGBA,
                GL_UNSIGNED_BYTE, picture.rgba.data());
  gl.GenerateMipmap(GL_TEXTURE_2D);
  // Software renderers take the nearest of the smaller copies, which halves their work.
  const GLint smooth = software ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_LINEAR;
  const GLint sharp = software ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_LINEAR;
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, use.smooth ? smooth : sharp);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, use.smooth ? GL_LINEAR : GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrapOf(use.wrapU));
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrapOf(use.wrapV));
  return texture;
}

/// Gives the memory of an avatar back that no longer exists. Its buffers are filled again for the next one.
void Renderer::Impl::releaseAvatar(AvatarGpu& made) {
  for (const AvatarTexture& texture : made.textures) gpu.discardTexture(texture.texture);
  for (const GLuint buffer : {made.shapeBuffer, made.vertexBuffer, made.indexBuffer, made.posedBuffer.id}) {
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, 0, nullptr, GL_STATIC_DRAW);
  }
  made.posedBuffer.capacity = 0;
  made.textures = {};
  made.groups = {};
  made.casters = {};
  made.shapes = made.bindShapes = {};
  made.vertices = {};
  made.posed = {};
  made.avatar.reset();
  made.inUse = false;
}

/// The GPU data of an avatar that is not shown yet in this picture, uploaded if it is new: several figures may show one
/// avatar in different poses. Data of avatars that no longer exist is reused.
AvatarGpu& Renderer::Impl::avatarGpuOf(const std::shared_ptr<const Avatar>& drawn) {
  for (AvatarGpu& known : avatars) {
    if (!known.shown && known.avatar.lock() == drawn) return known;
  }
  auto position = std::find_if(avatars.begin(), avatars.end(), [](const AvatarGpu& a) { return !a.inUse; });
  if (position == avatars.end()) {
    position = avatars.emplace(avatars.end());
    AvatarGpu& made = *position;
    made.vertexArray = gpu.makeVertexArray();
    made.shapeBuffer = gpu.makeBuffer();
    made.vertexBuffer = gpu.makeBuffer();
    made.indexBuffer = gpu.makeBuffer();
    made.jointBuffer.id = gpu.makeBuffer();
    made.posedBuffer.id = gpu.makeBuffer();
    made.jointTexture = gpu.makeBufferTexture();
  }
  fillAvatar(*position, *drawn);
  position->avatar = drawn;
  position->inUse = true;
  return *position;
}

void Renderer::Impl::fillAvatar(AvatarGpu& made, const Avatar& drawn) {
  // 1. Vertices.
  AvatarMesh mesh = makeAvatarMesh(drawn);
  made.fewInfluences = mesh.fewInfluences;
  made.posedOnCpu = software && mesh.vertices.size() > kPosedVertices;
  made.shadowEachPixel = drawn.character.mesh.triangles.size() < kFineTriangles;
  gl.BindVertexArray(made.vertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, made.shapeBuffer);
  gl.BufferData(GL_ARRAY_BUFFER, mesh.shapes.size() * sizeof(AvatarShape), mesh.shapes.data(), GL_DYNAMIC_DRAW);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(AvatarShape), offsetof(AvatarShape, position));
  attribute(1, 3, GL_FLOAT, GL_FALSE, sizeof(AvatarShape), offsetof(AvatarShape, normal));
  if (made.posedOnCpu) {
    gl.BindBuffer(GL_ARRAY_BUFFER, made.posedBuffer.id);
    attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(AvatarPosed), offsetof(AvatarPosed, position));
    attribute(1, 3, GL_FLOAT, GL_FALSE, sizeof(AvatarPosed), offsetof(AvatarPosed, normal));
    attribute(2, 4, GL_FLOAT, GL_FALSE, sizeof(AvatarPosed), offsetof(AvatarPosed, tangent));
  }
  gl.BindBuffer(GL_ARRAY_BUFFER, made.vertexBuffer);
  gl.BufferData(GL_ARRAY_BUFFER, mesh.vertices.size() * sizeof(AvatarVertex), mesh.vertices.data(), GL_STATIC_DRAW);
  constexpr std::size_t kStride = sizeof(AvatarVertex);
  if (!made.posedOnCpu) attribute(2, 4, GL_FLOAT, GL_FALSE, kStride, offsetof(AvatarVertex, tangent));
  attribute(3, 4, GL_FLOAT, GL_FALSE, kStride, offsetof(AvatarVertex, uv));
  attribute(4, 4, GL_FLOAT, GL_FALSE, kStride, offsetof(AvatarVertex, color));
  for (std::size_t half = 0; half < 2; ++half) {
    const GLuint joints = half == 0 ? 5 : 7;
    gl.EnableVertexAttribArray(joints);
    gl.VertexAttribIPointer(joints, 4, GL_UNSIGNED_SHORT, kStride,
                            reinterpret_cast<const void*>(offsetof(AvatarVertex, joints) + 8 * half));
    attribute(joints + 1, 4, GL_FLOAT, GL_FALSE, kStride, offsetof(AvatarVertex, weights) + 16 * half);
  }
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, made.indexBuffer);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, mesh.indices.size() * sizeof(std::uint32_t), mesh.indices.data(),
                GL_STATIC_DRAW);
  made.bindShapes = made.shapes = std::move(mesh.shapes);
  made.reshaped = false;
  if (made.posedOnCpu) {
    made.posed.resize(mesh.vertices.size());
    made.vertices = std::move(mesh.vertices);
  }

  // 2. Materials.
  while (made.surfaces.size() < drawn.look.materials.size()) made.surfaces.push_back(gpu.makeBuffer());
  made.uniforms.clear();
  for (std::size_t m = 0; m < drawn.look.materials.size(); ++m) {
    const shaders::SurfaceUniforms& uniforms =
        made.uniforms.emplace_back(shaders::surfaceUniforms(drawn.look.materials[m]));
    gl.BindBuffer(GL_UNIFORM_BUFFER, made.surfaces[m]);
    gl.BufferData(GL_UNIFORM_BUFFER, sizeof(uniforms), &uniforms, GL_DYNAMIC_DRAW);
  }

  // 3. Groups.
  for (const LookGroup& from : drawn.look.groups) {
    if (from.triangleCount == 0) continue;
    AvatarGroup group;
    group.material = &drawn.look.materials[from.material];
    group.firstIndex = 3 * from.firstTriangle;
    group.indexCount = glCount(3 * from.triangleCount);
    group.flat = from.flat;
    group.surface = made.surfaces[from.material];
    const auto uses = group.material->textures();
    for (std::size_t slot = 0; slot < uses.size(); ++slot) {
      group.textures[slot] = avatarTexture(made, drawn, *uses[slot], holdsColor(slot));
      if (group.textures[slot] != 0) group.available |= 1u << slot;
    }
    Aabb box;
    for (std::size_t t = from.firstTriangle; t < from.firstTriangle + from.triangleCount; ++t) {
      for (const VertexIndex v : drawn.character.mesh.triangles[t]) box.extend(drawn.character.mesh.vertices[v]);
    }
    group.center = box.center();
    group.joint = mainJoint(drawn.character, drawn.character.mesh.triangles[from.firstTriangle][0]);
    made.groups.push_back(group);
  }

  // 4. Casters: consecutive opaque groups are one, because only their shapes matter.
  for (std::size_t g = 0; g < made.groups.size(); ++g) {
    const AvatarGroup& group = made.groups[g];
    if (group.material->alpha == AlphaMode::kBlend && group.material->baseColor.w() < 0.5f) continue;
    AvatarCasters* last = made.casters.empty() ? nullptr : &made.casters.back();
    if (last == nullptr || !castAlike(made.groups[last->group], last->indexCount, group)) {
      made.casters.push_back({g, group.indexCount});
    } else {
      last->indexCount += group.indexCount;
    }
  }
}

Program Renderer::Impl::avatarProgram(AvatarVariant variant) {
  for (const AvatarProgram& known : avatarPrograms) {
    if (known.variant == variant) return known.program;
  }
  const Result<GLuint> made =
      gpu.makeProgram("avatar", shaders::avatarVertex(variant), shaders::avatarFragment(variant));
  const GLuint id = made ? *made : 0;
  const Program program{id, id != 0 ? gl.GetUniformLocation(id, "opacity") : -1};
  avatarPrograms.push_back({variant, program});
  if (id == 0) return program;
  use(program);
  const auto bind = [&](const char* sampler, int unit) {
    if (const GLint at = gl.GetUniformLocation(id, sampler); at >= 0) gl.Uniform1i(at, unit);
  };
  bind("shadowMap", 2);
  bind("joints", shaders::kJointUnit);
  for (int slot = 0; slot < shaders::kAvatarSlots; ++slot) {
    bind(shaders::samplerName(static_cast<AvatarSlot>(slot)), shaders::kFirstAvatarUnit + slot);
  }
  return program;
}

bool Renderer::Impl::uploadAvatar(const SceneFigure& figure, const SceneOptions& options) {
  if (options.colorSkinByPart || figure.avatar == nullptr || !figure.avatar->look.given()) return false;
  if (figure.worldFromModel.size() != figure.avatar->character.jointFromModel.size()) return false;  // not posed yet
  avatar = &avatarGpuOf(figure.avatar);
  avatar->shown = true;
  avatar->opacity = figure.opacity;
  shownAvatars.push_back(avatar);
  fillJointRows(figure.worldFromModel, avatar->jointRows);
  gpu.upload(avatar->jointBuffer, avatar->jointRows);
  gl.ActiveTexture(GL_TEXTURE0 + shaders::kJointUnit);
  gl.BindTexture(GL_TEXTURE_BUFFER, avatar->jointTexture);
  gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, avatar->jointBuffer.id);

  recolorAvatar(figure);
  reshapeAvatar(figure);
  if (!avatar->posedOnCpu) return true;
  poseAvatar(avatar->shapes, avatar->vertices, avatar->jointRows, avatar->posed);
  gpu.upload(avatar->posedBuffer, avatar->posed);
  return true;
}

void Renderer::Impl::bindAvatar(AvatarGpu& next) {
  avatar = &next;
  gl.BindVertexArray(avatar->vertexArray);
  gl.ActiveTexture(GL_TEXTURE0 + shaders::kJointUnit);
  gl.BindTexture(GL_TEXTURE_BUFFER, avatar->jointTexture);
}

/// Uploads the shape that an expression gives, or the bind pose's again.
void Renderer::Impl::reshapeAvatar(const SceneFigure& figure) {
  const std::size_t count = avatar->bindShapes.size();
  const bool reshaped = figure.avatarPositions.size() == count && figure.avatarNormals.size() == count;
  if (!reshaped && !avatar->reshaped) return;
  bool changed = false;
  for (std::size_t v = 0; v < count; ++v) {
    const AvatarShape now = reshaped ? AvatarShape{figure.avatarPositions[v].cast<float>(), figure.avatarNormals[v]}
                                     : avatar->bindShapes[v];
    AvatarShape& last = avatar->shapes[v];
    changed = changed || now.position != last.position || now.normal != last.normal;
    last = now;
  }
  avatar->reshaped = reshaped;
  if (!changed || avatar->posedOnCpu) return;
  gl.BindBuffer(GL_ARRAY_BUFFER, avatar->shapeBuffer);
  gl.BufferSubData(GL_ARRAY_BUFFER, 0, count * sizeof(AvatarShape), avatar->shapes.data());
}

/// Uploads the materials that an expression changes, or changed in the picture before.
void Renderer::Impl::recolorAvatar(const SceneFigure& figure) {
  const std::vector<Material>& own = figure.avatar->look.materials;
  const std::span<const Material> shown = figure.avatarMaterials.size() == own.size() ? figure.avatarMaterials : own;
  for (std::size_t m = 0; m < shown.size(); ++m) {
    const shaders::SurfaceUniforms now = shaders::surfaceUniforms(shown[m]);
    if (now == avatar->uniforms[m]) continue;
    avatar->uniforms[m] = now;
    gl.BindBuffer(GL_UNIFORM_BUFFER, avatar->surfaces[m]);
    gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof now, &now);
  }
}

void Renderer::Impl::drawAvatarGroup(const AvatarGroup& group, Draw draw, GLsizei indexCount) {
  AvatarVariant variant = shaders::variantFor(*group.material, draw);
  variant.flat = group.flat;
  variant.fading = avatar->opacity < 1.0f;
  variant.posed = avatar->posedOnCpu;
  variant.fewInfluences = avatar->fewInfluences || variant.posed;
  variant.shadowEachPixel = avatar->shadowEachPixel || group.flat;  // flat triangles have no normals at vertices
  variant.textures &= group.available;
  const Program program = avatarProgram(variant);
  if (program.id == 0) return;
  variant.fading ? use(program, avatar->opacity) : use(program);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 1, group.surface);
  for (std::size_t slot = 0; slot < group.textures.size(); ++slot) {
    if ((variant.textures >> slot & 1u) == 0) continue;
    gl.ActiveTexture(GL_TEXTURE0 + shaders::kFirstAvatarUnit + slot);
    gl.BindTexture(GL_TEXTURE_2D, group.textures[slot]);
  }
  gl.CullFace(draw == Draw::kOutline ? GL_FRONT : GL_BACK);
  enable(GL_CULL_FACE, draw == Draw::kOutline || !group.material->doubleSided);
  gl.DrawElements(GL_TRIANGLES, indexCount > 0 ? indexCount : group.indexCount, GL_UNSIGNED_INT,
                  reinterpret_cast<const void*>(group.firstIndex * sizeof(std::uint32_t)));
}

void Renderer::Impl::drawAvatarCasters(shaders::Pass pass) {
  if (shownAvatars.empty()) return;
  // Hair and clothes are open, so lit faces cast shadows.
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(kCasterSlope, kCasterUnits);
  const Draw draw = pass == shaders::Pass::kShadow ? Draw::kShadow : Draw::kContact;
  for (AvatarGpu* next : shownAvatars) {
    bindAvatar(*next);
    for (const AvatarCasters& casters : avatar->casters) {
      drawAvatarGroup(avatar->groups[casters.group], draw, casters.indexCount);
    }
  }
  gl.Disable(GL_POLYGON_OFFSET_FILL);
  gl.CullFace(GL_FRONT);
  enable(GL_CULL_FACE, pass == shaders::Pass::kShadow);
}

void Renderer::Impl::drawAvatarOpaque() {
  for (AvatarGpu* next : shownAvatars) {
    if (next->opacity < 1.0f) continue;
    bindAvatar(*next);
    drawOpaqueGroups();
  }
  gl.CullFace(GL_BACK);
}

void Renderer::Impl::drawOpaqueGroups() {
  for (const AvatarGroup& group : avatar->groups) {
    if (group.material->alpha == AlphaMode::kBlend) continue;
    drawAvatarGroup(group, Draw::kSurface);
    if (isOutlined(*group.material)) drawAvatarGroup(group, Draw::kOutline);
  }
}

/// Blended groups in the order that their materials ask for, then from far to near. The depth of what is more opaque
/// than not is drawn first, so that a strand of hair hides those behind it whatever their order in the mesh.
void Renderer::Impl::drawAvatarBlended(const Vec3& eye) {
  for (AvatarGpu* next : shownAvatars) {
    bindAvatar(*next);
    if (avatar->opacity < 1.0f) drawFading([this] { drawOpaqueGroups(); });
    drawBlendedGroups(eye);
  }
  gl.CullFace(GL_BACK);
  gl.Disable(GL_CULL_FACE);
}

void Renderer::Impl::drawBlendedGroups(const Vec3& eye) {
  std::vector<std::size_t>& order = avatar->blended;
  std::vector<double>& distances = avatar->distances;
  order.clear();
  distances.assign(avatar->groups.size(), 0.0);
  for (std::size_t g = 0; g < avatar->groups.size(); ++g) {
    const AvatarGroup& group = avatar->groups[g];
    if (group.material->alpha != AlphaMode::kBlend) continue;
    const std::size_t row = 3 * group.joint;
    Vec3 center;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      center[axis] = avatar->jointRows[row + axis].cast<double>().dot(group.center.homogeneous());
    }
    const double distance = (center - eye).squaredNorm();
    distances[g] = std::isfinite(distance) ? distance : 0.0;  // the order must be strict
    order.push_back(g);
  }
  if (order.empty()) return;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const int orderA = avatar->groups[a].material->drawOrder;
    const int orderB = avatar->groups[b].material->drawOrder;
    if (orderA != orderB) return orderA < orderB;
    return distances[a] != distances[b] ? distances[a] > distances[b] : a < b;
  });
  blendOver();
  for (const std::size_t g : order) {
    const AvatarGroup& group = avatar->groups[g];
    gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    drawAvatarGroup(group, Draw::kDepth);
    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.Enable(GL_BLEND);
    gl.DepthMask(GL_FALSE);
    if (isOutlined(*group.material)) drawAvatarGroup(group, Draw::kOutline);  // it is behind the surface
    gl.DepthMask(group.material->blendWritesDepth ? GL_TRUE : GL_FALSE);
    drawAvatarGroup(group, Draw::kSurface);
    gl.Disable(GL_BLEND);
    gl.DepthMask(GL_TRUE);
  }
}

}  // namespace lorica
