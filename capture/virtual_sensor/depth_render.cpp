#include "capture/virtual_sensor/depth_render.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

/// Geometry nearer to the pinhole's plane is clipped [m].
constexpr double kNearest = 0.05;

/// The first and last pixel whose centre is in [from, to], within 0 .. count - 1; empty if an end is not a number.
std::pair<int, int> pixelsIn(double from, double to, int count) {
  if (!(from <= to)) return {0, -1};
  const double first = std::clamp(std::ceil(from - 0.5), 0.0, static_cast<double>(count));
  const double last = std::clamp(std::floor(to - 0.5), -1.0, count - 1.0);
  return {static_cast<int>(first), static_cast<int>(last)};
}

}  // namespace

DepthRenderer::DepthRenderer(const DepthCamera& camera)
    : camera_(camera),
      focalX_(camera.focalX()),
      focalY_(camera.focalY()),
      inverseDepth_(static_cast<std::size_t>(camera.width) * camera.height, 0.0F),
      labels_(inverseDepth_.size(), 0) {}

void DepthRenderer::clear() {
  std::fill(inverseDepth_.begin(), inverseDepth_.end(), 0.0F);
  std::fill(labels_.begin(), labels_.end(), std::uint8_t{0});
}

DepthRenderer::Seen DepthRenderer::project(const Vec3& position) const {
  const double inverse = -1.0 / position.z();
  return {0.5 * camera_.width + focalX_ * position.x() * inverse,
          0.5 * camera_.height - focalY_ * position.y() * inverse, inverse};
}

void DepthRenderer::draw(std::span<const Vec3> positions, std::span<const Triangle> triangles, SurfaceSides sides,
                         std::uint8_t label) {
  seen_.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    seen_[i] = positions[i].z() <= -kNearest ? project(positions[i]) : Seen{0.0, 0.0, 0.0};
  }
  for (const Triangle& triangle : triangles) {
    const std::size_t a = triangle[0];
    const std::size_t b = triangle[1];
    const std::size_t c = triangle[2];
    if (seen_[a].inverse > 0.0 && seen_[b].inverse > 0.0 && seen_[c].inverse > 0.0) {
      drawSeen(seen_[a], seen_[b], seen_[c], sides, label);
    } else {
      drawClipped({positions[a], positions[b], positions[c]}, sides, label);
    }
  }
}

void DepthRenderer::drawClipped(const std::array<Vec3, 3>& corners, SurfaceSides sides, std::uint8_t label) {
  // The part beyond the near plane is a triangle or a quadrilateral.
  std::array<Seen, 4> kept{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& from = corners[i];
    const Vec3& to = corners[(i + 1) % 3];
    if (!from.allFinite() || !to.allFinite()) return;
    const double fromIn = -kNearest - from.z();
    const double toIn = -kNearest - to.z();
    if (fromIn >= 0.0) kept[count++] = project(from);
    if ((fromIn >= 0.0) != (toIn >= 0.0)) {
      Vec3 cut = from + fromIn / (fromIn - toIn) * (to - from);
      cut.z() = -kNearest;
      kept[count++] = project(cut);
    }
  }
  for (std::size_t i = 2; i < count; ++i) drawSeen(kept[0], kept[i - 1], kept[i], sides, label);
}

void DepthRenderer::drawSeen(const Seen& a, const Seen& b, const Seen& c, SurfaceSides sides, std::uint8_t label) {
  // Rows increase downwards, so triangles that are counter-clockwise from the camera have a negative area here.
  const double area = (b.column - a.column) * (c.row - a.row) - (c.column - a.column) * (b.row - a.row);
  if (!std::isfinite(area) || area == 0.0 || (sides == SurfaceSides::kOuter && area > 0.0)) return;

  // Sort from the top corner to the bottom one. Adjacent triangles process a common edge with the same two ends in the
  // same order, so both compute bit-identical crossings, and no pixel is left out between them.
  std::array<const Seen*, 3> sorted = {&a, &b, &c};
  const auto above = [](const Seen* p, const Seen* q) {
    return p->row < q->row || (p->row == q->row && p->column < q->column);
  };
  if (above(sorted[1], sorted[0])) std::swap(sorted[0], sorted[1]);
  if (above(sorted[2], sorted[1])) std::swap(sorted[1], sorted[2]);
  if (above(sorted[1], sorted[0])) std::swap(sorted[0], sorted[1]);
  const auto& [top, middle, bottom] = sorted;
  const auto [firstRow, lastRow] = pixelsIn(top->row, bottom->row, camera_.height);
  if (firstRow > lastRow) return;

  const auto slope = [](const Seen* from, const Seen* to) {
    return to->row > from->row ? (to->column - from->column) / (to->row - from->row) : 0.0;
  };
  const double whole = slope(top, bottom);
  const double upper = slope(top, middle);
  const double lower = slope(middle, bottom);

  // Inverse depth is affine in the image. Slivers have no reliable gradient: clamp to the values at the corners.
  const double perColumn =
      ((b.inverse - a.inverse) * (c.row - a.row) - (c.inverse - a.inverse) * (b.row - a.row)) / area;
  const double perRow =
      ((c.inverse - a.inverse) * (b.column - a.column) - (b.inverse - a.inverse) * (c.column - a.column)) / area;
  const float min = std::min({a.inverse, b.inverse, c.inverse});
  const float max = std::max({a.inverse, b.inverse, c.inverse});
  const float step = perColumn;

  for (int row = firstRow; row <= lastRow; ++row) {
    const double y = row + 0.5;
    const double x0 = top->column + (y - top->row) * whole;
    const double x1 =
        y < middle->row ? top->column + (y - top->row) * upper : middle->column + (y - middle->row) * lower;
    const auto [first, last] = pixelsIn(std::min(x0, x1), std::max(x0, x1), camera_.width);
    const float start = a.inverse + perColumn * (first + 0.5 - a.column) + perRow * (y - a.row);
    const std::size_t at = static_cast<std::size_t>(row) * camera_.width + first;
    for (int i = 0; i <= last - first; ++i) {
      const float inverse = std::clamp(start + step * i, min, max);
      float& held = inverseDepth_[at + i];
      if (inverse > held) {
        held = inverse;
        labels_[at + i] = label;
      }
    }
  }
}

void DepthRenderer::drawPlane(const Vec3& normal, double offset, std::uint8_t label) {
  LORICA_CHECK(offset != 0.0, "a plane through the pinhole cannot be drawn");
  // A ray (x, y, -1) meets the plane at depth offset / (normal . ray).
  const double perColumn = normal.x() / offset / focalX_;
  const double perRow = -normal.y() / offset / focalY_;
  std::size_t at = 0;
  for (int row = 0; row < camera_.height; ++row) {
    const double start =
        (0.5 - 0.5 * camera_.width) * perColumn + (row + 0.5 - 0.5 * camera_.height) * perRow - normal.z() / offset;
    for (int column = 0; column < camera_.width; ++column, ++at) {
      const float inverse = start + column * perColumn;
      if (inverse > inverseDepth_[at] && inverse < 1.0 / kNearest) {
        inverseDepth_[at] = inverse;
        labels_[at] = label;
      }
    }
  }
}

}  // namespace lorica
