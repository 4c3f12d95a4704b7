#include "viewer/renderer/frame_setup.h"
#include "viewer/renderer/renderer_impl.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace lorica {
namespace {

using shaders::Pass;
constexpr std::array<Pass, 3> kPasses = {Pass::kLit, Pass::kShadow, Pass::kContact};

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

}  // namespace

Result<void> Renderer::Impl::createPrograms() {
  const auto make = [&](GLuint& program, const char* name, const std::string& vertex, const std::string& fragment) {
    const Result<GLuint> made = gpu.makeProgram(name, vertex, fragment);
    if (!made.ok()) return Result<void>(made.error());
    program = made.value();
    gl.UseProgram(program);
    // In the order of their units; the first is the pass's own texture.
    for (GLint unit = 0;
         const char* map : {"source", "contactMap", "shadowMap", "behind", "behindDepth", "thickness"}) {
      if (const GLint i = gl.GetUniformLocation(program, map); i >= 0) gl.Uniform1i(i, unit);
      ++unit;
    }
    return Result<void>();
  };
  for (const Pass pass : kPasses) {
    auto r = make(skinProgram[passIndex(pass)], "skin", shaders::skinVertex(pass, false),
                  shaders::surfaceFragment(pass, false));
    if (!r.ok()) return r;
    r = make(fadingSkinProgram[passIndex(pass)], "fading skin", shaders::skinVertex(pass, true),
             shaders::fading(shaders::surfaceFragment(pass, true)));
    if (!r.ok()) return r;
    const std::string fragment = shaders::surfaceFragment(pass, true);
    r = make(propProgram[passIndex(pass)], "props", shaders::propVertex(pass),
             pass == Pass::kLit ? shaders::fading(fragment, "flat in") : fragment);
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
      {&grainShadowProgram, "grain shadows", shaders::grainVertex(Pass::kShadow),
       shaders::grainFragment(Pass::kShadow, false)},
      {&farGrainProgram, "far grains", shaders::grainVertex(Pass::kLit), shaders::grainFragment(Pass::kLit, false)},
      {&nearGrainProgram, "near grains", shaders::grainVertex(Pass::kLit), shaders::grainFragment(Pass::kLit, true)},
      {&dropProgram, "drops", shaders::dropVertex(), shaders::dropFragment()},
      {&smoothProgram, "water's smoothing", shaders::fullVertex(), shaders::smoothFragment()},
      {&waterNormalProgram, "water's normals", shaders::fullVertex(), shaders::waterNormalFragment()},
      {&waterProgram, "water", shaders::fullVertex(), shaders::waterFragment()},
      {&blurProgram, "blur", shaders::fullVertex(), shaders::blurFragment()},
      {&panelProgram, "panel", shaders::panelVertex(), shaders::panelFragment()},
  };
  for (const Entry& entry : entries) {
    if (auto r = make(*entry.program, entry.name, entry.vertex, entry.fragment); !r.ok()) return r;
  }
  blurStride = gl.GetUniformLocation(blurProgram, "stride");
  grainShadowUniform = gl.GetUniformLocation(grainShadowProgram, "grain");
  farGrainUniform = gl.GetUniformLocation(farGrainProgram, "grain");
  nearGrainUniform = gl.GetUniformLocation(nearGrainProgram, "grain");
  dropUniform = gl.GetUniformLocation(dropProgram, "grain");
  smoothUniform = gl.GetUniformLocation(smoothProgram, "direction");
  waterUniform = gl.GetUniformLocation(waterProgram, "water");
  markerTint = gl.GetUniformLocation(markerProgram, "tint");
  panelRectangle = gl.GetUniformLocation(panelProgram, "rectangle");
  return {};
}

void Renderer::Impl::attribute(GLuint index, GLint size, GLenum type, GLboolean normalized, std::size_t stride,
                               std::size_t at) {
  gl.EnableVertexAttribArray(index);
  gl.VertexAttribPointer(index, size, type, normalized, glCount(stride), offset(at));
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

void Renderer::Impl::fillPropShape(PropShapeGpu& shape, const PropMesh& mesh) {
  shape.indexCount = glCount(mesh.indices.size());
  gl.BindVertexArray(shape.vertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, shape.vertexBuffer);
  gl.BufferData(GL_ARRAY_BUFFER, mesh.vertices.size() * sizeof(PropMesh::Vertex), mesh.vertices.data(), GL_STATIC_DRAW);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, shape.indexBuffer);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, mesh.indices.size() * sizeof(std::uint32_t), mesh.indices.data(),
                GL_STATIC_DRAW);
}

void Renderer::Impl::createPropShape(PropShapeGpu& shape, const PropMesh& mesh) {
  shape.vertexArray = gpu.makeVertexArray();
  shape.vertexBuffer = gpu.makeBuffer();
  shape.indexBuffer = gpu.makeBuffer();
  shape.instanceBuffer.id = gpu.makeBuffer();
  fillPropShape(shape, mesh);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(PropMesh::Vertex), offsetof(PropMesh::Vertex, corner));
  attribute(1, 3, GL_FLOAT, GL_FALSE, sizeof(PropMesh::Vertex), offsetof(PropMesh::Vertex, normal));
  gl.BindBuffer(GL_ARRAY_BUFFER, shape.instanceBuffer.id);
  struct Field {
    GLint size;
    std::size_t at;
  };
  const Field fields[] = {{3, offsetof(PropInstance, x)},       {3, offsetof(PropInstance, y)},
                          {3, offsetof(PropInstance, z)},       {3, offsetof(PropInstance, origin)},
                          {4, offsetof(PropInstance, extents)}, {4, offsetof(PropInstance, color)}};
  static_assert(offsetof(PropInstance, opacity) == offsetof(PropInstance, color) + 3 * sizeof(float));
  static_assert(offsetof(PropInstance, bevel) == offsetof(PropInstance, extents) + 3 * sizeof(float));
  GLuint index = 2;
  for (const Field& field : fields) {
    attribute(index, field.size, GL_FLOAT, GL_FALSE, sizeof(PropInstance), field.at);
    gl.VertexAttribDivisor(index, 1);
    ++index;
  }
}

/// A grid over the picture with the sky's colour at its vertices, so that the gradient costs nothing per pixel.
void Renderer::Impl::createSky() {
  constexpr std::uint32_t kColumns = 8, kRows = 32;
  std::vector<Eigen::Vector2f> positions;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t row = 0; row <= kRows; ++row) {
    for (std::uint32_t column = 0; column <= kColumns; ++column) {
      positions.emplace_back(2.0f * column / kColumns - 1.0f, 2.0f * row / kRows - 1.0f);
      if (row == kRows || column == kColumns) continue;
      const std::uint32_t a = row * (kColumns + 1) + column, b = a + 1, c = b + kColumns + 1, d = c - 1;
      indices.insert(indices.end(), {a, b, c, a, c, d});
    }
  }
  skyIndexCount = glCount(indices.size());
  skyVertexArray = gpu.makeVertexArray();
  gl.BindVertexArray(skyVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ARRAY_BUFFER, positions.size() * sizeof(positions[0]), positions.data(), GL_STATIC_DRAW);
  attribute(0, 2, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector2f), 0);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.makeBuffer());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, indices.size() * sizeof(std::uint32_t), indices.data(), GL_STATIC_DRAW);
}

void Renderer::Impl::createSkin(SkinGpu& skin) {
  skin.vertexArray = gpu.makeVertexArray();
  skin.vertices.id = gpu.makeBuffer();
  skin.colors.id = gpu.makeBuffer();
  skin.indices = gpu.makeBuffer();
  gl.BindVertexArray(skin.vertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, skin.vertices.id);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(SkinMesh::Vertex), offsetof(SkinMesh::Vertex, position));
  attribute(1, 3, GL_FLOAT, GL_FALSE, sizeof(SkinMesh::Vertex), offsetof(SkinMesh::Vertex, normal));
  gl.BindBuffer(GL_ARRAY_BUFFER, skin.colors.id);
  attribute(2, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), 0);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, skin.indices);
}

void Renderer::Impl::createMeshes() {
  emptyVertexArray = gpu.makeVertexArray();
  frameBlock = gpu.makeBuffer();
  gl.BindBuffer(GL_UNIFORM_BUFFER, frameBlock);
  gl.BufferData(GL_UNIFORM_BUFFER, sizeof(FrameUniforms), nullptr, GL_STREAM_DRAW);

  hullVertexArray = gpu.makeVertexArray();
  hullBuffer.id = gpu.makeBuffer();
  overlayAttributes(hullVertexArray, hullBuffer);
  insideVertexArray = gpu.makeVertexArray();
  insideBuffer.id = gpu.makeBuffer();
  overlayAttributes(insideVertexArray, insideBuffer);
  boneVertexArray = gpu.makeVertexArray();
  boneBuffer.id = gpu.makeBuffer();
  overlayAttributes(boneVertexArray, boneBuffer);

  for (std::size_t shape = 0; shape < propShapes.size(); ++shape) {
    createPropShape(propShapes[shape], makePropMesh(static_cast<PropShape>(shape)));
  }

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

  grainVertexArray = gpu.makeVertexArray();
  grainBuffer.id = gpu.makeBuffer();
  gl.BindVertexArray(grainVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, grainBuffer.id);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(GrainVertex), offsetof(GrainVertex, center));
  attribute(1, 4, GL_FLOAT, GL_FALSE, sizeof(GrainVertex), offsetof(GrainVertex, color));
  dropVertexArray = gpu.makeVertexArray();
  dropBuffer.id = gpu.makeBuffer();
  gl.BindVertexArray(dropVertexArray);
  gl.BindBuffer(GL_ARRAY_BUFFER, dropBuffer.id);
  attribute(0, 3, GL_FLOAT, GL_FALSE, sizeof(DropVertex), offsetof(DropVertex, center));
  attribute(1, 2, GL_FLOAT, GL_FALSE, sizeof(DropVertex), offsetof(DropVertex, foam));
  GLfloat pointSizes[2] = {1.0f, 1.0f};
  gl.GetFloatv(GL_POINT_SIZE_RANGE, pointSizes);
  maxPointSize = std::min(pointSizes[1], 256.0f);
  const auto* renderer = reinterpret_cast<const char*>(gl.GetString(GL_RENDERER));
  const std::string_view name = renderer != nullptr ? renderer : "";
  software = name.find("llvmpipe") != std::string_view::npos || name.find("softpipe") != std::string_view::npos;

  createSky();
  caption.texture = gpu.makeTexture(GL_NEAREST);
  panel.texture = gpu.makeTexture(GL_NEAREST);
  insetTexture = gpu.makeTexture(GL_LINEAR);
}

}  // namespace lorica
