#include "viewer/window/panel_font.h"

#include "viewer/renderer/stroke_font.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace lorica {
namespace {

constexpr int kOversampling = 8;
constexpr double kCapPerLine = 0.58;       // height of capitals per line height
constexpr double kStrokePerCap = 0.13;     // thickness of a stroke per height of capitals
constexpr double kBaselinePerLine = 0.76;  // from the top of a line
constexpr double kBlankPerLine = 0.30;     // the stroke font's own blank is as wide as a letter
constexpr int kFirst = ' ' + 1, kLast = '~';

struct Glyph {
  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;
  float advance = 0.0f;
};

Glyph drawGlyph(char c, int lineHeight) {
  const double cap = kCapPerLine * lineHeight * kOversampling;
  const StrokeStyle style{kOversampling, cap / kStrokeCapHeight,
                          std::max(1, static_cast<int>(std::lround(kStrokePerCap * cap))), false};
  const StrokeLine line{std::string(1, c), style.thickness / 2,
                        static_cast<int>(kBaselinePerLine * lineHeight * kOversampling)};
  // Its width is the advance plus the thickness of one stroke.
  const int wide = strokeWidth(line.text, style);
  Glyph glyph;
  glyph.advance = static_cast<float>(wide - style.thickness) / kOversampling;
  glyph.width = (wide + style.thickness + kOversampling - 1) / kOversampling;
  glyph.height = lineHeight;
  glyph.coverage.resize(static_cast<std::size_t>(glyph.width) * static_cast<std::size_t>(glyph.height));
  drawStrokes({&line, 1}, style, glyph.width, glyph.height, glyph.coverage);
  return glyph;
}

}  // namespace

void fillPanelFont(ImFontAtlas& atlas, int lineHeight) {
  // The library's own font provides size and blank; all other glyphs are replaced.
  atlas.Clear();
  const std::array<ImWchar, 3> blank = {' ', ' ', 0};
  ImFontConfig config;
  config.SizePixels = static_cast<float>(lineHeight);
  config.GlyphRanges = blank.data();
  config.OversampleH = 1;
  ImFont* font = atlas.AddFontDefault(&config);
  std::array<Glyph, kLast - kFirst + 1> glyphs;
  std::array<int, kLast - kFirst + 1> positions{};
  for (int c = kFirst; c <= kLast; ++c) {
    const auto i = static_cast<std::size_t>(c - kFirst);
    glyphs[i] = drawGlyph(static_cast<char>(c), lineHeight);
    positions[i] = atlas.AddCustomRectFontGlyph(font, static_cast<ImWchar>(c), glyphs[i].width, glyphs[i].height,
                                                glyphs[i].advance, ImVec2(0.0f, 0.0f));
  }
  const auto blankAdvance = static_cast<float>(kBlankPerLine * lineHeight);
  const int blankPosition = atlas.AddCustomRectFontGlyph(font, ' ', 1, 1, blankAdvance);
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&pixels, &width, &height);
  const ImFontAtlasCustomRect* blankRect = atlas.GetCustomRectByIndex(blankPosition);
  pixels[static_cast<std::ptrdiff_t>(blankRect->Y) * width + blankRect->X] = 0;
  for (std::size_t i = 0; i < glyphs.size(); ++i) {
    const ImFontAtlasCustomRect* position = atlas.GetCustomRectByIndex(positions[i]);
    for (int y = 0; y < glyphs[i].height; ++y) {
      const std::uint8_t* row = glyphs[i].coverage.data() + static_cast<std::ptrdiff_t>(y) * glyphs[i].width;
      std::copy_n(row, glyphs[i].width, pixels + static_cast<std::ptrdiff_t>(position->Y + y) * width + position->X);
    }
  }
}

}  // namespace lorica
