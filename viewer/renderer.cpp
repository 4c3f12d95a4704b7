#include "viewer/renderer.h"

#include "viewer/frame_setup.h"
#include "viewer/gpu.h"
#include "viewer/overlay_mesh.h"
#include "viewer/prop_mesh.h"
#include "viewer/shaders.h"
#include "viewer/skin_mesh.h"
#include "viewer/targets.h"
#include "viewer/text.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace lorica {
namespace {

using shaders::Pass;
constexpr std::array<Pass, 3> kPasses = {Pass::kLit, Pass::kShadow, Pass::kContact};

/// Skins with fewer triangles look shadows up for each pixel: theirs are too coarse to do so for each vertex.
constexpr std::size_t kFineTriangles = 8000;

constexpr float kContactSoftness = 0.05f;  // standard deviation [m]

std::size_t at(Pass pass) {
  return static_cast<std::size_t>(pass);
}
const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}
GLsizei count(std::size_t n) {
  return static_cast<GLsizei>(n);
}

struct MarkerVertex {
  Vec3f center;
  Eigen::Vector2f corner;
};

/// One shape of prop on the GPU.
struct PropShapeGpu {
  GLuint vertexArray = 0;
  GLsizei indexCount = 0;
  StreamBuffer instanceBuffer;
  std::vector<PropInstance> instances;
};

/// A text panel as a texture, drawn anew only when its text or size changes.
struct PanelGpu {
  GLuint texture = 0;
  std::string text;
  int lineHeight = 0;
  int width = 0;
  int height = 0;
};

}  // namespace

struct Renderer::Impl {
  explicit Impl(const GlFunctions& functions) : gpu(functions), gl(gpu.gl) {}

  Gpu gpu;
  const GlFunctions& gl;
  Targets targets;

  std::array<GLuint, 3> skinProgram{}, propProgram{};  // by Pass
  GLuint coarseSkinProgram = 0;
  GLuint skyProgram = 0, farFloorProgram = 0, nearFloorProgram = 0, overlayProgram = 0, markerProgram = 0;
  GLuint blurProgram = 0, panelProgram = 0;
  GLint blurStride = -1, markerTint = -1, panelRectangle = -1;
  GLuint frameBlock = 0, emptyVertexArray = 0;

  SkinMesh skin;
  GLuint skinVertexArray = 0;
  StreamBuffer skinVertices, skinColors;
  GLuint skinIndices = 0;

  OverlayMesh overlay;
  GLuint hullVertexArray = 0, boneVertexArray = 0;
  StreamBuffer hullBuffer, boneBuffer;

  std::array<PropShapeGpu, 2> propShapes;
  GLuint skyVertexArray = 0, floorVertexArray = 0, markerVertexArray = 0;
  GLsizei skyIndexCount = 0;
  StreamBuffer floorBuffer, markerBuffer;
  std::vector<MarkerVertex> markers;
  PanelGpu caption, panel;

  Result<void> createPrograms();
  void createMeshes();
  void attribute(GLuint index, GLint size, GLenum type, GLboolean normalized, std::size_t stride, std::size_t at);
  void overlayAttributes(GLuint vertexArray, const StreamBuffer& buffer);
  void createSky();
  void createPropShape(PropShapeGpu& shape, const PropMesh& mesh);

  GLsizei uploadSkin(const Scene& scene, const SceneOptions& options);
  void drawCasters(Pass pass, GLsizei skinIndexCount, GLsizei hullCount);
  void drawContactShadow(GLsizei skinIndexCount, GLsizei hullCount, float contactHalfSide);
  void drawProps(Pass pass);
  void drawFloor(const FrameSetup& setup);
  GLsizei uploadMarkers(std::span<const Contact> contacts);
  void drawPanel(PanelGpu& target, const std::string& text, bool top);
};

Result<void> Renderer::Impl::createPrograms() {
  const auto make = [&](GLuint& program, const char* name, const std::string& vertex, const std::string& fragment) {
    const Result<GLuint> made = gpu.makeProgram(name, vertex, fragment);
    if (!made.ok()) return Result<void>(made.error());
    program = made.value();
    gl.UseProgram(program);
    // Unit 0: whatever the pass reads; 1: contact shadow; 2: shadow map.
    if (const GLint i = gl.GetUniformLocation(program, "source"); i >= 0) gl.Uniform1i(i, 0);
    if (const GLint i = gl.GetUniformLocation(program, "contactMap"); i >= 0) gl.Uniform1i(i, 1);
    if (const GLint i = gl.GetUniformLocation(program, "shadowMap"); i >= 0) gl.Uniform1i(i, 2);
    return Result<void>();
  };
  for (const Pass pass : kPasses) {
    auto r =
        make(skinProgram[at(pass)], "skin", shaders::skinVertex(pass, false), shaders::surfaceFragment(pass, false));
    if (!r.ok()) return r;
    r = make(propProgram[at(pass)], "props", shaders::propVertex(pass), shaders::surfaceFragment(pass, true));
    if (!r.ok()) return r;
  }
  struct Entry {
    GLuint* program;
    const char* name;
    std::string vertex, fragment;
  };
  const Entry entries[] = {
      {&coarseSkinProgram, "coarse skin", shaders::skinVertex(Pass::kLit, true),
       shaders::surfaceFragment(Pass::kLit, true)},
      {&skyProgram, "sky", shaders::skyVertex(), shaders::skyFragment()},
      {&farFloorProgram, "far floor", shaders::groundVertex(), shaders::groundFragment(false)},
      {&nearFloorProgram, "near floor", shaders::groundVertex(), shaders::groundFragment(true)},
      {&overlayProgram, "overlay", shaders::overlayVertex(), shaders::overlayFragment()},
      {&markerProgram, "markers", shaders::markerVertex(), shaders::markerFragment()},
      {&blurProgram, "blur", shaders::fullVertex(), shaders::blurFragment()},
      {&panelProgram, "panel", shaders::panelVertex(), shaders::panelFragment()},
  };
  for (const Entry& entry : entries) {
    if (auto r = make(*entry.program, entry.name, entry.vertex, entry.fragment); !r.ok()) return r;
  }
  blurStride = gl.GetUniformLocation(blurProgram, "stride");
  markerTint = gl.GetUniformLocation(markerProgram, "tint");
  panelRectangle = gl.GetUniformLocation(panelProgram, "rectangle");
  return {};
}

void Renderer::Impl::attribute(GLuint index, GLint size, GLenum type, GLboolean normalized, std::size_t stride,
                               std::size_t at) {
  gl.EnableVertexAttribArray(index);
  gl.VertexAttribPointer(index, size, type, normalized, count(stride), offset(at));
}

void Renderer::Impl::overlayAttributes(GLuint vertexArray, const StreamBuffer& buffer) {
  gl.BindVertexArray(vertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id);
  constexpr std::size_t kStride = sizeof(OverlayVertex);
  attribute(0, 3, GL_FLOAT, GL_FALSE, kStride, offsetof(OverlayVertex, position));
  attribute(1, 3, GL_FLOAT, GL_FALSE, kStride, offsetof(OverlayVertex, other));
  attribute(2, 4, GL_BYTE, GL_TRUE, kStride, offsetof(OverlayVertex, normal));
  attribute(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, kStride, offsetof(OverlayVertex, color));
}

void Renderer::Impl::createPropShape(PropShapeGpu& shape, const PropMesh& mesh) {
  shape.vertexArray = gpu.makeVertexArray();
  shape.indexCount = count(mesh.indices.size());
  shape.instanceBuffer.id = gpu.makeBuffer();
  gl.BindVertexArray(shape.vertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(PropMesh::Vertex)),
                mesh.vertices.data(), GL_STATIC_DRAW);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(PropMesh::Vertex), offsetof(PropMesh::Vertex, corner));
  attribute(1, 3, GL_FLOAT, GL_FALSE, sizeof(PropMesh::Vertex), offsetof(PropMesh::Vertex, normal));
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * sizeof(std::uint32_t)),
                mesh.indices.data(), GL_STATIC_DRAW);
  gl.BindBuffer(GL_ARRAY_BUFFER, shape.instanceBuffer.id);
  struct Field {
    GLint size;
    std::size_t at;
  };
  const Field fields[] = {{3, offsetof(PropInstance, x)},       {3, offsetof(PropInstance, y)},
                          {3, offsetof(PropInstance, z)},       {3, offsetof(PropInstance, origin)},
                          {4, offsetof(PropInstance, extents)}, {3, offsetof(PropInstance, color)}};
  static_assert(offsetof(PropInstance, bevel) == offsetof(PropInstance, extents) + 3 * sizeof(float));
  GLuint index = 2;
  for (const Field& field : fields) {
    attribute(index, field.size, GL_FLOAT, GL_FALSE, sizeof(PropInstance), field.at);
    gl.VertexAttribDivisor(index, 1);
    ++index;
  }
}

/// A grid over the picture whose corners carry the sky's colour: the gradient costs nothing a pixel.
void Renderer::Impl::createSky() {
  constexpr std::uint32_t kColumns = 8, kRows = 32;
  std::vector<Eigen::Vector2f> places;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t row = 0; row <= kRows; ++row) {
    for (std::uint32_t column = 0; column <= kColumns; ++column) {
      places.emplace_back(2.0f * static_cast<float>(column) / kColumns - 1.0f,
                          2.0f * static_cast<float>(row) / kRows - 1.0f);
      if (row == kRows || column == kColumns) continue;
      const std::uint32_t a = row * (kColumns + 1) + column, b = a + 1, c = b + kColumns + 1, d = c - 1;
      indices.insert(indices.end(), {a, b, c, a, c, d});
    }
  }
  skyIndexCount = count(indices.size());
  skyVertexArray = gpu.makeVertexArray();
  gl.BindVertexArray(skyVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(places.size() * sizeof(places[0])), places.data(),
                GL_STATIC_DRAW);
  attribute(0, 2, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector2f), 0);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)),
                indices.data(), GL_STATIC_DRAW);
}

void Renderer::Impl::createMeshes() {
  emptyVertexArray = gpu.makeVertexArray();
  frameBlock = gpu.makeBuffer();
  gl.BindBuffer(GL_UNIFORM_BUFFER, frameBlock);
  gl.BufferData(GL_UNIFORM_BUFFER, sizeof(FrameUniforms), nullptr, GL_STREAM_DRAW);

  skinVertexArray = gpu.makeVertexArray();
  skinVertices.id = gpu.makeBuffer();
  skinColors.id = gpu.makeBuffer();
  skinIndices = gpu.makeBuffer();
  gl.BindVertexArray(skinVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, skinVertices.id);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(SkinMesh::Vertex), offsetof(SkinMesh::Vertex, position));
  attribute(1, 3, GL_FLOAT, GL_FALSE, sizeof(SkinMesh::Vertex), offsetof(SkinMesh::Vertex, normal));
  gl.BindBuffer(GL_ARRAY_BUFFER, skinColors.id);
  attribute(2, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), 0);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, skinIndices);

  hullVertexArray = gpu.makeVertexArray();
  hullBuffer.id = gpu.makeBuffer();
  overlayAttributes(hullVertexArray, hullBuffer);
  boneVertexArray = gpu.makeVertexArray();
  boneBuffer.id = gpu.makeBuffer();
  overlayAttributes(boneVertexArray, boneBuffer);

  createPropShape(propShapes[static_cast<std::size_t>(PropShape::kBox)], makeBevelledBox());
  createPropShape(propShapes[static_cast<std::size_t>(PropShape::kSphere)], makePropSphere());

  floorVertexArray = gpu.makeVertexArray();
  floorBuffer.id = gpu.makeBuffer();
  gl.BindVertexArray(floorVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, floorBuffer.id);
  attribute(0, 2, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector2f), 0);

  markerVertexArray = gpu.makeVertexArray();
  markerBuffer.id = gpu.makeBuffer();
  gl.BindVertexArray(markerVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, markerBuffer.id);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(MarkerVertex), offsetof(MarkerVertex, center));
  attribute(1, 2, GL_FLOAT, GL_FALSE, sizeof(MarkerVertex), offsetof(MarkerVertex, corner));

  createSky();
  caption.texture = gpu.makeTexture(GL_NEAREST);
  panel.texture = gpu.makeTexture(GL_NEAREST);
}

GLsizei Renderer::Impl::uploadSkin(const Scene& scene, const SceneOptions& options) {
  if (!options.skin || scene.triangles.empty()) return 0;
  const bool changed = skin.update(scene.vertices, scene.triangles, scene.partOfTriangle);
  gl.BindVertexArray(skinVertexArray);
  gpu.upload(skinVertices, skin.vertices());
  if (changed) {
    gpu.upload(skinColors, skin.colors());
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(skin.indices().size() * sizeof(std::uint32_t)),
                  skin.indices().data(), GL_STATIC_DRAW);
  }
  if (options.colorSkinByPart) {
    gl.EnableVertexAttribArray(2);
  } else {
    const Vec3f clay = SkinMesh::clay();
    gl.DisableVertexAttribArray(2);
    gl.VertexAttrib3f(2, clay.x(), clay.y(), clay.z());
  }
  return count(skin.indices().size());
}

void Renderer::Impl::drawProps(Pass pass) {
  gl.UseProgram(propProgram[at(pass)]);
  for (const PropShapeGpu& shape : propShapes) {
    if (shape.instances.empty()) continue;
    gl.BindVertexArray(shape.vertexArray);
    gl.DrawElementsInstanced(GL_TRIANGLES, shape.indexCount, GL_UNSIGNED_INT, nullptr, count(shape.instances.size()));
  }
}

/// What casts shadows: the skin, or the hulls where no skin is shown, and the props.
void Renderer::Impl::drawCasters(Pass pass, GLsizei skinIndexCount, GLsizei hullCount) {
  gl.UseProgram(skinProgram[at(pass)]);
  if (skinIndexCount > 0) {
    if (!skin.closed()) gl.Disable(GL_CULL_FACE);
    gl.BindVertexArray(skinVertexArray);
    gl.DrawElements(GL_TRIANGLES, skinIndexCount, GL_UNSIGNED_INT, nullptr);
  } else if (hullCount > 0) {
    gl.BindVertexArray(hullVertexArray);
    gl.DrawArrays(GL_TRIANGLES, 0, hullCount);
  }
  if (pass == Pass::kShadow) gl.Enable(GL_CULL_FACE);
  drawProps(pass);
}

/// Nearness to the floor of whatever is lowest over each place, blurred in both directions.
void Renderer::Impl::drawContactShadow(GLsizei skinIndexCount, GLsizei hullCount, float contactHalfSide) {
  gl.BindFramebuffer(GL_FRAMEBUFFER, targets.contact[0]);
  gl.Viewport(0, 0, Targets::kContactSize, Targets::kContactSize);
  gl.ClearColor(0, 0, 0, 0);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.Disable(GL_DEPTH_TEST);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE);
  gl.BlendEquation(GL_MAX);
  drawCasters(Pass::kContact, skinIndexCount, hullCount);
  gl.BlendEquation(GL_FUNC_ADD);
  gl.Disable(GL_BLEND);
  gl.UseProgram(blurProgram);
  gl.BindVertexArray(emptyVertexArray);
  gl.ActiveTexture(GL_TEXTURE0);
  // The filter's own deviation is 1.41 texels; taps farther apart than three texels would show.
  const float texel = 2.0f * contactHalfSide / Targets::kContactSize;
  const float step = std::clamp(kContactSoftness / (1.41f * texel), 1.0f, 3.0f) / Targets::kContactSize;
  for (const int from : {0, 1}) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, targets.contact[1 - from]);
    gl.BindTexture(GL_TEXTURE_2D, targets.contactMap[from]);
    gl.Uniform4f(blurStride, from == 0 ? step : 0.0f, from == 0 ? 0.0f : step, 0.0f, 0.0f);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
  }
}

/// The floor is four plain strips around the part that shadows reach: reading shadow maps is what costs.
void Renderer::Impl::drawFloor(const FrameSetup& setup) {
  const float x = setup.uniforms.floorFade.x(), z = setup.uniforms.floorFade.y(), h = setup.floorHalfSide;
  const float xs[] = {x - h, setup.shadedMin.x(), setup.shadedMax.x(), x + h};
  const float zs[] = {z - h, setup.shadedMin.y(), setup.shadedMax.y(), z + h};
  std::array<Eigen::Vector2f, 30> corners;
  std::size_t n = 0;
  const auto rectangle = [&](float x0, float x1, float z0, float z1) {
    for (const auto& [px, pz] : {std::pair{x0, z0}, {x0, z1}, {x1, z1}, {x0, z0}, {x1, z1}, {x1, z0}}) {
      corners[n++] = {px, pz};
    }
  };
  rectangle(xs[1], xs[2], zs[1], zs[2]);
  rectangle(xs[0], xs[3], zs[0], zs[1]);
  rectangle(xs[0], xs[3], zs[2], zs[3]);
  rectangle(xs[0], xs[1], zs[1], zs[2]);
  rectangle(xs[2], xs[3], zs[1], zs[2]);
  gpu.upload(floorBuffer, corners.data(), sizeof(corners));
  gl.BindVertexArray(floorVertexArray);
  gl.UseProgram(nearFloorProgram);
  gl.DrawArrays(GL_TRIANGLES, 0, 6);
  gl.UseProgram(farFloorProgram);
  gl.DrawArrays(GL_TRIANGLES, 6, 24);
}

GLsizei Renderer::Impl::uploadMarkers(std::span<const Contact> contacts) {
  markers.clear();
  for (const Contact& contact : contacts) {
    const Vec3f center = contact.point.cast<float>();
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}) {
      markers.push_back({center, {static_cast<float>(x), static_cast<float>(y)}});
    }
  }
  if (!markers.empty()) gpu.upload(markerBuffer, markers);
  return count(markers.size());
}

/// Straight onto the resolved picture, one texel a pixel.
void Renderer::Impl::drawPanel(PanelGpu& target, const std::string& text, bool top) {
  if (text.empty()) return;
  const int lineHeight = std::clamp(targets.height / 34, 12, 48);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, target.texture);
  if (text != target.text || lineHeight != target.lineHeight) {
    const Image image = drawTextPanel(text, lineHeight);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                  image.rgba.data());
    target = {target.texture, text, lineHeight, image.width, image.height};
  }
  const float margin = 0.5f * static_cast<float>(lineHeight);
  const float sx = 2.0f / static_cast<float>(targets.width), sy = 2.0f / static_cast<float>(targets.height);
  const float left = std::floor(margin) * sx - 1.0f;
  const float bottom =
      (top ? static_cast<float>(targets.height - target.height) - std::floor(margin) : std::floor(margin)) * sy - 1.0f;
  gl.UseProgram(panelProgram);
  gl.Uniform4f(panelRectangle, left, bottom, left + static_cast<float>(target.width) * sx,
               bottom + static_cast<float>(target.height) * sy);
  gl.Disable(GL_DEPTH_TEST);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl.BindVertexArray(emptyVertexArray);
  gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  gl.Disable(GL_BLEND);
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Result<Renderer> Renderer::create(GetProc getProc) {
  const Result<GlFunctions> functions = loadGlFunctions(getProc);
  if (!functions.ok()) return functions.error();
  auto impl = std::make_unique<Impl>(functions.value());
  if (auto r = impl->createPrograms(); !r.ok()) return r.error();
  if (auto r = impl->targets.create(impl->gpu); !r.ok()) return r.error();
  impl->createMeshes();
  return Renderer(std::move(impl));
}

void Renderer::draw(const Scene& scene, const SceneOptions& options, const Camera& camera, int width, int height) {
  Impl& i = *impl_;
  const GlFunctions& gl = i.gl;
  i.targets.resize(i.gpu, std::max(width, 1), std::max(height, 1));
  const FrameSetup setup = setUpFrame(scene, options, camera, i.targets.width, i.targets.height, Targets::kShadowSize);

  // Everything that changes with the frame goes up first, one upload a buffer.
  gl.BindBuffer(GL_UNIFORM_BUFFER, i.frameBlock);
  gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(FrameUniforms), &setup.uniforms);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, i.frameBlock);
  const GLsizei skinIndexCount = i.uploadSkin(scene, options);
  GLsizei hullCount = 0, boneCount = 0, markerCount = 0;
  if (options.hulls && !scene.parts.empty()) {
    const std::vector<OverlayVertex>& vertices = i.overlay.hulls(scene.parts, camera.eye);
    i.gpu.upload(i.hullBuffer, vertices);
    hullCount = count(vertices.size());
  }
  if (options.bones && scene.skeleton != nullptr) {
    const std::vector<OverlayVertex>& vertices = i.overlay.bones(*scene.skeleton, scene.worldFromJoint, camera.eye);
    i.gpu.upload(i.boneBuffer, vertices);
    boneCount = count(vertices.size());
  }
  if (options.contacts) markerCount = i.uploadMarkers(scene.contacts);
  for (std::size_t shape = 0; shape < i.propShapes.size(); ++shape) {
    PropShapeGpu& target = i.propShapes[shape];
    target.instances.clear();
    if (!options.props) continue;
    makePropInstances(scene.props, static_cast<PropShape>(shape), target.instances);
    if (!target.instances.empty()) i.gpu.upload(target.instanceBuffer, target.instances);
  }

  // Shadow map.
  gl.BindFramebuffer(GL_FRAMEBUFFER, i.targets.shadow);
  gl.Viewport(0, 0, Targets::kShadowSize, Targets::kShadowSize);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
  gl.Disable(GL_CULL_FACE);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  // Closed surfaces cast with the faces that look away from the light: those never shade the faces that it meets.
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_FRONT);
  i.drawCasters(Pass::kShadow, skinIndexCount, hullCount);
  gl.Disable(GL_CULL_FACE);
  if (options.ground) i.drawContactShadow(skinIndexCount, hullCount, setup.uniforms.contactArea.z());

  // Opaque things, near before far: what they cover is not shaded again.
  gl.BindFramebuffer(GL_FRAMEBUFFER, i.targets.picture);
  gl.Viewport(0, 0, i.targets.width, i.targets.height);
  gl.Enable(GL_DEPTH_TEST);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_2D, i.targets.contactMap[0]);
  gl.ActiveTexture(GL_TEXTURE2);
  gl.BindTexture(GL_TEXTURE_2D, i.targets.shadowMap);
  gl.CullFace(GL_BACK);
  if (skinIndexCount > 0) {
    if (i.skin.closed()) gl.Enable(GL_CULL_FACE);
    gl.UseProgram(i.skin.triangleCount() < kFineTriangles ? i.coarseSkinProgram : i.skinProgram[at(Pass::kLit)]);
    gl.BindVertexArray(i.skinVertexArray);
    gl.DrawElements(GL_TRIANGLES, skinIndexCount, GL_UNSIGNED_INT, nullptr);
  }
  gl.Enable(GL_CULL_FACE);
  i.drawProps(Pass::kLit);
  if (options.ground) i.drawFloor(setup);
  gl.Disable(GL_CULL_FACE);
  gl.UseProgram(i.skyProgram);
  gl.BindVertexArray(i.skyVertexArray);
  gl.DrawElements(GL_TRIANGLES, i.skyIndexCount, GL_UNSIGNED_INT, nullptr);

  // Translucent hulls.
  gl.DepthMask(GL_FALSE);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  if (hullCount > 0) {
    gl.UseProgram(i.overlayProgram);
    gl.BindVertexArray(i.hullVertexArray);
    gl.DrawArrays(GL_TRIANGLES, 0, hullCount);
  }

  // Contacts: faint where something is in front of them.
  if (markerCount > 0) {
    gl.UseProgram(i.markerProgram);
    gl.BindVertexArray(i.markerVertexArray);
    for (const GLenum where : {GL_GREATER, GL_LEQUAL}) {
      gl.DepthFunc(where);
      gl.Uniform4f(i.markerTint, 1.0f, 1.0f, 1.0f, where == GL_GREATER ? 0.45f : 1.0f);
      gl.DrawArrays(GL_TRIANGLES, 0, markerCount);
    }
    gl.DepthFunc(GL_LEQUAL);
  }
  gl.DepthMask(GL_TRUE);

  // Bones shine through everything, but hide one another.
  if (boneCount > 0) {
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.UseProgram(i.overlayProgram);
    gl.BindVertexArray(i.boneVertexArray);
    gl.DrawArrays(GL_TRIANGLES, 0, boneCount);
  }
  gl.Disable(GL_BLEND);

  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, i.targets.picture);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, i.targets.resolved);
  gl.BlitFramebuffer(0, 0, i.targets.width, i.targets.height, 0, 0, i.targets.width, i.targets.height,
                     GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, i.targets.resolved);
  i.drawPanel(i.caption, options.caption, false);
  i.drawPanel(i.panel, options.panel, true);
}

Image Renderer::readBack() {
  const Targets& t = impl_->targets;
  Image image;
  image.width = t.width;
  image.height = t.height;
  const std::size_t rowBytes = static_cast<std::size_t>(t.width) * 4;
  image.rgba.resize(rowBytes * static_cast<std::size_t>(t.height));
  impl_->gl.BindFramebuffer(GL_FRAMEBUFFER, t.resolved);
  impl_->gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  impl_->gl.ReadPixels(0, 0, t.width, t.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  // OpenGL's rows start at the bottom. Coverage of panels and hulls has left its mark in alpha: the picture is opaque.
  for (int top = 0, bottom = t.height - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(image.rgba.data() + static_cast<std::size_t>(top) * rowBytes,
                     image.rgba.data() + static_cast<std::size_t>(top + 1) * rowBytes,
                     image.rgba.data() + static_cast<std::size_t>(bottom) * rowBytes);
  }
  for (std::size_t k = 3; k < image.rgba.size(); k += 4) image.rgba[k] = 255;
  return image;
}

void Renderer::present(int windowWidth, int windowHeight) {
  const Targets& t = impl_->targets;
  const GlFunctions& gl = impl_->gl;
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, t.resolved);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  const bool sameSize = windowWidth == t.width && windowHeight == t.height;
  gl.BlitFramebuffer(0, 0, t.width, t.height, 0, 0, windowWidth, windowHeight, GL_COLOR_BUFFER_BIT,
                     sameSize ? GL_NEAREST : GL_LINEAR);
}

}  // namespace lorica
