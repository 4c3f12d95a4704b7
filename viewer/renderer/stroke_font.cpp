#include "viewer/renderer/stroke_font.h"

#include "geometry/module.h"
#include "viewer/renderer/stroke_font_module.h"

namespace lorica {
namespace {

const StrokeFontModule& strokeFont() {
  static const StrokeFontModule& module = []() -> const StrokeFontModule& {
    const Result<const void*> loaded = loadModule("stroke_font", kStrokeFontSymbol, "drawing text");
    LORICA_CHECK(loaded.ok(), loaded.error().message.c_str());  // it is installed with the program
    return *static_cast<const StrokeFontModule*>(*loaded);
  }();
  return module;
}

}  // namespace

int strokeWidth(const std::string& text, const StrokeStyle& style) {
  return strokeFont().strokeWidth(text, style);
}

void drawStrokes(std::span<const StrokeLine> lines, const StrokeStyle& style, int width, int height,
                 std::span<std::uint8_t> coverage) {
  strokeFont().drawStrokes(lines, style, width, height, coverage);
}

}  // namespace lorica
