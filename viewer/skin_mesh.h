#pragma once

#include "acd/decomposition.h"
#include "geometry/tri_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A posed skin as the GPU wants it. Vertices on the border of two parts are doubled, so that each part keeps its
/// flat colour while the normals stay smooth across the border.
class SkinMesh {
 public:
  struct Vertex {
    Vec3f position;
    Vec3f normal;
  };

  /// Takes this frame's positions. Rebuilds indices and colours only when triangles or parts changed.
  /// @param partOfTriangle  as many as triangles, or empty for one colour
  /// @return whether `indices` and `colors` changed
  bool update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
              std::span<const PartIndex> partOfTriangle);

  [[nodiscard]] const std::vector<Vertex>& vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<std::uint32_t>& indices() const { return indices_; }
  /// Muted part colour of each vertex, linear RGB.
  [[nodiscard]] const std::vector<Vec3f>& colors() const { return colors_; }
  [[nodiscard]] std::size_t triangleCount() const { return triangles_.size(); }
  /// Every edge has its opposite: back faces can never be seen.
  [[nodiscard]] bool closed() const { return closed_; }

  /// Colour of skin that shows no parts: warm clay.
  static Vec3f clay() { return {0.62f, 0.53f, 0.46f}; }

 private:
  void rebuild(std::span<const Vec3> positions);

  std::size_t positionCount_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<PartIndex> partOfTriangle_;
  std::vector<std::int32_t> source_;      ///< for each vertex, its position
  std::vector<std::int32_t> normalSlot_;  ///< for each position, where its normal gathers; shared at seams
  std::vector<Vec3f> normals_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<Vec3f> colors_;
  bool closed_ = false;
};

}  // namespace lorica
