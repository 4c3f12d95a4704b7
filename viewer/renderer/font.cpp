#include "viewer/renderer/font.h"

#include "geometry/files.h"

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
#include <utility>
#include <vector>

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

double advanceOf(char32_t character, double em) {
  int glyph = 0, advance = 0, bearing = 0;
  const Font* font = fontWith(character, glyph);
  if (font == nullptr) return kBlank * em;
  stbtt_GetGlyphHMetrics(&font->info, glyph, &advance, &bearing);
  return advance * static_cast<double>(stbtt_ScaleForMappingEmToPixels(&font->info, em));
}

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

}  // namespace lorica
