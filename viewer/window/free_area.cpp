#include "viewer/window/free_area.h"

#include "geometry/counts.h"

#include <algorithm>

namespace lorica {

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
