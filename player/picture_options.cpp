#include "player/picture_options.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <system_error>
#include <utility>

namespace lorica {

std::optional<CanvasSize> pictureSizeOf(std::string_view text) {
  if (text == "portrait") return CanvasSize{1080, 1920};
  if (text == "square") return CanvasSize{1080, 1080};
  CanvasSize size;
  const char* end = text.data() + text.size();
  const auto [cross, first] = std::from_chars(text.data(), end, size.width);
  if (first != std::errc() || cross == end || *cross != 'x') return std::nullopt;
  const auto [stopped, second] = std::from_chars(cross + 1, end, size.height);
  if (second != std::errc() || stopped != end) return std::nullopt;
  for (const int side : {size.width, size.height}) {
    if (side < kSmallestSide || side > kLargestSide) return std::nullopt;
  }
  return size;
}

bool setBackground(std::string_view text, SceneOptions& show) {
  if (text.empty()) return true;
  show.transparent = text == "transparent";
  show.ground = false;
  if (show.transparent) return true;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kNames = {
      {{"green", "#00ff00"}, {"blue", "#0000ff"}, {"white", "#ffffff"}, {"black", "#000000"}, {"gray", "#808080"}}};
  for (const auto& [name, meant] : kNames) {
    if (text == name) text = meant;
  }
  std::uint32_t color = 0;
  const char* end = text.data() + text.size();
  const bool written = text.size() == 7 && text[0] == '#';
  if (!written || std::from_chars(text.data() + 1, end, color, 16).ptr != end) return false;
  show.background = Vec3f((color >> 16) / 255.0f, (color >> 8 & 0xff) / 255.0f, (color & 0xff) / 255.0f);
  return true;
}

}  // namespace lorica
