#pragma once

#include "viewer/renderer/gpu.h"
#include "viewer/renderer/grain_list.h"

#include <vector>

namespace lorica {

/// Vertex shader input of one drop.
struct DropVertex {
  Vec3f center;
  float foam;  ///< 0 to 1
  float size;  ///< to the radius of all: drops by themselves are smaller
};

/// What of water does not depend on its surface: in cells of a picture, how much of it lies behind one another, and
/// which drops foam.
class WaterCells {
 public:
  /// @param list        the drops, chosen for this view
  /// @param velocities  of each drop [m/s]; empty = no foam
  /// @param spacing     a drop has the volume of a cube of this side [m]
  /// @param across      width and height that the cells cover at a depth of 1 m [m]
  /// @return the chosen drops
  const std::vector<DropVertex>& make(std::span<const Vec3f> centers, std::span<const Vec3f> velocities,
                                      std::span<const std::uint32_t> chosen, const GrainList& list,
                                      const GrainView& view, float spacing, const Eigen::Vector2f& across);

  /// Metres of water in each cell, row by row from below.
  [[nodiscard]] const std::vector<float>& thickness() const { return thickness_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }

 private:
  [[nodiscard]] std::int32_t cellOf(std::int32_t fine, int fineColumns) const;

  int columns_ = 0, rows_ = 0;
  std::vector<float> thickness_, sharp_, count_;
  std::vector<Vec3f> velocity_;
  std::vector<DropVertex> drops_;
};

/// The framebuffers that water is drawn with, made when there is some.
struct WaterTargets {
  int width = 0, height = 0;                       ///< of the maps [pixels]
  int behindWidth = 0, behindHeight = 0;           ///< of the picture without water [pixels]
  GLuint surface[2] = {}, surfaceMap[2] = {};      ///< depth [m], minus foam
  GLuint normals = 0, normalMap = 0;               ///< normal to the right and up, depth [m], foam
  GLuint behind = 0, behindMap = 0, depthMap = 0;  ///< the picture without water
  GLuint thicknessMap = 0;

  void resize(Gpu& gpu, int pictureWidth, int pictureHeight, int divisor);
};

}  // namespace lorica
