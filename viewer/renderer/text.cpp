#include "viewer/renderer/text.h"

#include "viewer/renderer/font.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace lorica {
namespace {

constexpr double kEmPerLine = 0.71;        // size of the font per line height
constexpr double kTabPerLine = 5.5;        // distance of tab stops per line height
constexpr double kBaselinePerLine = 0.74;  // from the top of a line

int lineOf(int lineHeight) {
  return std::max(lineHeight, 6);
}

/// Beside the text, at both sides [pixels].
int marginOf(int line) {
  return std::max(1, line / 12);
}

/// Characters and where their lines start and end [pixels].
struct PlacedText {
  struct Character {
    char32_t character;
    double x;
    int row;
  };
  std::vector<Character> characters;
  double width = 0.0;
  int rows = 1;
};

PlacedText placed(std::string_view text, int line) {
  PlacedText all;
  double x = 0.0;
  int column = 0;
  for (const char32_t c : charactersOf(text)) {
    if (c == U'\n') {
      ++all.rows;
      x = column = 0;
    } else if (c == U'\t') {
      x = ++column * kTabPerLine * line;
    } else {
      all.characters.push_back({c, x, all.rows - 1});
      x += advanceOf(c, kEmPerLine * line);
      all.width = std::max(all.width, x);
    }
  }
  return all;
}

int maskWidth(const PlacedText& text, int line) {
  return std::ceil(text.width) + 2 * marginOf(line);
}

}  // namespace

TextMask drawText(std::string_view text, int lineHeight) {
  const int line = lineOf(lineHeight);
  const PlacedText all = placed(text, line);
  TextMask mask;
  mask.width = maskWidth(all, line);
  mask.height = all.rows * line;
  mask.coverage.resize(static_cast<std::size_t>(mask.width) * mask.height);
  for (const auto& [c, x, row] : all.characters) {
    drawCharacter(c, kEmPerLine * line, marginOf(line) + x, row * line + std::round(kBaselinePerLine * line),
                  mask.width, mask.height, mask.coverage);
  }
  return mask;
}

std::string fittedText(std::string_view text, int lineHeight, int width) {
  const int height = lineOf(lineHeight);
  const auto fits = [&](const std::string& line) { return maskWidth(placed(line, height), height) <= width; };
  std::istringstream words{std::string(text)};
  std::string all, line, word, blanks;
  const auto endLine = [&] {
    if (!all.empty()) all += '\n';
    all += line;
    line.clear();
  };
  while (words >> word) {
    if (!line.empty() && !fits(fmt::format("{}{}{}", line, blanks, word))) endLine();
    if (!line.empty()) line += blanks;
    if (!fits(word)) {
      while (!word.empty() && !fits(fmt::format("{}..", word))) {
        while (word.size() > 1 && (static_cast<unsigned char>(word.back()) & 0xc0) == 0x80) word.pop_back();
        word.pop_back();
      }
      word += "..";
    }
    line += word;
    blanks.clear();
    while (words.peek() == ' ') blanks += words.get();
  }
  endLine();
  return all;
}

Image drawTextPanel(std::string_view text, int lineHeight) {
  constexpr double kPlateAlpha = 0.72;
  const TextMask mask = drawText(text, lineHeight);
  const int margin = std::max(2, lineHeight / 3);
  const double radius = 0.9 * margin;
  Image panel = Image::filled(mask.width + 2 * margin, mask.height + margin);
  const std::array<double, 3> ink = {38, 44, 54};
  for (int y = 0; y < panel.height; ++y) {
    for (int x = 0; x < panel.width; ++x) {
      // The distance to the plate, shrunk by its corner radius, gives an anti-aliased rim.
      const double dx = std::max({radius - (x + 0.5), x + 0.5 - (panel.width - radius), 0.0});
      const double dy = std::max({radius - (y + 0.5), y + 0.5 - (panel.height - radius), 0.0});
      const double plate = kPlateAlpha * std::clamp(radius - std::hypot(dx, dy) + 0.5, 0.0, 1.0);
      const int tx = x - margin;
      const int ty = y - margin / 2;
      const bool inside = tx >= 0 && ty >= 0 && tx < mask.width && ty < mask.height;
      const double cover = inside ? mask.coverage[static_cast<std::size_t>(ty) * mask.width + tx] / 255.0 : 0.0;
      std::uint8_t* pixel = panel.pixel(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = std::lround(ink[c] * cover + 255.0 * plate * (1.0 - cover));
      }
      pixel[3] = std::lround(255.0 * (cover + plate * (1.0 - cover)));
    }
  }
  return panel;
}

}  // namespace lorica
