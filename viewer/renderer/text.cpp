#include "viewer/renderer/text.h"

#include "geometry/files.h"

#include <fmt/format.h>
#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#include <stb/stb_truetype.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <sstream>
#include <utility>

namespace lorica {
namespace {

constexpr char32_t kUnknown = U'\ufffd';
constexpr double kBlank = 0.5;  // advance without any font [em]

struct Font {
  std::string bytes;
  stbtt_fontinfo info{};
};

/// The fonts in the order in which they are asked; each is read when it is first needed.
class Fonts {
 public:
  /// @return null if there is no font at all
  const Font* with(char32_t character, int& glyph) {
    const std::lock_guard lock(mutex_);
    for (const char32_t wanted : {character, kUnknown, U'?'}) {
      for (Slot& slot : slots_) {
        if (const Font* font = slot.open()) {
          glyph = stbtt_FindGlyphIndex(&font->info, wanted);
          if (glyph != 0) return font;
        }
      }
    }
    if (!std::exchange(warned_, true)) {
      std::fputs("lorica: pictures have no lettering: no font was found; the package fonts-dejavu-core has one\n",
                 stderr);
    }
    return nullptr;
  }

 private:
  struct Slot {
    const char* name;
    bool tried = false;
    std::unique_ptr<Font> font = nullptr;

    const Font* open() {
      if (std::exchange(tried, true)) return font.get();
      const char* folder = std::getenv("LORICA_FONTS");
      Result<std::string> bytes = readFile(std::filesystem::path(folder ? folder : "/usr/share/fonts") / name);
      if (!bytes) return nullptr;
      auto opened = std::make_unique<Font>();
      opened->bytes = std::move(*bytes);
      const auto* data = reinterpret_cast<const unsigned char*>(opened->bytes.data());
      const int offset = stbtt_GetFontOffsetForIndex(data, 0);
      if (offset >= 0 && stbtt_InitFont(&opened->info, data, offset) != 0) font = std::move(opened);
      return font.get();
    }
  };

  std::array<Slot, 3> slots_ = {{{"truetype/dejavu/DejaVuSans.ttf"},
                                 {"opentype/noto/NotoSansCJK-Regular.ttc"},
                                 {"truetype/droid/DroidSansFallbackFull.ttf"}}};
  bool warned_ = false;  // that there is no font
  std::mutex mutex_;     // pictures are drawn in several threads
};

const Font* fontWith(char32_t character, int& glyph) {
  static Fonts fonts;
  return fonts.with(character, glyph);
}

/// @param em  size of the font [pixels]
double advanceOf(char32_t character, double em) {
  int glyph = 0, advance = 0, bearing = 0;
  const Font* font = fontWith(character, glyph);
  if (font == nullptr) return kBlank * em;
  stbtt_GetGlyphHMetrics(&font->info, glyph, &advance, &bearing);
  return advance * static_cast<double>(stbtt_ScaleForMappingEmToPixels(&font->info, em));
}

/// Adds a character to a mask.
/// @param x, baseline  where it starts [pixels]
/// @param coverage     0 to 255, rows from the top
void drawCharacter(char32_t character, double em, double x, double baseline, int width, int height,
                   std::span<std::uint8_t> coverage) {
  int glyph = 0;
  const Font* font = fontWith(character, glyph);
  if (font == nullptr) return;
  const float scale = stbtt_ScaleForMappingEmToPixels(&font->info, em);
  const double left = std::floor(x), top = std::floor(baseline);
  const float shiftX = x - left, shiftY = baseline - top;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  stbtt_GetGlyphBitmapBoxSubpixel(&font->info, glyph, scale, scale, shiftX, shiftY, &x0, &y0, &x1, &y1);
  if (x1 <= x0 || y1 <= y0) return;
  const int wide = x1 - x0;
  std::vector<std::uint8_t> drawn(static_cast<std::size_t>(wide) * (y1 - y0));
  stbtt_MakeGlyphBitmapSubpixel(&font->info, drawn.data(), wide, y1 - y0, wide, scale, scale, shiftX, shiftY, glyph);
  for (int y = y0; y < y1; ++y) {
    const int row = y + top;
    if (row < 0 || row >= height) continue;
    for (int column = x0; column < x1; ++column) {
      const int at = column + left;
      if (at < 0 || at >= width) continue;
      std::uint8_t& pixel = coverage[static_cast<std::size_t>(row) * width + at];
      pixel = std::min(255, pixel + drawn[(y - y0) * wide + (column - x0)]);
    }
  }
}

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

std::u32string charactersOf(std::string_view utf8) {
  std::u32string characters;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i++]);
    if (first < 0x80) {
      const bool control = (first < 0x20 && first != '\n' && first != '\t') || first == 0x7f;
      characters += control ? U' ' : first;
      continue;
    }
    const int more = first >= 0xf0 && first < 0xf5 ? 3 : first >= 0xe0 ? 2 : 1;
    char32_t character = first & (0x3f >> more);
    int seen = 0;
    for (; seen < more && i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80; ++seen) {
      character = character << 6 | (static_cast<unsigned char>(utf8[i++]) & 0x3f);
    }
    characters += first < 0xc2 || first > 0xf4 || seen < more ? kUnknown : character;
  }
  return characters;
}

std::string_view fontFileFor(char32_t character) {
  int glyph = 0;
  const Font* font = fontWith(character, glyph);
  return font != nullptr ? std::string_view(font->bytes) : std::string_view();
}

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
