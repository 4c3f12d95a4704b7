#include "viewer/renderer/picture_area.h"

#include "geometry/counts.h"

#include <algorithm>
#include <cmath>

namespace lorica {

ViewAxes axesOf(const Camera& camera) {
  ViewAxes axes;
  const Vec3 along = camera.target - camera.eye;
  axes.forward = along.norm() > 1e-9 ? Vec3(along.normalized()) : Vec3(0, 0, -1);
  const Vec3 right = axes.forward.cross(camera.up);
  axes.right = right.norm() > 1e-6 ? Vec3(right.normalized()) : Vec3::UnitX();
  axes.up = axes.right.cross(axes.forward);
  return axes;
}

Vec3 directionAt(double azimuth, double elevation) {
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

std::array<Vec3, 8> cornersOf(const Aabb& box) {
  std::array<Vec3, 8> corners;
  for (int c = 0; c < 8; ++c) {
    corners[c] = Vec3((c & 1) != 0 ? box.max.x() : box.min.x(), (c & 2) != 0 ? box.max.y() : box.min.y(),
                      (c & 4) != 0 ? box.max.z() : box.min.z());
  }
  return corners;
}

double distanceToSee(std::span<const Vec3> points, const Camera& camera, const PictureArea& area, double aspect) {
  const ViewAxes axes = axesOf(camera);
  const double high = area.half.y() * std::tan(0.5 * camera.verticalFov);
  const double wide = area.half.x() * std::tan(0.5 * camera.verticalFov) * aspect;
  double distance = 0.0;
  for (const Vec3& point : points) {
    const Vec3 from = point - camera.target;
    const double depth = std::max(std::abs(from.dot(axes.right)) / wide, std::abs(from.dot(axes.up)) / high);
    distance = std::max(distance, depth - from.dot(axes.forward));
  }
  return distance;
}

PictureArea freeArea(float width, float height, std::span<const PixelArea> panels) {
  // A rectangle that cannot grow ends at a panel or at the picture's edge at each of its sides.
  const int count = countOf(panels);
  const auto edge = [&](int panel, float PixelArea::*side, float whole) {
    return panel < 0 ? whole : std::clamp(panels[panel].*side, 0.0f, std::max(width, height));
  };
  const auto isFree = [&](const PixelArea& area) {
    return std::none_of(panels.begin(), panels.end(), [&](const PixelArea& p) {
      return p.left < area.right && p.right > area.left && p.top < area.bottom && p.bottom > area.top;
    });
  };
  PixelArea best{0, 0, width, height};
  float shorter = 0.0f, size = 0.0f;
  for (int l = -1; l < count; ++l) {
    for (int r = -1; r < count; ++r) {
      for (int t = -1; t < count; ++t) {
        for (int b = -1; b < count; ++b) {
          const PixelArea area{edge(l, &PixelArea::right, 0.0f), edge(t, &PixelArea::bottom, 0.0f),
                               edge(r, &PixelArea::left, width), edge(b, &PixelArea::top, height)};
          const float w = area.right - area.left, h = area.bottom - area.top, least = std::min(w, h);
          if (least <= 0.0f || least < shorter || (least == shorter && w * h <= size) || !isFree(area)) continue;
          best = area;
          shorter = least;
          size = w * h;
        }
      }
    }
  }
  PictureArea free;
  free.middle << (best.left + best.right) / width - 1.0, 1.0 - (best.top + best.bottom) / height;
  free.half << (best.right - best.left) / width, (best.bottom - best.top) / height;
  return free;
}

}  // namespace lorica
