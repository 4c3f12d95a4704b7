#pragma once

#include "acd/decomposition.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// GPU data of a posed skin. Vertices on the border of two parts are duplicated, so that each part has its flat colour
/// while the normals are smooth across the border.
class SkinMesh {
 public:
  struct Vertex {
    Vec3f position;
    Vec3f normal;
  };

  /// Sets this frame's positions. Rebuilds indices and colours only if triangles or parts changed.
  /// @param partOfTriangle  as many as triangles, or empty for one colour
  /// @return whether `indices` and `colors` changed
  bool update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
              std::span<const PartIndex> partOfTriangle);

  [[nodiscard]] const std::vector<Vertex>& vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<std::uint32_t>& indices() const { return indices_; }
  /// Muted part colour of each vertex, linear RGB.
  [[nodiscard]] const std::vector<Vec3f>& colors() const { return colors_; }
  [[nodiscard]] std::size_t triangleCount() const { return triangles_.size(); }
  /// Whether the mesh is closed: each edge has its opposite, so back faces are never visible.
  [[nodiscard]] bool closed() const { return closed_; }

  /// Colour of the skin without part colours: warm clay.
  static Vec3f clay() { return {0.62f, 0.53f, 0.46f}; }
  /// Muted colour of a part.
  static Vec3f colorOf(PartIndex part);

 private:
  void rebuild(std::span<const Vec3> positions);

  std::size_t positionCount_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<PartIndex> partOfTriangle_;
  std::vector<std::int32_t> source_;      ///< for each vertex, its position
  std::vector<std::int32_t> normalSlot_;  ///< for each position, the index of its normal; shared at seams
  std::vector<Vec3f> normals_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<Vec3f> colors_;
  bool closed_ = false;
};

}  // namespace lorica
